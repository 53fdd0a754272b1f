#!/usr/bin/env bash
# Everything that must hold, from a bare machine to the last line: style, the release build with all its tests (C++,
# viewer, browser), and some again under sanitizers, in turn from commit to commit.
# Logs are kept in build/logs. Ends with the number of tests that passed.
#
#   scripts/test.sh          what continuous integration runs
#   scripts/test.sh --all    every room under every sanitizer: some ten minutes more
set -euo pipefail
cd "$(dirname "$0")/.."

case "${1:-}" in
  "" | --all) ;;
  *)
    echo "test: there is no $1: it is scripts/test.sh or scripts/test.sh --all" >&2
    exit 2
    ;;
esac
# At one commit half the rooms under the address and undefined-behaviour sanitizers, with every reader's fuzz target, at the
# next the other half, and then those that work on several threads under the thread sanitizer (training goes through those
# of splats as well).
turn=$(($(git rev-list --count HEAD 2>/dev/null || echo 0) % 3))
address_turns=("core volume archive light splat study bake" "cinema section train asset measure serve" "")
thread_turns=("" "" "core light cinema section train serve")
read -ra address_rooms <<<"${address_turns[turn]}"
read -ra thread_rooms <<<"${thread_turns[turn]}"
if [ "${1:-}" = --all ]; then
  read -ra address_rooms <<<"${address_turns[*]}"
  read -ra thread_rooms <<<"${thread_turns[*]}"
fi

export CI=true
jobs="$(nproc)"
logs=build/logs
export NO_COLOR=1 # logs are searched for what failed
mkdir -p "$logs"
tests=0

# step NAME COMMAND...: runs quietly, says how long it took, shows the log's end if it fails.
step() {
  local name="$1" log begin
  shift
  log="$logs/${name// /-}.log"
  begin=$SECONDS
  printf '%-42s' "test: $name"
  if ! "$@" >"$log" 2>&1 </dev/null; then
    echo "FAILED after $((SECONDS - begin)) s; $log ends with"
    tail -n 60 "$log"
    echo "test: of $log, what failed:"
    grep -aE '^ *(FAIL|×|→)|[A-Z][A-Za-z]*Error:|\[  FAILED  \]|error:' "$log" | tail -n 20 || true
    echo "test: failed: $name"
    exit 1
  fi
  echo "$((SECONDS - begin)) s"
}

