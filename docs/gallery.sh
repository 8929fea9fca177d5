#!/bin/sh
# Draws the figures of docs/gallery.md, and says the seconds of each. An argument names the program.
set -eu
cd "$(dirname "$0")/.."
casimir=${1:-casimir}
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT

# In the page: <!-- figure NAME FIGURE OPTIONS -->
sed -n 's/^<!-- figure \(.*\) -->$/\1/p' docs/gallery.md | while read -r name figure options; do
    before=$(date +%s%N)
    # shellcheck disable=SC2086
    "$casimir" run "scenes/$name.toml" $options --out "$results/$name" > /dev/null
    after=$(date +%s%N)
    cp "$results/$name/figures/$figure.svg" "docs/figures/gallery-$name.svg"
    echo "$name $(((after - before) / 100000000))" | sed 's/\(.\)$/.\1/; s/ \./ 0./'
done
