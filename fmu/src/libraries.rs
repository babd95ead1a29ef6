//! Which libraries go into a package, and where they come from.

use crate::cross::{Compiler, CrossError};
use crate::package::{Binary, Platform};
use std::path::{Path, PathBuf};

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
    /// One that a folder of libraries does not have.
    #[error("{} is not there: the library for {platform}", .path.display())]
    NotInFolder {
        /// Where it should be.
        path: PathBuf,
        /// Name of the platform.
        platform: &'static str,
    },
    /// One that is for another platform, or no library at all.
    #[error("{} is no library for {platform}", .path.display())]
    Wrong {
        /// The file.
        path: PathBuf,
        /// Name of the platform.
        platform: &'static str,
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
            Self::NotInFolder { .. } => Some(
                "packaging/units.sh makes a folder of libraries, one below it for each platform by its name".to_owned(),
            ),
            Self::Wrong { .. } => Some("compile it with packaging/units.sh".to_owned()),
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

/// Name of the folder of libraries that may lie beside an installed program.
const FOLDER: &str = "units";

/// The folder of libraries beside the program, where there is one.
fn folder_beside_program() -> Option<PathBuf> {
    let folder = std::env::current_exe().ok()?.parent()?.to_owned();
    [folder.join(FOLDER), folder.join("../lib/toolroom").join(FOLDER)].into_iter().find(|folder| folder.is_dir())
}

/// The library of `platform` in a folder that holds one for each, `PLATFORM/NAME_OF_LIBRARY`.
///
/// # Errors
/// [`LibraryError::NotInFolder`], and [`LibraryError::Wrong`] where the file is for another platform.
pub fn library_of_folder(folder: &Path, platform: Platform) -> Result<Vec<u8>, LibraryError> {
    let path = folder.join(platform.name()).join(platform.library_name());
    let Ok(library) = std::fs::read(&path) else {
        return Err(LibraryError::NotInFolder { path, platform: platform.name() });
    };
    if platform.is_library(&library) {
        Ok(library)
    } else {
        Err(LibraryError::Wrong { path, platform: platform.name() })
    }
}

/// Where libraries come from.
pub struct Sources<'a> {
    /// A folder that holds those that are compiled already ([`library_of_folder`]). Where it is not given, one called
    /// `units` beside the program is looked into first, and what it does not have is compiled.
    pub folder: Option<&'a Path>,
    /// The library for this computer.
    pub own: &'a dyn Fn(Platform) -> Result<Vec<u8>, LibraryError>,
    /// Hears what is compiled and what is left out.
    pub say: &'a dyn Fn(String),
}

