#!/usr/bin/env bash
# Checks the form of our sources. Usage: scripts/lint.sh [format | fix | layers | tidy [folder or file ...]]
#   format  (default) clang-format agrees with every file; seconds
#   fix     makes it agree
#   layers  no include runs against the order of scripts/layers.txt, and no files of a room include each other in a circle
#   tidy    clang-tidy finds nothing, in the given folders (default: all); minutes a folder
# Exit code 77: the tool is not installed.
set -euo pipefail
cd "$(dirname "$0")/.."

mode=${1:-format}
shift || true

# Version 14, Debian 12's: other versions break lines elsewhere.
find_tool() {
  local name
  for name in "$1-14" "$1"; do
    if command -v "$name" >/dev/null && [[ "$("$name" --version)" == *"version 14."* ]]; then
      echo "$name"
      return
    fi
  done
  echo "skipped: $1 14 is not installed (Debian package $1)" >&2
  exit 77
}

# Our headers and sources below the given folders or files.
sources() {
  find "$@" \( -name '*.h' -o -name '*.cc' \) -type f | sort
}

folders=()
for folder in core eval filter frontend gnss smoother tests; do
  [[ -d "$folder" ]] && folders+=("$folder")
done

case "$mode" in
  format|fix)
    tool=$(find_tool clang-format)
    options=(--dry-run -Werror)
    [[ "$mode" == fix ]] && options=(-i)
    sources "${folders[@]}" | xargs "$tool" "${options[@]}"
    ;;
  layers)
    scripts/check_layers.sh
    ;;
  tidy)
    tool=$(find_tool clang-tidy)
    compiler=$(find_tool clang++)
    # Of its own: with clang's precompiled headers, which halve the time, and no groups, in which the analyzer sees headers alone.
    cmake -S . -B build-tidy -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DALIDADE_UNITY=OFF \
      -DCMAKE_CXX_COMPILER="$compiler" -DALIDADE_CCACHE=OFF >/dev/null
    ninja -C build-tidy -t targets all | sed -n 's/^\(.*cmake_pch.*\.pch\): .*/\1/p' | xargs ninja -C build-tidy >&2
    [[ $# -gt 0 ]] && folders=("$@")
    # Sources that no target of ours compiles, as the drivers of other systems, have no commands.
    sources "${folders[@]}" | grep '\.cc$' | while read -r file; do
      if grep -q "/$file\"" build-tidy/compile_commands.json; then
        echo "$file"
      fi
    done | xargs -P "$(nproc)" -n 1 "$tool" -p build-tidy --quiet --extra-arg=-Wno-unknown-warning-option \
      --extra-arg=-Wno-unused-command-line-argument
    ;;
  *)
    echo "usage: $0 [format | fix | layers | tidy [folder or file ...]]" >&2
    exit 2
    ;;
esac
