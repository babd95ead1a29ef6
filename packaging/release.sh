#!/usr/bin/env bash
# Release archives in dist/: the program with manual pages, completions and licences, and SHA256SUMS.
#
#   packaging/release.sh                                  Linux (glibc 2.28 or later) and Windows, both x86_64
#   packaging/release.sh x86_64-unknown-linux-musl        single targets, static here
#
# Needs cargo-zigbuild and Zig (`pip install cargo-zigbuild`), and the targets (`rustup target add …`). Units of others
# (feature fmu-import) need libclang of the build machine and are left out.
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
  cargo zigbuild --release --locked --features embedded-units --target "$target"
  name=toolroom-$version-$plain
  stage=target/release-stage/$name
  rm -rf "$stage" && mkdir -p "$stage"
  cp README.md CHANGELOG.md CITATION.cff LICENSE-APACHE LICENSE-MIT "$stage"
  cp -r "$pages/man" "$pages/completions" "$stage"
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
