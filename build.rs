//! With the feature `embedded-units`: compiles the shared library of exported units and packs it for the program, so
//! that an installed program exports by itself. The environment variable `TOOLROOM_UNITS_LIBRARY` names a library that is
//! already compiled, for packagers who cross-compile; it has to be one for the target of the program.

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
    use std::path::{Path, PathBuf};
    use std::process::Command;

    /// Names a library that is already compiled.
    const GIVEN: &str = "TOOLROOM_UNITS_LIBRARY";
    /// What the library is made of; the rest of the workspace may change without it.
    const SOURCES: [&str; 6] =
        ["Cargo.lock", "fmu/src", "fmu/build.rs", "fmu/Cargo.toml", "models", "scenarios/parameters"];

    pub fn library() -> Result<(), Box<dyn Error>> {
        println!("cargo::rerun-if-env-changed={GIVEN}");
        let out = PathBuf::from(env::var("OUT_DIR")?);
        let library = match env::var_os(GIVEN) {
            Some(given) => {
                let given = PathBuf::from(given);
                println!("cargo::rerun-if-changed={}", given.display());
                fs::read(&given).map_err(|error| format!("{GIVEN}={}: {error}", given.display()))?
            }
            None => compiled(&out)?,
        };
        let mut packed = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
        packed.write_all(&library)?;
        fs::write(out.join("units.zlib"), packed.finish()?)?;
        Ok(())
    }

    /// The library, compiled for the target of the program.
    fn compiled(out: &Path) -> Result<Vec<u8>, Box<dyn Error>> {
        SOURCES.iter().for_each(|source| println!("cargo::rerun-if-changed={source}"));
        let target = env::var("TARGET")?;
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
        Ok(fs::read(folder.join(target).join("release").join(name))?)
    }
}
