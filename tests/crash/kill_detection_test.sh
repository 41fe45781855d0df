#!/usr/bin/env bash
# GIVEN a program that writes a file under its own name WHEN it is killed in a write THEN kill_test.sh finds the torn file. GIVEN outputs
# of two runs THEN the listing differs when a figure does, and not when a measured time does.
# Usage: kill_detection_test.sh PROGRAM SOURCE_DIR
set -euo pipefail
program=$(realpath "$1")
source=$(realpath "$2")
here=$(dirname "$(realpath "$0")")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# The first time the positions are those of the program; afterwards, under a limit of the size, they are written without a temporary
# name. Without a limit the file appears whole, so that a kill at a random time never finds it torn before the limit does.
cat >torn <<END
#!/usr/bin/env bash
output=
for word in "\$@"; do
  case \$word in --output=*) output=\${word#--output=} ;; esac
done
if [[ \$1 != spp || -z \$output ]]; then
  exec "$program" "\$@"
elif [[ ! -e $work/rover.pos ]]; then
  "$program" "\$@" && cp "\$output" $work/rover.pos
else
  mkdir -p "\$(dirname "\$output")"
  if [[ \$(ulimit -f) == unlimited ]]; then
    cp $work/rover.pos "$work/\$BASHPID" && exec mv "$work/\$BASHPID" "\$output"
  fi
  exec cat $work/rover.pos >"\$output"
fi
END
chmod +x torn
if output=$("$here/kill_test.sh" ./torn "$source" 1 1 '^spp ' 2>&1) || [[ $output != *"spp, killed in a write of more than "*"torn or wrong: OUT/rover.pos "* ]]; then
  echo "a torn file, output: $output"
  exit 1
fi

# expect same|other FILE SED_PROGRAM: the listing of a file that the program has changed.
expect() {
  local verdict=other
  mkdir changed
  sed "$3" "one/$2" >"changed/$2"
  cmp -s "one/$2" "changed/$2" && { echo "$2: '$3' changes nothing"; exit 1; }
  mkdir original
  cp "one/$2" original
  [[ "$("$here/listing.pl" original)" == "$("$here/listing.pl" changed)" ]] && verdict=same
  [[ $verdict == "$1" ]] || { echo "$2 changed by '$3': found $verdict, expected $1"; exit 1; }
  rm -r original changed
}
mkdir one
cat >one/summary.csv <<END
estimator,calibration_time_ms,backend_ms,backend_ms_p95,realtime_factor,mode,message
a,1.5,2.5,3.5,4.5,causal,"b, c"
END
expect same summary.csv 's/,2.5,3.5,4.5,/,7,8,,/'
expect other summary.csv 's/,1.5,/,1.6,/'
expect other summary.csv 's/b, c/b, d/'
expect other summary.csv 's/,realtime_factor//'
cat >one/aggregate.csv <<END
estimator,completion_mean,backend_ms_mean,backend_ms_se,backend_ms_max
a,1,2.5,3.5,4.5
END
expect same aggregate.csv 's/2.5,3.5,4.5/7,8,9/'
expect other aggregate.csv 's/a,1,/a,2,/'
cat >one/tables.md <<'END'
## s

| estimator | ATE pos. \[m\] | back end \[ms\] | x real time \[s/s\] | NEES verdict |
|:---|---:|---:|---:|---:|
| a | 0.119 ± 0.047 ≈ | **4.97 ± 1.34** | 24.7 | consistent |
| b | **0.087** | 5.18 | 23.3 | consistent |

## Front end: tracks an image, their length, their end, and time

| sequence | thinned (%) | ms a frame | 95 % of frames |
|:---|---:|---:|---:|
| s | 1.25 | 2.25 | 3.25 |
END
expect same tables.md 's/\*\*4.97 ± 1.34\*\*/6/; s/5.18/**5.18**/; s/23.3/–/; s/ 2.25/ 12.25/; s/3.25/4/'
expect other tables.md 's/0.087/0.088/'
expect other tables.md 's/ ≈//'
expect other tables.md 's/1.25/1.26/'
expect other tables.md 's/back end .\[ms.\]/back end/'
cat >one/tables.tex <<'END'
    \toprule
    estimator & ATE pos. [m] & back end [ms] & NEES verdict \\
    \midrule
    {a} & {0.119 $\pm$ 0.047} & \textbf{4.97 $\pm$ 1.34} & {consistent} \\
    {b} & \textbf{0.087} & {5.18} & {consistent} \\
    \bottomrule
    \toprule
    sequence & thinned (\%) & 95 \% of frames \\
    \midrule
    {s} & {1.25} & {3.25} \\
    \bottomrule
END
expect same tables.tex 's/\\textbf{4.97 $\\pm$ 1.34}/{6}/; s/5.18/7/; s/3.25/4/'
expect other tables.tex 's/0.087/0.088/'
expect other tables.tex 's/1.25/1.26/'
expect other tables.tex 's/ \\midrule//'
cat >one/report.json <<'END'
{
 "figures": [{"key": "ate_pos_m", "label": "ATE pos."}, {"key": "backend_ms", "label": "back end"}],
 "aggregate": [{"means": [0.25, 4.5], "errors": [0.75, 0.5], "best": [0, 1]}],
 "frontends": [{"lost": 1.5, "mean_ms": 2.5, "p95_ms": null}],
 "cells": [{"figures": [0.125, 5.5], "stages": [null, 6.5], "nis": [7.5, 8.5]}]
}
END
expect same report.json 's/ 4.5\]/ null]/; s/, 0.5\]/, 2]/; s/, 1\]/, 0]/; s/ 2.5/ 3/; s/null}/4}/; s/5.5/6/; s/null, 6.5/1, 2/'
for change in 's/0.25/0.26/' 's/0.75/0.76/' 's/\[0, /[1, /' 's/0.125/1/' 's/ 1.5/ 2/' 's/8.5/9/' 's/backend_ms/other/'; do
  expect other report.json "$change"
done
{
  printf '<noscript><pre>s\n'
  cat <<'END'
  estimator  ATE pos. [m]  back end [ms]  gated 
  ----------------------------------------------
  a         0.119±0.047 ≈      4.97±1.34* 0.011*
  b                 0.087*          5.18  0.013 
END
  printf '\n</pre></noscript>\n<script type="application/json" id="data">%s</script>\n' "$(tr -d '\n' <one/report.json)"
} >one/report.html
expect same report.html 's/4.97±1.34\*/1.97±1.34 /; s/ 5.18 /15.18*/; s/5.5/6/; s/ 4.5\]/ null]/'
# Longer times make a wider column.
expect same report.html 's/back end \[ms\]/  &/; s/4.97±1.34/104.97±1.34/; s/5.18/  &/; s/^  -*$/&--/'
for change in 's/0.087/0.088/' 's/0.011\*/0.012*/' 's/0.047 ≈/0.047  /' 's/0.125/1/'; do
  expect other report.html "$change"
done
printf '<svg width="2">\n<path d="M1 2"/>\n</svg>\n' >one/s_time.svg
cp one/s_time.svg one/s_nees.svg
expect same s_time.svg 's/M1/M3/'
expect other s_time.svg 's/<.svg>//'
expect other s_nees.svg 's/M1/M3/'
# {"backend_ms": 1.5, "frames": 300, "names": ["ab"]}, the time as a float of single or double precision
printf '\xa3\x6abackend_ms\xfa\x3f\xc0\x00\x00\x66frames\x19\x01\x2c\x65names\x81\x62ab' >one/1.cbor
export LC_ALL=C
expect same 1.cbor 's/\xfa\x3f\xc0\x00\x00/\xfb\x3f\xf9\x99\x99\x99\x99\x99\x9a/'
expect other 1.cbor 's/\x19\x01\x2c/\x19\x01\x2d/'
expect other 1.cbor 's/ab$/ac/'
expect other 1.cbor 's/ab$/a/'
