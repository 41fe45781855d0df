#!/usr/bin/env bash
# Measures `spp` on a long observation file under a bound of the address space: ten simulated minutes at 10 Hz with 28 satellites are
# repeated with later stamps (so satellites are where they were not, and most of the repeated epochs have no solution).
# Needs /usr/bin/time (Debian package time).
# Usage: scripts/long_rinex.sh [HOURS, default 1] [PROGRAM, default build/alidade] [KIB of address space, default 2097152]
set -euo pipefail
cd "$(dirname "$0")/.."

hours=${1:-1}
program=${2:-build/alidade}
kib=${3:-2097152}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

settings=duration_s=600,path_m=2500,gnss.rate_hz=10,gnss.outage_s=0,gnss.clock_jump_at_s=-1
"$program" simulate --config=gnss_figure8_short --set="$settings,max_features=10,imu_rate_hz=50,camera_rate_hz=1" \
  --output="$work/sim" --quiet
gnss=$work/sim/mav0/gnss0
# "> 2023 11 14 22 13 21.0000000  0 28", later by 600 s a copy; the days of November suffice.
awk -v copies="$((hours * 6))" '
  header { print; header = !/END OF HEADER/; next }
  { body[++lines] = $0 }
  END {
    for (copy = 0; copy < copies; ++copy)
      for (i = 1; i <= lines; ++i) {
        if (body[i] !~ /^>/) { print body[i]; continue }
        split(body[i], word, " ")
        at = ((word[4] * 24 + word[5]) * 60 + word[6]) * 600 + int(word[7] * 10 + 0.5) + copy * 6000
        printf "> %s %s %02d %02d %02d %010.7f%s\n", word[2], word[3], int(at / 864000), int(at / 36000) % 24, int(at / 600) % 60, at % 600 / 10, substr(body[i], 30)
      }
  }' header=1 "$gnss/obs.rnx" >"$work/long.rnx"
echo "$hours h: $(grep -c '^>' "$work/long.rnx") epochs, $(du -m "$work/long.rnx" | cut -f1) MB"
ulimit -v "$kib"
/usr/bin/time --format="spp: %U s of user time, %M kB" "$program" spp --obs="$work/long.rnx" --nav="$gnss/nav.rnx" --output="$work/long.pos" 2>&1 | tail -2
