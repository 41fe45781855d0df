#!/usr/bin/env bash
# Kills every command that writes at random times (kill -9) and looks at what is left: each file is whole, or is not there; the command,
# run again, writes what an undisturbed run writes. Measured times are left out of the comparison.
# Usage: kill_test.sh PROGRAM SOURCE_DIR [KILLS a command, default 3] [SEED of the times, default 1]
set -euo pipefail
program=$1
source=$2
kills=${3:-3}
RANDOM=${4:-1}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
export ALIDADE_DATA_DIR=$source

"$program" simulate --config=figure8_short --set=duration_s=8,path_m=10 --output=tracks --quiet
cat >drawn.yaml <<EOF
name: drawn
duration_s: 3
path_m: 3.9
width_px: 320
height_px: 240
focal_px: 200
landmark_min_distance_m: 0.8
render: {enabled: true}
EOF
"$program" simulate --config=drawn.yaml --output=images --quiet
"$program" simulate --config=gnss_figure8_short --set=duration_s=5,path_m=6.5 --output=gnss --quiet
cat >plan.yaml <<EOF
set: {init.method: truth}
estimators: [$source/configs/estimators/alidade_filter.yaml, $source/configs/estimators/po_invio_multi.yaml]
sequences:
  - {config: $source/configs/datasets/figure8_short.yaml, name: short, set: {duration_s: 3, path_m: 3.9}, seeds: 1..4}
metrics: {rpe: [1]}
EOF

# What a command writes with --output=OUT. Its second word tells how an interrupted one is repeated.
commands=(
  "simulate --overwrite --config=figure8_short --set=duration_s=6,path_m=7.8"
  "simulate --overwrite --config=drawn.yaml"
  "track --overwrite --dataset=images"
  "run --overwrite --dataset=tracks --config=alidade_filter --set=init.method=truth"
  "run --overwrite --dataset=tracks --config=vins_mono_class --set=init.method=truth,smoother.window=5"
  "compare --resume --plan=plan.yaml --jobs=2 --figures=svg"
  "convert --overwrite --dataset=gnss"
  "convert --overwrite --dataset=gnss --compression=lz4"
  "refine_truth --overwrite --dataset=tracks"
)

# Checksums of all files below a folder without temporary ones, and without what measures time: timing.csv, the end of run.json,
# columns of times, and the tables and the report, which hold times throughout.
sums() {
  (cd "$1" && find . -type f ! -name '*.tmp*' ! -name '*.part' ! -name '*.running' ! -name timing.csv ! -name '*.cbor' ! -name 'tables.*' \
    ! -name 'report.*' ! -name '*_time.svg' | sort | while read -r file; do
    case $file in
      */run.json) echo "$file $(sed '/"times"/,$d' "$file" | sha256sum)" ;;
      *.csv) echo "$file $(without_times "$file" | sha256sum)" ;;
      *) echo "$file $(sha256sum <"$file")" ;;
    esac
  done)
}
without_times() {
  awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) keep[i] = $i !~ /_ms|^realtime_factor/ } { line = ""; for (i = 1; i <= NF; i++) if (keep[i]) line = line $i ","; print line }' "$1"
}

total=0
killed_early=0
for index in "${!commands[@]}"; do
  read -r command again rest <<<"${commands[$index]}"
  clean=clean_$index
  [[ $command == convert ]] && suffix=.bag || suffix=
  begin=$(date +%s%N)
  # shellcheck disable=SC2086
  "$program" $command $rest --output="$clean$suffix" --quiet >/dev/null
  length_ms=$((($(date +%s%N) - begin) / 1000000))
  expected=$(sums .  | grep "^\./$clean" | sed "s/$clean//")
  for ((kill = 0; kill < kills; ++kill)); do
    out=killed_${index}_$kill
    # shellcheck disable=SC2086
    "$program" $command $rest --output="$out$suffix" --quiet >/dev/null 2>&1 &
    process=$!
    sleep "$(printf '%d.%03d' $((RANDOM % (length_ms + 1) / 1000)) $((RANDOM % (length_ms + 1) % 1000)))"
    if kill -9 "$process" 2>/dev/null; then
      killed_early=$((killed_early + 1))
    fi
    wait "$process" 2>/dev/null || true
    # Workers of a killed comparison end by themselves.
    for wait in $(seq 100); do
      pgrep -f -- "--output=$out" >/dev/null || break
      sleep 0.05
    done
    left=$(sums . | grep "^\./$out" | sed "s/$out//" || true)
    # The tables of a comparison, and files that are replaced while it runs, may be of part of the cells.
    torn=$(comm -13 <(sort <<<"$expected") <(sort <<<"$left") | grep -v '^$' || true)
    if [[ -n "$torn" ]]; then
      echo "$command, killed: torn or wrong: $torn"
      exit 1
    fi
    # shellcheck disable=SC2086
    "$program" $command $again $rest --output="$out$suffix" --quiet >/dev/null
    repeated=$(sums . | grep "^\./$out" | sed "s/$out//")
    if [[ "$repeated" != "$expected" ]]; then
      echo "$command, killed and repeated: differs"
      diff <(echo "$expected") <(echo "$repeated") || true
      exit 1
    fi
    if [[ -n "$(find "$out"* -name '*.tmp*' -o -name '*.running' -o -name '*.part')" ]]; then
      echo "$command, killed and repeated: temporary files are left"
      exit 1
    fi
    if [[ $command == compare ]]; then  # made from the same cells once more, its tables and its report are the same
      mkdir "$out.tables"
      cp "$out"/*.* "$out/figures/short_time.svg" "$out.tables"
      # shellcheck disable=SC2086
      "$program" $command $again $rest --output="$out" --quiet >/dev/null
      for file in "$out.tables"/*; do
        cmp "$file" "$out/$(basename "$file")" 2>/dev/null || cmp "$file" "$out/figures/$(basename "$file")"
      done
      rm -rf "$out.tables"
    fi
    total=$((total + 1))
    rm -rf "$out$suffix"
  done
  echo "$command: $kills kills within ${length_ms} ms"
done
echo "$total kills, $killed_early of them before the end; nothing torn, repeated results equal"
