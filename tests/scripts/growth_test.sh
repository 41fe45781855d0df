#!/usr/bin/env bash
# GIVEN benchmark programs whose times follow a power of the size WHEN growth.sh runs them THEN it prints the power of the upper half of
# the sizes, and one above what the operations allow fails, as does a benchmark that is missing.
# Usage: growth_test.sh ROOT
set -euo pipefail
root=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export LC_ALL=C.UTF-8  # in place of one with a decimal comma, which few machines have

# programs EXPONENT_OF_TRACKS LARGEST_WINDOW: the time is 20 us times window^2 (window from 20 on; below it is constant) times a power
# of the tracks, in output as that of Google Benchmark. It fails in another locale than C.
programs() {
  local name
  for name in filter smoother; do
    cat >"$work/alidade_${name}_benchmark" <<PROGRAM
#!/usr/bin/env bash
[[ \$LC_ALL == C ]] || exit 1
awk -v name="$name" -v power="$1" -v largest="$2" '
  function row(window, tracks,    long) {
    long = window < 20 ? 20 : window
    printf "    {\n      \"name\": \"%s/%d/%d\",\n      \"run_type\": \"iteration\",\n", full, window, tracks
    printf "      \"cpu_time\": %.9e,\n      \"time_unit\": \"us\",\n      \"rows\": 3\n    },\n", 20 * long ^ 2 * (tracks / 150) ^ power
  }
  BEGIN {
    full = name == "filter" ? "FilterFrame/alidade_filter" : "SmootherFrame/alidade_smoother"
    print "{\n  \"benchmarks\": ["
    n = split("5 10 20 35 50", window, " ")
    for (i = 1; i <= n && window[i] <= largest; i++) row(window[i], 150)
    n = split("50 100 200 400 800", tracks, " ")
    for (i = 1; i <= n; i++) row(name == "filter" ? 25 : 10, tracks[i])
    print "  ]\n}"
  }'
PROGRAM
    chmod +x "$work/alidade_${name}_benchmark"
  done
}
# expect CODE PATTERN: of the output.
expect() {
  local code=0 output
  output=$("$root/scripts/growth.sh" --build="$work" --rounds=2 --output="$work/out" 2>&1) || code=$?
  if [[ $code -ne $1 ]] || ! grep -qE "$2" <<<"$output"; then
    printf 'code %s, expected %s; output, expected "%s":\n%s\n' "$code" "$1" "$2" "$output"
    exit 1
  fi
}
programs 1 50
expect 0 '^alidade_filter +window +8 +8 +8 +24\.5 +50 +[01]\.[0-9]+ +2\.00 +3\.0$'
expect 0 '^alidade_smoother +tracks .* 1\.00 +1\.00 +1\.0$'
grep -q '^alidade_filter,window,.*,2\.000,3\.0$' "$work/out/growth.csv"
programs 1.3 50
expect 1 '^alidade_filter +tracks .* 1\.30 +1\.30 +1\.0  above$'
programs 1 35
expect 1 'FilterFrame/alidade_filter/50/150 was not measured'
