#!/usr/bin/env bash
# Runs one benchmark program on one thread and prints a row a benchmark: name,CPU time [ms],counter=value counter=value ...
# Usage: scripts/benchmark_times.sh PROGRAM [--benchmark_filter=REGEX] [other flags of Google Benchmark]
# A benchmark that skips itself is named with its reason on standard error. JSON, because the csv output ends the program where two
# benchmarks have different counters.
set -euo pipefail
export LC_ALL=C  # the decimal separator of awk

program=$1
shift
OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 "$program" "$@" --benchmark_format=json 2>/dev/null | awk '
  BEGIN { ms["ns"] = 1e-6; ms["us"] = 1e-3; ms["ms"] = 1; ms["s"] = 1e3; split("", value) }
  /^  "benchmarks": \[/ { inside = 1; next }
  !inside { next }
  /^    \{/ { split("", value); counters = ""; after_unit = 0; next }
  /^    \}/ {
    if ("error_occurred" in value) print value["name"] ": skipped: " value["error_message"] >"/dev/stderr"
    else if (value["run_type"] == "iteration" && value["time_unit"] in ms && value["cpu_time"] + 0 > 0)
      printf "%s,%.6g,%s\n", value["name"], value["cpu_time"] * ms[value["time_unit"]], counters
    next
  }
  /^      "/ {
    key = $0; sub(/^ *"/, "", key); sub(/".*/, "", key)
    text = $0; sub(/^[^:]*: */, "", text); sub(/,$/, "", text); gsub(/"/, "", text)
    value[key] = text
    if (after_unit && key != "label") counters = counters (counters == "" ? "" : " ") key "=" sprintf("%.6g", text)
    if (key == "time_unit") after_unit = 1
  }' || { echo "$program failed" >&2; exit 1; }
