#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# deploy/test-changed.sh [--base REF] [--minutes N | --seconds N] [--only PART]...
#
# What deploy/test.sh leaves out, within a time: the ratios of the benchmarks, clang-tidy on what changed, the tests that a
# change concerns with sanitizers, and the fuzzers that are quickly built. What there was no time for is named, and is no
# failure; whatever is found is one.
#   --base REF     what changed is what differs from here (default: $COSLAM_CI_BASE, else the commit before, HEAD~1)
#   --minutes N    for all together (default: $COSLAM_CI_EXTRA_MIN, else 8); no part takes the share of a later one
#   --seconds N    the same in seconds
#   --only PART    benchmark, tidy, asan, tsan or fuzz; may be repeated
# Needs what deploy/setup.sh --lint --fuzz installs. Uses the build folder of the preset ci.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"

base=${COSLAM_CI_BASE:-HEAD~1}
minutes=${COSLAM_CI_EXTRA_MIN:-8}
seconds=
parts=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --base) need_value "$1" $# && base=$2 && shift ;;
    --minutes) need_value "$1" $# && minutes=$2 && shift ;;
    --seconds) need_value "$1" $# && seconds=$2 && shift ;;
    --only)
      need_value "$1" $#
      [[ $2 =~ ^(benchmark|tidy|asan|tsan|fuzz)$ ]] || die_usage "there is no part '$2'"
      parts+=("$2") && shift
      ;;
    -h | --help) show_help && exit 0 ;;
    *) die_usage "unknown option '$1'" ;;
  esac
  shift
done
[[ $minutes =~ ^[1-9][0-9]*$ ]] || die_usage "the minutes are a positive number, not '$minutes'"
seconds=${seconds:-$((60 * minutes))}
[[ $seconds =~ ^[1-9][0-9]*$ ]] || die_usage "the seconds are a positive number, not '$seconds'"
[[ ${#parts[@]} -gt 0 ]] || parts=(benchmark tidy asan tsan fuzz)
declare -A share=([benchmark]=1 [tidy]=3 [asan]=3 [tsan]=2 [fuzz]=3)  # of the time that is left
fuzz_targets=(settings messages)                                       # the quickest to build
fuzz_s=20

cd -- "$root"
SECONDS=0
log=$(mktemp)
trap 'rm -f -- "$log"' EXIT

# within COMMAND...: runs it until `until`; 124 when time ran out.
within() {
  local left=$((until - SECONDS))
  [[ $left -gt 0 ]] || return 124
  timeout --kill-after=10 "$left" "$@" || {
    local code=$?
    [[ $code != 137 || $SECONDS -lt $until ]] || code=124  # it had to be killed
    return "$code"
  }
}

# A part may set what its line says, `detail` and `left_out`. It fails when it found something, with 124 when time ran
# out before.
part_benchmark() {
  within deploy/benchmark.sh
}

part_tidy() {
  local code=0 left=$((until - SECONDS))
  within deploy/lint.sh --tidy --base "$base" --seconds $((left > 10 ? left - 5 : 5)) | tee -- "$log" || code=$?
  detail=$(sed -nE 's/^== clang-tidy: ([0-9]+ files).*/\1/p' "$log")
  left_out=$(sed -n 's/^left out, because time ran out: //p' "$log")
  return "$code"
}

# sanitized PRESET LABEL: one program after the other is built and run.
sanitized() {
  local preset=$1 label=$2 directory files list programs=() program code passed=0 bad=()
  mapfile -t files < <(git diff --name-only "$merge_base" -- '*.h' '*.cpp' '*.idl')
  directory=$(build_dir "$preset")
  within cmake --preset "$preset" --log-level=WARNING >/dev/null || return
  list=$(deploy/changed_tests.py --build "$directory" --label "$label" "${files[@]}") || return
  [[ -z $list ]] || mapfile -t programs <<<"$list"
  for program in "${programs[@]}"; do
    code=0
    within deploy/build.sh --preset "$preset" --target "$program" >"$log" 2>&1 || code=$?
    if [[ $code == 0 ]]; then
      step "$preset: ${program#test/}"
      (cd -- "$directory" && TSAN_OPTIONS="suppressions=$root/tests/support/tsan.supp" within "./$program" --gtest_brief=1) ||
        code=$?
    else
      [[ $code == 124 ]] || cat -- "$log"
    fi
    case $code in
      0) passed=$((passed + 1)) ;;
      124) left_out+=" ${program#test/}" ;;
      *) bad+=("${program#test/}") ;;
    esac
  done
  detail="$passed of ${#programs[@]} programs passed"
  [[ ${#bad[@]} -eq 0 ]] || { detail+=", failed: ${bad[*]}" && return 1; }
  [[ $passed -gt 0 || -z $left_out ]] || return 124
}

part_fuzz() {
  local target code done_targets=()
  command -v clang++ >/dev/null || { ended=skipped left_out="everything, there is no clang++" && return 0; }
  for target in "${fuzz_targets[@]}"; do
    code=0
    within deploy/build.sh --preset fuzz --target "fuzz_$target" || code=$?
    # Time for the whole of it, or none: a fuzzer that is stopped tells nothing.
    [[ $code != 0 || $((until - SECONDS)) -gt $((fuzz_s + 10)) ]] || code=124
    [[ $code != 0 ]] || deploy/fuzz.sh "$fuzz_s" "$target" || code=$?
    case $code in
      0) done_targets+=("$target") ;;
      124) left_out+=" $target" ;;
      *) detail="$target" && return 1 ;;
    esac
  done
  [[ ${#done_targets[@]} -gt 0 ]] || return 124
  detail="$fuzz_s s each: ${done_targets[*]}"
}

part() {
  case $1 in
    benchmark) part_benchmark ;;
    tidy) part_tidy ;;
    asan) sanitized asan unit ;;
    tsan) sanitized tsan threads ;;
    fuzz) part_fuzz ;;
  esac
}

merge_base=
if in_git && git rev-parse --quiet --verify "$base^{commit}" >/dev/null; then
  merge_base=$(git merge-base "$base" HEAD) || merge_base=
fi

failed=0
results=()
shares=0
for name in "${parts[@]}"; do shares=$((shares + share[$name])); done
for name in "${parts[@]}"; do
  start=$SECONDS
  until=$((start + (seconds - start) * share[$name] / shares))
  shares=$((shares - share[$name]))
  detail='' left_out='' ended=passed code=0
  step "$name: until $((until / 60)) min $((until % 60)) s"
  if [[ -z $merge_base && $name =~ ^(tidy|asan|tsan)$ ]]; then
    ended=skipped left_out="everything, there is no '$base' in this history"
  else
    part "$name" || code=$?
    case $code in
      0) ;;
      124) ended='no time' left_out=${left_out:-everything} ;;
      *) ended=FAILED failed=1 ;;
    esac
  fi
  results+=("$(printf '%-10s %-7s %4d s' "$name" "$ended" $((SECONDS - start)))${detail:+  $detail}${left_out:+; left out: ${left_out# }}")
done

step "result, on what differs from $base"
printf '%s\n' "${results[@]}"
exit "$failed"
