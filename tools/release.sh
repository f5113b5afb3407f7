#!/usr/bin/env bash
# Makes the files of a release in build/release/VERSION: source archive, Debian packages, notes, checksums.
#
#   tools/release.sh [--twice]
#
# Builds the last commit, not the working tree, and without compiler cache, whose settings may change the paths in objects. --twice:
# builds a second time and fails if a byte differs.
# The time of the commit is the time in every file, so that the same commit gives the same bytes.
set -euo pipefail
cd "$(dirname "$0")/.."

fail() { echo "tools/release.sh: $*" >&2; exit 1; }
twice=no
case "${1:-}" in
  "") ;;
  --twice) twice=yes ;;
  *) fail "unknown option $1; usage: tools/release.sh [--twice]" ;;
esac

git() { command git -c safe.directory="$PWD" "$@"; }
version=$(sed -n 's/^project(fieldcast VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
[ -n "$version" ] || fail "CMakeLists.txt has no line 'project(fieldcast VERSION ...'"
notes=$(git show HEAD:CHANGELOG.md | awk -v head="## $version " 'index($0, head) == 1 { on = 1; next } /^## / { on = 0 } on')
[ -n "$notes" ] || fail "CHANGELOG.md has no section '## $version'; write what changes for users"
head -1 tools/packaging/debian/changelog | grep -qF "($version" || fail "tools/packaging/debian/changelog does not begin with version $version"
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct HEAD)
export SOURCE_DATE_EPOCH TZ=UTC LC_ALL=C.UTF-8 CCACHE_DISABLE=1

release=$PWD/build/release/$version
rm -rf "$release"
mkdir -p "$release"
git archive --format=tar --prefix="fieldcast-$version/" HEAD | gzip -9n >"$release/fieldcast-$version.tar.gz"
printf '# Fieldcast %s\n%s\n' "$version" "$notes" >"$release/NOTES.md"

# Each build has its own source folder, so that the comparison finds paths of the folder in programs.
packages_of() {  # packages_of FOLDER: builds the packages from the archive
  source=$PWD/build/release/source-of-$(basename "$1")
  rm -rf "$source"
  mkdir -p "$source" "$1"
  tar -xzf "$release/fieldcast-$version.tar.gz" -C "$source" --strip-components=1
  (cd "$source" && tools/package.sh >&2)
  cp "$source"/build/packages/*.deb "$1"
  rm -rf "$source"
}

packages_of "$release"
if [ "$twice" = yes ]; then
  second=$PWD/build/release/second
  rm -rf "$second"
  packages_of "$second"
  for package in "$second"/*.deb; do
    cmp "$package" "$release/$(basename "$package")" || fail "$(basename "$package") of the second build differs; both are kept in build/release"
  done
  rm -rf "$second"
  echo "two builds gave the same bytes" >&2
fi
(cd "$release" && sha256sum -- *.deb *.tar.gz *.md >SHA256SUMS)
ls -l "$release"
