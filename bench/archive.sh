#!/usr/bin/env bash
# How soon what arrives in Orthanc is seen: from the last byte of storescu to the first picture in a browser, and to the
# finished draft, beside `clipgs build` of the same folder in the same run. Prints Markdown.
#
#   CLIPGS_DATA=... bench/archive.sh [CLIPGS]    needs orthanc, dcmtk, numpy, curl, Chromium; eight minutes on two cores
#
# The head of CLIPGS_DATA as 234 slices of 512 × 512. Orthanc's StableAge and the rules' settle_seconds are STABLE (2).
set -euo pipefail
here="$(cd "$(dirname "$0")/.." && pwd)"
clipgs="$(realpath "${1:-$here/build/release/src/cli/clipgs}")"
readonly stable="${STABLE:-2}"
work="$(mktemp -d)"
pids=()
trap 'kill "${pids[@]}" 2>/dev/null || true; rm -rf "$work"' EXIT

now() { date +%s.%N; }
less() { echo "$1 $2" | awk '{printf "%.1f", $1 - $2}'; }

# wait_for TEXT: until the worker, while it lives, says so.
wait_for() {
  until grep -q "$1" "$work/log"; do
    kill -0 "$worker" || { cat "$work/log" >&2; exit 1; }
    sleep 0.1
  done
}

/usr/bin/python3 "$here/bench/as_dicom.py" "$CLIPGS_DATA/head.nrrd" "$work/head" --hu 16,-1024
mkdir "$work/cases"
cat >"$work/orthanc.json" <<END
{"StorageDirectory": "$work/storage", "HttpPort": 18043, "DicomPort": 14243, "StableAge": $stable, "Plugins": [],
 "AuthenticationEnabled": false, "RemoteAccessAllowed": false, "LuaScripts": ["$work/clipgs.lua"]}
END
sed "s|/run/clipgs-archive.wake|$work/wake|" "$here/packaging/orthanc/clipgs.lua" >"$work/clipgs.lua"
touch "$work/wake"
cat >"$work/rules.json" <<END
{"clipgs_archive": 1, "orthanc": "http://127.0.0.1:18043", "wake": "$work/wake", "settle_seconds": $stable,
 "public_url": "http://127.0.0.1:18080/", "rules": [{"name": "head", "modality": "CT", "build": {"quality": "draft"}}]}
END

begin="$(now)"
"$clipgs" build "$work/head" -o "$work/alone.sog" --quality draft --quiet >/dev/null 2>&1
alone="$(less "$(now)" "$begin")"

/usr/sbin/Orthanc "$work/orthanc.json" >"$work/orthanc.log" 2>&1 &
pids+=($!)
until curl -sf http://127.0.0.1:18043/system >/dev/null; do sleep 0.1; done
"$clipgs" archive "$work/rules.json" -o "$work/cases" --state "$work/state" 2>"$work/log" &
worker=$!
pids+=("$worker")
"$clipgs" serve "$work/cases" --port 18080 >/dev/null 2>&1 &
pids+=($!)
(cd "$here/web" && exec npx vite-node bench/archive.ts -- http://127.0.0.1:18080/) >"$work/seen" 2>"$work/browser" &
browser=$!
until grep -q waiting "$work/browser"; do sleep 0.1; done

begin="$(now)"
storescu -aec ORTHANC 127.0.0.1 14243 +sd "$work/head"
received="$(now)"
wait_for 'built in'
built="$(now)"
wait_for 'back in the archive'
back="$(now)"
wait "$browser"
read -r name seen <"$work/seen"
cmp -s "$work/alone.sog" "$work/cases/$name.sog" && same="the same bytes" || same="OTHER BYTES"

echo "| 234 slices of 512 × 512, draft; s from the last byte that Orthanc received | |"
echo "|---|---|"
echo "| first picture in a browser | $(less "$seen" "$received") |"
echo "| the draft is finished | $(less "$built" "$received") |"
echo "| film, report and link are in Orthanc | $(less "$back" "$received") |"
echo "| \`clipgs build\` alone, of the folder | $alone |"
echo "| times that: first picture, finished | $(awk -v s="$seen" -v b="$built" -v r="$received" -v a="$alone" \
  'BEGIN {printf "%.2f, %.2f", (s - r) / a, (b - r) / a}') |"
echo
echo "Sent in $(less "$received" "$begin") s; StableAge $stable s; $same."
