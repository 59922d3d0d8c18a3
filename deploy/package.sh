#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# deploy/package.sh [--check] [--maintainer 'NAME <MAIL>']
#
# Builds the programs and makes Debian packages of them, in build/packages: coslam-agent, coslam-server,
# coslam-bridge, coslam (the tools), coslam-video, coslam-gstreamer, libcoslam-dev. Install them with
# `apt install ./FILE.deb ...`.
#   --maintainer   who hands them out, as it stands in the packages
#   --check        also runs lintian on them, and installs and runs them in a fresh Debian (debootstrap; needs root),
#                  first the agent alone, which may bring 150 MB at most with all that it needs
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"

check=no
maintainer=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --check) check=yes ;;
    --maintainer) need_value "$1" $# && maintainer=(-D "COSLAM_MAINTAINER=$2") && shift ;;
    -h | --help) show_help && exit 0 ;;
    *) die_usage "unknown option '$1'" ;;
  esac
  shift
done

"$root/deploy/setup.sh" --package || exit
cd -- "$root"
build=$(build_dir release)
cmake --preset release --log-level=NOTICE "${maintainer[@]}" || die "configuring failed: CMake says why above"
"$root/deploy/build.sh" --target coslam --target coslam-server --target coslam-agent --target coslam-bridge --target manual_pages || exit
step "package"
rm -rf -- "$build/packages"
(cd -- "$build" && cpack -G DEB -B "$build/packages") || die "the packages could not be made: CPack says why above"
rm -rf -- "$build/packages/_CPack_Packages"
ls -l -- "$build/packages"
[[ $check == yes ]] || exit 0

step "check: lintian"
# Who hands them out puts a real address.
lintian --allow-root --fail-on error,warning --suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog,initial-upload-closes-no-bugs \
  "$build/packages/"*.deb || die "lintian has found faults"

# shellcheck disable=SC1091  # this system's own
release=$(. /etc/os-release && printf '%s' "$VERSION_CODENAME")
step "check: a fresh Debian $release"
[[ $EUID -eq 0 ]] || die "installing in a fresh Debian needs root"
fresh=$(mktemp -d)
# shellcheck disable=SC2064  # the folder of now
trap "umount '$fresh/proc' 2>/dev/null || true; rm -rf --one-file-system '$fresh'" EXIT
mirror=$(cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources 2>/dev/null |
  grep -v '^#' | grep --only-matching -E 'https?://[^ ]+' | head -n 1) || true
debootstrap --variant=minbase "$release" "$fresh" "${mirror:-http://deb.debian.org/debian}" >"$build/packages/debootstrap.log" ||
  die "debootstrap failed: see $build/packages/debootstrap.log"
cp /etc/resolv.conf "$fresh/etc/" 2>/dev/null || true
for part in apt.conf apt.conf.d; do [[ ! -e /etc/apt/$part ]] || cp -r "/etc/apt/$part" "$fresh/etc/apt/"; done
mount -t proc proc "$fresh/proc"
cp "$build/packages/"*.deb "$fresh/root/"
# Installs packages, by what their files are called.
install_in_fresh() {
  chroot "$fresh" sh -c "DEBIAN_FRONTEND=noninteractive apt-get -q install --yes $*" >>"$build/packages/install.log" 2>&1 ||
    die "the packages cannot be installed: see $build/packages/install.log"
}
megabytes() { du --summarize --one-file-system --block-size=1MB --exclude=var/cache --exclude=var/lib/apt --exclude=root "$fresh" | cut -f 1; }
chroot "$fresh" apt-get -q update >"$build/packages/install.log" 2>&1 || die "there is no list of packages: see $build/packages/install.log"
most_mb=150
before_mb=$(megabytes)
install_in_fresh '/root/coslam-agent_*.deb'
agent_mb=$(($(megabytes) - before_mb))
step "the agent with all that it needs takes $agent_mb MB"
[[ $agent_mb -le $most_mb ]] || die "the agent with all that it needs takes $agent_mb MB, and $most_mb is the most"
said=$(chroot "$fresh" coslam-agent --id a --source rtsp://127.0.0.1/x 2>&1) && die "the agent plays a stream without FFmpeg"
[[ $said == *"the package coslam-video"* ]] || die "the agent does not say which package brings streams: $said"
install_in_fresh --no-install-recommends '/root/coslam_*.deb' '/root/coslam-*.deb'
chroot "$fresh" coslam render tag /root/tag --frames 60 || die "the installed coslam cannot render a scene"
chroot "$fresh" coslam run /root/tag --out /root/result || die "the installed programs cannot make a map"
chroot "$fresh" coslam eval /root/result /root/tag || die "the installed coslam cannot evaluate"
# There is no systemd in it: what the server's unit starts, for a moment.
start=$(sed -n 's/^ExecStart=//p' "$fresh/usr/lib/systemd/system/coslam-server.service" | sed 's|%E|/etc|g; s|%S|/var/lib|g')
chroot "$fresh" sh -c "mkdir -p /var/lib/coslam-server && timeout --preserve-status --signal INT 3 $start --set wire.interfaces=[127.0.0.1]" ||
  die "what coslam-server.service starts does not start"
step "the packages are sound"
