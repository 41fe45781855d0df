#!/bin/bash
# Renders the sequences of configs/datasets/hard_pixels and scores the default front end and plain Lucas-Kanade on each (docs/frontend.md):
#   scripts/hard_pixels.sh OUTPUT SEED [SETTINGS]
# SETTINGS: of the simulation, a.b=v,...; hybrid_dataset=FOLDER takes the motion and the IMU of a recording. EFFECTS: names of the sequences
# (all); JOBS: threads that draw; ALIDADE, SET: as of scripts/frontend_scores.sh, which prints the table at the end. Sequences that exist in
# OUTPUT/sequences are not drawn again.
set -euo pipefail

if [ $# -lt 2 ]; then
  echo "usage: $0 OUTPUT SEED [SETTINGS]" >&2
  exit 2
fi
root=$(cd "$(dirname "$0")/.." && pwd)
export ALIDADE=${ALIDADE:-$root/build/alidade}
output=$1
seed=$2
settings=${3:-}
effects=${EFFECTS:-easy noise exposure vignetting defocus rolling_shutter motion_blur repetitive poor_texture moving reflections all}
sequences=()
for effect in $effects; do
  sequence=$output/sequences/$effect
  if [ ! -e "$sequence/mav0/cam0/data.csv" ]; then
    "$ALIDADE" simulate --quiet --overwrite --config="$root/configs/datasets/hard_pixels/$effect.yaml" --seed="$seed" --set="$settings" \
      --jobs="${JOBS:-1}" --output="$sequence"
  fi
  sequences+=("$sequence")
done
"$root/scripts/frontend_scores.sh" "$output/scores" "${sequences[@]}"
