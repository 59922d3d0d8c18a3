#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
#
# The scripts of deploy/: they parse, explain themselves from any folder, and answer a wrong option with exit code 2.
set -euo pipefail
deploy=$(CDPATH='' cd -- "$(dirname -- "$0")/../../deploy" && pwd -P)
cd /

fail() {
  printf 'scripts_test.sh: %s\n' "$*" >&2
  exit 1
}

for script in "$deploy"/*.sh; do
  name=${script##*/}
  bash -n "$script" || fail "$name does not parse"
  [[ $name != lib.sh && $name != systems.sh ]] || continue
  [[ -x $script ]] || fail "$name is not executable"
  help=$("$script" --help) || fail "$name --help fails"
  [[ $help == "deploy/$name"* ]] || fail "$name --help does not start with its usage"
  code=0
  message=$("$script" --no-such-option 2>&1) || code=$?
  [[ $code -eq 2 ]] || fail "$name --no-such-option ends with $code, not 2"
  [[ $(wc -l <<<"$message") -eq 1 && $message == *"--no-such-option"* ]] || fail "$name: no clear sentence: $message"
done

# What test.sh does, in a tree of stand-ins: each notes how it was called and fails if $failing says so.
tree=$(mktemp -d)
trap 'rm -rf -- "$tree"' EXIT
mkdir -p "$tree/deploy" "$tree/bin" "$tree/build"
cp "$deploy/test.sh" "$deploy/lib.sh" "$tree/deploy"
for stand_in in deploy/setup.sh deploy/lint.sh deploy/build.sh bin/python3 bin/ctest; do
  # shellcheck disable=SC2016
  printf '#!/usr/bin/env bash\ncall="%s $*"\nprintf "%%s\\n" "$call" >>"$calls"\n[[ $call != ${failing:-none} ]]\n' \
    "${stand_in##*/}" >"$tree/$stand_in"
  chmod +x "$tree/$stand_in"
done
# calls_of FAILING OPTION...: what test.sh calls, in order; its own output is in $output, its exit code in $code.
calls_of() {
  local failing=$1
  shift
  code=0
  : >"$tree/calls"
  output=$(PATH=$tree/bin:$PATH calls=$tree/calls failing=$failing "$tree/deploy/test.sh" "$@" 2>&1) || code=$?
  calls=$(sed "s|$tree|TREE|g" "$tree/calls")
}
# expect CODE CALLS WHAT: how test.sh ended and what it called.
expect() { [[ "$code $calls" == "$1 $2" ]] || fail "test.sh $3 ends with $code, not $1, or calls not '$2' but '$calls': $output"; }
# without PATTERN: its input but for these lines.
without() { grep -v -- "$1"; }

shares=$((2 * $(nproc)))
checks='setup.sh --lint --test --browser
lint.sh --format
python3 TREE/deploy/check_layers.py
python3 TREE/deploy/check_words.py
python3 TREE/deploy/count_numbers.py'
run="build.sh --preset release
ctest --test-dir TREE/build --parallel $shares --output-on-failure --no-tests=error"
more="build.sh --preset asan --target unit_tests
ctest --preset asan --parallel $shares --no-tests=error
build.sh --preset tsan --target threads_tests
ctest --preset tsan --parallel $shares --no-tests=error
lint.sh --tidy --all"
full=$checks$'\n'$run$'\n'$more
calls_of none
expect 0 "$checks"$'\n'"$run" 'alone'
calls_of none --werror --lint --base HEAD
expect 0 "$checks"$'\nlint.sh --tidy --base HEAD\n'"${run/release/ci}" '--werror --lint --base HEAD'
calls_of none --full
expect 0 "$full" --full
for part in format layers words build tests asan tsan tidy; do
  grep -qE "^$part +passed +[0-9]+ s$" <<<"$output" || fail "test.sh --full says nothing of the part $part: $output"
done
# Whatever fails, the other parts run, and the exit code says it; only what was not built is not tested.
while IFS= read -r broken; do
  calls_of "$broken" --full
  case $broken in
    *release) expect 1 "$(without '^ctest --test-dir' <<<"$full")" "with a broken $broken" ;;
    build*) expect 1 "$(without "^ctest --preset ${broken:18:4}" <<<"$full")" "with a broken $broken" ;;
    *) expect 1 "$full" "with a broken $broken" ;;
  esac
  [[ $(grep -c ' FAILED ' <<<"$output") -eq 1 ]] || fail "test.sh does not name the broken $broken: $output"
done < <(sed "1d; s|TREE|$tree|" <<<"$full")
for wrong in '--full --lint' '--full --base HEAD' --base; do
  # shellcheck disable=SC2086
  calls_of none $wrong
  expect 2 '' "$wrong"
done

