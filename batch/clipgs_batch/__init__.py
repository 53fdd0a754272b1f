"""What the Snakefile, and the steps that it runs, are made of: docs/batch.md."""
