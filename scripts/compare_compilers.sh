#!/usr/bin/env bash
# Builds the program with GCC -O2, GCC -O3 and Clang -O3, runs the demo's plan (60 s, both back ends, without and with GNSS) with each,
# and prints the largest difference of the estimated states to the first one's: of the position in metres, of each other quantity
# relative to its value where that is above 1. These targets are always built with -O2, so
# that the levels are not compared for them: eval_X for X = bag, calibrate, compare, comparison, config, dataset, download, files,
# frontend_run, identify, peers, probe, record, report, rosbag, run_images, study, trajectory and truth (option TEXT in their CMakeLists.txt).
# Exit code 1: a difference is above the bound, a number is missing or not finite, rows or columns differ, or there are no states.
# Usage: scripts/compare_compilers.sh [output folder] [bound, default 1e-6]
#        scripts/compare_compilers.sh --compare FIRST SECOND [bound]     two files states.csv, or all of them below two folders
# Takes about half an hour on two cores. Needs Debian's clang beside what scripts/install_dependencies.sh installs.
set -euo pipefail
export LC_ALL=C  # the decimal separator of awk

# Prints the largest difference of each quantity, one line a file: "p 0 q 1e-12 ...", and of columns that only GNSS adds "gnss".
compare_states() {
  awk -F, -v bound="$3" '
    function finite(text) { return text ~ /^[-+]?([0-9]+[.]?[0-9]*|[.][0-9]+)([eE][-+]?[0-9]+)?$/ }
    function fault(text) { print text; bad = 1; exit }
    FNR == 1 && NR == 1 {
      columns = NF
      for (i = 2; i <= NF; i++) {
        group[i] = $i ~ /^(p|q|v|bg|ba|c)_/ ? substr($i, 1, index($i, "_") - 1) : "gnss"
        if (!(group[i] in most)) { names[++groups] = group[i]; most[group[i]] = 0 }
      }
      header = $0
      next
    }
    FNR == 1 { if ($0 != header) fault("columns differ"); second = 1; next }
    !second { first[FNR] = $0; rows = FNR; next }
    {
      if (!(FNR in first)) fault("rows differ")
      split(first[FNR], old, ",")
      if (old[1] != $1 || NF != columns) fault("rows differ")
      for (i = 2; i <= columns; i++) {
        if (old[i] == "" && $i == "") continue
        if (!finite(old[i]) || !finite($i)) fault("column " i " at " $1 " is " old[i] " and " $i)
        d = $i - old[i]
        if (d < 0) d = -d
        size = old[i] < 0 ? -old[i] : old[i] + 0
        if (group[i] != "p" && size > 1) d /= size
        if (d > most[group[i]]) most[group[i]] = d
      }
      compared = FNR
    }
    END {
      if (bad) exit 1
      if (compared != rows || rows < 2) { print "rows differ"; exit 1 }
      for (g = 1; g <= groups; g++) {
        printf("%s%s %.1e", (g > 1 ? "  " : ""), names[g], most[names[g]])
        if (most[names[g]] > bound) bad = 1
      }
      print ""
      exit bad
    }' "$1" "$2"
}

# compare_folders FIRST SECOND BOUND: each states.csv below either of them, one line a file. None at all is a failure.
compare_folders() {
  local file found files=0 failed=0
  while read -r file; do
    found=$(compare_states "$1/$file" "$2/$file" "$3") || failed=1
    printf '%-45s %s\n' "${file%/states.csv}" "$found"
    files=$((files + 1))
  done < <(find "$1" "$2" -name states.csv -printf '%P\n' | sort -u)
  if ((files == 0)); then
    echo "no states.csv below $1 and $2"
    failed=1
  fi
  return $failed
}

if [[ ${1:-} == --compare ]]; then
  compare=compare_states
  [[ -d $2 ]] && compare=compare_folders
  $compare "$2" "$3" "${4:-1e-6}"
  exit
fi

cd "$(dirname "$0")/.."
output=${1:-out/compilers}
bound=${2:-1e-6}
clang=$(command -v clang++-14 || command -v clang++) || { echo "clang++ is not installed (Debian package clang)" >&2; exit 1; }
variants=("gcc_O2 g++ -O2" "gcc_O3 g++ -O3" "clang_O3 $clang -O3")

for variant in "${variants[@]}"; do
  read -r name compiler level <<<"$variant"
  cmake -S . -B "$output/$name/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DALIDADE_BUILD_TESTS=OFF \
    -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS_RELEASE="$level -DNDEBUG" >/dev/null
  cmake --build "$output/$name/build" --target alidade --parallel "$(scripts/jobs.sh)" >/dev/null
  "$output/$name/build/alidade" compare --plan=configs/plans/demo.yaml --output="$output/$name/demo" --overwrite --quiet \
    --jobs="$(nproc)" >"$output/$name/table.txt"
done

reference=${variants[0]%% *}
failed=0
for variant in "${variants[@]:1}"; do
  name=${variant%% *}
  echo "largest differences of $name to $reference"
  compare_folders "$output/$reference/demo/cells" "$output/$name/demo/cells" "$bound" || failed=1
done
exit $failed
