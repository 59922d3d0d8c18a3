#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# install_test.sh CMAKE BUILD VERSION: what is installed is whole, and a program elsewhere finds and links it.
set -euo pipefail
cmake=$1 build=$2 version=$3
folder=$(mktemp -d)
trap 'rm -rf -- "$folder"' EXIT
prefix=$folder/prefix
fail() { printf 'install_test: %s\n' "$*" >&2; exit 1; }

for component in agent server bridge tools dev; do
  "$cmake" --install "$build" --prefix "$prefix" --component "$component" >"$folder/log" || { cat "$folder/log"; fail "no $component"; }
done
for program in coslam coslam-agent coslam-server coslam-bridge; do
  [[ $("$prefix/bin/$program" --version) == "$version" ]] || fail "$program does not say its version"
done
for file in etc/coslam/server.yaml lib/systemd/system/coslam-agent.service share/bash-completion/completions/coslam \
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
