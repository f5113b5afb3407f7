#!/usr/bin/env bash
# Makes a container image (OCI) of the Debian packages in build/packages, without a container engine.
#
#   tools/image.sh [--arch ARCH] [--suite SUITE] [--packages DIR] [--offline] [OUTPUT.tar]
#
# ARCH: amd64, arm64 or armhf; default: that of this machine. Other architectures need no emulator. SUITE: bookworm or trixie, the release
# that the packages were built for; default: that of this machine. --packages: the folder of the packages (tools/package.sh). --offline:
# uses the libraries that the last run downloaded, without looking for updates.
#
# OUTPUT.tar: default build/image/fieldcast_VERSION_ARCH.tar; `docker load`, `podman load` and `skopeo` read it. Prints its sizes and its
# digest. Works as root or with sudo. The time of each file is at most SOURCE_DATE_EPOCH (default: the last commit), so that the same
# packages give the same digest. docs/container.md describes the use of the image.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() { echo "tools/image.sh: $*" >&2; exit 1; }
usage() { sed -n '2,13s/^# \{0,1\}//p' "$0" >&2; exit 2; }
# value OPTION [VALUE ..]: returns the value of an option of this command line.
value() { [ $# -ge 2 ] || fail "$1 needs a value"; echo "$2"; }

tools/install.sh image
arch=$(dpkg --print-architecture)
suite=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
packages=build/packages offline=no output=""
while [ $# -gt 0 ]; do
  case "$1" in
    --arch) arch=$(value "$@"); shift ;;
    --suite) suite=$(value "$@"); shift ;;
    --packages) packages=$(value "$@"); shift ;;
    --offline) offline=yes ;;
    -*) usage ;;
    *) output=$1 ;;
  esac
  shift
done
case "$arch" in amd64|arm64|armhf) ;; *) fail "'$arch' is not supported; allowed: amd64, arm64, armhf" ;; esac
case "$suite" in bookworm|trixie) ;; *) fail "'$suite' is not supported; allowed: bookworm, trixie" ;; esac

programs=()
for name in fieldcast fieldcast-sim; do
  found=("$packages/${name}"_*_"$arch".deb)
  [ -f "${found[0]}" ] || fail "$packages has no package $name for $arch: run tools/package.sh first"
  [ "${#found[@]}" -eq 1 ] || fail "$packages has several packages $name for $arch; delete the old ones: ${found[*]}"
  programs+=("${found[0]}")
done
version=$(dpkg-deb -f "${programs[0]}" Version)
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git -c safe.directory="$PWD" log -1 --format=%ct)}
export SOURCE_DATE_EPOCH
mkdir -p build/image
output=${output:-build/image/fieldcast_${version}_$arch.tar}
libraries=build/image/libraries-$suite-$arch.tar

# The libraries that the packages depend on, and those these need. adduser is for the installation of a package only.
depends() { for deb in "${programs[@]}"; do dpkg-deb -f "$deb" Depends; done | tr ',' '\n' | sed 's/(.*//; s/[[:space:]]//g' | grep -vx adduser | sort -u; }

# Debian's archives of this machine: its package sources name the first one, and the one for security updates.
archive_of() {
  (cat /etc/apt/sources.list /etc/apt/sources.list.d/*.sources /etc/apt/sources.list.d/*.list 2>/dev/null || true) |
    sed -nE "s#^(URIs:|deb( \[[^]]*\])?) +(https?://[^ ]*/$1/?)( .*)?\$#\3#p" | head -1
}

if [ "$offline" = yes ]; then
  [ -f "$libraries" ] || fail "--offline: $libraries is missing; run once without --offline"
  depends | cmp -s - "$libraries.depends" || fail "--offline: the packages depend on other libraries than those of $libraries; run once without --offline"
else
  archive=$(archive_of debian)
  security=$(archive_of debian-security)
  [ -n "$archive" ] || fail "this machine's package sources name no archive of Debian"
  sources="deb $archive $suite main"$'\n'"deb $archive $suite-updates main"
  [ -z "$security" ] || sources+=$'\n'"deb $security $suite-security main"
  as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || fail "run it as root, or install sudo"
    as_root=(sudo SOURCE_DATE_EPOCH="$SOURCE_DATE_EPOCH")
  fi
  log=$(mktemp)
  trap 'rm -f "$log"' EXIT
  # `extract` unpacks the packages and runs none of their programs. The files in status.d list the packages for scanners.
  # shellcheck disable=SC2016
  "${as_root[@]}" mmdebstrap --variant=extract --architectures="$arch" --include="base-files ncurses-base $(depends | tr '\n' ' ')" \
    --setup-hook='for name in bin lib lib64 sbin; do mkdir -p "$1/usr/$name" && ln -s "usr/$name" "$1/$name"; done' \
    --extract-hook='mkdir "$1/var/lib/dpkg/status.d" && cd "$1/var/cache/apt/archives" &&
      for deb in *.deb; do dpkg-deb -f "$deb" >"$1/var/lib/dpkg/status.d/${deb%%_*}"; done' \
    "$suite" "$libraries.new.tar" - <<<"$sources" >"$log" 2>&1 || { cat "$log" >&2; fail "mmdebstrap failed, see above"; }
  mv "$libraries.new.tar" "$libraries"
  depends >"$libraries.depends"
fi

tools/packaging/oci_image.py "$arch" "$version" "$libraries" "$output" "${programs[@]}"
