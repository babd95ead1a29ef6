#!/bin/sh
# The eight ready units, three processes and the controller in FMI 2.0 and 3.0, each with the libraries of every platform that can be compiled for:
#
#     fmu/conformance/ready.sh target/release/toolroom dist
#
# `toolroom fmu export` says which platforms it left out and why; docs/guide/fmu-import.md says what they need. Set
# SOURCE_DATE_EPOCH for a date in the descriptions: the same sources and date give the same bytes.
set -eu
toolroom=${1:?the program that exports} out=${2:?folder of the units}
for model in turning milling infeed controller; do
  "$toolroom" --force fmu export "$model" --platforms all --out "$out"
done
for unit in "$out"/*.fmu; do
  "$toolroom" --quiet fmu check "$unit" >/dev/null || { echo "$unit is not sound" >&2; exit 1; }
done
