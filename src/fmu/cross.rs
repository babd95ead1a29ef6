//! Libraries for other platforms, through cargo-zigbuild.

use crate::failure::Failure;
use crate::speak::Voice;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use toolroom_fmu::{Binary, Platform};

/// What is needed to compile for other platforms and is not there.
#[derive(Clone, Copy)]
pub enum Missing {
    /// The sources that this program was made of.
    Sources,
    /// `cargo zigbuild`.
    Zigbuild,
}

impl Missing {
    pub fn failure(self) -> Failure {
        match self {
            Self::Sources => Failure::argument(
                "the sources of this program are not where it was built; other platforms cannot be compiled for",
                "run it in its source folder with `cargo run -- fmu export …`",
            ),
            Self::Zigbuild => Failure::argument(
                "cargo-zigbuild is not installed; it compiles for other platforms",
                "pip install cargo-zigbuild ziglang, and rustup target add for each platform",
            ),
        }
    }
}

/// Where cargo keeps the sources of other crates.
fn cargo_home() -> PathBuf {
    let home = || std::env::home_dir().unwrap_or_default().join(".cargo");
    std::env::var_os("CARGO_HOME").map_or_else(home, PathBuf::from)
}

/// The cross compiler.
pub struct Compiler {
    sources: PathBuf,
}

impl Compiler {
    pub fn find() -> Result<Self, Missing> {
        let sources = Path::new(env!("CARGO_MANIFEST_DIR"));
        if !sources.join("fmu/Cargo.toml").is_file() {
            return Err(Missing::Sources);
        }
        let answers =
            Command::new("cargo-zigbuild").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
        if !answers.is_ok_and(|status| status.success()) {
            return Err(Missing::Zigbuild);
        }
        Ok(Self { sources: sources.to_owned() })
    }

    /// The library of `platform`, compiled with optimisation.
    pub fn library(&self, platform: Platform, voice: &Voice) -> Result<Vec<u8>, Failure> {
        let thin: Vec<Vec<u8>> =
            platform.targets().iter().map(|target| self.compile(platform, target, voice)).collect::<Result<_, _>>()?;
        match <[Vec<u8>; 1]>::try_from(thin) {
            Ok([library]) => Ok(library),
            Err(thin) => Ok(Binary::universal(&thin)),
        }
    }

    fn compile(&self, platform: Platform, target: &str, voice: &Voice) -> Result<Vec<u8>, Failure> {
        voice.say(format_args!("compiling for {target} …"));
        // The version of the C library is no part of the target's name.
        let name = target.strip_suffix(".2.17").unwrap_or(target);
        let folder = self.sources.join("target");
        // A library tells nobody where it was built.
        let flags = [(self.sources.clone(), "toolroom"), (cargo_home(), "cargo")]
            .map(|(folder, name)| format!("--remap-path-prefix={}={name} ", folder.display()))
            .concat();
        // Nor does its own name, which macOS takes from where it was linked.
        let id =
            if platform == Platform::UniversalMac { "-Clink-arg=-Wl,-install_name,@rpath/toolroom.dylib " } else { "" };
        let output = Command::new("cargo-zigbuild")
            .args(["zigbuild", "--release", "--lib", "-p", "toolroom-fmu", "--target", target, "--target-dir"])
            .arg(&folder)
            .current_dir(&self.sources)
            .env("RUSTFLAGS", flags + id + "-Cstrip=symbols")
            .env("MACOSX_DEPLOYMENT_TARGET", "11.0")
            .output()
            .map_err(|error| Failure::Work { message: format!("cargo-zigbuild does not start: {error}") })?;
        if !output.status.success() {
            return Err(refusal(&String::from_utf8_lossy(&output.stderr), name));
        }
        let path = folder.join(name).join("release").join(platform.library_name());
        std::fs::read(&path)
            .map_err(|error| Failure::Work { message: format!("{} cannot be read: {error}", path.display()) })
    }
}

/// What the compiler said, with the likely fix.
fn refusal(said: &str, target: &str) -> Failure {
    if said.contains("target may not be installed") {
        let help = format!("rustup target add {target}");
        return Failure::argument(format_args!("Rust's standard library for {target} is not installed"), help);
    }
    let first = said.lines().find(|line| line.to_lowercase().starts_with("error")).unwrap_or("see cargo zigbuild");
    let help = "pip install ziglang brings zig, which cargo-zigbuild links with";
    Failure::argument(format_args!("{target} cannot be compiled for: {first}"), help)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_that_is_not_installed_is_told_with_the_command() {
        let said = "error[E0463]: can't find crate for `core`\n  = note: the `t` target may not be installed\n";
        let Failure::Argument { message, help } = refusal(said, "t") else { panic!("another failure") };
        assert_eq!(
            (message.as_str(), help.as_deref()),
            ("Rust's standard library for t is not installed", Some("rustup target add t"),)
        );
        let Failure::Argument { message, .. } = refusal("   Compiling x\nError: no zig\n", "t") else {
            panic!("another failure")
        };
        assert_eq!(message, "t cannot be compiled for: Error: no zig");
    }
}
