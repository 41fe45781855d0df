#!/usr/bin/env bash
# From a checkout to a comparison of ten estimators in minutes: builds, simulates, runs, prints the table.
# Usage: scripts/demo.sh [output folder]
set -euo pipefail
cd "$(dirname "$0")/.."

output=${1:-out/demo}
scripts/build.sh release alidade
build/alidade compare --plan=configs/plans/demo.yaml --output="$output" --overwrite --jobs="$(nproc)"
echo
echo "report: $(realpath "$output")/report.html"
