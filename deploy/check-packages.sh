#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# deploy/check-packages.sh RELEASE ARCH PACKAGES [--keep DIR]
#
# Installs the packages in the folder PACKAGES in a clean Debian and runs them there: first the agent alone, which may
# bring 150 MB at most with all that it needs; then all, on the recording that comes along; then what the units of systemd
# start. RELEASE: bookworm or trixie; ARCH: amd64 or arm64, which runs in QEMU. Needs root.
#   --keep DIR   the system is made in DIR and stays there
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"
# shellcheck source-path=SCRIPTDIR source=systems.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/systems.sh"

most_mb=150
keep=
arguments=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --keep) need_value "$1" $# && keep=$2 && shift ;;
    -h | --help) show_help && exit 0 ;;
    -*) die_usage "unknown option '$1'" ;;
    *) arguments+=("$1") ;;
  esac
  shift
done
[[ ${#arguments[@]} -eq 3 ]] || die_usage "it takes a release, a processor and a folder of packages"
release=${arguments[0]} arch=${arguments[1]} packages=${arguments[2]}

fresh=${keep:-$(mktemp -d)}
# shellcheck disable=SC2064  # the folder of now
[[ -n $keep ]] || trap "rm -rf --one-file-system -- '$fresh'" EXIT
log=$packages/install.log
step "check: a clean Debian $release for $arch"
fresh_system "$release" "$arch" "$fresh"
cp -- "$packages"/*.deb "$fresh/root/"

# Installs packages, by what their files are called.
install_there() {
  in_system "$fresh" "apt-get -q install --yes $*" >>"$log" 2>&1 || die "the packages cannot be installed: see $log"
}
in_system "$fresh" 'apt-get -q update' >"$log" 2>&1 || die "there is no list of packages: see $log"
before_mb=$(system_mb "$fresh")
install_there '/root/coslam-agent_*.deb'
agent_mb=$(($(system_mb "$fresh") - before_mb))
step "the agent with all that it needs takes $agent_mb MB"
[[ $agent_mb -le $most_mb ]] || die "the agent with all that it needs takes $agent_mb MB, and $most_mb is the most"
said=$(in_system "$fresh" 'coslam-agent --id a --source rtsp://127.0.0.1/x' 2>&1) && die "the agent plays a stream without FFmpeg"
[[ $said == *"the package coslam-video"* ]] || die "the agent does not say which package brings streams: $said"

install_there --no-install-recommends '/root/coslam_*.deb' '/root/coslam-*.deb'
recording=/usr/share/coslam/demo
in_system "$fresh" "coslam run $recording --out /root/result" || die "the installed programs cannot make a map"
in_system "$fresh" "coslam eval /root/result $recording" || die "the installed coslam cannot evaluate"

# starts PART [OPTION]...: what its unit starts, for a moment, since there is no systemd in it.
starts() {
  local start
  start=$(sed -n 's/^ExecStart=//p' "$fresh/usr/lib/systemd/system/coslam-$1.service" | sed 's|%E|/etc|g; s|%S|/var/lib|g')
  in_system "$fresh" "mkdir -p /var/lib/coslam-$1 && timeout --preserve-status --signal INT 5 $start ${*:2}" ||
    die "what coslam-$1.service starts does not start"
}
starts server --set 'wire.interfaces=[127.0.0.1]'
starts bridge --domain 42  # beside that of the fleet
step "the packages are sound: Debian $release, $arch, agent $agent_mb MB"
