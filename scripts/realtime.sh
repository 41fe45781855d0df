#!/usr/bin/env bash
# How many times faster than real time a run from pixels is on one core: renders a figure-8 of EuRoC's size, lens and rates (752 x 480,
# 20 Hz, configs/datasets/hard_pixels/easy.yaml) once, runs alidade_filter and alidade_smoother on its images, pinned to one core, and
# prints the time of a frame [ms] and the real-time factor, both for each part. Wall time of the parts, from timing.csv, mean over the
# frames after the start: tracking, back end, total of both; images are decoded before.
# CPU time, which other load affects less: "backCPU" of the back end a frame (run.json), "allCPU" of the whole program an image, with
# reading, start and writing. Median of the rounds. The machine should be idle.
# Usage: scripts/realtime.sh [--dataset=DIR] [--seed=N] [--duration=S] [--core=N] [--rounds=N] [--program=FILE] [--output=DIR]
#                            [--against=FILE --against-configs=DIR]
#   --dataset   a sequence with images instead of the rendered one
#   --seed      of the rendered sequence (default 901)
#   --duration  of the rendered sequence [s] (default 20, of which 2 s are at rest)
#   --core      where the runs are pinned (default: the first core that the script may use)
#   --rounds    runs of each estimator (default 3)
#   --program   the command line (default build/alidade)
#   --against   another build of it, which runs by turns with its own configs folder; ratios (program / other) follow
#   --output    where sequence, runs and frames.csv are written (default out/realtime); a sequence that is there is not rendered again
set -euo pipefail
export LC_ALL=C  # the decimal separator of awk and of the shell's `time`
shopt -s inherit_errexit
cd "$(dirname "$0")/.."

usage() { sed -n '8,17s/^# //p' "$0" >&2; exit 2; }
dataset='' seed=901 duration=20 core='' rounds=3 program=build/alidade output=out/realtime against='' against_configs=''
for argument in "$@"; do
  case "$argument" in
    --dataset=?*) dataset=${argument#*=} ;;
    --seed=[0-9]*) seed=${argument#*=} ;;
    --duration=[1-9]*) duration=${argument#*=} ;;
    --core=[0-9]*) core=${argument#*=} ;;
    --rounds=[1-9]*) rounds=${argument#*=} ;;
    --program=?*) program=${argument#*=} ;;
    --against=?*) against=${argument#*=} ;;
    --against-configs=?*) against_configs=${argument#*=} ;;
    --output=?*) output=${argument#*=} ;;
    *) echo "unexpected argument '$argument'" >&2; usage ;;
  esac
done
[[ -z $against || -n $against_configs ]] || { echo "--against needs --against-configs" >&2; usage; }

# Of "pid 7's current affinity list: 2,4-7", the 2.
[[ -n $core ]] || core=$(taskset -pc $$ | sed 's/.*: *\([0-9]*\).*/\1/')

mkdir -p "$output"
if [[ -z $dataset ]]; then
  dataset=$output/sequence_${seed}_$duration
  if [[ ! -e $dataset/mav0/cam0/data.csv ]]; then
    "$program" simulate --quiet --overwrite --config=configs/datasets/hard_pixels/easy.yaml --seed="$seed" \
      --set="duration_s=$duration,path_m=$(awk -v s="$duration" 'BEGIN { print 1.3 * s }')" --output="$dataset"
  fi
fi
images=$dataset/mav0/cam0/data.csv

# run SIDE PROGRAM CONFIGS ESTIMATOR ROUND: appends side,estimator,round and the milliseconds of a frame: tracking, back end, total, CPU of
# the back end, CPU of all.
run() {
  local folder=$output/run_$1_$4 cpu_s back_cpu_s
  cpu_s=$({ TIMEFORMAT='%U %S'
    time OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 taskset -c "$core" "$2" run --quiet --overwrite --dataset="$dataset" \
      --config="$3/estimators/$4.yaml" --output="$folder" >"$output/run.log" 2>&1; } 2>&1) || { cat "$output/run.log" >&2; exit 1; }
  back_cpu_s=$(sed -n 's/^ *"cpu_s": *\([0-9.e+-]*\).*/\1/p' "$folder/run.json")
  awk -F, -v row="$1,$4,$5" -v cpu_s="$cpu_s" -v back_cpu_s="$back_cpu_s" -v images="$(grep -vc '^#' "$images")" '
    NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
    {
      frames++
      back += $column["backend_ms"]
      total += $column["total_ms"]
    }
    END {
      split(cpu_s, cpu, " ")
      printf "%s,%.6g,%.6g,%.6g,%.6g,%.6g\n", row, (total - back) / frames, back / frames, total / frames, 1e3 * back_cpu_s / frames, 1e3 * (cpu[1] + cpu[2]) / images
    }' "$folder/timing.csv" >>"$output/frames.csv"
}

echo "side,estimator,round,tracking_ms,backend_ms,total_ms,backend_cpu_ms,process_cpu_ms" >"$output/frames.csv"
for ((round = 1; round <= rounds; round++)); do
  for estimator in alidade_filter alidade_smoother; do
    run new "$program" configs "$estimator" "$round"
    [[ -z $against ]] || run base "$against" "$against_configs" "$estimator" "$round"
  done
done

period_ms=$(awk -F, '!/^#/ { if (!n++) first = $1; last = $1 } END { printf "%.9g", (last - first) / (n - 1) * 1e-6 }' "$images")
echo "$dataset: an image every $period_ms ms"
awk -F, -v period_ms="$period_ms" -v rounds="$rounds" '
  function median(key,    i, j, t, values, n) {
    for (i = 1; i <= rounds; i++) if ((key, i) in time) values[++n] = time[key, i]
    if (!n) return ""
    for (i = 2; i <= n; i++)
      for (j = i; j > 1 && values[j] < values[j - 1]; j--) { t = values[j]; values[j] = values[j - 1]; values[j - 1] = t }
    return n % 2 ? values[(n + 1) / 2] : (values[n / 2] + values[n / 2 + 1]) / 2
  }
  function cell(text) { printf " %9s", text }
  # kind: "ms" | "x" (real-time factor) | "ratio" of the two sides.
  function line(side, estimator, kind,    part, mine, other) {
    printf "%-5s %-17s %-6s", side, estimator, kind
    for (part = 4; part <= 8; part++) {
      mine = median(side SUBSEP estimator SUBSEP part)
      other = median("base" SUBSEP estimator SUBSEP part)
      if (mine == "" || mine == 0 || (kind == "ratio" && other + 0 == 0)) cell("-")
      else if (kind == "ms") cell(sprintf("%.3f", mine))
      else if (kind == "x") cell(sprintf("%.1f", period_ms / mine))
      else cell(sprintf("%.3f", mine / other))
    }
    print ""
  }
  NR > 1 {
    if (!(($1, $2) in known)) { known[$1, $2] = 1; sides[++rows] = $1; names[rows] = $2 }
    for (i = 4; i <= 8; i++) time[$1, $2, i, $3] = $i
  }
  END {
    printf "%-5s %-17s %-6s %9s %9s %9s %9s %9s\n", "", "estimator", "", "tracking", "back end", "total", "backCPU", "allCPU"
    for (r = 1; r <= rows; r++) { line(sides[r], names[r], "ms"); line(sides[r], names[r], "x") }
    for (r = 1; r <= rows; r++) if (sides[r] == "new" && (("base", names[r]) in known)) line("new", names[r], "ratio")
  }' "$output/frames.csv"
