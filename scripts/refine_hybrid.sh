#!/usr/bin/env bash
# Refines the truth of the EuRoC and TUM-VI sequences that the hybrid plans fly along (docs/refined_truth.md).
# Usage: scripts/refine_hybrid.sh DATA OUT
#   DATA  holds euroc/ and tumvi/ with the sequences; images are not needed
#   OUT   gets the same folders: the --data of configs/plans/filters_hybrid_euroc.yaml and smoothers_hybrid.yaml
set -euo pipefail
if [[ $# -ne 2 ]]; then
  echo "usage: scripts/refine_hybrid.sh DATA OUT" >&2
  exit 2
fi
data=$(realpath "$1")
mkdir -p "$2"
out=$(realpath "$2")
cd "$(dirname "$0")/.."

refine() {
  local sequence=$1
  shift
  echo "$sequence"
  build/alidade refine_truth --dataset="$data/$sequence" --output="$out/$sequence" "$@"
}

# Vicon and Leica truth of EuRoC is smoothed: over seconds its errors are correlated.
for sequence in V1_02_medium V2_01_easy V2_02_medium; do
  refine "euroc/$sequence" --truth_rate=0.5
done
# The recomputed truth was made with this IMU; the official one is independent, and the rotation of its body is found.
official=$data/euroc/V1_01_easy/mav0/state_groundtruth_estimate0/data.csv
refine euroc/V1_01_easy --truth_rate=0.5 --truth="$official"
# The orientation of the machine hall's truth was computed with this IMU: its fit does not show its error. The vehicle
# stands for ten seconds; with fewer poses the refined truth creeps there.
for sequence in MH_03_medium MH_05_difficult; do
  refine "euroc/$sequence" --truth_rate=2 --truth_std_deg=0.2
done
# Motion capture as it was recorded; the IMU has scale errors.
for sequence in room1 room3 room5; do
  refine "tumvi/$sequence" --truth_rate=2 --imu_scale
done
