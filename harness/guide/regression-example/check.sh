#!/bin/sh
# Runs the scenario and compares every link of its drag with the pinned ones. Exit status: 0 the same to the last bit,
# 3 not the same (out/difference.json says where), 2 wrong input.
# More words go to `bitgrain run`. BITGRAIN names the program, OUT a folder for results, which is emptied first: what an
# older program computed proves nothing.
set -eu
cd "$(dirname "$0")"
out=${OUT:-out}
rm -rf "$out" "$out-beds"
exec "${BITGRAIN:-bitgrain}" run drag.toml --out "$out" --beds "$out-beds" --against pinned.chain.csv "$@"
