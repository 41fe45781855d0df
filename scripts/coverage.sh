#!/usr/bin/env bash
# Line coverage of every reader of files: gnss/formats and the rooms of eval that read, by their own tests (Clang's source-based coverage).
# Only these rooms are compiled again, with Clang; tests and all other libraries are those of the release build, which is brought up to
# date first. Prints a table, worst file first. Exit code 1: a file is below LEAST; 77: clang++-14, llvm-cov-14 or llvm-profdata-14 is
# missing (Debian packages clang-14 and llvm-14). The report of uncovered lines: build/coverage/lines.txt.
# Usage: scripts/coverage.sh [LEAST, percent, default 85]
set -euo pipefail
cd "$(dirname "$0")/.."

least=${1:-85}
for tool in clang++-14 llvm-cov-14 llvm-profdata-14; do
  command -v "$tool" >/dev/null || { echo "skipped: $tool is not installed (Debian packages clang-14 and llvm-14)"; exit 77; }
done
rooms=(gnss/formats eval/files eval/config eval/dataset eval/rosbag eval/bag eval/trajectory)
programs=(alidade_gnss_tests alidade_eval_files_tests alidade_eval_config_tests alidade_eval_dataset_tests alidade_eval_rosbag_tests
  alidade_eval_bag_tests alidade_eval_trajectory_tests alidade_eval_metrics_tests alidade_eval_compare_tests)
# Rooms write and hold as well; these files do nothing else.
not_readers='writer|export|output_file|escape_html|time_left|digest|hash|config_json|folder_lock|spool_file|csv_text|png_image|/ephemeris'

jobs=${JOBS:-$(nproc)}
[[ -f build/build.ninja ]] || cmake --preset release >&2
ninja -C build -j "$jobs" "${programs[@]}" >&2
source=$PWD
out=$source/build/coverage
mkdir -p "$out"
cd build

# The sources of a room as CMake groups them, compiled with its include paths and definitions.
for room in "${rooms[@]}"; do
  target=alidade_${room/\//_}
  for object in $(ninja -t query "$room/lib$target.a" | grep -o "$room/CMakeFiles/[^ ]*\.o$"); do
    command=$(ninja -t commands "$object" | grep -e " -o $object ")
    words=$(grep -oE -e '(-isystem |-I|-D)[^ ]+' <<<"$command" | grep -v NDEBUG | tr '\n' ' ')
    echo "$out/${target}_$(basename "$object") $words ${command##* -c }"
  done
done >"$out/sources.txt"

# compile OBJECT WORD ... SOURCE: unless it is newer than all that it was made of.
compile() {
  local object=$1
  shift
  if [[ -f $object.d ]] && ! tr ' \\' '\n\n' <"$object.d" | grep / | grep -v ':$' | xargs sh -c 'find "$@" -newer "$0"' "$object" 2>&1 | grep -q .; then
    return
  fi
  eval "clang++-14 -std=c++20 -O1 -DNDEBUG -fprofile-instr-generate -fcoverage-mapping -MMD -MF '$object.d' $* -c -o '$object'"
}
export -f compile
rm -f "$out"/*.profraw
xargs -P "$jobs" -I{} bash -c 'compile {}' <"$out/sources.txt"

# The program's own link command, with these objects instead of the rooms' archives.
binaries=()
for program in "${programs[@]}"; do
  link=$(ninja -t commands "$program" | tail -1)
  objects=
  for room in "${rooms[@]}"; do
    archive=$room/libalidade_${room/\//_}.a
    [[ $link == *" $archive"* ]] && objects+=" $out/alidade_${room/\//_}_*.o"
    link=${link//"$archive"/}
  done
  link=$(sed -E "s|^: && [^ ]+|: \\&\\& clang++-14 -fprofile-instr-generate|" <<<"$link")
  link=${link/-o $program /-o $out/$program $objects }
  eval "$link"
  LLVM_PROFILE_FILE=$out/$program.profraw "$out/$program" --gtest_brief=1 >&2
  binaries+=("-object=$out/$program")
done

llvm-profdata-14 merge -o "$out/all.profdata" "$out"/*.profraw
report() { llvm-cov-14 "$@" -instr-profile="$out/all.profdata" "${binaries[0]#-object=}" "${binaries[@]:1}" "${rooms[@]/#/$source/}"; }
report show -format=text >"$out/lines.txt"
# Columns of `report`: file, regions x3, functions x3, lines, missed, cover, branches x3.
report report | awk -v least="$least" -v skip="$not_readers" '
  $1 ~ /\.(cc|h)$/ && $8 > 0 && $1 !~ skip { print $1, $8, $9, 100 * (1 - $9 / $8) }' |
  sort -k4,4n | awk -v least="$least" '
  BEGIN { printf "%-44s %6s %8s %8s\n", "reader", "lines", "missed", "covered" }
  { printf "%-44s %6d %8d %6.1f %%%s\n", $1, $2, $3, $4, $4 < least ? "  below" : ""; lines += $2; missed += $3; bad += $4 < least }
  END {
    printf "%-44s %6d %8d %6.1f %%\n", "all", lines, missed, 100 * (1 - missed / lines)
    exit bad > 0
  }'
