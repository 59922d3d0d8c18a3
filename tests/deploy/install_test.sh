#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# install_test.sh CMAKE BUILD VERSION: what is installed is whole, and programs elsewhere find and link it. Those of
# docs/examples are left in BUILD/test/examples.
set -euo pipefail
cmake=$1 build=$2 version=$3
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
prefix=$folder/prefix
fail() { printf 'install_test: %s\n' "$*" >&2; exit 1; }

for component in agent server bridge tools video dev; do
  "$cmake" --install "$build" --prefix "$prefix" --component "$component" >"$folder/log" || { cat "$folder/log"; fail "no $component"; }
done
for program in coslam coslam-agent coslam-server coslam-bridge; do
  [[ $("$prefix/bin/$program" --version) == "$version" ]] || fail "$program does not say its version"
done
for file in etc/coslam/server.yaml lib/systemd/system/coslam-agent.service lib/coslam/plugins/coslam-video.so share/bash-completion/completions/coslam \
  share/doc/coslam/README.md share/doc/coslam/docs/field.md share/coslam/idl/coslam.idl; do
  [[ -s $prefix/$file ]] || fail "$file is missing"
done
# Links lead to what is installed; those of pages about the code into the source, which is not.
documents=$prefix/share/doc/coslam source=$(CDPATH='' cd -- "$(dirname -- "$0")/../.." && pwd -P)
while IFS=: read -r document target; do
  file=${target%%#*}
  [[ $target != *://* && -n $file && ! -e ${document%/*}/$file ]] || continue
  of_source=$(realpath --canonicalize-missing --relative-to="$documents" -- "${document%/*}/$file")
  [[ $of_source =~ ^(agent|common|deploy|idl|server|tests)/ && -e $source/$of_source ]] ||
    fail "$document leads to $target, which is not there"
done < <(grep -RHoP --include='*.md' '(?<=[]][(])[^()" ]+(?=[)])' "$documents")
printf 'changed: true\n' >"$prefix/etc/coslam/server.yaml"
"$cmake" --install "$build" --prefix "$prefix" --component server >/dev/null
grep --quiet changed "$prefix/etc/coslam/server.yaml" || fail "the user's configuration was written over"

# shellcheck source=/dev/null
source "$prefix/share/bash-completion/completions/coslam"
COMP_WORDS=("$prefix/bin/coslam" exp) COMP_CWORD=1
_coslam
[[ ${COMPREPLY[*]} == "explain export" ]] || fail "completion gives ${COMPREPLY[*]}"
COMP_WORDS=("$prefix/bin/coslam" run --inl) COMP_CWORD=2
_coslam
[[ ${COMPREPLY[*]} == --inline ]] || fail "completion gives ${COMPREPLY[*]}"
COMP_WORDS=("$prefix/bin/coslam" run sim : walk) COMP_CWORD=4
_coslam
[[ ${COMPREPLY[*]} == walking-man ]] || fail "completion gives ${COMPREPLY[*]}"
COMP_WORDS=("$prefix/bin/coslam" export r --format e) COMP_CWORD=4
_coslam
[[ ${COMPREPLY[*]} == euroc ]] || fail "completion gives ${COMPREPLY[*]}"
COMP_WORDS=("$prefix/bin/coslam" map c) COMP_CWORD=2
_coslam
[[ ${COMPREPLY[*]} == "check compact copy" ]] || fail "completion gives ${COMPREPLY[*]}"

mkdir "$folder/user"
cat >"$folder/user/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(user LANGUAGES CXX)
find_package(coslam REQUIRED)
add_executable(user user.cpp)
target_link_libraries(user PRIVATE coslam::coslam_wire)
END
cat >"$folder/user/user.cpp" <<'END'
#include "common/base/version.h"
#include "common/wire/codec.h"
int main() {
  coslam::MovingState state;
  state.server_run = coslam::RunId(1);
  return coslam::encode(state).server_run() == 1 && coslam::version()[0] != 0 ? 0 : 1;
}
END
build_user() {
  "$cmake" -S "$folder/user" -B "$folder/user/build" -D CMAKE_PREFIX_PATH="$prefix" && "$cmake" --build "$folder/user/build"
}
build_user >"$folder/log" 2>&1 || { cat "$folder/log"; fail "a program does not find or link it"; }
"$folder/user/build/user" || fail "the program that links it fails"

# The examples, from where they are installed.
rm -rf -- "$build/test/examples"
build_examples() {
  "$cmake" -S "$documents/docs/examples" -B "$folder/examples" -D CMAKE_PREFIX_PATH="$prefix" -D CMAKE_BUILD_TYPE=Debug \
    -D CMAKE_CXX_FLAGS="-Wall -Wextra -Wshadow -Werror" -D CMAKE_RUNTIME_OUTPUT_DIRECTORY="$build/test/examples" &&
    "$cmake" --build "$folder/examples"
}
build_examples >"$folder/log" 2>&1 || { cat "$folder/log"; fail "the examples cannot be built"; }

# On a result of one agent that goes 3 m along x in 2 s and then 4 m along y, has no pose in the last of its images, and
# sees somebody walk there and back, beside a point that goes alone.
mkdir -p "$folder/result/trajectory"
cat >"$folder/result/report.json" <<'END'
{"agents": {"anna": {"images": {"captured": 4}, "tracked_percent": 75.0}}, "maps": [{"map": 1, "scale_known": true}]}
END
cat >"$folder/result/trajectory/anna.tum" <<'END'
# t_s tx ty tz qx qy qz qw, camera to world; lengths are metres
0.000000000 1 0 0 0 0 0 1
2.000000000 4 0 0 0 0 0 1
4.000000000 4 4 0 0 0 0.6 0.8
END
cat >"$folder/result/objects.csv" <<'END'
t_s,object,x,y,z,vx,vy,vz,extent_x,extent_y,extent_z,members
0.500000000,1,0,0,5,1,0,0,0.5,1.7,0.5,7 8
1.000000000,1,0.5,0,5,0,0,-1.5,0.5,1.7,0.5,7 8 9
1.500000000,1,0,0,5,-1,0,0,0.5,1.7,0.5,7 9
END
cat >"$folder/result/dynamic.csv" <<'END'
t_s,id,x,y,z,cov_xx,cov_xy,cov_xz,cov_yy,cov_yz,cov_zz,views
0.500000000,7,0,0,5,1e-4,0,0,1e-4,0,1e-4,2
0.500000000,12,3,0,5,1e-4,0,0,1e-4,0,1e-4,2
END
# prints PROGRAM LINE...: on that result, these lines, runs of blanks apart.
prints() {
  local program=$1 line
  "$build/test/examples/$program" "$folder/result" >"$folder/printed" || fail "the example $program fails"
  if [[ $program == moving ]]; then
    grep --quiet --line-regexp --fixed-strings -- "$(head -n 1 "$folder/printed")" "$documents/docs/examples/README.md" ||
      fail "docs/examples/README.md shows another head of moving"
  fi
  shift
  for line in "$@"; do
    tr --squeeze-repeats ' ' <"$folder/printed" | grep --quiet --line-regexp --fixed-strings -- "$line" ||
      { cat "$folder/printed"; fail "the example $program does not print '$line'"; }
  done
}
prints paths 'anna 4 75.0% 7.000 m 1.750 m/s'
prints moving '1 0.50 1.50 3 1.250 0.000 1.000' '3 points in objects, 1 alone, 2 places in all'
rm "$folder/result/report.json"
said=$("$build/test/examples/paths" "$folder/result" 2>&1) && fail "the example paths reads what is no result"
[[ $said == "paths: $folder/result: there is no report.json, so this is no result" ]] || fail "the example paths says $said"
