#!/usr/bin/env bash
# Release archives in dist/: the program with manual pages, completions and licences, and SHA256SUMS.
#
#   packaging/release.sh                                  Linux (glibc 2.28 or later) and Windows, both x86_64
#   packaging/release.sh x86_64-unknown-linux-musl        single targets, static here
#
# Needs cargo-zigbuild and Zig (`pip install cargo-zigbuild`), and the targets (`rustup target add …`). Units of others
# (feature fmu-import) need libclang of the build machine and are left out. Where packaging/units.sh has made dist/units, the
# archives have it as units/ beside the program, which then exports units for every platform, and the program has the library of
# its own platform inside.
set -euo pipefail
cd "$(dirname "$0")/.."
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(x86_64-unknown-linux-gnu.2.28 x86_64-pc-windows-gnu)
version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -1)
command -v cargo-zigbuild >/dev/null || { echo "cargo-zigbuild is not there: pip install cargo-zigbuild" >&2; exit 1; }

# Pages that are the same on every platform, by the program of this machine.
cargo build --profile quick --locked
pages=target/release-pages
rm -rf "$pages" && mkdir -p "$pages/completions"
target/quick/toolroom reference --man "$pages/man" --quiet
for shell in bash zsh fish powershell; do target/quick/toolroom completions $shell >"$pages/completions/toolroom.$shell"; done

mkdir -p dist
for target in "${targets[@]}"; do
  # The part behind a dot is the version of glibc, which the folder of results does not have.
  plain=${target%%.*}
  case $plain in
    x86_64-unknown-linux-*) library=dist/units/x86_64-linux/libtoolroom_fmu.so ;;
    aarch64-unknown-linux-*) library=dist/units/aarch64-linux/libtoolroom_fmu.so ;;
    x86_64-pc-windows-*) library=dist/units/x86_64-windows/toolroom_fmu.dll ;;
    *-apple-darwin) library=dist/units/darwin/libtoolroom_fmu.dylib ;;
    *) library= ;;
  esac
  if [ -n "$library" ] && [ -f "$library" ]; then export TOOLROOM_UNITS_LIBRARY=$PWD/$library; else unset TOOLROOM_UNITS_LIBRARY; fi
  cargo zigbuild --release --locked --features embedded-units --target "$target"
  name=toolroom-$version-$plain
  stage=target/release-stage/$name
  rm -rf "$stage" && mkdir -p "$stage"
  cp README.md CHANGELOG.md CITATION.cff LICENSE-APACHE LICENSE-MIT "$stage"
  cp -r "$pages/man" "$pages/completions" "$stage"
  if [ -d dist/units ]; then cp -r dist/units "$stage/units"; fi
  rm -f "$stage/man/.toolroom.json"
  if [ -f "target/$plain/release/toolroom.exe" ]; then
    cp "target/$plain/release/toolroom.exe" "$stage"
    (cd target/release-stage && python3 -m zipfile -c "../../dist/$name.zip" "$name")
  else
    cp "target/$plain/release/toolroom" "$stage"
    # Same content, same archive.
    tar --sort=name --mtime='2026-01-01' --owner=0 --group=0 -C target/release-stage -czf "dist/$name.tar.gz" "$name"
  fi
done
(cd dist && sha256sum toolroom-"$version"-* >SHA256SUMS && cat SHA256SUMS)
