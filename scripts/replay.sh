#!/usr/bin/env bash
# Prints what a change of the code did to the estimates: runs tests/replay/plan.yaml (short simulations, presets of both back ends, without
# and with GNSS) and compares each run with tests/replay/figures.csv. Prints for each preset how many runs are equal to the byte, and
# otherwise, of each figure, the mean difference over the seeds (same seed, before and after) with its standard error and the largest.
# Rounding of another compiler or processor shows there and does not fail. Exit code 1: a figure of a run is off by more than TOLERANCE,
# or a run has another status, is missing or new.
# Usage: scripts/replay.sh [PROGRAM, default build/alidade]
#        scripts/replay.sh --update [PROGRAM]             stores what is measured, and prints what changed
#        scripts/replay.sh --compare STORED MEASURED      compares two such files
set -euo pipefail
cd "$(dirname "$0")/.."

# Other kernels of OpenBLAS change these runs by at most 2e-6 % (OPENBLAS_CORETYPE=Prescott).
tolerance_percent=0.1
stored=tests/replay/figures.csv

compare_figures() {
  awk -F, -v tolerance="$tolerance_percent" '
    FNR == 1 { for (i = 1; i <= NF; ++i) name[i] = $i; next }
    NR == FNR { before[$1 "," $2 "," $3] = $0; next }
    {
      run = $1 "," $2 "," $3
      group = $1 " on " $2
      if (!(group in runs)) order[++groups] = group
      ++runs[group]
      if (!(run in before)) { print "new run: " run; bad = 1; next }
      split(before[run], old)
      delete before[run]
      if (old[4] != $4) { print run ": was " old[4] ", is " $4; bad = 1; next }
      inputs[group] += old[5] != $5
      equal[group] += old[6] == $6
      for (i = 7; i <= NF; ++i) {
        # In percent of the value before; a figure that was 0 or absent must stay so.
        change = old[i] + 0 != 0 ? 100 * ($i - old[i]) / old[i] : (old[i] "" == $i "" ? 0 : 1e9)
        sum[group, i] += change
        squares[group, i] += change * change
        size = change < 0 ? -change : change
        if (size > largest[group, i]) { largest[group, i] = size; seed[group, i] = $3 }
      }
      columns = NF
    }
    END {
      for (g = 1; g <= groups; ++g) {
        group = order[g]
        n = runs[group]
        printf "%s: %d of %d runs equal to the byte%s\n", group, equal[group], n, inputs[group] ? "; inputs of " inputs[group] " changed" : ""
        for (i = 7; i <= columns; ++i) {
          if (largest[group, i] == 0) continue
          mean = sum[group, i] / n
          spread = n > 1 ? squares[group, i] - n * mean * mean : 0
          beyond = largest[group, i] > tolerance
          error = n > 1 && spread > 0 ? sqrt(spread / (n - 1) / n) : 0
          note = beyond ? ": beyond " tolerance " %" : ""
          printf "  %s: %+.3g %% +- %.2g, at most %.3g %% (seed %s)%s\n", name[i], mean, error, largest[group, i], seed[group, i], note
          bad = bad || beyond
        }
      }
      for (run in before) { print "missing run: " run; bad = 1 }
      exit bad
    }' "$1" "$2"
}

if [[ ${1:-} == --compare ]]; then
  compare_figures "$2" "$3"
  exit
fi
update=false
if [[ ${1:-} == --update ]]; then
  update=true
  shift
fi
program=${1:-build/alidade}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$program" compare --plan=tests/replay/plan.yaml --output="$work/out" --quiet >"$work/table.txt" || { cat "$work/table.txt"; exit 1; }

# estimator,sequence,seed,status,digest of the input and of the states, figures
figures=(rmse_pos_m rmse_ori_deg nees_pose nees_vel)
{
  echo "estimator,sequence,seed,status,input,states,$(IFS=,; echo "${figures[*]}")"
  awk -F, -v wanted="status,input_digest,${figures[*]}" '
    BEGIN { count = split(wanted, names, /[ ,]/) }
    NR == 1 { for (i = 1; i <= NF; ++i) column[$i] = i; next }
    { line = $1 "," $3 "," $4; for (i = 1; i <= count; ++i) line = line "," $column[names[i]]; print line }' "$work/out/summary.csv" |
    while IFS=, read -r estimator sequence seed status input rest; do
      states=$(sha256sum "$work/out/cells/$estimator/$sequence/$seed/states.csv" | cut -c1-16)
      echo "$estimator,$sequence,$seed,$status,${input:0:16},$states,$rest"
    done
} >"$work/figures.csv"
code=0
if [[ -f $stored ]]; then
  compare_figures "$stored" "$work/figures.csv" || code=$?
fi
if $update; then
  cp "$work/figures.csv" "$stored"
  code=0
elif [[ $code -ne 0 ]]; then
  echo "If that is meant: scripts/replay.sh --update, and commit $stored"
fi
exit "$code"
