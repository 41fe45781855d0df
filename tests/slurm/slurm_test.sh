#!/usr/bin/env bash
# GIVEN a plan of 200 cells WHEN it runs on a Slurm cluster one node of which dies and comes back THEN no cell is lost, and what it
# wrote is, but for measured times, what --jobs=2 writes.
# Usage: slurm_test.sh PROGRAM SOURCE_DIR
set -euo pipefail
program=$1
source=$2
. "$source/tests/slurm/cluster.sh"
need_slurm

work=$(mktemp -d)
cluster=$work/cluster
trap 'stop_cluster; rm -rf "$work"' EXIT
start_cluster
cd "$work"

cat >plan.yaml <<EOF
title: "A cluster"
set: {init.method: truth}
estimators:
$(for i in 1 2 3 4; do
  echo "  - {config: $source/configs/estimators/po_invio_two.yaml, name: window_$i, set: {filter.window: $((4 + i))}}"
done)
sequences:
  - {config: $source/configs/datasets/figure8_short.yaml, name: short, set: {duration_s: 4, path_m: 5.2}, seeds: 1..50}
metrics: {rpe: [1]}
EOF
"$program" compare --plan=plan.yaml --output=local --jobs=2 --quiet >/dev/null

"$program" compare --plan=plan.yaml --output=cluster_run --engine=slurm --slurm_options="--partition=all --time=5" >slurm.txt 2>&1 &
waiting=$!
for i in $(seq 600); do
  done_cells=$(find cluster_run/scores -name '*.cbor' 2>/dev/null | wc -l || true)
  [[ $done_cells -ge 20 ]] && break
  sleep 0.1
done
[[ $done_cells -lt 190 ]] || { echo "too late to kill a node: $done_cells cells"; exit 1; }
for i in $(seq 2000); do
  killed=$(kill_busy_node node1)
  [[ $killed -ge 2 ]] && break
  sleep 0.01
done
[[ $killed -ge 2 ]] || { echo "no task was hit"; exit 1; }
"$program" compare --status=cluster_run | head -1
sleep 8  # SlurmdTimeout: the node is declared dead, its job requeued
start_node node1
if ! wait "$waiting"; then
  tail --lines=30 slurm.txt "$cluster"/*.log
  exit 1
fi
requeued=$(grep -c "Requeuing JobId" "$cluster/slurmctld.log" || true)
[[ $requeued -ge 1 ]] || { echo "no job was requeued"; tail --lines=30 "$cluster/slurmctld.log"; exit 1; }
grep -q "jobs .* of Slurm; .scancel" slurm.txt
"$program" compare --status=cluster_run | grep -q "^200 of 200 cells are complete, 0 of them failed"

# Everything but timing.csv, the times at the end of run.json, and the columns and places of the tables that hold times.
plain() {
  (cd "$1" && find . -type f ! -name timing.csv ! -path './scores/*' ! -path './slurm/*' ! -name '*.html' ! -name 'report.json' \
    ! -name 'tables.*' ! -name summary.csv ! -name aggregate.csv | sort | while read -r file; do
    echo "$file $(sed '/"times"/,$d' "$file" | sha256sum)"
  done)
}
diff <(plain local) <(plain cluster_run)
# columns FILE: without those of times, which are named *_ms and realtime_factor*.
columns() {
  awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) keep[i] = $i !~ /_ms|^realtime_factor/ } { line = ""; for (i = 1; i <= NF; i++) if (keep[i]) line = line $i ","; print line }' "$1"
}
diff <(columns local/summary.csv) <(columns cluster_run/summary.csv)
echo "200 cells are equal, $requeued jobs were requeued"
