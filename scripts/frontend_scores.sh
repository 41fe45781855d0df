#!/bin/bash
# Scores of the default front end and of plain Lucas-Kanade, with equal numbers of features, on sequences with images (docs/frontend.md):
#   scripts/frontend_scores.sh OUTPUT SEQUENCE...
# Prints a table and leaves each run in OUTPUT/<sequence>/<front end>, with the whole score in score.txt. ALIDADE: the program (build/alidade);
# SET: settings of both, a.b=v,...
set -euo pipefail

if [ $# -lt 2 ]; then
  echo "usage: $0 OUTPUT SEQUENCE..." >&2
  exit 2
fi
root=$(cd "$(dirname "$0")/.." && pwd)
program=${ALIDADE:-$root/build/alidade}
output=$1
shift

# A figure of score.json, or "-".
figure() {  # file, key
  local value
  value=$(sed -n "s/^  \"$2\": \([0-9][-+.0-9eE]*\),*$/\1/p" "$1")
  echo "${value:--}"
}

# "median / 95 %" of the corner error at an age, or "-".
corner() {  # file, age
  awk -F, -v age="$2" '$1 == age && $7 != "" { printf "%.2f / %.1f", $7, $8; found = 1 } END { if (!found) printf "-" }' "$1"
}

row='| %-16s | %-7s | %5.0f | %3.0f %% | %6.1f | %5.2f %% | %-10s | %-10s | %5.2f |\n'
echo "| images | front end | features | coverage | life | loss | corner, age 1 | corner, age 30 | CPU [ms] |"
echo "|---|---|---:|---:|---:|---:|---:|---:|---:|"
for sequence in "$@"; do
  for config in base frontends/plain_lk; do
    folder=$output/$(basename "$sequence")/$(basename "$config")
    mkdir -p "$folder"
    "$program" track --quiet --overwrite --score --dataset="$sequence" --config="$root/configs/$config.yaml" --set="${SET:-}" \
      --output="$folder" >"$folder.txt"
    mv "$folder.txt" "$folder/score.txt"
    json=$folder/score.json
    name=default
    [ "$config" = base ] || name=plain
    # shellcheck disable=SC2059
    printf "$row" "$(basename "$sequence")" "$name" "$(figure "$json" features_per_frame)" \
      "$(figure "$json" coverage | awk '{ print 100 * $1 }')" "$(figure "$json" mean_life_frames)" \
      "$(figure "$json" loss_share | awk '{ print 100 * $1 }')" "$(corner "$folder/score.csv" 1)" "$(corner "$folder/score.csv" 30)" \
      "$(figure "$json" cpu_ms)"
  done
done
