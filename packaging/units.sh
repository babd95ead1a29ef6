#!/usr/bin/env bash
# The eight ready units in dist/: three processes and the controller in FMI 2.0 and 3.0, each with the libraries of Linux
# (x86-64 and ARM, glibc 2.17 or later), Windows and macOS (both processors), and the libraries by themselves in dist/units.
#
#   packaging/units.sh target/release/toolroom                      compiles the libraries, all five
#   packaging/units.sh target/release/toolroom dist --libraries D   takes those of the folder D, PLATFORM/LIBRARY
#
# Compiling needs cargo-zigbuild and Zig (`pip install cargo-zigbuild ziglang`) and the targets:
#   rustup target add x86_64-unknown-linux-gnu aarch64-unknown-linux-gnu x86_64-pc-windows-gnu \
#                     x86_64-apple-darwin aarch64-apple-darwin
# A platform that is missing is an error; MISSING=allowed makes the units without it. Set SOURCE_DATE_EPOCH for a date in the
# descriptions: the same sources and date give the same bytes.
set -euo pipefail
toolroom=${1:?the program that exports} out=${2:-dist} given=
if [ "${3:-}" = --libraries ]; then given=${4:?folder of libraries}; fi
mkdir -p "$out"

if [ -z "$given" ]; then
  compiled=$(mktemp -d)
  trap 'rm -rf "$compiled"' EXIT
  "$toolroom" --force fmu export turning --fmi 3 --platforms all --out "$compiled/all.fmu"
  python3 -m zipfile -e "$compiled/all.fmu" "$compiled/all"
  given=$out/units
  # A package of FMI 3.0 has the universal library of macOS twice.
  for pair in x86_64-linux:x86_64-linux:libtoolroom_fmu.so aarch64-linux:aarch64-linux:libtoolroom_fmu.so \
    x86_64-windows:x86_64-windows:toolroom_fmu.dll x86_64-darwin:darwin:libtoolroom_fmu.dylib; do
    IFS=: read -r folder platform name <<<"$pair"
    for library in "$compiled/all/binaries/$folder"/*; do
      [ -f "$library" ] || continue
      mkdir -p "$given/$platform" && cp "$library" "$given/$platform/$name"
    done
  done
fi

# How old a Linux may be, where this can be looked up.
if command -v objdump >/dev/null; then
  for library in "$given"/x86_64-linux/*.so; do
    [ -f "$library" ] || continue
    newest=$(objdump -T "$library" | sed -n 's/.*GLIBC_\([0-9.]*\).*/\1/p' | sort -V | tail -1)
    echo "$library: glibc $newest or later"
    [ "$(printf '%s\n2.28\n' "$newest" | sort -V | tail -1)" = 2.28 ] || { echo "$library is for newer systems than glibc 2.28" >&2; exit 1; }
  done
fi

missing=
for platform in x86_64-linux aarch64-linux x86_64-windows darwin; do
  ls "$given/$platform"/*toolroom_fmu.* >/dev/null 2>&1 || missing="$missing $platform"
done
if [ -n "$missing" ]; then
  echo "no library for$missing" >&2
  [ "${MISSING:-}" = allowed ] || exit 1
fi

for model in turning milling infeed controller; do
  "$toolroom" --force fmu export "$model" --libraries "$given" --out "$out"
done
for unit in "$out"/toolroom_*.fmu; do
  "$toolroom" --quiet fmu check "$unit" >/dev/null || { echo "$unit is not sound" >&2; exit 1; }
done
(cd "$out" && sha256sum toolroom_*.fmu | tee UNITS.SHA256SUMS)
