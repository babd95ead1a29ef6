#!/usr/bin/env bash
# Wheels of the Python package in dist/: one for every Python from 3.9 on (abi3), by platform.
#
#   packaging/wheels.sh                             this machine's platform; on Linux for glibc 2.28 or later
#   packaging/wheels.sh aarch64-unknown-linux-gnu   others, with Zig as linker
#
# Needs maturin and Zig: pip install "maturin[zig]".
set -euo pipefail
cd "$(dirname "$0")/.."
command -v maturin >/dev/null || { echo "maturin is not there: pip install 'maturin[zig]'" >&2; exit 1; }
options=(--release --locked --out dist --manifest-path python/Cargo.toml)
[ "$(uname)" = Linux ] && options+=(--zig --compatibility manylinux_2_28)
if [ $# -eq 0 ]; then
  maturin build "${options[@]}"
else
  for target in "$@"; do maturin build "${options[@]}" --target "$target"; done
fi
