#!/usr/bin/env bash
# Checks that programs of another processor run here, by qemu-user and the kernel's binfmt_misc. If not, says what to do and ends with 1.
#
#   tools/emulator.sh ARCH
#
# ARCH: amd64, arm64 or armhf.
set -euo pipefail

arch=$1
[ "$arch" != "$(dpkg --print-architecture)" ] || exit 0
declare -A names=([amd64]=x86_64 [arm64]=aarch64 [armhf]=arm)
name=qemu-${names[$arch]}
# mmdebstrap asks arch-test.
if ! command -v "$name-static" >/dev/null || ! command -v arch-test >/dev/null; then
  echo "programs for $arch do not run here: apt-get install qemu-user-static binfmt-support arch-test" >&2
  exit 1
fi
if ! grep -qs '^enabled' "/proc/sys/fs/binfmt_misc/$name"; then
  echo "the kernel does not start $name for programs for $arch. Run as root:" >&2
  [ -e /proc/sys/fs/binfmt_misc/status ] || echo "  mount -t binfmt_misc binfmt_misc /proc/sys/fs/binfmt_misc" >&2
  echo "  update-binfmts --enable $name" >&2
  exit 1
fi
