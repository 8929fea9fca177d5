#!/bin/sh
# Draws the figures of the gallery in docs/scenes.md. An argument names the program to take.
set -eu
cd "$(dirname "$0")/.."
casimir=${1:-casimir}
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT

# In the page: <!-- figure NAME FIGURE -->
sed -n 's/^<!-- figure \(.*\) -->$/\1/p' docs/scenes.md | while read -r name figure; do
    "$casimir" run "scenes/$name.toml" --out "$results/$name" > /dev/null
    cp "$results/$name/figures/$figure.svg" "docs/figures/gallery-$name.svg"
    echo "$name: $figure"
done
