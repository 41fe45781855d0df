#!/bin/bash
# Scores of the default front end and of plain Lucas-Kanade, with equal numbers of features, on sequences with images (docs/frontend.md):
#   scripts/frontend_scores.sh OUTPUT SEQUENCE...
# Prints the scores and leaves each run in OUTPUT/<sequence>/<front end>. ALIDADE: the program (build/alidade); SET: settings of both, a.b=v,...
set -euo pipefail

if [ $# -lt 2 ]; then
  echo "usage: $0 OUTPUT SEQUENCE..." >&2
  exit 2
fi
root=$(cd "$(dirname "$0")/.." && pwd)
program=${ALIDADE:-$root/build/alidade}
output=$1
shift
for sequence in "$@"; do
  for config in base frontends/plain_lk; do
    name=$(basename "$sequence")/$(basename "$config")
    echo "== $name"
    "$program" track --quiet --overwrite --score --dataset="$sequence" --config="$root/configs/$config.yaml" --set="${SET:-}" \
      --output="$output/$name" | tail -n +3
  done
done
