#!/usr/bin/env bash
# GIVEN two files states.csv WHEN compare_compilers.sh compares them THEN the largest difference of each quantity is printed, and one
# above the bound in any column, a NaN, a blank, a missing row and another header fail; so do a
# missing file of two folders and folders without any.
# Usage: compare_compilers_test.sh SCRIPT
set -euo pipefail
script=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cat >"$work/first.csv" <<EOF
timestamp_ns,p_x,p_y,p_z,q_w,v_x,c_00,clock_m
1000000000,1,2,-3,1,0.5,1e-05,
2000000000,1.5,2,-3.5,1,0.25,1e-05,200000
EOF
# shellcheck source=tests/scripts/expect_change.sh
source "$(dirname "$0")/expect_change.sh"
expect() { expect_change "$script" "$work/first.csv" "$@"; }
expect 0 "p 0.0e+00  q 0.0e+00  v 0.0e+00  c 0.0e+00  gnss 0.0e+00" ""
expect 0 "p 5.0e-07" "s/-3.5/-3.5000005/"
expect 1 "p 2.0e-06" "s/-3.5/-3.500002/"
expect 1 "v 1.0e-05" "s/0.25/0.25001/"
expect 0 "gnss 5.0e-07" "s/,200000$/,200000.1/"
expect 1 "gnss 5.0e-06" "s/,200000$/,200001/"
expect 1 "column 4 at 2000000000 is -3.5 and nan" "s/-3.5/nan/"
expect 1 "column 4 at 2000000000 is -3.5 and inf" "s/-3.5/inf/"
expect 1 "column 8 at 2000000000 is 200000 and " "s/,200000$/,/"
expect 1 "rows differ" "3d"
expect 1 "rows differ" "s/^2000000000/2000000001/"
expect 1 "columns differ" "s/p_z/p_w/"

# A NaN of both is no agreement either.
sed -i "s/-3.5/nan/" "$work/first.csv"
expect 1 "column 4 at 2000000000 is nan and nan" ""

# Two folders: each file of either of them counts, and none is a failure.
# expect_folders CODE TEXT: of the folders first and second.
expect_folders() {
  local code=0 output
  output=$("$script" --compare "$work/first" "$work/second" 2>&1) || code=$?
  if [[ $code -ne $1 || $output != *"$2"* ]]; then
    printf 'two folders: code %s, expected %s; output, expected "%s":\n%s\n' "$code" "$1" "$2" "$output"
    exit 1
  fi
}
mkdir -p "$work/first/a/1" "$work/second/a/1" "$work/second/b/2"
expect_folders 1 "no states.csv below"
sed "s/nan/-3.5/" "$work/first.csv" | tee "$work/first/a/1/states.csv" >"$work/second/a/1/states.csv"
expect_folders 0 "p 0.0e+00"
sed "s/-3.5/-3.4/" "$work/first/a/1/states.csv" >"$work/second/a/1/states.csv"
expect_folders 1 "p 1.0e-01"
cp "$work/first/a/1/states.csv" "$work/second/a/1/states.csv"
cp "$work/first/a/1/states.csv" "$work/second/b/2/states.csv"
expect_folders 1 "b/2"
