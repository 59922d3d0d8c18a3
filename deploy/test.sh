#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# deploy/test.sh [--werror] [--lint [--base REF]]
#
# From a fresh checkout to the test result: installs what is missing, builds everything, checks format and layers, runs
# all tests. All checks run even when one fails; the exit code is 0 when all passed.
#   --werror     compiler warnings are errors
#   --lint       also clang-tidy on the files changed since REF (see deploy/lint.sh)
#   --base REF   what --lint compares with
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"

preset=release
lint=no
lint_options=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --werror) preset=ci ;;
    --lint) lint=yes ;;
    --base) need_value "$1" $# && lint_options=(--base "$2") && shift ;;
    -h | --help) show_help && exit 0 ;;
    *) die_usage "unknown option '$1'" ;;
  esac
  shift
done

failed=0
results=()
# check NAME COMMAND...: runs it and notes how it ended.
check() {
  local name=$1
  shift
  if "$@"; then
    results+=("$(printf '%-8s passed' "$name")")
  else
    results+=("$(printf '%-8s FAILED' "$name")")
    failed=1
  fi
}

"$root/deploy/setup.sh" --lint || exit
check format "$root/deploy/lint.sh" --format
check layers python3 "$root/deploy/check_layers.py"
[[ $lint == no ]] || check lint "$root/deploy/lint.sh" --tidy "${lint_options[@]}"
"$root/deploy/build.sh" --preset "$preset" || exit

cd -- "$root"
step "test: two at a time"
log=$(build_dir "$preset")/test.log
# shellcheck disable=SC2317  # called through check
run_tests() {
  ctest --test-dir "$(build_dir "$preset")" --parallel 2 --output-on-failure --no-tests=error 2>&1 | tee "$log"
}
check tests run_tests

step "result"
printf '%s\n' "${results[@]}"
awk '/% tests passed/ { closing = 1 } closing' "$log"  # CTest's own closing summary
exit "$failed"
