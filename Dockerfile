# toolroom in a container: docker build -t toolroom . && docker run --rm -v "$PWD:/work" toolroom compare scenario.toml
FROM rust:1.95-slim-bookworm AS build
WORKDIR /src
COPY . .
# The compiler of the image, and not the one that rust-toolchain.toml would fetch.
RUN RUSTUP_TOOLCHAIN=$RUST_VERSION cargo build --release --locked --features embedded-units

FROM debian:bookworm-slim
COPY --from=build /src/target/release/toolroom /usr/local/bin/toolroom
COPY --from=build /src/LICENSE-MIT /src/LICENSE-APACHE /usr/share/doc/toolroom/
# Files that it writes belong to whoever runs the container: docker run --user "$(id -u):$(id -g)".
WORKDIR /work
ENTRYPOINT ["toolroom"]
