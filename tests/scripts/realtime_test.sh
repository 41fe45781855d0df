#!/usr/bin/env bash
# GIVEN a program whose runs have known times WHEN realtime.sh and parallel_study.sh run it THEN the printed factors and ratios are those
# of the times, on the first core that is allowed and in the locale C; and the real program accepts the plan.
# Usage: realtime_test.sh PROGRAM ROOT
set -euo pipefail
real=$1 root=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export LC_ALL=C.UTF-8  # in place of one with a decimal comma, which few machines have

# program NAME ROW: a command line that writes images at 20 Hz and two equal rows of timing.csv. It records its cores and fails in
# another locale than C.
program() {
  cat >"$work/$1" <<PROGRAM
#!/usr/bin/env bash
set -e
[[ \$LC_ALL == C ]]
for argument in "\$@"; do
  case "\$argument" in --output=*) output=\${argument#*=} ;; esac
done
case \$1 in
  simulate)
    mkdir -p "\$output/mav0/cam0"
    printf '#timestamp [ns],filename\n1000000000,a.png\n1050000000,b.png\n1100000000,c.png\n' >"\$output/mav0/cam0/data.csv" ;;
  run)
    mkdir -p "\$output"
    taskset -pc \$\$ >"$work/cores"
    printf '%s\n' 'timestamp_ns,frontend_ms,propagate_ms,update_ms,backend_ms,total_ms' '1050000000,$2' '1100000000,$2' >"\$output/timing.csv"
    printf '{\n  "times": {\n    "cpu_s": 0.004,\n    "wall_s": 1\n  }\n}\n' >"\$output/run.json" ;;
esac
PROGRAM
  chmod +x "$work/$1"
}
# expect PATTERN: in $output.
expect() {
  grep -qE "$1" <<<"$output" || { printf 'expected "%s", found:\n%s\n' "$1" "$output"; exit 1; }
}
program fast 3,0.1,0.5,1,5
program slow 8,0.1,0.5,4,12

last_core=$(taskset -pc $$ | sed 's/.*[^0-9]//')
output=$(taskset -c "$last_core" "$root/scripts/realtime.sh" --program="$work/fast" --against="$work/slow" \
  --against-configs="$root/configs" --rounds=2 --output="$work/out")
expect 'an image every 50 ms'
expect '^new +alidade_filter +ms +4\.000 +1\.000 +5\.000 +2\.000 '
expect '^new +alidade_smoother +x +12\.5 +50\.0 +10\.0 +25\.0 '
expect '^base +alidade_filter +ms +8\.000 +4\.000 +12\.000 +2\.000 '
expect '^new +alidade_filter +ratio +0\.500 +0\.250 +0\.417 +1\.000 '
output=$(cat "$work/cores")
expect ": $last_core\$"

cat >"$work/times.csv" <<EOF
jobs,round,wall_s,cpu_s
1,1,10,8
2,1,6,9
2,2,5,8
1,2,10,8
1,3,20,16
2,3,14,16
EOF
output=$("$root/scripts/parallel_study.sh" --times="$work/times.csv")
expect '^wall +10\.00 +6\.00 +0\.600  \(0\.500 to 0\.700\)$'
expect '^CPU +8\.00 +9\.00 +1\.000  \(1\.000 to 1\.125\)$'
"$root/scripts/parallel_study.sh" --program="$work/fast" --rounds=2 --output="$work/study" >/dev/null
output=$(cut -d, -f1,2 "$work/study/times.csv" | paste -sd' ')
expect '^jobs,round 1,1 2,1 2,2 1,2$'
"$root/scripts/parallel_study.sh" --program="$real" --seeds=1 --duration=10 --rounds=1 --output="$work/study" >/dev/null
