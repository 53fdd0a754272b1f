#!/usr/bin/env bash
# Installs what clipgs needs, from the distribution's own packages: Debian 12 or newer, Ubuntu 24.04.
# Does nothing, and needs no rights, when everything is there already.
#
#   scripts/setup.sh            everything: to build, to test and to check the style
#   scripts/setup.sh --build    only what is needed to build and run
set -euo pipefail
cd "$(dirname "$0")/.."

case "${1:-}" in
  "") with_checks=1 ;;
  --build) with_checks=0 ;;
  *)
    echo "usage: scripts/setup.sh [--build]" >&2
    exit 2
    ;;
esac

readonly node_wanted=18 # as web/package.json says

if ! command -v apt-get >/dev/null; then
  echo "setup: this script speaks apt only; on other systems install the libraries that" >&2
  echo "setup: CMakeLists.txt names (GDCM 3, oneTBB, Highway, GLM, fmt, CLI11, libwebp, ...)" >&2
  exit 1
fi

as_root() {
  if [ "$(id -u)" -eq 0 ]; then
    env DEBIAN_FRONTEND=noninteractive "$@"
  else
    sudo env DEBIAN_FRONTEND=noninteractive "$@"
  fi
}

installed() {
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

available() {
  [ -n "$(apt-cache madison "$1" 2>/dev/null)" ]
}

updated=0
update_lists() {
  if [ "$updated" -eq 0 ]; then
    echo "setup: reading the package lists"
    as_root apt-get update -qq
    updated=1
  fi
}

# While packages are installed Debian's scripts ask this before they start a service; only tests start what is a server
# among ours, each its own.
readonly policy=/usr/sbin/policy-rc.d
forbid_services() {
  if [ ! -e "$policy" ]; then
    local refusal
    refusal="$(mktemp)"
    printf '#!/bin/sh\nexit 101\n' >"$refusal"
    as_root install -m 755 "$refusal" "$policy"
    rm -f "$refusal"
    trap 'as_root rm -f "$policy"' EXIT
  fi
}

install_packages() {
  update_lists
  forbid_services
  echo "setup: installing $*"
  if ! as_root apt-get install -y -qq --no-install-recommends "$@" >"$log" 2>&1; then
    tail -n 20 "$log" >&2
    echo "setup: apt-get could not install the packages above; see $log" >&2
    exit 1
  fi
}

log="$(mktemp)"

packages=(
  ca-certificates git
  # build
  g++ cmake ninja-build ccache pkg-config
  # libraries
  libgdcm-dev zlib1g-dev libtbb-dev libhwy-dev libglm-dev libfmt-dev libcli11-dev
  nlohmann-json3-dev libwebp-dev libaom-dev libdav1d-dev libzstd-dev libspng-dev libarchive-dev libeigen3-dev
  libboost-dev libssl-dev libcpp-httplib-dev libqrencode-dev libcairo2-dev fonts-dejavu-core
  # clipgs render --tour writes MP4 and WebM with it
  ffmpeg
  libgtest-dev libgmock-dev libbenchmark-dev
  # the viewer's WebAssembly
  clang-19 lld-19 wasi-libc libc++-19-dev-wasm32 libclang-rt-19-dev-wasm32
)
# The browsers that the viewer is tested in, and what drives them and gives them a screen.
browsers=(chromium chromium-driver firefox-esr webkit2gtk-driver xvfb libgl1-mesa-dri)
# A hospital's archive, which the tests fetch from.
archives=(orthanc orthanc-dicomweb dcmtk)
checks=(dpkg-dev file doxygen clang-format-19 clang-tidy-19 libclang-rt-19-dev llvm-19 python3 groff-base zsh fish "${browsers[@]}"
  "${archives[@]}")
if [ "$with_checks" -eq 1 ]; then
  packages+=("${checks[@]}")
fi

missing=()
for package in "${packages[@]}"; do
  installed "$package" || missing+=("$package")
done

if [ "${#missing[@]}" -gt 0 ]; then
  update_lists
  wanted=()
  for package in "${missing[@]}"; do
    if available "$package"; then
      wanted+=("$package")
    else
      echo "setup: this system has no package $package; what needs it will be left out" >&2
    fi
  done
  if [ "${#wanted[@]}" -gt 0 ]; then
    install_packages "${wanted[@]}"
  fi
fi

# Nor does the system start it when it starts.
for package in "${missing[@]}"; do
  if [ "$package" = orthanc ] && installed orthanc; then
    as_root update-rc.d orthanc disable >/dev/null
  fi
done

# Node comes with npm or without it, depending on who packaged it.
command -v node >/dev/null || install_packages nodejs
command -v npm >/dev/null || install_packages npm

if [ "$(node --version | sed 's/^v\([0-9]*\).*/\1/')" -lt "$node_wanted" ]; then
  echo "setup: Node $(node --version) is too old, the viewer needs $node_wanted or newer" >&2
  exit 1
fi

rm -f "$log"
