#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# deploy/test-systems.sh [--release 12|13]... [--work DIR] [--write] [PART]...
#
# Tries everything on clean systems, and prints a table. Needs root and the network, and takes hours on two cores; all of
# it uses 30 GB.
#   demo       deploy/demo.sh from a checkout, and a second time
#   packages   deploy/package.sh there; what it made is installed and run in a clean system
#   arm64      deploy/build.sh --arch arm64 there; unit tests in QEMU, and whether a run gives the same bits as on amd64
#   packages-arm64   packages for arm64, installed and run in a clean system in QEMU
#   fleet      server and agents of different releases and processors, from those packages, make one map
#   tests      deploy/test.sh --werror from nothing, but for Debian's packages
# Without PART all of them, in this order; each needs what stands before it.
#   --release   of Debian; both when it is not given
#   --work      where the systems are made (default: /var/tmp/coslam-systems); what is there already is used again
#   --write     also writes the table into docs/systems.md
# shellcheck disable=SC2016,SC2317  # patterns of the inner shells; parts are called by name
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"
# shellcheck source-path=SCRIPTDIR source=systems.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/systems.sh"

releases=()
parts=()
work=/var/tmp/coslam-systems
write=no
all_parts=(demo packages arm64 packages-arm64 fleet tests)
while [[ $# -gt 0 ]]; do
  case $1 in
    --release) need_value "$1" $# && releases+=("$2") && shift ;;
    --work) need_value "$1" $# && work=$2 && shift ;;
    --write) write=yes ;;
    -h | --help) show_help && exit 0 ;;
    -*) die_usage "unknown option '$1'" ;;
    *)
      [[ " ${all_parts[*]} " == *" $1 "* ]] || die_usage "there is no part '$1'"
      parts+=("$1")
      ;;
  esac
  shift
