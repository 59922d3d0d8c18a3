#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# deploy/package.sh [--arch arm64] [--check] [--maintainer 'NAME <MAIL>']
#
# Builds the programs and makes Debian packages of them, in build/packages: coslam-agent, coslam-server,
# coslam-bridge, coslam (the tools), coslam-video, coslam-gstreamer, libcoslam-dev. Install them with
# `apt install ./FILE.deb ...`.
#   --arch arm64   for another processor, in build-arm64/packages
#   --maintainer   who hands them out, as it stands in the packages
#   --check        also runs lintian on them, and installs and runs them in a fresh Debian (needs root): deploy/check-packages.sh
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"

check=no
arch=$(dpkg --print-architecture)
preset=release
for_arch=()
maintainer=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --check) check=yes ;;
    --arch) need_value "$1" $# && arch=$2 && preset=$2 && for_arch=(--arch "$2") && shift ;;
    --maintainer) need_value "$1" $# && maintainer=(-D "COSLAM_MAINTAINER=$2") && shift ;;
    -h | --help) show_help && exit 0 ;;
    *) die_usage "unknown option '$1'" ;;
  esac
  shift
done

"$root/deploy/setup.sh" --package || exit
cd -- "$root"
build=$(build_dir "$preset")
"$root/deploy/build.sh" "${for_arch[@]}" --target coslam --target coslam-server --target coslam-agent --target coslam-bridge --target manual_pages || exit
cmake --preset "$preset" --log-level=NOTICE "${maintainer[@]}" || die "configuring failed: CMake says why above"
step "package"
rm -rf -- "$build/packages"
(
  cd -- "$build"
  if [[ $preset == arm64 ]]; then  # what they depend on is looked up in the sysroot
    DPKG_ADMINDIR=$(sysroot_dir)/var/lib/dpkg
    export DPKG_ADMINDIR DEB_HOST_ARCH=arm64
  fi
  cpack -G DEB -B "$build/packages"
) || die "the packages could not be made: CPack says why above"
rm -rf -- "$build/packages/_CPack_Packages"
ls -l -- "$build/packages"
[[ $check == yes ]] || exit 0

step "check: lintian"
# Who hands them out puts a real address.
lintian --allow-root --fail-on error,warning --suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog,initial-upload-closes-no-bugs \
  "$build/packages/"*.deb || die "lintian has found faults"

exec "$root/deploy/check-packages.sh" "$(debian_release)" "$arch" "$build/packages"