# The same of test-changed.sh, in a history of two commits. What takes a minute in place of its work is `slow`.
cp "$deploy/test-changed.sh" "$tree/deploy"
for stand_in in deploy/benchmark.sh deploy/lint.sh deploy/build.sh deploy/fuzz.sh bin/cmake bin/clang++ build-asan/test/map_test \
  build-tsan/test/flow_test; do
  mkdir -p "$(dirname "$tree/$stand_in")"
  # shellcheck disable=SC2016
  printf '#!/usr/bin/env bash\ncall="%s $*"\nprintf "%%s\\n" "$call" >>"$calls"\n[[ $call != ${slow:-none} ]] || exec sleep 60\n[[ $call != ${failing:-none} ]]\n' \
    "${stand_in##*/}" >"$tree/$stand_in"
  chmod +x "$tree/$stand_in"
done
# shellcheck disable=SC2016
printf '#!/usr/bin/env bash\n[[ $# -eq 4 ]] || { [[ $4 == unit ]] && echo test/map_test || echo test/flow_test; }\n' >"$tree/deploy/changed_tests.py"
chmod +x "$tree/deploy/changed_tests.py"
git_here() { git -C "$tree" -c user.name=test -c user.email=test@localhost -c commit.gpgsign=false "$@" >/dev/null; }
git_here init -q
git_here add deploy
git_here commit -q -m one
touch "$tree/a.cpp"
git_here add a.cpp
git_here commit -q -m two
# changed_calls FAILING SLOW OPTION...: as calls_of.
changed_calls() {
  local failing=$1 slow=$2
  shift 2
  code=0
  : >"$tree/calls"
  output=$(PATH=$tree/bin:$PATH calls=$tree/calls failing=$failing slow=$slow "$tree/deploy/test-changed.sh" "$@" 2>&1) || code=$?
  calls=$(sed -E "s|$tree|TREE|g; s|--seconds [0-9]+|--seconds N|" "$tree/calls")
}
changed='benchmark.sh '$'\n''lint.sh --tidy --base HEAD~1 --seconds N
cmake --preset asan --log-level=WARNING
build.sh --preset asan --target test/map_test
map_test --gtest_brief=1
cmake --preset tsan --log-level=WARNING
build.sh --preset tsan --target test/flow_test
flow_test --gtest_brief=1
build.sh --preset fuzz --target fuzz_settings
fuzz.sh 20 settings
build.sh --preset fuzz --target fuzz_messages
fuzz.sh 20 messages'
changed_calls none none
expect 0 "$changed" 'test-changed.sh'
for part in benchmark tidy asan tsan fuzz; do
  grep -qE "^$part +passed +[0-9]+ s" <<<"$output" || fail "test-changed.sh says nothing of the part $part: $output"
done
for broken in 'benchmark.sh ' 'map_test --gtest_brief=1' 'build.sh --preset tsan --target test/flow_test' 'fuzz.sh 20 messages'; do
  changed_calls "$broken" none
  [[ $code -eq 1 && $(grep -c ' FAILED ' <<<"$output") -eq 1 ]] || fail "test-changed.sh does not name the broken $broken: $output"
done
changed_calls none 'map_test --gtest_brief=1' --only asan --seconds 5
[[ $code -eq 0 && $output == *'0 of 1 programs passed; left out: map_test'* ]] || fail "test-changed.sh waits for what is slow: $output"
changed_calls none none --base nowhere
[[ $code -eq 0 && $(grep -c "left out: everything, there is no 'nowhere'" <<<"$output") -eq 3 ]] || fail "test-changed.sh without history: $output"
changed_calls none none --base HEAD --only tsan
expect 0 'cmake --preset tsan --log-level=WARNING' 'test-changed.sh where nothing changed'

# Every package is listed once, and the whole list is read.
listed=$(sed 's/#.*//; /^\[/d; /^ *$/d' "$deploy/packages.txt" | sort)
[[ -z $(uniq -d <<<"$listed") ]] || fail "packages.txt lists a package twice"
COSLAM_SETUP=off "$deploy/setup.sh" --lint --test --browser --fuzz || fail "setup.sh ignores COSLAM_SETUP=off"
if command -v shellcheck >/dev/null; then
  (cd "$deploy" && shellcheck --external-sources ./*.sh ../tests/deploy/*.sh ../.ci/run) || fail "shellcheck complains"
fi
# The services stay fenced in: an exposure of at most 2.0 of 10.
if command -v systemd-analyze >/dev/null; then
  for unit in "$deploy"/systemd/*.service; do
    systemd-analyze security --offline=true --threshold=20 --no-pager "$unit" >/dev/null 2>&1 ||
      fail "${unit##*/} is too exposed: systemd-analyze security --offline=true shows by what"
  done
fi
echo "all scripts of deploy/ are in order"
