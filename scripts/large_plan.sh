#!/usr/bin/env bash
# Measures what follows the cells of a large comparison: tables and status of CELLS finished cells, whose reports are copies of those of
# four runs of 20 s with other seeds (so their figures have no meaning). Prints time and largest memory of each step, and sizes.
# Needs perl and /usr/bin/time (Debian package time).
# Usage: scripts/large_plan.sh [CELLS, a multiple of 4000, default 8000] [PROGRAM, default build/alidade]
set -euo pipefail
cd "$(dirname "$0")/.."

cells=${1:-8000}
program=$(realpath "${2:-build/alidade}")
first=100001  # a number that CBOR writes as four bytes
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

names=(filter smoother multi two)
files=(alidade_filter alidade_smoother po_invio_multi po_invio_two)
# plan SEEDS LAST_SEQUENCE
plan() {
  echo "set: {init.method: truth}"
  echo "estimators:"
  for i in 0 1 2 3; do
    echo "  - {config: $PWD/configs/estimators/${files[$i]}.yaml, name: ${names[$i]}}"
  done
  echo "sequences:"
  for sequence in $(seq -f 's%03g' 0 "$2"); do
    echo "  - {config: $PWD/configs/datasets/figure8_short.yaml, name: $sequence, set: {duration_s: 20, path_m: 26}, seeds: $1}"
  done
  echo "metrics: {rpe: [8]}"
}
seeds=1000  # of a sequence, as many as a plan may have
last=$((cells / 4 / seeds - 1))
plan "[$first]" 0 >"$work/one.yaml"
plan "$first..$((first + seeds - 1))" "$last" >"$work/plan.yaml"
"$program" compare --plan="$work/one.yaml" --output="$work/one" --quiet >/dev/null
echo "estimator,sequence,seed" >"$work/cells.csv"
mkdir -p "$work/out"
for name in "${names[@]}"; do
  for sequence in $(seq -f 's%03g' 0 "$last"); do
    mkdir -p "$work/out/scores/$name/$sequence"
    # Every report with its own sequence and seed: key "seed" (5 bytes), type of a 32-bit number, the number.
    perl -e '
      my ($from, $folder, $sequence, $first, $count) = @ARGV;
      local $/;
      open(my $in, "<:raw", $from) or die;
      my $report = <$in>;
      $report =~ s/\x64s000/\x64$sequence/ or die "no sequence";
      for my $seed ($first .. $first + $count - 1) {
        (my $copy = $report) =~ s/\x64seed\x1a..../"\x64seed\x1a" . pack("N", $seed)/se or die "no seed";
        open(my $out, ">:raw", "$folder/$seed.cbor") or die;
        print $out $copy;
        close($out);
      }' "$work/one/scores/$name/s000/$first.cbor" "$work/out/scores/$name/$sequence" "$sequence" "$first" "$seeds"
    seq "$first" "$((first + seeds - 1))" | sed "s/^/$name,$sequence,/" >>"$work/cells.csv"
  done
done
mv "$work/cells.csv" "$work/out/cells.csv"

# measure NAME WORD ...
measure() {
  local name=$1
  shift
  /usr/bin/time --format="$name: %U s of user time, %e s, %M kB" "$program" "$@" >"$work/said.txt"
}
echo "$cells cells, $(du -sm "$work/out/scores" | cut -f1) MB of reports"
measure status compare --status="$work/out"
head -1 "$work/said.txt"
measure tables compare --quiet --plan="$work/plan.yaml" --output="$work/out" --stage=tables
(cd "$work/out" && du -m report.html report.json summary.csv)
