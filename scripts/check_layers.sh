#!/usr/bin/env bash
# Names every #include that runs against the order of scripts/layers.txt, and circles of units within a room.
# A unit is a header with the sources that implement it: the source of its name, and every source without a header of its own
# that includes this header first of all headers of its room. Usage: scripts/check_layers.sh [root]
# Exit code 1: there are some, or a folder with sources is missing in the list.
set -euo pipefail
root=${1:-$(dirname "$0")/..}
cd "$root"

folders=()
for folder in core gnss frontend filter smoother eval; do
  [[ -d $folder ]] && folders+=("$folder")
done
grep -rn --include='*.h' --include='*.cc' -E '^ *# *include *["<]' "${folders[@]}" | LC_ALL=C sort -t: -k1,1 -k2,2n | awk '
  # The room of a path: the longest entry that is the path up to some slash.
  function room_of(path,   known, room) {
    for (known in rank) if (index(path, known "/") == 1 && length(known) > length(room)) room = known
    return room
  }
  function begins_with_one(text, list,   words, n, i) {
    n = split(list, words, " ")
    for (i = 1; i <= n; i++) if (index(text "/", words[i]) == 1) return 1
    return 0
  }
  function fault(text) { print where ": " text; bad = 1 }
  function stem_of(path) { sub(/[.][a-z]+$/, "", path); return path }
  # Edges from the unit of a file to those of the headers of its room that it includes.
  function add_edges(path,   headers, n, i, unit, to) {
    n = split(own_room[path], headers, " ")
    unit = stem_of(path)
    if (path ~ /[.]cc$/ && index(own_room[path] " ", " " unit ".h ") == 0) unit = stem_of(headers[1])
    if (!(unit in targets)) { units[++unit_count] = unit; targets[unit] = "" }
    for (i = 1; i <= n; i++) {
      to = stem_of(headers[i])
      if (to == unit || (unit, to) in via) continue
      via[unit, to] = path
      targets[unit] = targets[unit] " " to
    }
  }
  # Depth first; trail[1 .. depth] is the way to the unit.
  function visit(unit, depth,   next_units, n, i) {
    trail[depth] = unit
    open[unit] = depth
    n = split(targets[unit], next_units, " ")
    for (i = 1; i <= n; i++) {
      if (next_units[i] in open) { if (open[next_units[i]]) print_circle(open[next_units[i]], depth) }
      else visit(next_units[i], depth + 1)
    }
    open[unit] = 0
  }
  function print_circle(first, last,   i, to, text) {
    text = "circle of units: " trail[first]
    for (i = first; i <= last; i++) {
      to = i < last ? trail[i + 1] : trail[first]
      text = text " -> " to " (" via[trail[i], to] ")"
    }
    print text
    bad = 1
  }
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
    if (to == from) {
      if (!(part[1] in own_room)) files[++file_count] = part[1]
      own_room[part[1]] = own_room[part[1]] " " header
    }
  }
  END {
    for (f = 1; f <= file_count; f++) add_edges(files[f])
    for (u = 1; u <= unit_count; u++) if (!(units[u] in open)) visit(units[u], 1)
    exit bad
  }
' scripts/layers.txt -
