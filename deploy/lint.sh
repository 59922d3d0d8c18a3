#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# deploy/lint.sh [--format | --tidy] [--base REF | --all] [--again] [--fix] [--jobs N] [--seconds N]
#
# Checks the C++ files: the layout of all of them with clang-format, and those that changed with clang-tidy. Both are
# version 14, because other versions lay out and warn differently. Without --format or --tidy it does both.
#   --format     only the layout
#   --tidy       only clang-tidy
#   --base REF   clang-tidy takes what differs from here (default: where this branch left origin/main or main)
#   --all        clang-tidy takes every file
#   --again      also those that were clean before and have not changed since, with all that they include
#   --fix        lays the files out instead of complaining
#   --jobs N     clang-tidy processes at a time (default 2)
#   --seconds N  clang-tidy leaves out what it did not come to until then, and says so
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"

format=yes
tidy=yes
base=
all=no
fix=no
jobs=2
again=()
seconds=
limit=()
while [[ $# -gt 0 ]]; do
  case $1 in
    --format) tidy=no ;;
    --tidy) format=no ;;
    --base) need_value "$1" $# && base=$2 && shift ;;
    --all) all=yes ;;
    --again) again=(--again) ;;
    --fix) fix=yes ;;
    --jobs) need_value "$1" $# && jobs=$2 && shift ;;
    --seconds) need_value "$1" $# && seconds=$2 && shift ;;
    -h | --help) show_help && exit 0 ;;
    *) die_usage "unknown option '$1'" ;;
  esac
  shift
done
[[ $format == yes || $tidy == yes ]] || die_usage "--format and --tidy exclude each other"
[[ $jobs =~ ^[1-9][0-9]*$ ]] || die_usage "--jobs takes a positive number, not '$jobs'"
[[ -z $seconds || $seconds =~ ^[1-9][0-9]*$ ]] || die_usage "--seconds takes a positive number, not '$seconds'"
cd -- "$root"

# tool NAME: the path of version 14 of a clang tool.
tool() {
  local path
  path=$(command -v "$1-14") || path=$(command -v "$1") || die "there is no $1: run deploy/setup.sh --lint"
  "$path" --version | grep -q 'version 14\.' || die "$1 here is not version 14: run deploy/setup.sh --lint"
  printf '%s\n' "$path"
}

check_format() {
  local clang_format files
  clang_format=$(tool clang-format) || exit
  mapfile -t files < <(source_files)
  step "format: ${#files[@]} files"
  if [[ $fix == yes ]]; then
    "$clang_format" -i "${files[@]}"
  else
    "$clang_format" --dry-run -Werror --ferror-limit=5 "${files[@]}" ||
      die "the layout differs from .clang-format: deploy/lint.sh --format --fix puts it right"
  fi
}

# The files that clang-tidy takes: .cpp files that changed, and the .cpp file beside a header that changed.
tidy_files() {
  local merge_base file
  if [[ $all == yes ]]; then
    source_files | grep '\.cpp$' || true
    return
  fi
  in_git || die "without git history there is nothing to compare with: use --all"
  if [[ -z $base ]]; then
    for base in origin/main main HEAD; do
      if git rev-parse --quiet --verify "$base^{commit}" >/dev/null; then break; fi
    done
  fi
  git rev-parse --quiet --verify "$base^{commit}" >/dev/null || die "git knows no '$base' to compare with: use --all"
  merge_base=$(git merge-base "$base" HEAD) || die "'$base' and this branch share no history: use --all"
  {
    git diff --name-only --diff-filter=d "$merge_base" -- '*.h' '*.cpp'
    git ls-files --others --exclude-standard -- '*.h' '*.cpp'
  } | while IFS= read -r file; do
    file=${file%.*}.cpp
    [[ ! -f $file ]] || printf '%s\n' "$file"
  done | sort -u
}

check_tidy() {
  local clang_tidy list files directory generated
  clang_tidy=$(tool clang-tidy) || exit
  list=$(tidy_files) || exit
  files=()
  [[ -z $list ]] || mapfile -t files <<<"$list"
  step "clang-tidy: ${#files[@]} files, $jobs at a time"
  [[ ${#files[@]} -gt 0 ]] || return 0

  directory=$(build_dir tidy)
  cmake --preset tidy --log-level=WARNING >/dev/null || die "configuring the preset tidy failed: CMake says why above"
  # The headers that are made from the IDL must exist; nothing else needs to be built.
  mapfile -t generated < <(ninja -C "$directory" -t targets all | sed -nE 's/^(idl\/.*\.(h|hpp|ipp|cxx)): CUSTOM_COMMAND$/\1/p')
  if [[ ${#generated[@]} -gt 0 ]]; then
    ninja -C "$directory" "${generated[@]}" >/dev/null || die "the headers of idl/ could not be made: see above"
  fi

  [[ -z $seconds ]] || limit=(--seconds $((seconds > SECONDS ? seconds - SECONDS : 1)))
  python3 deploy/tidy_files.py --build "$directory" --clang-tidy "$clang_tidy" --jobs "$jobs" "${limit[@]}" "${again[@]}" "${files[@]}" ||
    die "clang-tidy found something: see above"
}

[[ $format == no ]] || check_format
[[ $tidy == no ]] || check_tidy
