#!/usr/bin/env bash
# Shows that the packages can be made again: builds the committed sources twice, from nothing and without ccache, in two folders, with
# other numbers of jobs, umask, time zone and language, and compares program, archives and .deb files byte by byte. Then reads from them
# how they were hardened, and looks for the names of the folders in them. Takes twice a clean build (docs/architecture.md, "Compile time").
# Exit code 1: something differs, is not hardened or names a folder.
# Usage: scripts/packaging/reproducible.sh [TARGET ..., default all of the package; then no .deb is made]
# Environment: WORK keeps the folders there; SOURCE_DATE_EPOCH, default the time of the last commit.
set -euo pipefail
cd "$(dirname "$0")/../.."

targets=("$@")
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)}
export SOURCE_DATE_EPOCH
work=${WORK:-}
if [[ -z $work ]]; then
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
fi

# build FOLDER JOBS
build() {
  mkdir -p "$1/build"
  git archive HEAD | tar --extract --directory="$1"
  cmake -S "$1" -B "$1/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DALIDADE_DISTRIBUTE=ON -DALIDADE_BUILD_TESTS=OFF \
    -DALIDADE_CCACHE=OFF >"$1/cmake.txt" 2>&1
  ninja -C "$1/build" -j "$2" "${targets[@]}" >"$1/ninja.txt"
  [[ ${#targets[@]} -gt 0 ]] || (cd "$1/build" && cpack >cpack.txt)
}
one=$work/one another=$work/another/folder_of_another_length
(umask 022 && TZ=UTC LC_ALL=C build "$one" "${JOBS:-2}")
(umask 027 && TZ=Asia/Tokyo LC_ALL=C.UTF-8 build "$another" 1)

code=0
results=$(cd "$one/build" && find . \( -name 'alidade' -type f -perm -100 -o -name 'lib*.a' -o -name '*.deb' \) -not -path './_CPack*' | sort)
equal=0 count=0
for file in $results; do
  count=$((count + 1))
  if cmp -s "$one/build/$file" "$another/build/$file"; then
    equal=$((equal + 1))
  else
    echo "$file differs"
    code=1
  fi
  if grep -q --binary-files=text "$work" "$one/build/$file"; then
    echo "$file names the folder of its build"
    code=1
  fi
done
echo "$equal of $count files are equal: $(grep -c '\.a$' <<<"$results" || true) archives, $(grep -c '\.deb$' <<<"$results" || true) packages"
if [[ -f $one/build/alidade ]]; then
  mapfile -t archives < <(find "$one/build" -name 'libalidade_*.a' -not -path '*/_CPack*' | sort)
  scripts/packaging/hardening.sh "$one/build/alidade" "${archives[@]}" || code=1
  sha256sum "$one/build/alidade" "$one"/build/*.deb | sed "s|$one/build/||"
fi
exit "$code"
