#!/usr/bin/env bash
# Feeds random inputs to every reader and to sessions of both back ends, under AddressSanitizer and UndefinedBehaviorSanitizer (libFuzzer;
# the targets are in tests/fuzz). What is found lies in build-dev/fuzz/findings/TARGET; inputs that reach new code are kept in
# build-dev/fuzz/corpus/TARGET, where the next call goes on. Once a finding is mended, its input belongs in tests/fuzz/inputs/TARGET.
# Exit code 1: something was found.
# Usage: scripts/fuzz.sh [SECONDS in all, default 600] [TARGET ...]   (scripts/fuzz.sh list: the targets)
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=${1:-600}
shift || true
scripts/build.sh dev alidade_fuzz alidade
build=$PWD/build-dev
if [[ $seconds == list ]]; then
  exec "$build/alidade_fuzz"
fi
mapfile -t targets < <(if [[ $# -gt 0 ]]; then printf '%s\n' "$@"; else "$build/alidade_fuzz"; fi)
fuzz=$build/fuzz

# Seeds: what the program itself writes and ships.
seed() {
  local target=$1
  shift
  mkdir -p "$fuzz/seeds/$target"
  cp -- "$@" "$fuzz/seeds/$target/"
}
if [[ ! -f $fuzz/seeds/complete ]]; then
  rm -rf "$fuzz/seeds"
  mkdir -p "$fuzz/seeds"
  work=$(mktemp -d)
  trap 'rm -rf "$work"' EXIT
  alidade() { "$build/alidade" "$@" --quiet >/dev/null; }
  small=max_features=10,imu_rate_hz=50,duration_s=1,path_m=2
  alidade simulate --config=gnss_figure8_short --set="$small,gnss.rate_hz=2,gnss.outage_s=0,gnss.clock_jump_at_s=-1" --output="$work/gnss"
  alidade simulate --config=fix_figure8 --set="$small,fix.rate_hz=5" --output="$work/fix"
  printf 'width_px: 64\nheight_px: 48\nfocal_px: 40\nduration_s: 0.2\npath_m: 0.3\nrender: {enabled: true}\n' >"$work/drawn.yaml"
  alidade simulate --config="$work/drawn.yaml" --output="$work/drawn"
  alidade run --dataset="$work/fix" --config=po_invio_multi --set=init.method=truth --output="$work/run"
  for name in gnss fix drawn; do
    alidade convert --dataset="$work/$name" --output="$work/$name.bag"
  done
  seed rinex_observation "$work"/gnss/mav0/gnss0/*.obs
  seed rinex_navigation "$work"/gnss/mav0/gnss0/*.nav
  seed tracks "$work/fix/mav0/cam0/tracks.csv"
  seed sheet "$work"/fix/mav0/fix0/sensor.yaml
  cp "$work/gnss/mav0/cam0/sensor.yaml" "$fuzz/seeds/sheet/camera.yaml"
  cp "$work/gnss/mav0/imu0/sensor.yaml" "$fuzz/seeds/sheet/imu.yaml"
  cp "$work/gnss/mav0/gnss0/sensor.yaml" "$fuzz/seeds/sheet/gnss.yaml"
  seed calibration tests/fuzz/seeds/calibration/*
  seed nmea tests/fuzz/seeds/nmea/*
  seed sp3 tests/fuzz/seeds/sp3/*
  seed rinex_clock tests/fuzz/seeds/rinex_clock/*
  seed compact_rinex tests/fuzz/seeds/compact_rinex/*
  seed trajectory tests/fuzz/seeds/trajectory/* "$work/run/trajectory.tum" "$work/run/states.csv"
  seed image "$work"/drawn/mav0/cam0/data/*.png
  seed hall "$work/drawn/mav0/cam0/hall.csv"
  seed times "$work/run/timing.csv"
  seed config configs/estimators/*.yaml
  seed simulator_config configs/datasets/*.yaml
  seed plan configs/plans/*.yaml
  seed catalogue configs/data/catalogue.yaml
  seed bag "$work"/*.bag
  # A file of a folder is given by its name in the first line.
  for pair in sequence:gnss sequence:fix run:run; do
    target=${pair%%:*}
    folder=$work/${pair#*:}
    mkdir -p "$fuzz/seeds/$target"
    (cd "$folder" && find . -type f -size -200k | sort) | while read -r file; do
      { echo "${file#./}" && cat "$folder/$file"; } >"$fuzz/seeds/$target/$(basename "$folder")_${file//\//_}"
    done
  done
  rm -rf "$work"
  touch "$fuzz/seeds/complete"
fi

# Runs one target; what it found is in its folder of findings.
fuzz_target() {
  local target=$1 limit=$2
  mkdir -p "$fuzz/corpus/$target" "$fuzz/findings/$target" "$fuzz/seeds/$target" "tests/fuzz/inputs"
  local folders=("$fuzz/corpus/$target" "$fuzz/seeds/$target")
  [[ -d tests/fuzz/inputs/$target ]] && folders+=("tests/fuzz/inputs/$target")
  ALIDADE_FUZZ_TARGET=$target OPENBLAS_NUM_THREADS=1 "$build/alidade_fuzz" -max_total_time="$limit" -timeout=30 -rss_limit_mb=2048 \
    -max_len=65536 -print_final_stats=1 -artifact_prefix="$fuzz/findings/$target/" "${folders[@]}" >"$fuzz/$target.log" 2>&1 || true
  local runs
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$fuzz/$target.log")
  printf '%-20s %10s inputs, %s findings\n' "$target" "${runs:-?}" "$(find "$fuzz/findings/$target" -type f | wc -l)"
}
export -f fuzz_target
export fuzz build
cores=$(nproc)
each=$((seconds * cores / ${#targets[@]}))
printf '%s\n' "${targets[@]}" | xargs -P "$cores" -I{} bash -c "fuzz_target {} $((each > 0 ? each : 1))"
found=$(find "$fuzz/findings" -type f | wc -l)
echo "$found findings in $fuzz/findings"
[[ $found -eq 0 ]]
