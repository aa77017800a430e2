#!/bin/sh
# Pins the links that this program gives: after a change that is meant to change results. OUT is emptied first.
set -eu
cd "$(dirname "$0")"
out=${OUT:-out}
rm -rf "$out" "$out-beds"
"${BITGRAIN:-bitgrain}" run drag.toml --out "$out" --beds "$out-beds"
cp "$out/runs/run-1/chain.csv" pinned.chain.csv
