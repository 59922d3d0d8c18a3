#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# deploy/test.sh [--werror] [--lint [--base REF] | --full]
#
# From a fresh checkout to the test result: installs what is missing, builds everything, checks format, layers and
# words, runs all tests. All parts run even when one fails; the exit code is 0 when all passed. At the end stands how
# each part ended and how long it took.
#   --werror     compiler warnings are errors
#   --lint       also clang-tidy on the files changed since REF (see deploy/lint.sh)
#   --base REF   what --lint compares with
#   --full       also the unit tests with the address and undefined behaviour sanitizers, the tests with threads with the
#                thread sanitizer, and clang-tidy on every file; takes hours on two cores the first time
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"

preset=release
lint=no
full=no
lint_options=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --werror) preset=ci ;;
    --lint) lint=yes ;;
    --full) full=yes ;;
    --base) need_value "$1" $# && lint_options=(--base "$2") && shift ;;
    -h | --help) show_help && exit 0 ;;
    *) die_usage "unknown option '$1'" ;;
  esac
  shift
done
if [[ $full == yes && ($lint == yes || ${#lint_options[@]} -gt 0) ]]; then
  die_usage "--full checks every file with clang-tidy: leave out --lint and --base"
fi

failed=0
results=()
ended=
# check NAME COMMAND...: runs it and notes how it ended, also in `ended`.
check() {
  local name=$1 start=$SECONDS
  shift
  ended=passed
  if ! "$@"; then
    ended=FAILED
    failed=1
  fi
  results+=("$(printf '%-8s %s %6d s' "$name" "$ended" $((SECONDS - start)))")
}

# shellcheck disable=SC2317  # called through check
run_tests() {
  step "test"
  ctest --test-dir "$(build_dir "$preset")" --parallel "$(test_shares)" --output-on-failure --no-tests=error 2>&1 | tee "$log"
}

# sanitized PRESET TARGET: builds and runs the tests that the preset is for.
# shellcheck disable=SC2317
sanitized() {
  "$root/deploy/build.sh" --preset "$1" --target "$2" || return
  step "test: preset $1"
  ctest --preset "$1" --parallel "$(test_shares)" --no-tests=error
}

cd -- "$root"
log=$(build_dir "$preset")/test.log
rm -f -- "$log"
"$root/deploy/setup.sh" --lint --test --browser || exit
check format "$root/deploy/lint.sh" --format
check layers python3 "$root/deploy/check_layers.py"
check words python3 "$root/deploy/check_words.py"
check numbers python3 "$root/deploy/count_numbers.py"
[[ $lint == no ]] || check lint "$root/deploy/lint.sh" --tidy "${lint_options[@]}"
check build "$root/deploy/build.sh" --preset "$preset"
# Without a build there are no tests, or those of another day.
if [[ $ended == passed ]]; then
  check tests run_tests
else
  results+=("tests    not run")
fi
if [[ $full == yes ]]; then
  check asan sanitized asan unit_tests
  check tsan sanitized tsan threads_tests
  check tidy "$root/deploy/lint.sh" --tidy --all
fi

step "result"
[[ ! -f $log ]] || awk '/% tests passed/ { closing = 1 } closing' "$log"  # CTest's own closing summary
printf '%s\n' "${results[@]}"
exit "$failed"
