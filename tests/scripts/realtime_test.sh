#!/usr/bin/env bash
# GIVEN a program whose runs have known times WHEN realtime.sh and parallel_study.sh run it THEN the printed factors and ratios are those
# of the times; and the real program accepts the plan.
# Usage: realtime_test.sh PROGRAM ROOT
set -euo pipefail
real=$1 root=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# program NAME HEADER ROW: a command line that writes images at 20 Hz, two equal rows of timing.csv, and compares in 1.2 s / jobs.
program() {
  cat >"$work/$1" <<PROGRAM
#!/usr/bin/env bash
set -e
for argument in "\$@"; do
  case "\$argument" in --output=*) output=\${argument#*=} ;; --jobs=*) jobs=\${argument#*=} ;; esac
done
case \$1 in
  simulate)
    mkdir -p "\$output/mav0/cam0"
    printf '#timestamp [ns],filename\n1000000000,a.png\n1050000000,b.png\n1100000000,c.png\n' >"\$output/mav0/cam0/data.csv" ;;
  run)
    mkdir -p "\$output"
    printf '%s\n' 'timestamp_ns,$2' '1050000000,$3' '1100000000,$3' >"\$output/timing.csv"
    printf '{\n  "times": {\n    "cpu_s": 0.004,\n    "wall_s": 1\n  }\n}\n' >"\$output/run.json" ;;
  compare) sleep "\$(awk -v jobs="\$jobs" 'BEGIN { print 1.2 / jobs }')" ;;
esac
PROGRAM
  chmod +x "$work/$1"
}
# expect PATTERN: in $output.
expect() {
  grep -qE "$1" <<<"$output" || { printf 'expected "%s", found:\n%s\n' "$1" "$output"; exit 1; }
}
columns=frontend_ms,propagate_ms,update_ms,backend_ms,total_ms
program separate "$columns,decode_ms" 4,0.1,0.5,1,5,3
program together "$columns" 8,0.1,0.5,4,12

output=$("$root/scripts/realtime.sh" --program="$work/separate" --against="$work/together" --against-configs="$root/configs" --rounds=2 \
  --output="$work/out")
expect 'an image every 50 ms'
expect '^new +alidade_filter +ms +3\.000 +1\.000 +1\.000 +5\.000 +2\.000 '
expect '^new +alidade_smoother +x +16\.7 +50\.0 +50\.0 +10\.0 +25\.0 '
expect '^base +alidade_filter +ms +- +8\.000 +4\.000 +12\.000 +2\.000 '
expect '^new +alidade_filter +ratio +- +0\.125 +0\.250 +0\.417 +1\.000 '

output=$("$root/scripts/parallel_study.sh" --program="$work/separate" --rounds=1 --output="$work/study")
expect '^wall +[1-9][0-9.]* +[0-9.]+ +0\.[3-9]'
"$root/scripts/parallel_study.sh" --program="$real" --seeds=1 --duration=10 --rounds=1 --output="$work/study" >/dev/null
