#!/usr/bin/env bash
# How the cost of a frame grows with the window and with the number of tracks: runs the benchmarks of alidade_filter and
# alidade_smoother at growing sizes n on one thread and fits cost = a n^b by least squares in log-log, over all sizes and over the upper
# half of them. Prints CPU times and exponents b, the latter beside the largest one that the operations of a frame allow
# (docs/performance.md); one that exceeds it by more than the tolerance is marked, and the exit code is then 1.
# Usage: scripts/growth.sh [--build=DIR] [--min-time=SECONDS] [--rounds=N] [--tolerance=B] [--output=DIR]
#   --build      folder of the benchmark programs (default build)
#   --min-time   shortest time of one benchmark in one round [s] (default 0.5)
#   --rounds     runs of each program, of which the median counts (default 3)
#   --tolerance  of an exponent (default 0.15)
#   --output     where times.csv (program, benchmark, CPU time) and growth.csv are written (default out/growth)
set -euo pipefail
export LC_ALL=C  # the decimal separator of awk
shopt -s inherit_errexit
cd "$(dirname "$0")/.."

usage() { sed -n '6,11s/^# //p' "$0" >&2; exit 2; }
build=build min_time=0.5 rounds=3 tolerance=0.15 output=out/growth
for argument in "$@"; do
  case "$argument" in
    --build=?*) build=${argument#*=} ;;
    --min-time=[0-9]*) min_time=${argument#*=} ;;
    --rounds=[1-9]*) rounds=${argument#*=} ;;
    --tolerance=[0-9]*) tolerance=${argument#*=} ;;
    --output=?*) output=${argument#*=} ;;
    *) echo "unexpected argument '$argument'" >&2; usage ;;
  esac
done

windows='5|10|20|35|50' tracks='50|100|200|400|800'
mkdir -p "$output"
echo "benchmark,cpu_ms" >"$output/times.csv"
# measure PROGRAM NAME WINDOW: WINDOW is that of the growing tracks.
measure() {
  scripts/benchmark_times.sh "$build/$1" --benchmark_min_time="$min_time" \
    --benchmark_filter="^$2/(($windows)/150|$3/($tracks))\$" | cut -d, -f1,2 >>"$output/times.csv"
}
for ((round = 1; round <= rounds; round++)); do
  measure alidade_filter_benchmark FilterFrame/alidade_filter 25
  measure alidade_smoother_benchmark SmootherFrame/alidade_smoother 10
done

# series: estimator, what grows, the benchmark's name before and after n, the largest exponent, the sizes.
awk -v tolerance="$tolerance" -v windows="${windows//|/ }" -v tracks="${tracks//|/ }" -v table="$output/growth.csv" '
  function median(key,    i, j, t, values, n) {
    n = count[key]
    for (i = 1; i <= n; i++) values[i] = time[key, i]
    for (i = 2; i <= n; i++)
      for (j = i; j > 1 && values[j] < values[j - 1]; j--) { t = values[j]; values[j] = values[j - 1]; values[j - 1] = t }
    return n % 2 ? values[(n + 1) / 2] : (values[n / 2] + values[n / 2 + 1]) / 2
  }
  # Slope of log cost over log size from the point `first` on.
  function exponent(first, points, size, cost,    i, n, x, y, sx, sy, sxx, sxy) {
    for (i = first; i <= points; i++) {
      x = log(size[i]); y = log(cost[i])
      n++; sx += x; sy += y; sxx += x * x; sxy += x * y
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx)
  }
  function series(name, grows, before, after, largest, sizes,    points, i, size, cost, upper, all, line, mark) {
    points = split(sizes, size, " ")
    for (i = 1; i <= points; i++) {
      if (!((before size[i] after) in count)) { print before size[i] after " was not measured" >"/dev/stderr"; exit 1 }
      cost[i] = median(before size[i] after)
      line = line sprintf(" %9.4g", cost[i])
    }
    all = exponent(1, points, size, cost)
    upper = exponent(points - int((points + 1) / 2) + 1, points, size, cost)
    mark = upper > largest + tolerance ? "  above" : ""
    if (mark != "") failed = 1
    printf "%-17s %-7s %s %7.2f %7.2f %8.1f%s\n", name, grows, line, all, upper, largest, mark
    printf "%s,%s,%.3f,%.3f,%.1f\n", name, grows, all, upper, largest >table
  }
  function heading(grows, sizes,    n, i, size) {
    n = split(sizes, size, " ")
    printf "%-17s %-7s ", "CPU time [ms]", grows
    for (i = 1; i <= n; i++) printf " %9d", size[i]
    printf " %7s %7s %8s\n", "b all", "b upper", "largest"
  }
  BEGIN { FS = "," }
  FNR > 1 { time[$1, ++count[$1]] = $2 }
  END {
    print "benchmark,grows,exponent_all,exponent_upper,largest" >table
    heading("window", windows)
    series("alidade_filter", "window", "FilterFrame/alidade_filter/", "/150", 3, windows)
    series("alidade_smoother", "window", "SmootherFrame/alidade_smoother/", "/150", 3, windows)
    heading("tracks", tracks)
    series("alidade_filter", "tracks", "FilterFrame/alidade_filter/25/", "", 1, tracks)
    series("alidade_smoother", "tracks", "SmootherFrame/alidade_smoother/10/", "", 1, tracks)
    exit failed
  }' "$output/times.csv"
