//! Platforms of a unit: folders below `binaries/`, and what a binary is made for.

use object::{Architecture, BinaryFormat, Object, ObjectSymbol};
use std::collections::BTreeSet;

/// One platform under its two folder names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Platform {
    /// Folder of FMI 2.0 (`linux64`).
    pub fmi2: &'static str,
    /// Folder of FMI 3.0 (`x86_64-linux`).
    pub fmi3: &'static str,
    /// Ending of a shared library.
    pub suffix: &'static str,
    format: BinaryFormat,
    architecture: Architecture,
}

/// Platforms of the standard. FMI 2.0.4 takes the names of FMI 3.0 for those that it did not
/// know before.
pub const PLATFORMS: &[Platform] = &[
    Platform {
        fmi2: "linux64",
        fmi3: "x86_64-linux",
        suffix: ".so",
        format: BinaryFormat::Elf,
        architecture: Architecture::X86_64,
    },
    Platform {
        fmi2: "linux32",
        fmi3: "x86-linux",
        suffix: ".so",
        format: BinaryFormat::Elf,
        architecture: Architecture::I386,
    },
    Platform {
        fmi2: "aarch64-linux",
        fmi3: "aarch64-linux",
        suffix: ".so",
        format: BinaryFormat::Elf,
        architecture: Architecture::Aarch64,
    },
    Platform {
        fmi2: "win64",
        fmi3: "x86_64-windows",
        suffix: ".dll",
        format: BinaryFormat::Pe,
        architecture: Architecture::X86_64,
    },
    Platform {
        fmi2: "win32",
        fmi3: "x86-windows",
        suffix: ".dll",
        format: BinaryFormat::Pe,
        architecture: Architecture::I386,
    },
    Platform {
        fmi2: "aarch64-windows",
        fmi3: "aarch64-windows",
        suffix: ".dll",
        format: BinaryFormat::Pe,
        architecture: Architecture::Aarch64,
    },
    Platform {
        fmi2: "darwin64",
        fmi3: "x86_64-darwin",
        suffix: ".dylib",
        format: BinaryFormat::MachO,
        architecture: Architecture::X86_64,
    },
    Platform {
        fmi2: "aarch64-darwin",
        fmi3: "aarch64-darwin",
        suffix: ".dylib",
        format: BinaryFormat::MachO,
        architecture: Architecture::Aarch64,
    },
];

impl Platform {
    /// The platform that this program runs on, where the standard names it.
    pub fn host() -> Option<&'static Self> {
        let wanted = format!("{}-{}", std::env::consts::ARCH, std::env::consts::OS).replace("macos", "darwin");
        PLATFORMS.iter().find(|platform| platform.fmi3 == wanted)
    }

    /// Folder below `binaries/` for a unit of FMI `major`.
    pub fn folder(&self, major: u8) -> &'static str {
        if major < 3 { self.fmi2 } else { self.fmi3 }
    }

    /// The platform of a folder below `binaries/` in a unit of FMI `major`.
    pub fn of_folder(folder: &str, major: u8) -> Option<&'static Self> {
        PLATFORMS.iter().find(|platform| platform.folder(major) == folder)
    }
}

/// What a shared library says about itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Binary {
    /// `Elf`, `Pe` or `MachO` and the processor, for messages.
    pub kind: String,
    /// Functions that it hands out.
    pub functions: BTreeSet<String>,
    /// Highest version of the GNU C library that it asks for, (major, minor).
    pub glibc: Option<(u32, u32)>,
    format: BinaryFormat,
    architectures: Vec<Architecture>,
}

impl Binary {
    /// Reads the tables of a shared library; it is not loaded.
    ///
    /// # Errors
    /// Why the bytes are no shared library.
    pub fn parse(bytes: &[u8]) -> Result<Self, String> {
        let mut slices: Vec<&[u8]> = Vec::new();
        // A universal library holds one library for each processor.
        if let Ok(fat) = object::read::macho::MachOFatFile32::parse(bytes) {
            for arch in fat.arches() {
                use object::read::macho::FatArch;
                slices.push(arch.data(bytes).map_err(|error| error.to_string())?);
            }
        }
        let thin = if slices.is_empty() {
            vec![Self::of_one(bytes)?]
        } else {
            slices.into_iter().map(Self::of_one).collect::<Result<_, _>>()?
        };
        let mut libraries = thin.into_iter();
        let mut whole = libraries.next().ok_or("an empty universal library")?;
        for library in libraries {
            whole.architectures.extend(library.architectures);
            // What a user of either processor can count on.
            whole.functions.retain(|function| library.functions.contains(function));
        }
        whole.kind = format!("{:?} for {:?}", whole.format, whole.architectures);
        Ok(whole)
    }

    /// A library for one processor.
    fn of_one(bytes: &[u8]) -> Result<Self, String> {
        let file = object::File::parse(bytes).map_err(|error| error.to_string())?;
        let mut functions: BTreeSet<String> = BTreeSet::new();
        for export in file.exports().map_err(|error| error.to_string())? {
            let name = String::from_utf8_lossy(export.name()).into_owned();
            // C symbols of macOS carry an underscore.
            let name =
                if file.format() == BinaryFormat::MachO { name.trim_start_matches('_').to_owned() } else { name };
            functions.insert(name);
        }
        let undefined = file.dynamic_symbols().any(|symbol| symbol.is_undefined());
        let glibc = (file.format() == BinaryFormat::Elf && undefined).then(|| glibc(bytes)).flatten();
        Ok(Self {
            kind: String::new(),
            functions,
            glibc,
            format: file.format(),
            architectures: vec![file.architecture()],
        })
    }

    /// Whether it can run on `platform`.
    pub fn fits(&self, platform: &Platform) -> bool {
        self.format == platform.format && self.architectures.contains(&platform.architecture)
    }
}

/// The highest `GLIBC_x.y` among the names of an ELF file's version table.
fn glibc(bytes: &[u8]) -> Option<(u32, u32)> {
    const MARK: &[u8] = b"GLIBC_";
    let mut highest = None;
    for offset in bytes
        .windows(MARK.len())
        .enumerate()
        .filter(|(_, window)| *window == MARK)
        .map(|(offset, _)| offset + MARK.len())
    {
        let end = bytes[offset..]
            .iter()
            .position(|byte| !byte.is_ascii_digit() && *byte != b'.')
            .map_or(bytes.len(), |n| offset + n);
        let text = std::str::from_utf8(&bytes[offset..end]).unwrap_or_default();
        let mut numbers = text.split('.').map_while(|part| part.parse::<u32>().ok());
        if let (Some(major), Some(minor)) = (numbers.next(), numbers.next()) {
            highest = highest.max(Some((major, minor)));
        }
    }
    highest
}
