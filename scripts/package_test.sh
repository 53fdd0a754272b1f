#!/usr/bin/env bash
# Builds the package for Debian, installs it on a bare Debian 12 in a folder of its own, and tries what it brings there:
# a case of the phantom is built, served and asked for. Then the package is removed, and nothing of it may be left.
# Needs root, debootstrap and the network; takes some three minutes.
#
#   scripts/package_test.sh              of build/release
#   scripts/package_test.sh CLIPGS.deb   of a package that is there
set -euo pipefail
cd "$(dirname "$0")/.."

readonly mirror="${MIRROR:-http://deb.debian.org/debian}"

[ "$(id -u)" -eq 0 ] || { echo "package test: only root can set up another Debian" >&2; exit 1; }
command -v debootstrap >/dev/null || { echo "package test: install debootstrap" >&2; exit 1; }

package="${1:-}"
if [ -z "$package" ]; then
  bash scripts/package.sh
  package="$(ls -t build/package/*.deb | head -n 1)"
fi

work="$(mktemp -d)"
root="$work/debian"
served=
# Not with what is mounted there still.
trap '[ -z "$served" ] || kill "$served" 2>/dev/null || true; umount "$root/proc" 2>/dev/null || true; mountpoint -q "$root/proc" || rm -rf --one-file-system "$work"' EXIT

say() { echo "package test: $*"; }
readonly within=(chroot "$root" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8)
inside() { "${within[@]}" "$@"; }
fail() {
  echo "package test: $*" >&2
  exit 1
}

say "a bare Debian 12 from $mirror"
debootstrap --variant=minbase bookworm "$root" "$mirror" >"$work/log" 2>&1 || fail "$(tail -n 3 "$work/log")"
mount -t proc proc "$root/proc"
inside apt-get update -qq

say "installing $(basename "$package")"
cp "$package" "$root/root/clipgs.deb"
inside apt-get install -y -qq --no-install-recommends /root/clipgs.deb >"$work/log" 2>&1 || fail "$(tail -n 5 "$work/log")"
inside clipgs --version
inside test -f /usr/lib/systemd/system/clipgs.service -a -f /etc/default/clipgs -a -d /etc/clipgs

say "building a case"
inside mkdir -p /srv/cases/teaching
inside clipgs phantom /root/phantom.nrrd --size 96
inside clipgs build /root/phantom.nrrd -o /srv/cases/teaching/phantom.sog --quality instant --quiet

say "serving it"
token="$(inside clipgs token /etc/clipgs/tokens.json --add ward --folder teaching 2>/dev/null)"
port=$((20000 + RANDOM % 20000))
"${within[@]}" clipgs serve /srv/cases --port "$port" --tokens /etc/clipgs/tokens.json --audit /root/audit.jsonl >"$work/serve" 2>&1 &
served=$!
url="http://127.0.0.1:$port"
for _ in $(seq 100); do
  curl -fs "$url/health" >/dev/null && break
  sleep 0.1
done
ask() { curl -fsS -H "Authorization: Bearer $token" "$url/$1"; }
[ "$(curl -s "$url/health")" = ok ] || fail "it is not well: $(cat "$work/serve")"
ask "" | grep -q "<title>" || fail "there is no viewer"
ask api/cases | grep -q '"name":"teaching/phantom"' || fail "it does not list the case"
ask cases/teaching/phantom.sog | cmp - "$root/srv/cases/teaching/phantom.sog" || fail "it gives another case"
ask cases/teaching/phantom/thumbnail | head -c 4 | grep -q RIFF || fail "there is no thumbnail"
[ "$(curl -s -o /dev/null -w '%{http_code}' "$url/api/cases")" = 403 ] || fail "it lets in everybody"
grep -q '"token":"ward","case":"teaching/phantom"' "$root/root/audit.jsonl" || fail "it does not say who opened the case"
kill "$served"
wait "$served" || fail "it ended with $?"
served=

say "removing it"
inside apt-get purge -y -qq clipgs >"$work/log" 2>&1 || fail "$(tail -n 5 "$work/log")"
left="$(inside find /etc /usr /var/lib -xdev -name '*clipgs*' -not -path /etc/clipgs)"
[ -z "$left" ] || fail "left behind: $left"
inside test -f /etc/clipgs/tokens.json || fail "tokens are the owner's and were removed"
say "it installs, serves and goes again"
