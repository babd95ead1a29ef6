//! Platforms and where their libraries lie in a package.

use super::Version;

/// A platform that a unit can run on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Platform {
    /// Linux on x86-64.
    X86Linux,
    /// Linux on 64-bit ARM.
    ArmLinux,
    /// Windows on x86-64.
    X86Windows,
    /// macOS on both processors, one universal library.
    UniversalMac,
}

impl Platform {
    /// Every platform, in the order of a package.
    pub const ALL: [Self; 4] = [Self::X86Linux, Self::ArmLinux, Self::X86Windows, Self::UniversalMac];

    /// The platform that this program runs on, where it is one of them.
    pub fn host() -> Option<Self> {
        match (std::env::consts::OS, std::env::consts::ARCH) {
            ("linux", "x86_64") => Some(Self::X86Linux),
            ("linux", "aarch64") => Some(Self::ArmLinux),
            ("windows", "x86_64") => Some(Self::X86Windows),
            ("macos", _) => Some(Self::UniversalMac),
            _ => None,
        }
    }

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::X86Linux => "x86_64-linux",
            Self::ArmLinux => "aarch64-linux",
            Self::X86Windows => "x86_64-windows",
            Self::UniversalMac => "darwin",
        }
    }

    /// Compiler targets whose libraries it needs; with the oldest C library on Linux.
    pub fn targets(self) -> &'static [&'static str] {
        match self {
            Self::X86Linux => &["x86_64-unknown-linux-gnu.2.17"],
            Self::ArmLinux => &["aarch64-unknown-linux-gnu.2.17"],
            Self::X86Windows => &["x86_64-pc-windows-gnu"],
            Self::UniversalMac => &["x86_64-apple-darwin", "aarch64-apple-darwin"],
        }
    }

    /// Folders of its library under `binaries`. The universal library lies where importers of
    /// FMI 2.0 look on either processor.
    pub(super) fn folders(self, version: Version) -> &'static [&'static str] {
        match (version, self) {
            (Version::Two, Self::X86Linux) => &["linux64"],
            (_, Self::ArmLinux) => &["aarch64-linux"],
            (Version::Two, Self::X86Windows) => &["win64"],
            (Version::Two, Self::UniversalMac) => &["darwin64", "aarch64-darwin"],
            (Version::Three, Self::X86Linux) => &["x86_64-linux"],
            (Version::Three, Self::X86Windows) => &["x86_64-windows"],
            (Version::Three, Self::UniversalMac) => &["x86_64-darwin", "aarch64-darwin"],
        }
    }

    /// Ending of its libraries.
    pub fn extension(self) -> &'static str {
        match self {
            Self::X86Linux | Self::ArmLinux => ".so",
            Self::X86Windows => ".dll",
            Self::UniversalMac => ".dylib",
        }
    }

    /// Whether these are the bytes of a library of this platform, by the head of its format: ELF, PE, or a universal
    /// binary of macOS.
    pub fn is_library(self, bytes: &[u8]) -> bool {
        let starts = |at: usize, with: &[u8]| bytes.get(at..).is_some_and(|rest| rest.starts_with(with));
        let number = |at: usize| bytes.get(at..at + 4).and_then(|four| four.try_into().ok()).map(u32::from_le_bytes);
        // Numbers of processors: EM_X86_64 and EM_AARCH64 of ELF, IMAGE_FILE_MACHINE_AMD64 of PE.
        match self {
            Self::X86Linux => starts(0, b"\x7fELF\x02\x01") && starts(18, &[62, 0]),
            Self::ArmLinux => starts(0, b"\x7fELF\x02\x01") && starts(18, &[183, 0]),
            Self::X86Windows => {
                starts(0, b"MZ") && number(0x3c).is_some_and(|header| starts(header as usize, b"PE\0\0\x64\x86"))
            }
            Self::UniversalMac => starts(0, &[0xca, 0xfe, 0xba, 0xbe]),
        }
    }

    /// File name of the library as the compiler leaves it.
    pub fn library_name(self) -> String {
        let prefix = if self == Self::X86Windows { "" } else { "lib" };
        format!("{prefix}toolroom_fmu{}", self.extension())
    }
}

/// The library of one platform.
#[derive(Clone, Debug)]
pub struct Binary {
    /// Where it runs.
    pub platform: Platform,
    /// Its bytes.
    pub library: Vec<u8>,
}

impl Binary {
    /// One library of several macOS libraries, with the header of a universal binary.
    ///
    /// ```
    /// use toolroom_fmu::Binary;
    /// let mut thin = vec![0; 32];
    /// thin[..8].copy_from_slice(&[0xcf, 0xfa, 0xed, 0xfe, 7, 0, 0, 1]);
    /// let universal = Binary::universal(&[thin.clone(), thin]);
    /// assert_eq!(universal[..8], [0xca, 0xfe, 0xba, 0xbe, 0, 0, 0, 2]);
    /// ```
    pub fn universal(thin: &[Vec<u8>]) -> Vec<u8> {
        /// Alignment of 64-bit libraries, as a power of two.
        const ALIGNMENT: u32 = 14;
        let page = 1usize << ALIGNMENT;
        let mut whole = Vec::new();
        whole.extend(0xcafe_babe_u32.to_be_bytes());
        whole.extend((thin.len() as u32).to_be_bytes());
        let mut offset = page;
        for library in thin {
            // Processor type and subtype of the library's own header, which is little-endian.
            let word = |at: usize| {
                let bytes = library.get(at..at + 4).and_then(|four| four.try_into().ok()).unwrap_or_default();
                u32::from_le_bytes(bytes)
            };
            for value in [word(4), word(8), offset as u32, library.len() as u32, ALIGNMENT] {
                whole.extend(value.to_be_bytes());
            }
            offset = (offset + library.len()).next_multiple_of(page);
        }
        for library in thin {
            whole.resize(whole.len().next_multiple_of(page), 0);
            whole.extend(library);
        }
        whole
    }
}
