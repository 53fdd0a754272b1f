#!/usr/bin/env python3
"""Takes jobs back from Slurm: `cancel.py NUMBER...`."""

import subprocess
import sys

sys.exit(subprocess.run(["scancel", *sys.argv[1:]]).returncode)
