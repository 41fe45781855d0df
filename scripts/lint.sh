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
for folder in core docs eval filter frontend gnss smoother tests; do
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
    # In two passes, because most of the time goes into matching the declarations of other libraries' headers, once a translation unit:
    # the analyzer over single sources, as it looks at functions of the main file alone; all other checks over the groups of the build.
    # Clang's precompiled headers halve the time of both.
    [[ $# -gt 0 ]] && folders=("$@")
    mapfile -t wanted < <(sources "${folders[@]}" | grep '\.cc$')
    analyzer=$(sed -n 's/^ *\(-\{0,1\}clang-analyzer-.*\),$/\1/p' .clang-tidy | paste -sd,)
    tidy_pass() {  # name, unity, checks
      local build=build-tidy-$1
      cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DALIDADE_UNITY="$2" \
        -DCMAKE_CXX_COMPILER="$compiler" -DALIDADE_CCACHE=OFF >/dev/null
      ninja -C "$build" -t targets all | sed -n 's/^\(.*cmake_pch.*\.pch\): .*/\1/p' | xargs ninja -C "$build" >&2
      # Sources that the build makes are part of its groups.
      ninja -C "$build" -t targets all | sed -n 's/^\([^/].*\.cc\): CUSTOM_COMMAND$/\1/p' | xargs -r ninja -C "$build" >&2
      # Sources that no target of ours compiles, as the drivers of other systems, have no commands.
      translation_units "$build" | xargs -r -P "$(nproc)" -n 1 scripts/tidy_unit.sh "$tool" "$build" "$3"
    }
    # The translation units of a build that hold wanted sources.
    translation_units() {
      local unit file
      sed -n 's/^ *"file": "\(.*\)".*/\1/p' "$1/compile_commands.json" | sort -u | while read -r unit; do
        for file in "${wanted[@]}"; do
          if [[ "$unit" == "$PWD/$file" ]] || { [[ "$unit" == */Unity/* ]] && grep -q "/$file\"" "$unit"; }; then
            echo "$unit"
            break
          fi
        done
      done
    }
    clean=0
    tidy_pass sources OFF "-*,bugprone-suspicious-include,$analyzer" || clean=1
    tidy_pass groups ON "-clang-analyzer-*,-bugprone-suspicious-include" || clean=1
    exit "$clean"
    ;;
  *)
    echo "usage: $0 [format | fix | layers | tidy [folder or file ...]]" >&2
    exit 2
    ;;
esac
