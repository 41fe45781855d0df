#!/usr/bin/env bash
# Writes what a built program is made of as an SPDX 2.3 document (JSON) on stdout: the Debian packages whose libraries the loader
# finds for it, and the header-only packages that are compiled into it, each with version, source and licence of its package.
# DEPENDS_ON: linked by the program itself; the others are linked by these (DEPENDENCY_OF is left to their own packages).
# Nothing in it depends on the time or the place: the date is SOURCE_DATE_EPOCH (default: that of the last commit, else 1970).
# Usage: scripts/packaging/sbom.sh [PROGRAM, default build/alidade] > alidade.spdx.json
# Exit code 77: not a Debian system.
set -euo pipefail
export LC_ALL=C
cd "$(dirname "$0")/../.."

program=${1:-build/alidade}
for tool in dpkg-query ldd readelf sha256sum; do
  command -v "$tool" >/dev/null || { echo "skipped: $tool is not installed" >&2; exit 77; }
done
[[ -x $program ]] || { echo "sbom.sh: $program: not a program" >&2; exit 2; }

headers=(libeigen3-dev libboost-dev libboost-math-dev nlohmann-json3-dev libjs-d3)
version=$(sed -n 's/^project(alidade VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
epoch=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || echo 0)}
checksum=$(sha256sum "$program" | cut -d ' ' -f 1)

# Package that a library file belongs to: by its path, or by that without the link of /lib to /usr/lib.
package_of() {
  local file
  for file in "$1" "$(readlink -f "$1")" "${1#/usr}" "/usr$1"; do
    dpkg-query -S "$file" 2>/dev/null | head -n 1 | sed 's/:.*//' | grep . && return
  done
  echo "sbom.sh: $1 belongs to no package" >&2
  return 1
}

# SPDX identifier of a short name of Debian's copyright format; NOASSERTION for others.
spdx() {
  case "$1" in
    Expat | MIT) echo MIT ;;
    X11) echo X11 ;;
    Apache-2 | Apache-2.0) echo Apache-2.0 ;;
    BSD-3-[Cc]lause) echo BSD-3-Clause ;;
    BSD-2-[Cc]lause) echo BSD-2-Clause ;;
    BSL-1.0 | BSL-1 | Boost-1.0) echo BSL-1.0 ;;
    MPL-2.0 | MPL-2) echo MPL-2.0 ;;
    Zlib | zlib) echo Zlib ;;
    ISC) echo ISC ;;
    curl) echo curl ;;
    LGPL-2 | LGPL-2.0) echo LGPL-2.0-only ;;
    LGPL-2+ | LGPL-2.0+) echo LGPL-2.0-or-later ;;
    LGPL-2.1) echo LGPL-2.1-only ;;
    LGPL-2.1+) echo LGPL-2.1-or-later ;;
    LGPL-3 | LGPL-3.0) echo LGPL-3.0-only ;;
    LGPL-3+ | LGPL-3.0+) echo LGPL-3.0-or-later ;;
    GPL-2 | GPL-2.0) echo GPL-2.0-only ;;
    GPL-2+ | GPL-2.0+) echo GPL-2.0-or-later ;;
    GPL-3 | GPL-3.0) echo GPL-3.0-only ;;
    GPL-3+ | GPL-3.0+) echo GPL-3.0-or-later ;;
    "Apache-2.0 AND BSD-3-Clause") echo "Apache-2.0 AND BSD-3-Clause" ;;
    *) echo NOASSERTION ;;
  esac
}

# Licence that a package states for its files as a whole; the page docs/packaging.md has those of the parts in use.
licence_of() {
  local file=/usr/share/doc/$1/copyright
  [[ -r $file ]] || { echo NOASSERTION; return; }
  spdx "$(awk '/^Files: \*[ \t]*$/ {all = 1; next} all && /^License:/ {sub(/^License:[ \t]*/, ""); sub(/[ \t]+$/, ""); print; exit}' "$file")"
}

escape() { sed 's/\\/\\\\/g; s/"/\\"/g' <<<"$1"; }

declare -A direct=()
while read -r name; do
  direct[$name]=1
done < <(readelf -d "$program" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p')

declare -A linked=() # package -> DEPENDS_ON where the program names a library of it
while read -r name path; do
  package=$(package_of "$path")
  [[ ${linked[$package]:-} == DEPENDS_ON || -n ${direct[$name]:-} ]] && linked[$package]=DEPENDS_ON || linked[$package]=indirect
done < <(ldd "$program" | sed -n 's/^[ \t]*\([^ ]*\) => \(\/[^ ]*\) .*/\1 \2/p')
for package in "${headers[@]}"; do
  dpkg-query -W "$package" >/dev/null 2>&1 && linked[$package]=CONTAINS
done
mapfile -t packages < <(printf '%s\n' "${!linked[@]}" | sort)

cat <<HEAD
{
  "spdxVersion": "SPDX-2.3",
  "dataLicense": "CC0-1.0",
  "SPDXID": "SPDXRef-DOCUMENT",
  "name": "alidade-$version",
  "documentNamespace": "urn:alidade:$version:$checksum",
  "creationInfo": {"created": "$(date -u -d "@$epoch" +%Y-%m-%dT%H:%M:%SZ)", "creators": ["Tool: sbom.sh"]},
  "packages": [
    {"SPDXID": "SPDXRef-alidade", "name": "alidade", "versionInfo": "$version", "downloadLocation": "NOASSERTION",
     "filesAnalyzed": false, "licenseConcluded": "NOASSERTION", "licenseDeclared": "BSD-3-Clause",
     "copyrightText": "NOASSERTION", "checksums": [{"algorithm": "SHA256", "checksumValue": "$checksum"}]}
HEAD
for package in "${packages[@]}"; do
  # shellcheck disable=SC2016  # fields of dpkg-query
  IFS=$'\t' read -r number source architecture < <(dpkg-query -W -f '${Version}\t${source:Package}\t${Architecture}\n' "$package" | head -n 1)
  printf '    ,{"SPDXID": "SPDXRef-%s", "name": "%s", "versionInfo": "%s", "downloadLocation": "NOASSERTION", "filesAnalyzed": false,\n' \
    "${package//[^A-Za-z0-9.-]/-}" "$package" "$(escape "$number")"
  printf '     "sourceInfo": "Debian source package %s", "licenseConcluded": "NOASSERTION", "licenseDeclared": "%s",\n' \
    "$source" "$(licence_of "$package")"
  printf '     "licenseComments": "/usr/share/doc/%s/copyright", "copyrightText": "NOASSERTION",\n' "$package"
  printf '     "externalRefs": [{"referenceCategory": "PACKAGE-MANAGER", "referenceType": "purl",\n'
  printf '       "referenceLocator": "pkg:deb/debian/%s@%s?arch=%s"}]}\n' "$package" "$(sed 's/+/%2B/g; s/:/%3A/g' <<<"$number")" "$architecture"
done
echo '  ],'
echo '  "relationships": ['
echo '    {"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": "SPDXRef-alidade"}'
for package in "${packages[@]}"; do
  [[ ${linked[$package]} == indirect ]] && continue
  printf '    ,{"spdxElementId": "SPDXRef-alidade", "relationshipType": "%s", "relatedSpdxElement": "SPDXRef-%s"}\n' \
    "${linked[$package]}" "${package//[^A-Za-z0-9.-]/-}"
done
echo '  ]'
echo '}'
