#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# deploy/fuzz.sh [SECONDS] [TARGET]...
#
# What reads the words of strangers, under libFuzzer with the address and undefined behaviour sanitizers, each target for
# SECONDS (600): decoders loaders settings mcap bag db3 messages recording map_file web (all). Needs clang and its
# runtime (deploy/setup.sh --fuzz). What was found lies in build-fuzz/fuzz/, and stays in the corpus there.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"

[[ ${1:-} != -h && ${1:-} != --help ]] || { show_help && exit 0; }
seconds=${1:-600}
[[ $seconds =~ ^[1-9][0-9]*$ ]] || die_usage "SECONDS is a positive number, not '$seconds'"
names=("${@:2}")
[[ ${#names[@]} -gt 0 ]] || names=(decoders loaders calibrations settings mcap bag db3 messages recording map_file web)
targets=()
for name in "${names[@]}"; do
  targets+=(--target "fuzz_$name")
  [[ -f $root/tests/fuzz/$name.cpp ]] || die_usage "there is no target '$name'"
done

"$root/deploy/build.sh" --preset fuzz "${targets[@]}"
folder=$(build_dir fuzz)/fuzz
failed=0
for name in "${names[@]}"; do
  step "fuzz: $name, $seconds s"
  corpus=$folder/corpus-$name
  mkdir -p -- "$corpus"
  COSLAM_FUZZ_SEEDS=$corpus "$folder/fuzz_$name" -max_total_time="$seconds" -max_len=4096 -timeout=10 -rss_limit_mb=2048 \
    -print_final_stats=1 -verbosity=0 -print_funcs=0 -close_fd_mask=1 -artifact_prefix="$folder/$name-" "$corpus" || failed=1
done
[[ $failed == 0 ]] || die "something was found: $folder/*-crash-*, *-oom-*, *-timeout-*"
step "fuzz: nothing was found"