# count_tests NAME: adds the tests that the step of that name ran, as ctest counted them.
count_tests() {
  local line
  line="$(grep -E '^100% tests passed, 0 tests failed out of [0-9]+' "$logs/${1// /-}.log")"
  tests=$((tests + ${line##* }))
}

# configure_and_build PRESET [TARGET...]: everything, or only some targets.
configure_and_build() {
  local preset="$1"
  shift
  cmake --preset "$preset" -DCLIPGS_TESTS=ON -DCLIPGS_UNITY=ON
  cmake --build --preset "$preset" "${@/#/--target=}"
}

run_tests() {
  ctest --preset "$1" -j "$jobs" --no-tests=error "${@:2}"
}

# As the thread-sanitized preset compiles, which need not be built for it.
tidy() {
  cmake --preset tsan -DCLIPGS_TESTS=ON -DCLIPGS_UNITY=ON && bash scripts/tidy.sh --turn
}

# The thread sanitizer needs addresses where it expects them; some kernels spread them wider.
run_tests_in_place() {
  export TSAN_OPTIONS="suppressions=$PWD/scripts/thread_sanitizer.txt"
  if setarch -R true 2>/dev/null; then
    setarch -R ctest --preset tsan -j "$jobs" --no-tests=error "$@"
  else
    run_tests tsan "$@"
  fi
}

check_scripts() {
  local script
  for script in scripts/*.sh bench/*.sh batch/*.sh packaging/*.sh .ci/run; do
    bash -n "$script"
  done
}

bash scripts/setup.sh

everything=()
if [ ! -x "${CHROMIUM:-/usr/bin/chromium}" ]; then
  echo "test: there is no chromium (CHROMIUM names another one): the tests in the browser are left out" >&2
  everything=(-LE browser)
fi

step "scripts" check_scripts
step "format" bash scripts/format.sh --check
step "build release" configure_and_build release
# The tests say themselves which they leave out, too.
for needed in chromedriver:Chromium firefox-esr:Firefox WebKitWebDriver:WebKitGTK; do
  if ! command -v "${needed%%:*}" >/dev/null; then
    echo "test: there is no ${needed%%:*}: what is the same in every browser is not tested in ${needed##*:}" >&2
  fi
done

# What only compiles or reads goes on beside the release build's tests, which wait much for browsers, and gives way to them.
checks_beside() {
  renice -n 19 "$BASHPID" >/dev/null
  step "lint viewer" npm --prefix web run lint
  step "reference" bash scripts/reference.sh
  [ "${#address_rooms[@]}" -eq 0 ] || step "build asan ubsan" configure_and_build asan fuzz "${address_rooms[@]/%/_test}"
  [ "${#thread_rooms[@]}" -eq 0 ] || step "build tsan" configure_and_build tsan "${thread_rooms[@]/%/_test}"
  # All rooms together take too long; scripts/tidy.sh by hand has them.
  step "tidy" tidy
}
set -m # a group of its own, so that all of it can be ended
checks_beside >"$logs/beside.log" 2>&1 &
beside=$!
set +m
trap 'kill -- -"$beside" 2>/dev/null || true' EXIT

step "tests release" run_tests release "${everything[@]}"
count_tests "tests release"
grep -a 'needed a second try' build/release/Testing/Temporary/LastTest.log | sed 's/^/test: /' || true
echo "test: beside them:"
waited=$SECONDS
wait "$beside" || {
  cat "$logs/beside.log"
  exit 1
}
trap - EXIT
cat "$logs/beside.log"
echo "test: waited for these for $((SECONDS - waited)) s"

# Statistics over many samples, finite differences, whole scans and the same again at other thread counts take minutes
# there, through code that other tests go through as well.
if [ "${#address_rooms[@]}" -gt 0 ]; then
  step "tests asan ubsan" run_tests asan -L fast -E 'HoldsEveryTissue|GradientsOf|OnGradientOpacity|TwoThreads|NumberOfThreads|Denoise\.B|RealDicom|RealData|ThePenaltyOnOverdraw|FlippedBits|OnBoundaries|EndsWhereTheSection|ManySmallSteps|NoSplitComesNear|LeavesLessThanHalf|IsThatOfRaysThroughAPixel|HaveABoundarysLook'
  count_tests "tests asan ubsan"
  # Every reader of files and requests, with some thousand inputs each; scripts/fuzz.sh goes on for hours.
  step "tests fuzz targets" run_tests asan -L fuzz
  count_tests "tests fuzz targets"
fi
if [ "${#thread_rooms[@]}" -gt 0 ]; then
  step "tests tsan" run_tests_in_place -L fast -E 'NoiseFloor|GradientsOf|FiniteDifferences|TheTracer|Gloss|FastIsTheReference|FitReflectance|ResumesFrom|Learns|ThePenaltyOnOverdraw|GaussiansTooSmall|RefiningImproves|SameBytesAtOneAndTwo|AUniaxialModelIsTheSame|OnGradientOpacity|Denoise\.B|SlowClients|NoSplitComesNear|ManySmallSteps|HaveABoundarysLook|OnBoundaries|MakesUpForTheLight|ComesBackFromDisk|WithASectionFacesAreRight|LookAsThePathTracer'
  count_tests "tests tsan"
fi

echo "test: under the address sanitizer: ${address_rooms[*]:-none}; under the thread sanitizer: ${thread_rooms[*]:-none}"
echo "test: release and sanitizers, $((SECONDS / 60)) min"
echo "100% tests passed, 0 tests failed out of $tests"
