#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# deploy/setup.sh [--lint] [--test] [--browser] [--package] [--fuzz] [--arm64] [--list]
#
# Installs the Debian packages of deploy/packages.txt that are missing; does nothing when there are none.
#   --lint      also those that the format, layer and lint checks need
#   --test      also those of other programs that tests compare with
#   --browser   also the browser that the page is tested in (300 MB)
#   --package   also those that packages are made and checked with
#   --fuzz      also the compiler that fuzzers are built with
#   --arm64     also those that deploy/build.sh --arch arm64 needs: compiler, emulator, what makes the sysroot
#   --list      only print the names of the missing packages
# Without npm, for the page, the browser, the compiler of fuzzers and the other programs all else works: if they cannot be
# had, it says so and goes on.
# COSLAM_SETUP=off skips it, for systems where the libraries come from elsewhere.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"

sets=(build)
optional=(speed)
command -v npm >/dev/null || optional+=(page)  # from wherever it is
list=no
while [[ $# -gt 0 ]]; do
  case $1 in
    --lint) sets+=(lint) ;;
    --test) optional+=(test) ;;
    --browser) command -v chromium >/dev/null || optional+=(browser) ;;
    --package) sets+=(package systems) ;;
    --fuzz) optional+=(fuzz) ;;
    --arm64) sets+=(arm64 systems) ;;
    --list) list=yes ;;
    -h | --help) show_help && exit 0 ;;
    *) die_usage "unknown option '$1'" ;;
  esac
  shift
done

if [[ ${COSLAM_SETUP:-on} == off ]]; then exit 0; fi
if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  die "this system has no apt-get: install what deploy/packages.txt lists by other means and set COSLAM_SETUP=off"
fi

# The packages of one set, one a line; a|b where releases name it differently.
packages_of() {
  awk -v wanted="[$1]" '{ sub(/#.*/, ""); gsub(/ *\| */, "|") } /^\[/ { inside = ($1 == wanted); next }
    inside && NF { print $1 }' "$root/deploy/packages.txt"
}

# missing_of ARRAY SET...: puts the packages of these sets that are not installed into the array.
missing_of() {
  local -n out=$1
  local wanted=() names=() set installed package
  for set in "${@:2}"; do
    mapfile -t -O "${#wanted[@]}" wanted < <(packages_of "$set")
  done
  [[ ${#wanted[@]} -gt 0 ]] || return 0
  IFS='|' read -r -a names <<<"$(IFS='|' && printf '%s' "${wanted[*]}")"
  installed=$(dpkg-query --show --showformat='${Package} ${db:Status-Status}\n' "${names[@]}" 2>/dev/null |
    awk '$2 == "installed" { print $1 }') || true
  for package in "${wanted[@]}"; do
    grep -qxF -f <(tr '|' '\n' <<<"$package") <<<"$installed" || out+=("$package")
  done
}

# names_here PACKAGE...: how this release names them, one a line: of a|b the first that apt knows, else the first.
names_here() {
  local package name names
  for package in "$@"; do
    IFS='|' read -r -a names <<<"$package"
    package=${names[0]}
    for name in "${names[@]}"; do
      if apt-cache show "$name" >/dev/null 2>&1; then package=$name && break; fi
    done
    printf '%s\n' "$package"
  done
}

[[ -n $(packages_of build) ]] || die "deploy/packages.txt lists no packages"
missing=()
extra=()
missing_of missing "${sets[@]}"
missing_of extra "${optional[@]}"

if [[ $list == yes ]]; then
  names_here "${missing[@]}" "${extra[@]}"
  exit 0
fi
if [[ $((${#missing[@]} + ${#extra[@]})) -eq 0 ]]; then
  step "setup: all packages are installed"
  exit 0
fi

as_root=()
if [[ $EUID -ne 0 ]]; then
  command -v sudo >/dev/null || die "cannot install ${missing[*]}: not root, and there is no sudo"
  as_root=(sudo)
fi
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3)
[[ -t 1 ]] || apt+=(-q -o Dpkg::Use-Pty=0)

step "setup: installing ${missing[*]} ${extra[*]}"
if ! "${apt[@]}" update; then
  [[ ${#missing[@]} -eq 0 ]] || die "apt-get update failed: is the network there?"
  warn "apt-get update failed: going on without ${extra[*]}"
  exit 0
fi
mapfile -t missing < <(names_here "${missing[@]}")
mapfile -t extra < <(names_here "${extra[@]}")
[[ ${#missing[@]} -eq 0 ]] || "${apt[@]}" install --yes --no-install-recommends "${missing[@]}" ||
  die "apt-get could not install ${missing[*]} (Debian 12 and 13 have them all)"
[[ ${#extra[@]} -eq 0 ]] || "${apt[@]}" install --yes --no-install-recommends "${extra[@]}" ||
  warn "going on without ${extra[*]}"
