#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# deploy/setup.sh [--lint] [--test] [--list]
#
# Installs the Debian packages of deploy/packages.txt that are missing; does nothing when there are none.
#   --lint   also those that the format, layer and lint checks need
#   --test   also those of other programs that tests compare with
#   --list   only print the names of the missing packages
# COSLAM_SETUP=off skips it, for systems where the libraries come from elsewhere.
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"

sets=(build)
list=no
while [[ $# -gt 0 ]]; do
  case $1 in
    --lint) sets+=(lint) ;;
    --test) sets+=(test) ;;
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

# The packages of one set, one a line.
packages_of() {
  awk -v wanted="[$1]" '{ sub(/#.*/, "") } /^\[/ { inside = ($1 == wanted); next } inside && NF { print $1 }' \
    "$root/deploy/packages.txt"
}

wanted=()
for set in "${sets[@]}"; do
  mapfile -t -O "${#wanted[@]}" wanted < <(packages_of "$set")
done
[[ ${#wanted[@]} -gt 0 ]] || die "deploy/packages.txt lists no packages"

installed=$(dpkg-query --show --showformat='${Package} ${db:Status-Status}\n' "${wanted[@]}" 2>/dev/null |
  awk '$2 == "installed" { print $1 }') || true
missing=()
for package in "${wanted[@]}"; do
  grep -qxF -- "$package" <<<"$installed" || missing+=("$package")
done

if [[ $list == yes ]]; then
  [[ ${#missing[@]} -eq 0 ]] || printf '%s\n' "${missing[@]}"
  exit 0
fi
if [[ ${#missing[@]} -eq 0 ]]; then
  step "setup: all ${#wanted[@]} packages are installed"
  exit 0
fi

as_root=()
if [[ $EUID -ne 0 ]]; then
  command -v sudo >/dev/null || die "cannot install ${missing[*]}: not root, and there is no sudo"
  as_root=(sudo)
fi
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3)
[[ -t 1 ]] || apt+=(-q -o Dpkg::Use-Pty=0)

step "setup: installing ${#missing[@]} of ${#wanted[@]} packages: ${missing[*]}"
"${apt[@]}" update || die "apt-get update failed: is the network there?"
"${apt[@]}" install --yes --no-install-recommends "${missing[@]}" ||
  die "apt-get could not install ${missing[*]} (Debian 12 has them all)"
