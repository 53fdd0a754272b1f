#!/usr/bin/env bash
# Installs what is built into an empty folder and packs it for Debian, and looks at what came of it: the unit, the
# package's files, what it needs, and whether its program runs. scripts/package_test.sh installs it for real.
#
#   packaging/package_check.sh BUILD
set -euo pipefail

readonly build="$1"
work="$(mktemp -d)"
trap 'rm -rf "$work"' EXIT

fail() {
  echo "package: $*" >&2
  exit 1
}

readonly prefix="$work/prefix"
cmake --install "$build" --prefix "$prefix" >"$work/log"
readonly unit="$prefix/lib/systemd/system/clipgs.service"
grep -q "^ExecStart=$prefix/bin/clipgs serve " "$unit" || fail "the unit starts another program"
readonly archive_unit="${unit%.service}-archive.service"
grep -q "^ExecStart=$prefix/bin/clipgs archive " "$archive_unit" || fail "the archive's unit starts another program"
[ -z "$(find "$prefix" -path '*/etc/*')" ] || fail "cmake --install writes beside its prefix"
if command -v systemd-analyze >/dev/null; then
  # Of this unit; others of the machine may have their own faults.
  for one in "$unit" "$archive_unit" "${unit%.service}"-tokens.{path,service}; do
    said="$(systemd-analyze verify --man=no --recursive-errors=no "$one" 2>&1)" || fail "systemd refuses $(basename "$one"): $said"
  done
  for one in "$unit" "$archive_unit"; do
    systemd-analyze security --offline=true --threshold=15 "$one" >"$work/log" 2>&1 ||
      fail "$(basename "$one") may do more than it needs: $(tail -n 1 "$work/log")"
  done
else
  echo "package: there is no systemd-analyze: the unit is not tested" >&2
fi

cpack --config "$build/CPackConfig.cmake" -B "$work/pack" >"$work/log" 2>&1 || fail "cpack: $(tail -n 5 "$work/log")"
packages=("$work"/pack/*.deb)
[ "${#packages[@]}" -eq 1 ] || fail "there are ${#packages[@]} packages"
readonly package="${packages[0]}"
field() { dpkg-deb -f "$package" "$1"; }

[ "$(field Package)" = clipgs ] || fail "it is called $(field Package)"
[[ "$(field Version)" == "$("$prefix/bin/clipgs" --version)"-* ]] || fail "it is of version $(field Version)"
for needed in libc6 libstdc++6 libssl3 libwebp7 libgdcm3 libtbb12 zlib1g fonts-dejavu-core; do
  # Ubuntu calls some with an ending.
  [[ ", $(field Depends)" == *", $needed"* ]] || fail "it does not depend on $needed: $(field Depends)"
done

dpkg-deb -x "$package" "$work/root"
dpkg-deb -e "$package" "$work/control"
for file in etc/default/clipgs etc/logrotate.d/clipgs etc/clipgs usr/bin/clipgs usr/lib/systemd/system/clipgs.service usr/lib/systemd/system/clipgs-archive.service usr/lib/systemd/system/clipgs-tokens.path \
  usr/share/clipgs/orthanc/clipgs.lua usr/share/doc/clipgs/examples/orthanc/rules.json usr/share/doc/clipgs/orthanc.md \
  usr/share/bash-completion/completions/clipgs usr/share/doc/clipgs/changelog.Debian.gz usr/share/doc/clipgs/changelog.gz \
  usr/share/doc/clipgs/copyright usr/share/doc/clipgs/service.md usr/share/fish/vendor_completions.d/clipgs.fish \
  usr/share/man/man1/clipgs-serve.1.gz usr/share/man/man1/clipgs-token.1.gz usr/share/zsh/vendor-completions/_clipgs; do
  [ -e "$work/root/$file" ] || fail "it lacks /$file"
done
others="$(cd "$work/root" && find . -type f -not -path './etc/*' -not -path './usr/*')"
[ -z "$others" ] || fail "it holds $others"
grep -q '^ExecStart=/usr/bin/clipgs serve ' "$work/root/usr/lib/systemd/system/clipgs.service" ||
  fail "its unit starts another program"
(cd "$work/root" && find etc -type f -printf '/%p\n' | sort) | diff - <(sort "$work/control/conffiles") >"$work/log" ||
  fail "conffiles are others than what lies in /etc: $(cat "$work/log")"
for script in postinst prerm postrm; do
  [ -x "$work/control/$script" ] || fail "$script does not run"
  sh -n "$work/control/$script"
done
[ "$("$work/root/usr/bin/clipgs" --version)" = "$("$prefix/bin/clipgs" --version)" ] || fail "its program does not run"
echo "package: $(basename "$package"), $(($(stat -c %s "$package") / 1000000)) MB"