done
[[ ${#releases[@]} -gt 0 ]] || releases=(12 13)
[[ ${#parts[@]} -gt 0 ]] || parts=("${all_parts[@]}")
[[ $EUID -eq 0 ]] || die "systems of their own need root"
"$root/deploy/setup.sh" --package --arm64 || exit
mkdir -p -- "$work"

codename() {
  case $1 in
    12) printf 'bookworm\n' ;;
    13) printf 'trixie\n' ;;
    *) die_usage "there is no release '$1' here, only 12 and 13" ;;
  esac
}
for release in "${releases[@]}"; do codename "$release" >/dev/null; done

rows=()
failed=0
# row SYSTEM WHAT FOUND OK: a line of the table; OK is 0 when all was well.
row() {
  local state=passes
  if [[ $4 -ne 0 ]]; then state='**fails**' failed=1; fi
  rows+=("| $1 | $2 | $3 | $state |")
  printf '%s\n' "${rows[-1]}"
}

# The system in which a release builds, with a checkout of what is committed here in /root/coslam. npm asks there where it
# asks on this machine.
builder() {
  local dir=$work/build-$1
  if [[ ! -d $dir/root/coslam ]]; then
    fresh_system "$(codename "$1")" amd64 "$dir"
    git clone --quiet -- "$root" "$dir/root/coslam"
    if command -v npm >/dev/null; then
      cp -- /etc/ssl/certs/ca-certificates.crt "$dir/root/certificates.crt"
      printf 'registry=%s\ncafile=/root/certificates.crt\n' "$(npm config get registry)" >"$dir/root/.npmrc"
    fi
  fi
  git -C "$dir/root/coslam" fetch --quiet -- "$root" HEAD
  git -C "$dir/root/coslam" reset --quiet --hard FETCH_HEAD
  printf '%s\n' "$dir"
}

# timed SYSTEM COMMAND: its output goes to a log; sets elapsed_s, cpu_min and code.
timed() {
  local times log=$work/${FUNCNAME[1]}-$release.log
  code=0
  TIMEFORMAT='%0R %0U %0S'
  times=$({ time in_system "$1" "cd /root/coslam && $2" >>"$log" 2>&1; } 2>&1) || code=$?
  read -r elapsed_s user_s system_s <<<"${times##*$'\n'}"
  cpu_min=$(((user_s + system_s + 30) / 60))
  [[ $code -eq 0 ]] || warn "failed: see $log"
}

# shellcheck disable=SC2317  # the parts are called by name
part_demo() {
  local system
  system=$(builder "$1")
  timed "$system" deploy/demo.sh
  row "Debian $1, amd64" '`deploy/demo.sh`, from nothing' "$elapsed_s s, $cpu_min CPU minutes" "$code"
  timed "$system" deploy/demo.sh
  row "Debian $1, amd64" '`deploy/demo.sh`, again' "$elapsed_s s" "$code"
}

part_tests() {
  local system
  system=$(builder "$1")
  in_system "$system" 'cd /root/coslam && deploy/setup.sh --lint --test --browser' >"$work/part_tests-$1.log" 2>&1 || true
  timed "$system" 'rm -rf build && CCACHE_DISABLE=1 deploy/test.sh --werror'
  row "Debian $1, amd64" '`deploy/test.sh --werror`' "$elapsed_s s, $cpu_min CPU minutes; $(grep -oE '[0-9]+ tests failed out of [0-9]+' "$work/part_tests-$1.log" | tail -n 1)" "$code"
}

# packages_of RELEASE ARCH: makes them, installs and runs them in a clean system, which the fleet uses.
packages_of() {
  local system made installed=$work/installed-$1-$2 log=$work/packages-$1-$2.log for_arch='' said
  system=$(builder "$1")
  made=build
  [[ $2 == amd64 ]] || { for_arch="--arch $2" && made=build-$2; }
  code=0
  in_system "$system" "cd /root/coslam && deploy/package.sh $for_arch" >"$log" 2>&1 || code=$?
  rm -rf --one-file-system -- "$installed"
  [[ $code -ne 0 ]] || "$root/deploy/check-packages.sh" "$(codename "$1")" "$2" "$system/root/coslam/$made/packages" --keep "$installed" >>"$log" 2>&1 || code=$?
  said=$(grep -oE 'agent with all that it needs takes [0-9]+ MB' "$log" | head -n 1 | grep -oE '[0-9]+ MB') || true
  row "Debian $1, $2" 'packages: installed and run in a clean system' "agent with all that it needs ${said:-unknown}" "$code"
  [[ $code -eq 0 ]] || warn "failed: see $log"
}
part_packages() { packages_of "$1" amd64; }
part_packages-arm64() { packages_of "$1" arm64; }

# The bits of a result, in few digits.
digest='cat $(ls trajectory/* live/* points.csv dynamic.csv) | grep -v "^#" | sha256sum | cut -c 1-16'
part_arm64() {
  local system here there
  system=$(builder "$1")
  timed "$system" 'deploy/build.sh --arch arm64'
  row "Debian $1, arm64" '`deploy/build.sh --arch arm64`' "$elapsed_s s, $cpu_min CPU minutes" "$code"
  timed "$system" "ctest --test-dir build-arm64 --label-regex unit --parallel $(test_shares)"
  row "Debian $1, arm64 in QEMU" 'unit tests' "$elapsed_s s; $(grep -oE '[0-9]+ tests failed out of [0-9]+' "$work/part_arm64-$1.log" | tail -n 1)" "$code"
  for folder in build build-arm64; do
    timed "$system" "QEMU_LD_PREFIX=\$HOME/.cache/coslam-arm64 $folder/bin/coslam run deploy/demo --inline --out /root/$folder --force"
  done
  here=$(in_system "$system" "cd /root/build && $digest") there=$(in_system "$system" "cd /root/build-arm64 && $digest")
  [[ $here == "$there" ]] && code=0 || code=1
  row "Debian $1, arm64 in QEMU" 'a run gives the same bits as on amd64' "$here, $there" "$code"
}

# Four machines on one switch, coslam-0 to coslam-3; 10.77.0.1 is the first.
switch_on() {
  local i
  ip netns add coslam-switch
  ip -n coslam-switch link add switch type bridge
  ip -n coslam-switch link set switch up
  for i in 0 1 2 3; do
    ip netns add "coslam-$i"
    ip -n "coslam-$i" link add port type veth peer name "port$i" netns coslam-switch
    ip -n coslam-switch link set "port$i" master switch up
    ip -n "coslam-$i" address add "10.77.0.$((i + 1))/24" dev port
    ip -n "coslam-$i" link set port up
    ip -n "coslam-$i" link set lo up
    ip -n "coslam-$i" route add default dev port
  done
}
switch_off() { for host in coslam-0 coslam-1 coslam-2 coslam-3 coslam-switch; do ip netns delete "$host" 2>/dev/null || true; done; }

# one_fleet SERVER AGENT AGENT AGENT: installed systems, each on a machine of its own; the agents play the recording that
# comes along.
one_fleet() {
  local server=$work/installed-$1 agent i=0 pids=() recording=/usr/share/coslam/demo log=$work/fleet.log said
  rm -rf -- "$server/root/fleet"
  switch_off && switch_on
  COSLAM_HOST=coslam-0 in_system "$server" 'coslam-server --result /root/fleet --set agents=cam0,cam1,cam2' >>"$log" 2>&1 &
  pids+=($!)
  for agent in "${@:2}"; do
    COSLAM_HOST=coslam-$((i + 1)) in_system "$work/installed-$agent" \
      "coslam-agent --id cam$i --source $recording/cam$i.mp4 --calibration $recording/cam$i.yaml --rate max" >>"$log" 2>&1 &
    pids+=($!)
    i=$((i + 1))
  done
  code=0
  for pid in "${pids[@]}"; do wait "$pid" || code=$?; done
  switch_off
  said=$(in_system "$server" "coslam eval /root/fleet $recording" | grep -oE 'joint ATE [0-9.]+ m') || code=1
  row "server $1, agents ${*:2}" 'one map' "${said:-none}" "$code"
}
part_fleet() {
  [[ $1 == "${releases[-1]}" ]] || return 0
  one_fleet 13-amd64 12-amd64 13-amd64 12-arm64
  one_fleet 12-amd64 13-amd64 12-amd64 13-arm64
}

for part in "${parts[@]}"; do
  for release in "${releases[@]}"; do
    step "$part: Debian $release"
    rm -f -- "$work/part_$part-$release.log"
    "part_$part" "$release"
  done
done

table=$(printf '%s\n' '| system | what | found | |' '|---|---|---|---|' "${rows[@]}")
step "result, at $(git -C "$root" log -1 --format='%h of %cs')"
printf '%s\n' "$table"
if [[ $write == yes ]]; then
  python3 - "$root/docs/systems.md" "$table" <<'PYTHON'
import pathlib
import re
import sys

page = pathlib.Path(sys.argv[1])
marks = ("<!-- deploy/test-systems.sh -->", "<!-- end -->")
text = page.read_text()
page.write_text(re.sub(f"{marks[0]}.*?{marks[1]}", lambda _: f"{marks[0]}\n{sys.argv[2]}\n{marks[1]}", text, flags=re.DOTALL))
PYTHON
fi
exit "$failed"
