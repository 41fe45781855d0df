#!/usr/bin/env bash
# Pairs two outputs of `alidade compare` of one plan, of two versions of the program: cells by estimator, sequence and seed.
# Usage: scripts/pair.sh BEFORE AFTER
# Prints, for each estimator and sequence, the number of pairs and of each figure the ratio after / before (geometric mean over the pairs)
# with Student's t of its logarithm, and the largest |t|. With ten pairs |t| = 2.26 is the 5 % level of one figure.
set -euo pipefail
export LC_ALL=C  # the decimal separator of awk
[[ $# -eq 2 && -f $1/summary.csv && -f $2/summary.csv ]] || { echo "usage: $0 BEFORE AFTER (folders with a summary.csv)" >&2; exit 2; }

# Fields with commas are quoted and stand last (message), so that splitting at commas is enough.
awk -F, '
  FNR == 1 {
    for (i = 1; i <= NF; i++) column[FILENAME, $i] = i
    next
  }
  function cell(name) { return $(column[FILENAME, name]) }
  {
    group = cell("estimator") " " cell("sequence")
    for (f = 1; f <= 3; f++) {
      value = cell(figure[f])
      key = group SUBSEP cell("seed") SUBSEP f
      if (FILENAME == ARGV[1]) {
        before[key] = value
      } else if (value > 0 && before[key] > 0) {
        x = log(value / before[key])
        if (!((group, f) in n)) { if (!(group in seen)) order[++groups] = group; seen[group] }
        n[group, f]++; sum[group, f] += x; square[group, f] += x * x
      }
    }
  }
  BEGIN { split("rmse_pos_m rmse_ori_deg nees_pose", figure, " ") }
  END {
    printf "%-38s %5s  %-17s %-17s %-17s\n", "estimator sequence", "pairs", "position (t)", "orientation (t)", "pose NEES (t)"
    for (g = 1; g <= groups; g++) {
      line = sprintf("%-38s %5d", order[g], n[order[g], 1])
      for (f = 1; f <= 3; f++) {
        k = n[order[g], f]
        if (k < 2) { line = line sprintf("  %-16s", "-"); continue }
        mean = sum[order[g], f] / k
        variance = (square[order[g], f] - k * mean * mean) / (k - 1)
        t = variance > 1e-30 ? mean / sqrt(variance / k) : 0
        if (t * t > largest * largest) largest = t
        line = line sprintf("  %6.3f (%5.1f)  ", exp(mean), t)
      }
      print line
    }
    printf "largest |t|: %.1f\n", largest < 0 ? -largest : largest
  }' "$1/summary.csv" "$2/summary.csv"
