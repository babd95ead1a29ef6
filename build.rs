//! With the feature `embedded-units`: compiles the shared library of exported units and packs it for the program, so
//! that an installed program exports by itself.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    #[cfg(feature = "embedded-units")]
    embedded::library().expect("the library of exported units: build without `embedded-units` to do without it");
}

#[cfg(feature = "embedded-units")]
mod embedded {
    use std::env;
    use std::error::Error;
    use std::fs;
    use std::io::Write;
    use std::path::PathBuf;
    use std::process::Command;

    /// What the library is made of; the rest of the workspace may change without it.
    const SOURCES: [&str; 6] =
        ["Cargo.lock", "fmu/src", "fmu/build.rs", "fmu/Cargo.toml", "models", "scenarios/parameters"];

    pub fn library() -> Result<(), Box<dyn Error>> {
        SOURCES.iter().for_each(|source| println!("cargo::rerun-if-changed={source}"));
        let (out, target) = (PathBuf::from(env::var("OUT_DIR")?), env::var("TARGET")?);
        // A folder of its own: cargo holds the lock of the other one while this runs.
        let folder = out.join("units");
        let status = Command::new(env::var("CARGO")?)
            .args(["build", "--release", "--lib", "-p", "toolroom-fmu", "--target", &target, "--target-dir"])
            .arg(&folder)
            .current_dir(env::var("CARGO_MANIFEST_DIR")?)
            .env_remove("CARGO_ENCODED_RUSTFLAGS")
            .env_remove("RUSTC_WORKSPACE_WRAPPER")
            .env_remove("CARGO_BUILD_BUILD_DIR")
            .status()?;
        if !status.success() {
            return Err("cargo build -p toolroom-fmu failed".into());
        }
        let name = match env::var("CARGO_CFG_TARGET_OS")?.as_str() {
            "windows" => "toolroom_fmu.dll",
            "macos" => "libtoolroom_fmu.dylib",
            _ => "libtoolroom_fmu.so",
        };
        let library = fs::read(folder.join(target).join("release").join(name))?;
        let mut packed = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
        packed.write_all(&library)?;
        fs::write(out.join("units.zlib"), packed.finish()?)?;
        Ok(())
    }
}
