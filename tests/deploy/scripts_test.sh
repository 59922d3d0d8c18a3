#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# The scripts of deploy/: they parse, explain themselves from any folder, and answer a wrong option with exit code 2.
set -euo pipefail
deploy=$(CDPATH='' cd -- "$(dirname -- "$0")/../../deploy" && pwd -P)
cd /

fail() {
  printf 'scripts_test.sh: %s\n' "$*" >&2
  exit 1
}

for script in "$deploy"/*.sh; do
  name=${script##*/}
  bash -n "$script" || fail "$name does not parse"
  [[ $name != lib.sh ]] || continue
  [[ -x $script ]] || fail "$name is not executable"
  help=$("$script" --help) || fail "$name --help fails"
  [[ $help == "deploy/$name"* ]] || fail "$name --help does not start with its usage"
  code=0
  message=$("$script" --no-such-option 2>&1) || code=$?
  [[ $code -eq 2 ]] || fail "$name --no-such-option ends with $code, not 2"
  [[ $(wc -l <<<"$message") -eq 1 && $message == *"--no-such-option"* ]] || fail "$name: no clear sentence: $message"
done

# Every package is listed once, and the whole list is read.
listed=$(sed 's/#.*//; /^\[/d; /^ *$/d' "$deploy/packages.txt" | sort)
[[ -z $(uniq -d <<<"$listed") ]] || fail "packages.txt lists a package twice"
COSLAM_SETUP=off "$deploy/setup.sh" --lint || fail "setup.sh ignores COSLAM_SETUP=off"
if command -v shellcheck >/dev/null; then
  (cd "$deploy" && shellcheck --external-sources ./*.sh ../tests/deploy/*.sh ../.ci/run) || fail "shellcheck complains"
fi
# The services stay fenced in: an exposure of at most 2.0 of 10.
if command -v systemd-analyze >/dev/null; then
  for unit in "$deploy"/systemd/*.service; do
    systemd-analyze security --offline=true --threshold=20 --no-pager "$unit" >/dev/null 2>&1 ||
      fail "${unit##*/} is too exposed: systemd-analyze security --offline=true shows by what"
  done
fi
echo "all scripts of deploy/ are in order"
