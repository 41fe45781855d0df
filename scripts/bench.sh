#!/usr/bin/env bash
# Compares the speed of this tree with another commit: builds the commit beside this tree, runs the benchmarks of both by turns on one
# thread, and prints CPU times and their ratio (this tree / commit): median of the rounds, smallest and largest.
# Usage: scripts/bench.sh --against=COMMIT [--filter=REGEX] [--rounds=N] [--min-time=SECONDS] [--output=DIR]
#   --filter    benchmarks by their name (default: all), e.g. 'alidade_filter/25/150|Gnss'
#   --rounds    runs of each side, by turns (default 5)
#   --min-time  shortest time of one benchmark in one round [s] (default 0.5)
#   --output    where the commit is built and the results are written (default out/bench): bench.csv, rounds.csv
# Benchmarks that only one side has are listed without a ratio. The machine should be idle: other load widens the spread.
set -euo pipefail
shopt -s inherit_errexit
cd "$(dirname "$0")/.."

usage() { sed -n '4,8s/^# //p' "$0" >&2; exit 2; }
against='' filter='.' rounds=5 min_time=0.5 output=out/bench
for argument in "$@"; do
  case "$argument" in
    --against=?*) against=${argument#*=} ;;
    --filter=?*) filter=${argument#*=} ;;
    --rounds=[1-9]*) rounds=${argument#*=} ;;
    --min-time=[0-9]*) min_time=${argument#*=} ;;
    --output=?*) output=${argument#*=} ;;
    *) echo "unexpected argument '$argument'" >&2; usage ;;
  esac
done
[[ -n "$against" ]] || { echo "--against is missing" >&2; usage; }
commit=$(git rev-parse --verify --quiet "$against^{commit}") || { echo "'$against' is not a commit of this repository" >&2; exit 2; }

scripts/install_dependencies.sh >&2
beside=$output/${commit:0:10}
if [[ ! -d $beside/source ]]; then
  mkdir -p "$beside/extracted"
  git archive "$commit" | tar -x -C "$beside/extracted"
  mv "$beside/extracted" "$beside/source"
fi

# Configures and builds the benchmarks of the tree $1 in $2, which must be new or have the compiler of this tree's build; prints their names.
build() {
  local compiler
  compiler=$(sed -n 's/^CMAKE_CXX_COMPILER:[A-Z]*=//p' build/CMakeCache.txt 2>/dev/null || true)
  cmake -S "$1" -B "$2" -G Ninja -DCMAKE_BUILD_TYPE=Release ${compiler:+-DCMAKE_CXX_COMPILER="$compiler"} >&2
  local programs
  programs=$(ninja -C "$2" -t targets all | sed -nE 's/^(alidade_[a-z]+_benchmark): .*/\1/p' | sort -u)
  # shellcheck disable=SC2086 # one word a target
  cmake --build "$2" --parallel "$(scripts/jobs.sh)" --target $programs >&2
  echo "$programs"
}
new_programs=$(build . build)
base_programs=$(build "$beside/source" "$beside/build")

# Runs one program of side $1 ("base" or "new") in round $2; appends "side,round,name,milliseconds of CPU".
run() {
  local folder=build
  [[ $1 == base ]] && folder=$beside/build
  [[ -x $folder/$3 ]] || return 0
  local rows
  if ! rows=$(scripts/benchmark_times.sh "$folder/$3" --benchmark_filter="$filter" --benchmark_min_time="$min_time"); then
    [[ $1 == base ]]  # its benchmarks are left out; one of this tree must not fail
    return
  fi
  awk -F, -v side="$1" -v round="$2" 'NF { printf "%s,%d,%s,%s\n", side, round, $1, $2 }' <<<"$rows"
}

echo "side,round,benchmark,cpu_ms" >"$output/rounds.csv"
for ((round = 1; round <= rounds; round++)); do
  for program in $(printf '%s\n%s\n' "$new_programs" "$base_programs" | sort -u); do
    sides=(base new)
    ((round % 2 == 0)) && sides=(new base)
    for side in "${sides[@]}"; do
      run "$side" "$round" "$program" >>"$output/rounds.csv"
    done
  done
done

# One row a benchmark, in the order of the first round. The ratio is taken within each round.
awk -F, '
  function median(values, count,    i, j, t) {
    for (i = 2; i <= count; i++)
      for (j = i; j > 1 && values[j] < values[j - 1]; j--) { t = values[j]; values[j] = values[j - 1]; values[j - 1] = t }
    return count % 2 ? values[(count + 1) / 2] : (values[count / 2] + values[count / 2 + 1]) / 2
  }
  NR > 1 {
    if (!($3 in known)) { known[$3] = 1; names[++n] = $3 }
    time[$1, $3, $2] = $4
    if ($2 > rounds) rounds = $2
  }
  END {
    print "benchmark,base_ms,new_ms,ratio,ratio_min,ratio_max"
    for (i = 1; i <= n; i++) {
      name = names[i]; bases = news = both = 0
      split("", b); split("", w); split("", q)
      for (r = 1; r <= rounds; r++) {
        if (("base", name, r) in time) b[++bases] = time["base", name, r]
        if (("new", name, r) in time) w[++news] = time["new", name, r]
        if (("base", name, r) in time && ("new", name, r) in time) q[++both] = time["new", name, r] / time["base", name, r]
      }
      middle = both ? median(q, both) : 0  # sorts q
      printf "%s,%s,%s,%s\n", name, bases ? sprintf("%.4g", median(b, bases)) : "", news ? sprintf("%.4g", median(w, news)) : "",
        both ? sprintf("%.3f,%.3f,%.3f", middle, q[1], q[both]) : ",,"
    }
  }' "$output/rounds.csv" >"$output/bench.csv"

if [[ $(wc -l <"$output/bench.csv") -le 1 ]]; then
  echo "no benchmark matches '$filter'" >&2
  exit 1
fi
echo "CPU time, this tree against ${commit:0:10}; $rounds rounds"
awk -F, 'NR == 1 { printf "%-45s %12s %12s %8s %17s\n", "benchmark", "base [ms]", "new [ms]", "ratio", "(min to max)"; next }
  { printf "%-45s %12s %12s %8s %17s\n", $1, $2 == "" ? "-" : $2, $3 == "" ? "-" : $3, $4 == "" ? "-" : $4,
      $4 == "" ? "" : "(" $5 " to " $6 ")" }' "$output/bench.csv"
