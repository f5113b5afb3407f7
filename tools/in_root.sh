#!/usr/bin/env bash
# Runs a command in a Debian of its own, in a copy of this tree, and makes that Debian if it is missing.
#
#   tools/in_root.sh SUITE [ARCH] [--] COMMAND...
#
# SUITE: bookworm (Debian 12) or trixie (Debian 13). ARCH: amd64, arm64 or armhf; default: that of this machine; others need
# qemu-user-static. COMMAND runs as root of that Debian in /fieldcast, a copy of what git tracks here; its build folder stays there
# until the next run, so that a second build is short. Packages come from the servers that this machine uses.
#
# Roots are kept in $FIELDCAST_ROOTS (default: ~/.cache/fieldcast/roots); delete the folder of one to make it again. Needs root or sudo,
# mmdebstrap and rsync. Processes of the command end with it; it sees no process and no shared memory of this machine, but its network.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() { echo "tools/in_root.sh: $*" >&2; exit 1; }
usage() { sed -n '2,11s/^# \{0,1\}//p' "$0" >&2; exit 2; }

[ $# -ge 2 ] || usage
suite=$1; shift
case "$suite" in bookworm|trixie) ;; *) fail "'$suite' is no suite; allowed: bookworm, trixie" ;; esac
here=$(dpkg --print-architecture)
arch=$here
case "$1" in amd64|arm64|armhf) arch=$1; shift ;; esac
[ "${1:-}" != -- ] || shift
[ $# -gt 0 ] || usage

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || fail "run it as root, or install sudo"
  as_root=(sudo)
fi
for program in mmdebstrap rsync; do
  command -v "$program" >/dev/null || fail "$program is missing: apt-get install $program"
done
tools/emulator.sh "$arch" || fail "no root for $arch, see above"

root=${FIELDCAST_ROOTS:-${XDG_CACHE_HOME:-$HOME/.cache}/fieldcast/roots}/$suite-$arch
# Debian's archive of this machine: the first address in its package sources whose suites are Debian's own releases.
archive=$( (cat /etc/apt/sources.list /etc/apt/sources.list.d/*.sources /etc/apt/sources.list.d/*.list 2>/dev/null || true) |
  sed -nE 's#^(URIs:|deb( \[[^]]*\])?) +(https?://[^ ]*/debian/?)( .*)?$#\3#p' | head -1)
[ -n "$archive" ] || fail "this machine's package sources name no archive of Debian"

if [ ! -f "$root/etc/fieldcast-root" ]; then
  echo "tools/in_root.sh: making $suite for $arch, about a minute" >&2
  "${as_root[@]}" rm -rf "$root"
  mkdir -p "$(dirname "$root")"
  log=$(mktemp)
  "${as_root[@]}" mmdebstrap --quiet --variant=minbase --architectures="$arch" "$suite" "$root" "$archive" >"$log" 2>&1 ||
    { cat "$log" >&2; rm -f "$log"; fail "mmdebstrap failed, see above"; }
  rm -f "$log"
  # Without a flush for each file: a root that was interrupted is made again.
  "${as_root[@]}" sh -c "echo force-unsafe-io >'$root/etc/dpkg/dpkg.cfg.d/fieldcast'"
  "${as_root[@]}" touch "$root/etc/fieldcast-root"
fi

# What git tracks, as it is in the working tree. Unchanged files keep their times, so that ninja builds only what changed; of the rest, only what
# a build made stays.
copy=$root/fieldcast
"${as_root[@]}" mkdir -p "$copy"
list=$(mktemp)
trap 'rm -f "$list"' EXIT
git -c safe.directory="$PWD" ls-files | while IFS= read -r file; do [ ! -e "$file" ] || echo "$file"; done | LC_ALL=C sort >"$list"
[ ! -f "$copy/.tracked" ] || LC_ALL=C comm -13 "$list" "$copy/.tracked" | (cd "$copy" && "${as_root[@]}" xargs -r -d '\n' rm -f --)
"${as_root[@]}" rsync -rlp --checksum --files-from="$list" ./ "$copy/"
"${as_root[@]}" cp "$list" "$copy/.tracked"
rm -f "$list"

# Own mounts, processes and shared memory. The network is that of this machine, because apt needs it.
exec "${as_root[@]}" unshare --mount --pid --ipc --fork --kill-child --propagation private sh -c '
  root=$1; shift
  mount --bind "$root" "$root"  # ip netns needs a mount point at /
  mount -t proc proc "$root/proc"
  mount --rbind /sys "$root/sys"
  mount -t tmpfs tmpfs "$root/tmp"
  mount -t tmpfs -o mode=755 tmpfs "$root/dev"
  for node in null zero full random urandom tty; do
    : >"$root/dev/$node" && mount --bind "/dev/$node" "$root/dev/$node"
  done
  mkdir -p "$root/dev/pts" "$root/dev/shm"
  mount -t devpts -o newinstance,ptmxmode=0666,mode=620 devpts "$root/dev/pts"
  ln -s pts/ptmx "$root/dev/ptmx"; ln -s /proc/self/fd "$root/dev/fd"
  ln -s /proc/self/fd/0 "$root/dev/stdin"; ln -s /proc/self/fd/1 "$root/dev/stdout"; ln -s /proc/self/fd/2 "$root/dev/stderr"
  mount -t tmpfs tmpfs "$root/dev/shm"
  [ ! -e /etc/resolv.conf ] || cp -L /etc/resolv.conf "$root/etc/resolv.conf"
  # npm trusts the authorities of this machine, for example that of a proxy.
  [ ! -e /etc/ssl/certs/ca-certificates.crt ] || cp -L /etc/ssl/certs/ca-certificates.crt "$root/etc/fieldcast-authorities.crt"
  exec chroot "$root" /usr/bin/env -i HOME=/root NODE_EXTRA_CA_CERTS=/etc/fieldcast-authorities.crt PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin LANG=C.UTF-8 \
    TERM="${TERM:-dumb}" sh -c "cd /fieldcast && exec \"\$@\"" sh "$@"' sh "$root" "$@"