impl Sources<'_> {
    /// Libraries of the `wanted` platforms by name, each once and in a fixed order: `host` is this computer, which is
    /// meant where nothing is and no folder is given; `all` whatever can be had, which is meant with a folder.
    ///
    /// # Errors
    /// [`LibraryError`] of a platform that was named, and of a file that is no library.
    pub fn libraries(&self, wanted: &[String]) -> Result<Vec<Binary>, LibraryError> {
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
            platforms = if self.folder.is_some() { Platform::ALL.to_vec() } else { host.into_iter().collect() };
        }
        platforms.sort_unstable();
        platforms.dedup();
        let every = wanted.iter().any(|word| word == "all") || wanted.is_empty() && self.folder.is_some();
        let mut binaries = Vec::new();
        for platform in platforms {
            match self.library(platform, wanted.is_empty()) {
                Ok(library) => binaries.push(Binary { platform, library }),
                Err(error @ LibraryError::Wrong { .. }) => return Err(error),
                // With `all` the package has what can be had.
                Err(error) if every && (Some(platform) != host || self.folder.is_some()) => {
                    (self.say)(format!("left out {}: {error}", platform.name()));
                }
                Err(error) => return Err(error),
            }
        }
        // A folder without any library is the wrong folder.
        match (self.folder, binaries.is_empty()) {
            (Some(folder), true) => {
                Err(LibraryError::NotInFolder { path: folder.to_owned(), platform: "any platform" })
            }
            _ => Ok(binaries),
        }
    }

    /// The library of one platform; `unnamed` where the user asked for none by name.
    fn library(&self, platform: Platform, unnamed: bool) -> Result<Vec<u8>, LibraryError> {
        if let Some(folder) = self.folder {
            return library_of_folder(folder, platform);
        }
        let is_host = Some(platform) == Platform::host();
        if is_host && unnamed {
            return (self.own)(platform);
        }
        if let Some(folder) = folder_beside_program() {
            match library_of_folder(&folder, platform) {
                Err(LibraryError::NotInFolder { .. }) => {}
                found => return found,
            }
        }
        // With the cross compiler at hand this computer's library is made for old C libraries too.
        match Compiler::find() {
            Ok(compiler) => {
                let began = |target: &str| (self.say)(format!("compiling for {target} …"));
                compiler.library(platform, &began).map_err(LibraryError::Cross)
            }
            Err(_) if is_host => (self.own)(platform),
            Err(error) => Err(LibraryError::Cross(error)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;

    /// The first bytes of a library of each platform, as their formats have them.
    fn first_bytes(platform: Platform) -> Vec<u8> {
        let mut bytes = vec![0; 128];
        match platform {
            Platform::X86Linux | Platform::ArmLinux => {
                bytes[..6].copy_from_slice(b"\x7fELF\x02\x01");
                bytes[18] = if platform == Platform::X86Linux { 62 } else { 183 };
            }
            Platform::X86Windows => {
                bytes[..2].copy_from_slice(b"MZ");
                bytes[0x3c] = 0x40;
                bytes[0x40..0x46].copy_from_slice(b"PE\0\0\x64\x86");
            }
            Platform::UniversalMac => bytes[..4].copy_from_slice(&[0xca, 0xfe, 0xba, 0xbe]),
        }
        bytes
    }

    fn put(folder: &Path, platform: Platform, bytes: &[u8]) {
        let place = folder.join(platform.name());
        std::fs::create_dir_all(&place).expect("writable");
        std::fs::write(place.join(platform.library_name()), bytes).expect("writable");
    }

    fn none(_: Platform) -> Result<Vec<u8>, LibraryError> {
        panic!("the folder has what is needed")
    }

    #[test]
    fn a_folder_of_libraries_gives_what_it_has_and_says_what_it_has_not() {
        let folder = std::env::temp_dir().join(format!("toolroom-libraries-{}", std::process::id()));
        for platform in [Platform::ArmLinux, Platform::X86Windows, Platform::UniversalMac] {
            put(&folder, platform, &first_bytes(platform));
        }
        let said = RefCell::new(Vec::new());
        let sources = Sources { folder: Some(&folder), own: &none, say: &|line| said.borrow_mut().push(line) };
        let names = |wanted: &[&str]| {
            let wanted: Vec<String> = wanted.iter().map(|word| (*word).to_owned()).collect();
            let found = sources.libraries(&wanted)?;
            Ok::<_, LibraryError>(found.iter().map(|binary| binary.platform.name()).collect::<Vec<_>>())
        };
        let there = ["aarch64-linux", "x86_64-windows", "darwin"];
        assert_eq!(names(&[]).expect("three"), there);
        assert_eq!(names(&["all"]).expect("three"), there);
        assert!(said.borrow()[0].starts_with("left out x86_64-linux: "), "{:?}", said.borrow());
        assert_eq!(names(&["darwin", "aarch64-linux", "darwin"]).expect("two"), ["aarch64-linux", "darwin"]);
        assert!(matches!(names(&["x86_64-linux"]), Err(LibraryError::NotInFolder { .. })));
        // A library of another platform is refused, whatever was asked for.
        put(&folder, Platform::X86Linux, &first_bytes(Platform::ArmLinux));
        assert!(matches!(names(&["all"]), Err(LibraryError::Wrong { platform: "x86_64-linux", .. })));
        put(&folder, Platform::X86Linux, b"MZ");
        assert!(matches!(names(&["x86_64-linux"]), Err(LibraryError::Wrong { .. })));
        std::fs::remove_dir_all(&folder).expect("removable");
        assert!(matches!(names(&[]), Err(LibraryError::NotInFolder { platform: "any platform", .. })));
    }
}
