# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash disable=SC2034
#
# What the scripts of this folder share. Source it first: it sets strict mode and `root`, the top of the source tree.

set -Eeuo pipefail
shopt -s inherit_errexit
root=$(CDPATH='' cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd -P)
caller_dir=$PWD  # relative paths that the user gives start here

step() { printf '\n== %s\n' "$*"; }
warn() { printf '%s: %s\n' "${0##*/}" "$*" >&2; }

# A failure: one sentence. A wrong command line: the same, exit code 2.
die() {
  trap - ERR
  warn "$*"
  exit 1
}
die_usage() {
  trap - ERR
  warn "$* (try --help)"
  exit 2
}
trap '[[ $BASH_SUBSHELL -gt 0 ]] || warn "stopped: ${BASH_SOURCE[0]##*/}:$LINENO failed"' ERR

# Shows the comment block that follows the licence header of the calling script.
show_help() { awk 'NR > 3 { if (!/^#/) exit; sub(/^# ?/, ""); print }' "$0"; }

# need_value OPTION REMAINING: dies unless a value follows the option.
need_value() { [[ $2 -ge 2 ]] || die_usage "$1 needs a value"; }

# Where a preset of CMakePresets.json builds.
build_dir() {
  case $1 in
    release | ci) printf '%s/build\n' "$root" ;;
    *) printf '%s/build-%s\n' "$root" "$1" ;;
  esac
}

# The sysroot of arm64 that deploy/sysroot.sh makes.
sysroot_dir() { printf '%s\n' "${COSLAM_SYSROOT:-${XDG_CACHE_HOME:-$HOME/.cache}/coslam-arm64}"; }

# The code name of the Debian that this machine runs; empty where it is none.
debian_release() {
  # shellcheck disable=SC1091  # this system's own
  (. /etc/os-release && printf '%s\n' "${VERSION_CODENAME:-}")
}

# Where Debian's packages come from: COSLAM_MIRROR, else what this machine uses.
debian_mirror() {
  local mirror
  mirror=$(cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list /etc/apt/sources.list.d/*.sources 2>/dev/null |
    grep -v '^#' | grep --only-matching -E 'https?://[^ ]+' | head -n 1) || true
  printf '%s\n' "${COSLAM_MIRROR:-${mirror:-http://deb.debian.org/debian}}"
}

# Parallel compilers: one a core, but no more than the free memory feeds (1.5 GiB each).
build_jobs() {
  local jobs free_kib
  jobs=$(nproc)
  free_kib=$(awk '$1 == "MemAvailable:" { print $2 }' /proc/meminfo 2>/dev/null) || free_kib=
  if [[ -n $free_kib && $((free_kib / 1572864)) -lt $jobs ]]; then jobs=$((free_kib / 1572864)); fi
  printf '%d\n' $((jobs > 1 ? jobs : 1))
}

# What CTest may run at a time, in halves of a core: each test says how many it takes (deploy/cmake/CoslamTargets.cmake).
test_shares() { printf '%d\n' $((2 * $(nproc))); }

# True in a git checkout of this tree (false in an unpacked archive).
in_git() { [[ $(git -C "$root" rev-parse --show-toplevel 2>/dev/null) == "$root" ]]; }

# The C++ files of the project, relative to the root, one a line: what git tracks or would track, else what lies there.
source_files() {
  local file
  if in_git; then
    git -C "$root" ls-files --cached --others --exclude-standard -- '*.h' '*.cpp'
  else
    (cd -- "$root" && find agent common server deploy tests docs -type f \( -name '*.h' -o -name '*.cpp' \))
  fi | sort -u | while IFS= read -r file; do
    [[ ! -f $root/$file ]] || printf '%s\n' "$file"  # skip what is deleted but not committed
  done
}
