#!/usr/bin/env bash
# Speed of the path tracer: beside a plain tracer, which tests hold it to, and beside Blender's Cycles if
# that is installed (Debian's packages blender and python3-openvdb). Prints Markdown.
#
#   CLIPGS_DATA=... bench/cinema.sh
#
# Takes ten minutes on two cores. Leave the machine alone meanwhile: everything uses all of it.
set -euo pipefail
cd "$(dirname "$0")/.."

if [ -z "${CLIPGS_DATA:-}" ]; then
  echo "cinema: set CLIPGS_DATA to the folder with head.nrrd, chest.nrrd and abdomen_pelvis_3mm.nii.gz" >&2
  exit 2
fi
bash scripts/build.sh >&2
cmake --build --preset release --target cinema_bench denoise_bench >&2
readonly bench=build/release/src/cinema/cinema_bench
readonly denoise=build/release/src/cinema/denoise_bench

cat <<EOF2
Made by \`CLIPGS_DATA=... bench/cinema.sh\` on $(nproc) cores of
$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1) and no graphics card. Pictures of 512 × 512
pixels, paths of at most 4 vertices, times without loading the volume.

### Beside the plain tracer

Delta tracking against one majorant, in double precision, one path at a time. A sample is a path that
starts at the camera; adaptive ones go where the noise is.

| preset | plain reference, ns a sample | ours, samples spread evenly, ns | ours, adaptive, ns | ratio | plain, s to 35 dB | ours | ours with denoiser |
|---|---|---|---|---|---|---|---|
EOF2
"$bench" "$CLIPGS_DATA/head.nrrd" bone 16,-1024
"$bench" "$CLIPGS_DATA/head.nrrd" bone 16,-1024 0,0,-1,-117
"$bench" "$CLIPGS_DATA/chest.nrrd" muscle

cat <<EOF2

### The denoiser

Pictures of 256 × 256 pixels, mean squared errors over black as PSNR, means of 8 seeds, against a converged
picture of the same view whose own noise is taken off. The bias is the error of the mean of denoised pictures
over ever more seeds: with the noise that 8 leave in theirs taken off.

| preset | samples a pixel | as traced, dB | denoised, dB | gain, dB | bias alone, dB | its share of the error |
|---|---|---|---|---|---|---|
EOF2
"$denoise" "$CLIPGS_DATA/head.nrrd" bone 16,-1024
"$denoise" "$CLIPGS_DATA/head.nrrd" bone 16,-1024 0,0,-1,-117
"$denoise" "$CLIPGS_DATA/chest.nrrd" muscle
"$denoise" "$CLIPGS_DATA/abdomen_pelvis_3mm.nii.gz" soft-tissue

printf '\n### Beside Cycles\n\n'
if ! command -v blender >/dev/null; then
  echo "Blender is not installed."
  exit 0
fi
cat <<EOF2
$(blender --version | head -n 1) on the CPU with as many threads, the same view of the same matter and
lights (\`bench/cycles.py\`): one volume step a voxel, at most 1024 steps, no denoiser, even samples.
The preset's extinction with one colour and without surfaces, which both can do. Cycles interpolates
extinctions where clipgs interpolates values, so that its edges are fatter.

| preset | noise floor, dB | Cycles, s | ours, s | ratio | PSNR between the pictures, dB |
|---|---|---|---|---|---|
EOF2
# beside_cycles VOLUME PRESET [--hu SCALE,OFFSET]
beside_cycles() {
  local volume="$1" preset="$2"
  shift 2
  # Blender talks on stdout too.
  blender -b --factory-startup --python-exit-code 1 --python bench/cycles.py -- \
    "$CLIPGS_DATA/$volume" "presets/$preset.json" build/release/src/cli/clipgs "$@" | grep '^|'
}
beside_cycles head.nrrd bone --hu 16,-1024
beside_cycles chest.nrrd muscle

cat <<'EOF2'

An opaque body of one colour under the same lights: of Blender the isosurface as a mesh of quads with smooth normals, of clipgs the voxels, finer ones or as scanned.

| body | noise floor, dB | Cycles, s | ours, s | ratio | PSNR between the pictures, dB |
|---|---|---|---|---|---|
EOF2
for scanned in "" --as-scanned; do
  beside_cycles head.nrrd bone --hu 16,-1024 --surface 300 --spp 8,32,128 $scanned
  beside_cycles chest.nrrd muscle --surface -300 --spp 4,16,64 $scanned
done
