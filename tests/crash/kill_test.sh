#!/usr/bin/env bash
# Kills every command that writes files, and looks at what is left: each file is whole, or is not there; the command, run again, writes
# what an undisturbed run writes, and leaves no temporary file. In one folder it is killed at a random time (kill -9), and then in the midst
# of a write, by the signal of a limit of the size of files. Measured times are left out of the comparison (listing.pl).
# Usage: kill_test.sh PROGRAM SOURCE_DIR [KILLS at random times a command, default 3] [SEED of the times, default 1]
#                     [COMMANDS: a regular expression, only those that match it]
set -euo pipefail
program=$(realpath "$1")
source=$(realpath "$2")
kills=${3:-3}
RANDOM=${4:-1}
only=${5:-}
here=$(dirname "$(realpath "$0")")

work=$(mktemp -d)
server=
trap '[[ -z "$server" ]] || kill "$server"; rm -rf "$work"' EXIT
trap 'echo "line $LINENO: $BASH_COMMAND: exit code $?"' ERR
cd "$work"
export ALIDADE_DATA_DIR=$source
export SOURCE_DATE_EPOCH=0  # the day in reports
ulimit -c 0

# What a command writes into the folder OUT. Its second word gives how an interrupted one is repeated; -: as it was begun.
commands=(
  "simulate --overwrite --config=figure8_short --set=duration_s=6,path_m=7.8 --output=OUT"
  "simulate --overwrite --config=drawn.yaml --output=OUT"
  "track --overwrite --dataset=images --score --overlay=10 --output=OUT"
  "run --overwrite --dataset=tracks --config=alidade_filter --set=init.method=truth --output=OUT"
  "run --overwrite --dataset=brief --config=alidade_filter --set=init.method=truth --audit --output=OUT"
  "run --overwrite --dataset=tracks --config=vins_mono_class --set=init.method=truth,smoother.window=5 --output=OUT"
  "run --overwrite --dataset=brief --config=batch --set=init.method=truth --output=OUT"
  "run --overwrite --dataset=gnss --config=gnss_imu --set=init.method=truth --output=OUT"
  "evaluate - --truth=tracks/mav0/state_groundtruth_estimate0/data.csv --estimate=refined/mav0/state_groundtruth_estimate0/data.csv --export=OUT"
  "compare --resume --plan=plan.yaml --jobs=2 --figures=svg --output=OUT"
  "starts - --plan=starts.yaml --starts=3 --limit=2 --output=OUT/starts.csv"
  "identify --overwrite --dataset=rest --output=OUT"
  "identify --overwrite --dataset=brief --motion --set=init.method=truth --output=OUT"
  "calibrate --overwrite --dataset=without_sheet --set=init.method=truth --output=OUT"
  "spp --overwrite --obs=gnss/mav0/gnss0/obs.rnx --nav=gnss/mav0/gnss0/nav.rnx --output=OUT/rover.pos"
  "convert --overwrite --dataset=gnss --output=OUT/gnss.bag"
  "convert --overwrite --dataset=gnss --compression=lz4 --output=OUT/gnss.bag"
  "convert --overwrite --dataset=tracks.bag --calibration=camchain.yaml --output=OUT"
  "convert --overwrite --calibration=camchain.yaml --output=OUT"
  "refine_truth --overwrite --dataset=tracks --output=OUT"
  "data - fetch parcel --catalogue=catalogue.yaml --mirror=MIRROR --output=OUT"
)

# Every command whose help names a flag of an output is among them.
for command in $("$program" help | sed -n '/^Commands:/,/^$/s/^  \([a-z_][a-z_]*\)  .*/\1/p'); do
  [[ $command == help ]] && continue
  flags=$("$program" "$command" --help)
  if [[ $flags == *$'\n  --output '* || $flags == *$'\n  --export '* ]]; then
    [[ $'\n'$(printf '%s\n' "${commands[@]}") == *$'\n'"$command "* ]] || { echo "$command writes files and is not killed here"; exit 1; }
  fi
done

