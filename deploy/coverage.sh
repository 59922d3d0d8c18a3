#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# deploy/coverage.sh [--jobs N] [--again]
#
# Which part of the lines of server/estimator, agent and common the unit tests run, against the floors of
# tests/coverage.json. Builds in build-coverage/; from nothing about 30 minutes of one core, and the tests.
#   --jobs N   parallel compilers (default: one a core, fewer when memory is short)
#   --again    only counts again what the last run left
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"

jobs=$(build_jobs)
again=no
while [[ $# -gt 0 ]]; do
  case $1 in
    --jobs) need_value "$1" $# && jobs=$2 && shift ;;
    --again) again=yes ;;
    -h | --help) show_help && exit 0 ;;
    *) die_usage "unknown option '$1'" ;;
  esac
  shift
done
[[ $jobs =~ ^[1-9][0-9]*$ ]] || die_usage "--jobs takes a positive number, not '$jobs'"

cd -- "$root"
directory=$(build_dir coverage)
if [[ $again == no ]]; then
  deploy/build.sh --preset coverage --target unit_tests --jobs "$jobs"
  find "$directory" -name '*.gcda' -delete
  # Each program once: CTest would start it for each of its cases, and each end writes what was counted.
  list=$(deploy/changed_tests.py --build "$directory" --label unit --all)
  while IFS= read -r program; do
    step "test: ${program#test/}"
    (cd -- "$directory" && "./$program" --gtest_brief=1) || die "${program#test/} fails: see above"
  done <<<"$list"
fi
step "coverage: lines that the unit tests run"
python3 deploy/coverage.py --build "$directory" --floors tests/coverage.json --jobs "$jobs" ||
  die "less is covered than tests/coverage.json asks for"
