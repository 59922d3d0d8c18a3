#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# deploy/build.sh [--preset NAME | --arch arm64] [--target NAME]... [--jobs N]
#
# Configures and builds. Without --target everything, tests included.
#   --preset NAME   of CMakePresets.json: release (default), ci, dev, asan, tsan
#   --arch arm64    for another processor, in build-arm64/: installs the compiler, the emulator that runs the tests and, into
#                   a folder of their own, the libraries (deploy/sysroot.sh)
#   --target NAME   build only this; may be repeated
#   --jobs N        parallel compilers (default: one a core, fewer when memory is short)
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"

preset=release
arch=
jobs=$(build_jobs)
targets=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --preset) need_value "$1" $# && preset=$2 && shift ;;
    --arch) need_value "$1" $# && arch=$2 && shift ;;
    --target) need_value "$1" $# && targets+=("$2") && shift ;;
    --jobs) need_value "$1" $# && jobs=$2 && shift ;;
    -h | --help) show_help && exit 0 ;;
    *) die_usage "unknown option '$1'" ;;
  esac
  shift
done
[[ $jobs =~ ^[1-9][0-9]*$ ]] || die_usage "--jobs takes a positive number, not '$jobs'"

if [[ -n $arch ]]; then
  [[ $preset == release && $arch == arm64 ]] || die_usage "--arch takes arm64, and no --preset beside it"
  preset=arm64
  "$root/deploy/setup.sh" --arm64 || exit
  "$root/deploy/sysroot.sh" || exit
fi

cd -- "$root"
directory=$(build_dir "$preset")
step "configure: preset $preset, in ${directory#"$root"/}/"
cmake --preset "$preset" --log-level=NOTICE || die "configuring the preset $preset failed: CMake says why above"

step "build: ${targets[*]:-everything}, $jobs at a time"
export NINJA_STATUS='[%f/%t, %e s] '
cmake --build "$directory" --parallel "$jobs" ${targets[@]:+--target "${targets[@]}"} ||
  die "the build failed: the first error above says where"
