# For tests of scripts that compare two files; to be sourced.
# expect_change SCRIPT FIRST CODE TEXT SED_PROGRAM: what SCRIPT --compare prints and returns for FIRST and the file that the sed program
# makes of it.
expect_change() {
  local code=0 output changed
  changed=$(dirname "$2")/changed.csv
  sed "$5" "$2" >"$changed"
  output=$("$1" --compare "$2" "$changed") || code=$?
  if [[ $code -ne $3 || $output != *"$4"* ]]; then
    printf 'with %s: code %s, expected %s; output, expected "%s":\n%s\n' "$5" "$code" "$3" "$4" "$output"
    exit 1
  fi
}
