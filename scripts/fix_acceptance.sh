#!/usr/bin/env bash
# Acceptance of position fixes: runs configs/plans/fix.yaml (1 Hz, 1 m and 2 cm, an outage of 30 s, 10 % wrong fixes; twelve seeds, on
# which both back ends are paired) and checks, for each sequence and back end, that every run aligned within 15 s of motion and that the
# mean NEES of the position since the alignment lies in its 95 % band. The band is that of chi-square with 3 degrees of freedom a run:
# the errors of one run count as a single one, since they are correlated (docs/fixes.md).
# Usage: scripts/fix_acceptance.sh [OUTPUT, default out/fix] [JOBS, default 2]
# Runs that OUTPUT has already are kept. ALIDADE: the program (build/alidade). Exit code 1: a check or a run failed.
set -euo pipefail
export LC_ALL=C  # the decimal separator of awk
cd "$(dirname "$0")/.."

output=${1:-out/fix}
jobs=${2:-2}
program=${ALIDADE:-build/alidade}
plan=configs/plans/fix.yaml

code=0
"$program" compare --plan="$plan" --output="$output" --jobs="$jobs" --resume --quiet >/dev/null || code=$?
case $code in
  0) ;;
  7) echo "some runs failed; the checks are those of the others" ;;
  *) echo "compare ended with exit code $code" >&2; exit "$code" ;;
esac
"$program" gnss_study --plan="$plan" --input="$output" --quiet | awk -F'|' -v most_s=15 -v least_runs=10 '
  # | sequence | `estimator` | 12 of 12 | 5.9, 7.1 | ... | NEES position | low to high |
  NF == 13 && $4 ~ /^ [0-9]+ of [0-9]+ $/ {
    split($4, runs, " "); split($5, after, ","); split($12, band, " ")
    verdict = ""
    if (runs[3] < least_runs) verdict = verdict " too few runs;"
    if (runs[1] < runs[3]) verdict = verdict " not every run aligned;"
    if (!(after[2] ~ /[0-9]/) || after[2] + 0 > most_s) verdict = verdict " aligned too late;"
    if (!($11 ~ /[0-9]/) || $11 + 0 < band[1] + 0 || $11 + 0 > band[3] + 0) verdict = verdict " NEES outside of its band;"
    printf "%-14s %-12s aligned %2d of %2d, the last after %4.1f s (at most %d s); NEES %.2f (%.2f to %.2f):%s\n", \
      $2, $3, runs[1], runs[3], after[2], most_s, $11, band[1], band[3], verdict == "" ? " met" : verdict
    failed += verdict != ""
    rows++
  }
  END {
    if (rows != 4) { printf "found %d of the 4 pairs of sequence and back end\n", rows; exit 1 }
    exit (failed > 0)
  }'
[[ $code -eq 0 ]] || exit 1
