#!/usr/bin/env bash
# Names every #include that runs against the order of scripts/layers.txt. Usage: scripts/check_layers.sh [root]
# Exit code 1: there are some, or a folder with sources is missing in the list.
set -euo pipefail
root=${1:-$(dirname "$0")/..}
cd "$root"

folders=()
for folder in core gnss frontend estimator filter smoother eval; do
  [[ -d $folder ]] && folders+=("$folder")
done
grep -rn --include='*.h' --include='*.cc' -E '^ *# *include *["<]' "${folders[@]}" | awk '
  # The room of a path: the entry that is the path up to some slash.
  function room_of(path,   known) {
    for (known in rank) if (index(path, known "/") == 1) return known
    return ""
  }
  function begins_with_one(text, list,   words, n, i) {
    n = split(list, words, " ")
    for (i = 1; i <= n; i++) if (index(text "/", words[i]) == 1) return 1
    return 0
  }
  function fault(text) { print where ": " text; bad = 1 }
  FNR == NR {
    sub(/#.*/, "")
    if ($1 == "package") { name = $2; $1 = $2 = ""; packages[name] = $0 }
    else if (NF) { name = $1; rank[name] = ++count; $1 = ""; sub(/^ *not/, ""); excluded[name] = $0 }
    next
  }
  {
    split($0, part, ":")
    where = part[1] ":" part[2]
    from = room_of(part[1])
    if (from == "") { fault("its folder is not in scripts/layers.txt"); next }
    header = $0
    sub(/^[^"<]*["<]/, "", header)
    sub(/[">].*/, "", header)
    to = room_of(header)
    if (to != "" && rank[to] > rank[from]) fault(from " includes " header ", which comes later in scripts/layers.txt")
    if (to != "" && to != from && begins_with_one(to, excluded[from])) fault(from " must not include " header)
    for (name in packages)
      if (index(header, name) == 1 && !begins_with_one(from, packages[name]))
        fault(from " must not include <" header ">: only" packages[name] " may")
  }
  END { exit bad }
' scripts/layers.txt -
