#!/usr/bin/env bash
# Makes a signed apt repository in FOLDER, for a web server or a USB stick.
#
#   tools/repository.sh FOLDER [--suite NAME] [--key ID] [PACKAGE.deb ..]
#
# Adds the packages (default: build/packages/*.deb) to those that FOLDER already has. --suite: name of the Debian release for which
# they were built; default: that of this machine. --key: signing key in gpg's keyring; default: the key "Fieldcast packages", which is
# made without a passphrase if it is missing. FOLDER/fieldcast.asc is the public key. docs/operating.md describes the use.
set -euo pipefail

fail() { echo "tools/repository.sh: $*" >&2; exit 1; }
folder="" key="Fieldcast packages" packages=()
suite=$(sed -n 's/^VERSION_CODENAME=//p' /etc/os-release)
while [ $# -gt 0 ]; do
  case "$1" in
    --suite) suite=${2:?}; shift 2 ;;
    --key) key=${2:?}; shift 2 ;;
    -*) sed -n '2,9s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
    *.deb) packages+=("$1"); shift ;;
    *) folder=$1; shift ;;
  esac
done
[ -n "$folder" ] || fail "name the folder of the repository"
[[ "$suite" =~ ^[a-z]+$ ]] || fail "'$suite' is not the name of a suite; expected for example bookworm"
[ "${#packages[@]}" -gt 0 ] || packages=("$(dirname "$0")"/../build/packages/*.deb)
[ -f "${packages[0]}" ] || fail "there is no ${packages[0]}; build the packages with tools/package.sh"
for program in dpkg-scanpackages gpg; do
  command -v "$program" >/dev/null || fail "$program is missing: apt-get install dpkg-dev gpg"
done

if ! gpg --batch --quiet --list-secret-keys "$key" >/dev/null 2>&1; then
  [ "$key" = "Fieldcast packages" ] || fail "gpg has no secret key '$key'"
  gpg --batch --quiet --passphrase "" --quick-generate-key "$key" ed25519 sign never
  echo "tools/repository.sh: made the signing key '$key' in gpg's keyring; keep a copy: gpg --export-secret-keys --armor" >&2
fi

mkdir -p "$folder/pool/$suite"
cp "${packages[@]}" "$folder/pool/$suite"
cd "$folder"
gpg --batch --quiet --armor --export "$key" >fieldcast.asc

# The new index replaces the old one when it is complete, because apt may read the repository meanwhile.
index=dists/$suite
rm -rf "$index.new"
mapfile -t architectures < <(for file in "pool/$suite"/*.deb; do dpkg-deb -f "$file" Architecture; done | sort -u | grep -vx all)
for architecture in "${architectures[@]}"; do
  list=$index.new/main/binary-$architecture/Packages
  mkdir -p "$(dirname "$list")"
  dpkg-scanpackages --multiversion --arch "$architecture" "pool/$suite" >"$list" 2>"$list.log" || { cat "$list.log" >&2; exit 1; }
  rm "$list.log"
  gzip -9nk "$list"
done
(
  cd "$index.new"
  printf '%s\n' "Origin: Fieldcast" "Label: Fieldcast" "Suite: $suite" "Codename: $suite" "Date: $(LC_ALL=C date -u '+%a, %d %b %Y %H:%M:%S UTC')" \
    "Architectures: ${architectures[*]}" "Components: main" "SHA256:" >Release
  for list in main/*/*; do
    printf ' %s %s %s\n' "$(sha256sum "$list" | cut -d' ' -f1)" "$(stat -c %s "$list")" "$list" >>Release
  done
  gpg --batch --quiet --yes --local-user "$key" --clearsign --output InRelease Release
  gpg --batch --quiet --yes --local-user "$key" --armor --detach-sign --output Release.gpg Release
)
rm -rf "$index"
mv "$index.new" "$index"
fingerprint=$(gpg --batch --quiet --list-keys --with-colons "$key" | awk -F: '$10 ~ /^[0-9A-F]+$/ { print $10; exit }')
echo "$PWD: $suite for ${architectures[*]}, $(grep -c '^Package:' "$index/main/binary-${architectures[0]}/Packages") packages, key $fingerprint"
