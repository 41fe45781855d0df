#!/usr/bin/env bash
# What a second job gains in a comparison: runs a small plan (alidade_filter, alidade_smoother and po_invio_multi on the figure-8) with
# --jobs=1 and --jobs=2 by turns, and prints wall and CPU times [s] and the ratios two jobs / one job: median of the rounds, smallest and
# largest. Ideal: 0.5 of the wall time, 1 of the CPU time. The machine must be idle and have two cores.
# Usage: scripts/parallel_study.sh [--seeds=N] [--duration=S] [--rounds=N] [--program=FILE] [--output=DIR]
#        scripts/parallel_study.sh --times=FILE     prints the ratios of a times.csv
#   --seeds     of the sequence: three cells each (default 8)
#   --duration  of the sequence [s] (default 60)
#   --rounds    runs with each number of jobs (default 3)
#   --program   the command line (default build/alidade)
#   --output    where plan, comparisons and times.csv are written (default out/parallel_study)
set -euo pipefail
export LC_ALL=C  # the decimal separator of awk and of the shell's `time`
cd "$(dirname "$0")/.."

usage() { sed -n '5,11s/^# //p' "$0" >&2; exit 2; }
seeds=8 duration=60 rounds=3 program=build/alidade output=out/parallel_study times=''
for argument in "$@"; do
  case "$argument" in
    --times=?*) times=${argument#*=} ;;
    --seeds=[1-9]*) seeds=${argument#*=} ;;
    --duration=[1-9]*) duration=${argument#*=} ;;
    --rounds=[1-9]*) rounds=${argument#*=} ;;
    --program=?*) program=${argument#*=} ;;
    --output=?*) output=${argument#*=} ;;
    *) echo "unexpected argument '$argument'" >&2; usage ;;
  esac
done

# print_ratios TIMES_CSV
print_ratios() {
  awk -F, '
    function median(values, n,    i, j, t) {
      for (i = 2; i <= n; i++)
        for (j = i; j > 1 && values[j] < values[j - 1]; j--) { t = values[j]; values[j] = values[j - 1]; values[j - 1] = t }
      return n % 2 ? values[(n + 1) / 2] : (values[n / 2] + values[n / 2 + 1]) / 2
    }
    function row(name, time,    r, one, two, ratio, middle) {
      for (r = 1; r <= rounds; r++) { one[r] = time[1, r]; two[r] = time[2, r]; ratio[r] = two[r] / one[r] }
      middle = median(ratio, rounds)  # sorts
      printf "%-6s %10.2f %10.2f %8.3f  (%.3f to %.3f)\n", name, median(one, rounds), median(two, rounds), middle, ratio[1], ratio[rounds]
    }
    NR > 1 { wall[$1, $2] = $3; cpu[$1, $2] = $4; if ($2 > rounds) rounds = $2 }
    END {
      printf "%-6s %10s %10s %8s  (min to max)\n", "[s]", "one job", "two jobs", "ratio"
      row("wall", wall)
      row("CPU", cpu)
    }' "$1"
}
if [[ -n $times ]]; then
  print_ratios "$times"
  exit
fi

mkdir -p "$output"
cat >"$output/plan.yaml" <<EOF
set: {init.method: truth}
estimators:
  - $PWD/configs/estimators/alidade_filter.yaml
  - $PWD/configs/estimators/alidade_smoother.yaml
  - $PWD/configs/estimators/po_invio_multi.yaml
sequences:
  - config: $PWD/configs/datasets/figure8_short.yaml
    set: {duration_s: $duration, path_m: $(awk -v s="$duration" 'BEGIN { print 1.31 * s }')}
    seeds: 1..$seeds
metrics: {rpe: [8]}
EOF

# run JOBS ROUND: appends jobs,round,wall,CPU.
run() {
  local seconds
  rm -rf "$output/jobs_$1"
  seconds=$({ TIMEFORMAT='%R %U %S'
    time OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 "$program" compare --quiet --plan="$output/plan.yaml" --jobs="$1" \
      --output="$output/jobs_$1" >"$output/compare.log" 2>&1; } 2>&1) || { cat "$output/compare.log" >&2; exit 1; }
  awk -v jobs="$1" -v round="$2" '{ printf "%d,%d,%s,%.3f\n", jobs, round, $1, $2 + $3 }' <<<"$seconds" >>"$output/times.csv"
}
echo "jobs,round,wall_s,cpu_s" >"$output/times.csv"
for ((round = 1; round <= rounds; round++)); do
  order=(1 2)
  ((round % 2 == 0)) && order=(2 1)
  for jobs in "${order[@]}"; do run "$jobs" "$round"; done
done

print_ratios "$output/times.csv"
