//! Which libraries go into a package, and where they come from.

use crate::cross::{Compiler, CrossError};
use crate::package::{Binary, Platform};
use std::path::PathBuf;

/// Why a library is not to be had.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LibraryError {
    /// One that has to be compiled.
    #[error(transparent)]
    Cross(#[from] CrossError),
    /// That of this computer is not where the program looks.
    #[error("the library {name} is not beside the program in {}", .folder.display())]
    Missing {
        /// Name of the file.
        name: String,
        /// Folder of the program.
        folder: PathBuf,
    },
    /// The one inside the program cannot be unpacked.
    #[error("the library in this program is damaged: {0}")]
    Damaged(std::io::Error),
}

impl LibraryError {
    /// The likely fix; none where the work failed although the computer is set up for it.
    pub fn fix(&self) -> Option<String> {
        match self {
            Self::Cross(error) => error.fix(),
            Self::Missing { .. } => Some(
                "build the program with `--features embedded-units`, which puts the library into it, or copy the \
                 library that `cargo build -p toolroom-fmu` makes there"
                    .to_owned(),
            ),
            Self::Damaged(_) => None,
        }
    }
}

/// The library for this computer, which was built with the program and lies beside it.
///
/// # Errors
/// [`LibraryError::Missing`].
pub fn library_beside_program(platform: Platform) -> Result<Vec<u8>, LibraryError> {
    let name = platform.library_name();
    let folder =
        std::env::current_exe().ok().and_then(|program| Some(program.parent()?.to_owned())).unwrap_or_default();
    // Cargo leaves it among the dependencies; an installed program has it beside itself.
    let places: [PathBuf; 4] = [
        folder.join("deps").join(&name),
        folder.join(&name),
        folder.join("../lib").join(&name),
        folder.join("../deps").join(&name),
    ];
    let found = places.iter().find_map(|place| std::fs::read(place).ok());
    found.ok_or(LibraryError::Missing { name, folder })
}

/// Libraries of the `wanted` platforms by name, each once and in a fixed order: `host` is this computer, which is meant
/// where nothing is, `all` whatever can be had. `own` gives the library for this computer; `say` hears what is compiled
/// and what is left out.
///
/// # Errors
/// [`LibraryError`] of a platform that was named.
pub fn libraries(
    wanted: &[String],
    embedded: &dyn Fn(Platform) -> Result<Vec<u8>, LibraryError>,
    say: &dyn Fn(String),
) -> Result<Vec<Binary>, LibraryError> {
    let host = Platform::host();
    let named = |word: &String| -> Vec<Platform> {
        let is_wanted = |platform: &Platform| match word.as_str() {
            "host" => Some(*platform) == host,
            "all" => true,
            name => platform.name() == name,
        };
        Platform::ALL.into_iter().filter(is_wanted).collect()
    };
    let mut platforms: Vec<Platform> = wanted.iter().flat_map(named).collect();
    if wanted.is_empty() {
        platforms.extend(host);
    }
    platforms.sort_unstable();
    platforms.dedup();
    let every = wanted.iter().any(|word| word == "all");
    let cross = Compiler::find();
    let began = |target: &str| say(format!("compiling for {target} …"));
    let mut binaries = Vec::new();
    for platform in platforms {
        // With the cross compiler at hand this computer's library is made for old C libraries too.
        let library = match &cross {
            Ok(compiler) if Some(platform) != host || !wanted.is_empty() => {
                compiler.library(platform, &began).map_err(LibraryError::Cross)
            }
            _ if Some(platform) == host => embedded(platform),
            _ => Compiler::find().and_then(|compiler| compiler.library(platform, &began)).map_err(LibraryError::Cross),
        };
        match library {
            Ok(library) => binaries.push(Binary { platform, library }),
            // With `all` the package has what can be had.
            Err(error) if every && Some(platform) != host => say(format!("left out {}: {error}", platform.name())),
            Err(error) => return Err(error),
        }
    }
    Ok(binaries)
}