"$program" simulate --config=figure8_short --set=duration_s=8,path_m=10 --output=tracks --quiet
"$program" simulate --config=figure8_short --set=duration_s=2.5,path_m=3.2,max_features=20 --output=brief --quiet
cat >drawn.yaml <<END
name: drawn
duration_s: 3
path_m: 3.9
width_px: 320
height_px: 240
focal_px: 200
landmark_min_distance_m: 0.8
render: {enabled: true}
END
"$program" simulate --config=drawn.yaml --output=images --quiet
"$program" simulate --config=gnss_figure8_short --set=duration_s=5,path_m=6.5 --output=gnss --quiet
"$program" refine_truth --dataset=tracks --output=refined --quiet >/dev/null
"$program" convert --dataset=tracks --output=tracks.bag --quiet
cp -r tracks without_sheet
rm without_sheet/mav0/imu0/sensor.yaml
cat >plan.yaml <<END
set: {init.method: truth}
estimators: [$source/configs/estimators/alidade_filter.yaml, $source/configs/estimators/po_invio_multi.yaml]
sequences:
  - {config: $source/configs/datasets/figure8_short.yaml, name: short, set: {duration_s: 3, path_m: 3.9}, seeds: 1..4}
  - {path: $work/images, name: drawn}
metrics: {rpe: [1]}
END
cat >starts.yaml <<END
estimators: [$source/configs/estimators/alidade_filter.yaml]
sequences:
  - {config: $source/configs/datasets/figure8_short.yaml, name: short, set: {duration_s: 8, path_m: 10}, seeds: [1]}
END
cat >camchain.yaml <<END
cam0:
  T_cam_imu: [[0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 0], [0, 0, 0, 1]]
  camera_model: pinhole
  distortion_coeffs: [0, 0, 0, 0]
  distortion_model: radtan
  intrinsics: [460, 460, 376, 240]
  resolution: [752, 480]
END
# 30 s at 50 Hz.
mkdir -p rest/mav0/imu0
cp tracks/mav0/imu0/sensor.yaml rest/mav0/imu0
{
  head -1 tracks/mav0/imu0/data.csv
  awk 'BEGIN {
    srand(1)
    for (i = 0; i < 1500; i++) {
      printf "%d0000000", 1000 + 2 * i
      for (axis = 0; axis < 6; axis++) printf ",%.6f", (axis < 3 ? 0.01 : 0.1) * (rand() - 0.5) + (axis == 5 ? 9.81 : 0)
      print ""
    }
  }'
} >rest/mav0/imu0/data.csv
mkdir served
cp tracks/mav0/imu0/data.csv served/parcel
cat >catalogue.yaml <<END
datasets:
  - name: parcel
    title: a file
    page: http://127.0.0.1/
    base: http://127.0.0.1/
    files: [{name: parcel, file: parcel, path: parcel, bytes: $(stat -c %s served/parcel), sha256: $(sha256sum <served/parcel | cut -d' ' -f1)}]
END
"$here/slow_server.pl" served >port 2>/dev/null &
server=$!
for _ in $(seq 1200); do
  [[ -s port ]] && break
  sleep 0.05
done
mirror=http://127.0.0.1:$(cat port)/

# Starts a command with the words of `commands` into a folder.
run_into() {  # folder, words...
  local out=$1
  shift
  local words=("${@//OUT/$out}")
  [[ $1 == evaluate ]] || words+=(--quiet)
  exec "$program" "${words[@]//MIRROR/$mirror}"
}

fail() {
  echo "$*"
  exit 1
}

beside() {  # all files but those in a folder
  find . -path "./$1" -prune -o -type f -print | sort
}

# Whatever a killed command left in a folder is in the listing of an undisturbed run.
expect_whole() {  # what, folder, expected listing
  local torn
  torn=$(comm -13 <(sort <<<"$3") <("$here/listing.pl" "$2" | sort) | grep -v '^$' || true)
  [[ -z "$torn" ]] || fail "$1: torn or wrong: $torn"
}

# Limits in the midst of the smallest file, which the first file to be written does not pass either, and of a random one. Only that of the
# report ends a comparison: the rest is written by its workers, whose deaths it outlives.
size_limits() {  # folder of an undisturbed run
  local sizes
  if [[ -e $1/report.html ]]; then
    sizes=("$(stat -c %s "$1/report.html")")
  else
    mapfile -t sizes < <(find "$1" -type f -size +0 -printf '%s\n' | sort -nu)
    sizes=("${sizes[0]}" "${sizes[RANDOM % ${#sizes[@]}]}")
  fi
  printf '%s\n' "${sizes[@]}" | sort -nu | while read -r size; do echo $((size / 2)); done
}

