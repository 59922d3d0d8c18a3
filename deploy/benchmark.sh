#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# deploy/benchmark.sh
#
# Measures the ratios of tests/benchmark/budget.json and compares each with its ceiling there; about 15 seconds once the
# programs are built, in build/.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"

case ${1:-} in
  -h | --help) show_help && exit 0 ;;
  ?*) die_usage "unknown option '$1'" ;;
esac

targets=()
for name in track step bundle codec; do targets+=(--target "coslam_benchmark_$name"); done
"$root/deploy/build.sh" "${targets[@]}"
step "benchmark: ratios and their ceilings"
python3 "$root/tests/benchmark/budget.py" --bin "$(build_dir release)/bin" ||
  die "a ratio is above its ceiling in tests/benchmark/budget.json"
