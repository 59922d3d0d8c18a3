# SPDX-FileCopyrightText: 2026 The CoSLAM authors
# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
#
# Clean Debian systems in folders, in which packages and the source are tried. Source it after lib.sh; needs root, and
# mmdebstrap (deploy/setup.sh --package).

# A system of another processor runs in QEMU's user mode; the kernel is told so once. COSLAM_QEMU is the emulator, where it
# is not the system's.
let_run() {
  local arch=$1 emulators=/proc/sys/fs/binfmt_misc emulator version
  [[ $arch != "$(dpkg --print-architecture)" ]] || return 0
  [[ $arch == arm64 ]] || die "systems of $arch cannot be run here"
  [[ -e $emulators/register ]] || mount -t binfmt_misc none "$emulators" || die "this kernel runs no programs of other processors"
  [[ ! -e $emulators/coslam-arm64 ]] || return 0
  emulator=${COSLAM_QEMU:-$(command -v qemu-aarch64-static || command -v qemu-aarch64)} || die "there is no QEMU: deploy/setup.sh --arm64 installs it"
  version=$("$emulator" --version | grep -oE 'version [0-9]+' | head -n 1)
  [[ ${version#version } -ge 10 ]] ||
    die "$emulator is of ${version:-an unknown version}: QEMU 7 does not choose the interface of multicasts, which DDS asks for, 10 does; COSLAM_QEMU names another"
  # An ELF program for arm64.
  printf ':coslam-arm64:M::%s:%s:%s:F' '\x7fELF\x02\x01\x01\x00\x00\x00\x00\x00\x00\x00\x00\x00\x02\x00\xb7\x00' \
    '\xff\xff\xff\xff\xff\xff\xff\x00\xff\xff\xff\xff\xff\xff\xff\xff\xfe\xff\xff\xff' "$emulator" >"$emulators/register" ||
    die "$emulator cannot be registered"
}

# fresh_system RELEASE ARCH DIR: a Debian that has what every Debian has, and no more. The first of its kind is kept in
# COSLAM_SYSTEMS (~/.cache/coslam-systems), as an archive.
fresh_system() {
  local release=$1 arch=$2 to=$3 kept
  kept=${COSLAM_SYSTEMS:-${XDG_CACHE_HOME:-$HOME/.cache}/coslam-systems}/$release-$arch.tar
  [[ $EUID -eq 0 ]] || die "a system of its own needs root"
  let_run "$arch"
  if [[ ! -e $kept ]]; then
    mkdir -p -- "$(dirname -- "$kept")"
    mmdebstrap --quiet --variant=minbase --architectures="$arch" "$release" "$kept.new.tar" "$(debian_mirror)" || die "mmdebstrap could not make Debian $release for $arch"
    mv -- "$kept.new.tar" "$kept"
  fi
  mkdir -p -- "$to"
  tar --extract --file="$kept" --directory="$to" --exclude='./dev/*'
  cp --remove-destination /etc/resolv.conf "$to/etc/" 2>/dev/null || true
}

# in_system DIR COMMAND: a shell command as root there. Whatever it started has ended when this returns. COSLAM_HOST names
# the network namespace in which it runs, as on a machine of its own.
in_system() {
  # shellcheck disable=SC2016  # the inner shell's own
  ${COSLAM_HOST:+ip netns exec "$COSLAM_HOST"} unshare --mount --pid --fork --kill-child bash -c '
    set -e
    mount -t proc proc "$0/proc"
    mount --rbind /dev "$0/dev"
    mount --rbind /sys "$0/sys"
    mount -t tmpfs tmpfs "$0/dev/shm"
    exec chroot "$0" /usr/bin/env -i HOME=/root TERM=dumb LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive \
      PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin bash -c "$1"' "$1" "$2"
}

# Megabytes that a system takes, without what apt keeps.
system_mb() {
  du --summarize --one-file-system --block-size=1MB --exclude=var/cache --exclude=var/lib/apt --exclude=root -- "$1" | cut -f 1
}
