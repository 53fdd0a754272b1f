#!/usr/bin/env bash
# What single steps take: of training, of a picture of a face, of baking and packing. Prints Markdown.
#
#   bench/kernels.sh
set -euo pipefail
cd "$(dirname "$0")/.."
bash scripts/build.sh >&2
cmake --build --preset release --target train_bench face_bench bake_bench >&2

echo "Forward, loss, backward and Adam (\`train_bench\`): size of the picture in pixels, number of Gaussians, SH degree, and whether a plane cuts (exact)."
echo
echo '```'
build/release/src/train/train_bench --benchmark_min_time=5 2>/dev/null
echo '```'
echo
echo "A picture of 1024 × 1024 pixels of a face on one core (\`face_bench\`); \`covered\` is the share of the picture that the face takes."
echo
echo '```'
build/release/src/section/face_bench 2>/dev/null
echo '```'
echo
echo "A model of 120,000 Gaussians of SH degree 3 with random weights, 200 states, to a case (\`bake_bench\`); ClipGS-VR's states are about 6 GB a case on disk and 40 MB in the headset."
echo
echo '```'
build/release/src/asset/bake_bench 2>/dev/null
echo '```'
