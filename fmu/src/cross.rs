//! Libraries for other platforms, through cargo-zigbuild.

use crate::{Binary, Platform};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Why there is no library for another platform.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CrossError {
    /// The sources that this program was made of.
    #[error("the sources of this program are not where it was built; other platforms cannot be compiled for")]
    NoSources,
    /// `cargo zigbuild`.
    #[error("cargo-zigbuild is not installed; it compiles for other platforms")]
    NoZigbuild,
    /// Rust's standard library of a target.
    #[error("Rust's standard library for {target} is not installed")]
    NoTarget {
        /// The target.
        target: String,
    },
    /// The compiler.
    #[error("{target} cannot be compiled for: {reason}")]
    Refused {
        /// The target.
        target: String,
        /// What the compiler says first.
        reason: String,
    },
    /// The compiler does not start.
    #[error("cargo-zigbuild does not start: {0}")]
    Start(std::io::Error),
    /// A library that was compiled and is not there.
    #[error("{path} cannot be read: {source}")]
    Unreadable {
        /// Where it should be.
        path: String,
        /// What the system says.
        source: std::io::Error,
    },
}

impl CrossError {
    /// The likely fix; none where the work failed although the computer is set up for it.
    pub fn fix(&self) -> Option<String> {
        Some(match self {
            Self::NoSources => "run it in its source folder with `cargo run -- fmu export …`".to_owned(),
            Self::NoZigbuild => {
                "pip install cargo-zigbuild ziglang, and rustup target add for each platform".to_owned()
            }
            Self::NoTarget { target } => format!("rustup target add {target}"),
            Self::Refused { .. } => "pip install ziglang brings zig, which cargo-zigbuild links with".to_owned(),
            Self::Start(_) | Self::Unreadable { .. } => return None,
        })
    }
}

/// Where cargo keeps the sources of other crates.
fn cargo_home() -> PathBuf {
    let home = || std::env::home_dir().unwrap_or_default().join(".cargo");
    std::env::var_os("CARGO_HOME").map_or_else(home, PathBuf::from)
}

/// The cross compiler.
#[derive(Clone, Debug)]
pub struct Compiler {
    sources: PathBuf,
}

impl Compiler {
    /// The cross compiler of this computer, with the sources that this program was built from.
    ///
    /// # Errors
    /// [`CrossError::NoSources`], [`CrossError::NoZigbuild`].
    pub fn find() -> Result<Self, CrossError> {
        let sources = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new(""));
        if !sources.join("fmu/Cargo.toml").is_file() {
            return Err(CrossError::NoSources);
        }
        let answers =
            Command::new("cargo-zigbuild").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
        if !answers.is_ok_and(|status| status.success()) {
            return Err(CrossError::NoZigbuild);
        }
        Ok(Self { sources: sources.to_owned() })
    }

    /// The library of `platform`, compiled with optimisation; `began` hears of each target before it is compiled for.
    ///
    /// # Errors
    /// [`CrossError`]: what is missing, or what the compiler says.
    pub fn library(&self, platform: Platform, began: &dyn Fn(&str)) -> Result<Vec<u8>, CrossError> {
        let thin: Vec<Vec<u8>> =
            platform.targets().iter().map(|target| self.compile(platform, target, began)).collect::<Result<_, _>>()?;
        match <[Vec<u8>; 1]>::try_from(thin) {
            Ok([library]) => Ok(library),
            Err(thin) => Ok(Binary::universal(&thin)),
        }
    }

    fn compile(&self, platform: Platform, target: &str, began: &dyn Fn(&str)) -> Result<Vec<u8>, CrossError> {
        began(target);
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
            .map_err(CrossError::Start)?;
        if !output.status.success() {
            return Err(refusal(&String::from_utf8_lossy(&output.stderr), name));
        }
        let path = folder.join(name).join("release").join(platform.library_name());
        std::fs::read(&path).map_err(|source| CrossError::Unreadable { path: path.display().to_string(), source })
    }
}

/// What the compiler said.
fn refusal(said: &str, target: &str) -> CrossError {
    let target = target.to_owned();
    if said.contains("target may not be installed") {
        return CrossError::NoTarget { target };
    }
    let first = said.lines().find(|line| line.to_lowercase().starts_with("error")).unwrap_or("see cargo zigbuild");
    CrossError::Refused { target, reason: first.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_that_is_not_installed_is_told_with_the_command() {
        let said = "error[E0463]: can't find crate for `core`\n  = note: the `t` target may not be installed\n";
        let error = refusal(said, "t");
        assert_eq!(error.to_string(), "Rust's standard library for t is not installed");
        assert_eq!(error.fix().as_deref(), Some("rustup target add t"));
        assert_eq!(
            refusal("   Compiling x\nError: no zig\n", "t").to_string(),
            "t cannot be compiled for: Error: no zig"
        );
    }
}
