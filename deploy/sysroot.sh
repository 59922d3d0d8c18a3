#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# deploy/sysroot.sh [--force]
#
# Makes the sysroot that deploy/build.sh --arch arm64 builds against: the libraries of deploy/packages.txt for arm64, of the
# Debian that this machine runs, unpacked into a folder of their own (1.4 GB). The packages of this machine stay as they
# are, and nothing of arm64 is run. Does nothing when the sysroot has what is needed.
#   --force   makes it again
# COSLAM_SYSROOT says where it lies (default: ~/.cache/coslam-arm64), COSLAM_MIRROR where Debian's packages come from.
# shellcheck disable=SC2016  # variables of awk, dpkg and CMake
set -euo pipefail
# shellcheck source-path=SCRIPTDIR source=lib.sh
source "$(dirname -- "${BASH_SOURCE[0]}")/lib.sh"

force=no
while [[ $# -gt 0 ]]; do
  case $1 in
    --force) force=yes ;;
    -h | --help) show_help && exit 0 ;;
    *) die_usage "unknown option '$1'" ;;
  esac
  shift
done

sysroot=$(sysroot_dir)
release=$(debian_release)
# Where releases name a package differently, the newest stands first.
case $release in
  bookworm) newest=0 ;;
  trixie) newest=1 ;;
  *) die "the sysroot is that of this machine's Debian, 12 or 13, and this is neither" ;;
esac
# Libraries and headers of the sets that programs are built and run with.
wanted=$(awk -v newest="$newest" '{ sub(/#.*/, "") } /^\[/ { inside = /^\[(build|speed)\]/; next } inside && $1 ~ /^lib|-dev$/ { print newest ? $1 : $NF }' \
  "$root/deploy/packages.txt" | sort | paste --serial --delimiters=,)
wanted="base-files,$wanted"
note=$sysroot/coslam-packages
if [[ $force == no && -f $note && $(<"$note") == "$release: $wanted" ]]; then
  step "sysroot: all packages are there"
  exit 0
fi
command -v mmdebstrap >/dev/null || die "there is no mmdebstrap: deploy/setup.sh --arm64 installs it"

step "sysroot: Debian $release for arm64, in $sysroot"
mkdir -p -- "$(dirname -- "$sysroot")"
made=$(mktemp -d -- "$sysroot.XXXXXX")
# shellcheck disable=SC2064  # the folder of now
trap "rm -rf --one-file-system -- '$made'" EXIT
mkdir -- "$made/tree"
mmdebstrap --quiet --mode="$([[ $EUID -eq 0 ]] && echo root || echo unshare)" --variant=extract --architectures=arm64 \
  --skip=check/qemu --skip=cleanup/apt/cache --aptopt='APT::Install-Recommends "false"' --include="$wanted" "$release" - \
  "$(debian_mirror)" |
  tar --extract --directory="$made/tree" --no-same-owner --exclude='./dev/*' --exclude='./usr/share/doc' \
    --exclude='./usr/share/locale' --exclude='./usr/share/man' --exclude='./usr/share/icons' --exclude='./usr/lib/llvm*' ||
  die "mmdebstrap could not get the packages: it says why above"

# Links that begin at the top would leave the sysroot.
while IFS= read -r -d '' link; do
  to=$(readlink -- "$link")
  [[ -e $made/tree$to ]] || continue
  ln --symbolic --force --no-dereference --relative -- "$made/tree$to" "$link"
done < <(find "$made/tree" -type l -lname '/*' -print0)

# The BLAS and LAPACK that Debian's own scripts would have chosen.
libraries=$made/tree/usr/lib/aarch64-linux-gnu
for name in libopenblas.so.0 libblas.so.3 liblapack.so.3; do
  [[ -e $libraries/openblas-serial/$name ]] || die "the packages have no $name"
  ln --symbolic --force -- "openblas-serial/$name" "$libraries/$name"
done
ln --symbolic --force -- libblas.so.3 "$libraries/libblas.so"
ln --symbolic --force -- liblapack.so.3 "$libraries/liblapack.so"
# CMake files of packages that name libraries from the top of the file system.
find "$libraries/cmake" "$made/tree/usr/share" -name '*.cmake' -type f -exec \
  sed --in-place --regexp-extended 's:(["; ])/usr(/lib|/include|/share|"):\1${CMAKE_SYSROOT}/usr\2:g' {} +

# What dpkg would have noted, with paths in the sysroot: dpkg-shlibdeps finds in it what packages for arm64 depend on.
notes=$made/tree/var/lib/dpkg
rm -rf -- "$notes"
mkdir -p -- "$notes/info" "$notes/updates"
printf '1\n' >"$notes/info/format"
printf '%s\narm64\n' "$(dpkg --print-architecture)" >"$notes/arch"
for deb in "$made/tree/var/cache/apt/archives/"*.deb; do
  rm -rf -- "$made/control"
  dpkg-deb --control "$deb" "$made/control"
  name=$(dpkg-deb --show --showformat='${Package}' "$deb")
  [[ $(dpkg-deb --show --showformat='${Multi-Arch}' "$deb") != same ]] || name+=:arm64
  name=$notes/info/$name
  { sed '1a Status: install ok installed' "$made/control/control" && printf '\n'; } >>"$notes/status"
  for kind in symbols shlibs; do
    [[ ! -e $made/control/$kind ]] || mv -- "$made/control/$kind" "$name.$kind"
  done
  dpkg-deb --fsys-tarfile "$deb" | tar --list | sed "s:/$::; s:^\.:$sysroot:" >"$name.list"
done
rm -rf -- "$made/tree/var/cache/apt"
printf '%s\n' "$release: $wanted" >"$made/tree/coslam-packages"
chmod 755 -- "$made/tree"
[[ ! -e $sysroot ]] || mv -- "$sysroot" "$made/before"
mv -- "$made/tree" "$sysroot"