total=0
killed_early=0
in_writes=0
for index in "${!commands[@]}"; do
  [[ "${commands[$index]}" =~ $only ]] || continue
  read -r command repeat words <<<"${commands[$index]}"
  read -ra words <<<"$words"
  again=()
  [[ $repeat == - ]] || again=("$repeat")
  clean=clean_$index
  begin=$(date +%s%N)
  (run_into "$clean" "$command" "${words[@]}") >/dev/null || fail "$command ${words[*]}: exit code $?"
  length_ms=$((($(date +%s%N) - begin) / 1000000))
  expected=$("$here/listing.pl" "$clean")
  [[ -n "$expected" ]] || fail "$command wrote no file"
  for ((kill = 0; kill < kills; ++kill)); do
    out=killed_${index}_$kill
    before=$(beside "$out")
    limits=$(size_limits "$clean")

    run_into "$out" "$command" "${words[@]}" >/dev/null 2>&1 &
    process=$!
    sleep "$(printf '%d.%03d' $((RANDOM % (length_ms + 1) / 1000)) $((RANDOM % (length_ms + 1) % 1000)))"
    if kill -9 "$process" 2>/dev/null; then
      killed_early=$((killed_early + 1))
    fi
    wait "$process" 2>/dev/null || true
    # Workers of a killed comparison end by themselves.
    for _ in $(seq 1200); do
      pgrep -f -- "--output=$out" >/dev/null || break
      sleep 0.05
    done
    expect_whole "$command, killed" "$out" "$expected"

    for limit in $limits; do
      # What is there is not fetched again. A download killed after its last byte has only to be checked and renamed.
      [[ $command == data && ( -e $out/parcel/parcel || $(stat -c %s "$out/parcel/parcel.part" 2>/dev/null) == $(stat -c %s served/parcel) ) ]] && continue
      code=0
      { (prlimit --pid "$BASHPID" --fsize="$limit" && run_into "$out" "$command" "${again[@]}" "${words[@]}"); } >/dev/null 2>&1 || code=$?
      [[ $code -eq $((128 + $(kill -l XFSZ))) ]] || fail "$command, with files of at most $limit bytes: exit code $code, expected the end by SIGXFSZ"
      expect_whole "$command, killed in a write of more than $limit bytes" "$out" "$expected"
      in_writes=$((in_writes + 1))
    done

    (run_into "$out" "$command" "${again[@]}" "${words[@]}") >/dev/null || fail "$command, killed and repeated: exit code $?"
    repeated=$("$here/listing.pl" "$out")
    if [[ "$repeated" != "$expected" ]]; then
      diff <(echo "$expected") <(echo "$repeated") || true
      fail "$command, killed and repeated: differs"
    fi
    left=$(find "$out" -name '*.tmp*' -o -name '*.running' -o -name '*.part' -o -name provisional)
    [[ -z "$left" ]] || fail "$command, killed and repeated: temporary files are left: $left"
    [[ "$(beside "$out")" == "$before" ]] || fail "$command, killed and repeated: files are left beside its output: $(beside "$out" | comm -13 <(echo "$before") -)"

    if [[ $command == compare ]]; then  # made from the same cells once more, its tables and its report are the same
      mkdir "$out.tables"
      cp "$out"/*.* "$out"/figures/*_time.svg "$out.tables"
      (run_into "$out" "$command" "${again[@]}" "${words[@]}") >/dev/null
      for file in "$out.tables"/*; do
        cmp "$file" "$out/$(basename "$file")" 2>/dev/null || cmp "$file" "$out/figures/$(basename "$file")"
      done
      rm -rf "$out.tables"
    fi
    total=$((total + 1))
    rm -rf "$out"
  done
  echo "$command ${words[*]}: $kills kills within ${length_ms} ms, and in writes"
done
echo "$total kills at random times, $killed_early of them before the end, and $in_writes in writes; nothing torn, repeated results equal"
