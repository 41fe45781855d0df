#!/usr/bin/env bash
# Builds the program with GCC -O2, GCC -O3 and Clang -O3, runs the demo's plan (60 s, both back ends, without and with GNSS) with each,
# and prints the largest difference of the estimated positions to the first one's. Exit code 1: above the bound.
# Usage: scripts/compare_compilers.sh [output folder] [bound in metres, default 1e-6]
# Takes about half an hour on two cores. Needs Debian's clang beside what scripts/install_dependencies.sh installs.
set -euo pipefail
cd "$(dirname "$0")/.."

output=${1:-out/compilers}
bound=${2:-1e-6}
clang=$(command -v clang++-14 || command -v clang++) || { echo "clang++ is not installed (Debian package clang)" >&2; exit 1; }
variants=("gcc_O2 g++ -O2" "gcc_O3 g++ -O3" "clang_O3 $clang -O3")

for variant in "${variants[@]}"; do
  read -r name compiler level <<<"$variant"
  cmake -S . -B "$output/$name/build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DALIDADE_BUILD_TESTS=OFF \
    -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="$level -DNDEBUG" >/dev/null
  cmake --build "$output/$name/build" --target alidade --parallel "$(scripts/jobs.sh)" >/dev/null
  "$output/$name/build/alidade" compare --plan=configs/plans/demo.yaml --output="$output/$name/demo" --overwrite --quiet \
    --jobs="$(nproc)" >"$output/$name/table.txt"
done

# Of two states.csv: the largest difference of p_x, p_y or p_z (columns 2 to 4) at equal stamps; "rows differ" when the stamps do.
difference() {
  paste -d, <(cut -d, -f1-4 "$1") <(cut -d, -f1-4 "$2") | awk -F, '
    NR == 1 { next }
    $1 != $5 { print "rows differ"; wrong = 1; exit }
    { for (i = 2; i <= 4; i++) { d = $i - $(i + 4); if (d < 0) d = -d; if (d > most) most = d } }
    END { if (!wrong) printf "%.1e\n", most }'
}

reference=${variants[0]%% *}
failed=0
printf '%-45s %12s %12s\n' "largest |dp| [m] to $reference" "${variants[1]%% *}" "${variants[2]%% *}"
while read -r cell; do
  line=()
  for variant in "${variants[@]:1}"; do
    found=$(difference "$output/$reference/demo/cells/$cell/states.csv" "$output/${variant%% *}/demo/cells/$cell/states.csv")
    line+=("$found")
    awk -v found="$found" -v bound="$bound" 'BEGIN { exit !(found + 0 <= bound + 0 && found !~ /rows/) }' || failed=1
  done
  printf '%-45s %12s %12s\n' "$cell" "${line[@]}"
done < <(cd "$output/$reference/demo/cells" && find . -name states.csv -printf '%h\n' | sed 's|^\./||' | sort)
exit $failed
