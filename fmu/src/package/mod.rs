//! The package: one zip file with description, libraries, documentation and resources.
//!
//! The same unit and the same libraries give the same bytes: entries in a fixed order, with the
//! earliest date that a zip file can hold.

mod documentation;
mod icon;
mod own;
mod platform;
mod reference;

pub use own::{OwnSet, OwnSetError, own_set};
pub use platform::{Binary, Platform};

use crate::catalogue::Entry;
use crate::description::Description;
use crate::fault::Fault;
use std::io::{Cursor, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// Version of the standard of a package.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// FMI 2.0.
    Two,
    /// FMI 3.0.
    Three,
}

impl Version {
    /// First number of the version.
    pub fn number(self) -> u32 {
        match self {
            Self::Two => 2,
            Self::Three => 3,
        }
    }
}

/// Why a package was not written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PackageError {
    /// The zip file.
    #[error("the package cannot be written: {0}")]
    Zip(#[from] zip::result::ZipError),
    /// Its content.
    #[error("the package cannot be written: {0}")]
    Write(#[from] std::io::Error),
    /// The run that gives the reference results.
    #[error("the reference results cannot be computed: {0}")]
    Reference(#[from] Box<Fault>),
}

/// Licence texts that go with every package.
const LICENCES: [(&str, &str); 2] = [
    ("LICENSE-MIT.txt", include_str!("../../../LICENSE-MIT")),
    ("LICENSE-APACHE.txt", include_str!("../../../LICENSE-APACHE")),
];

/// The package of a unit with the libraries of some platforms, and parameter sets beside the shipped ones.
///
/// # Errors
/// [`PackageError`]; memory is the only place written to.
pub fn package(unit: &Entry, version: Version, binaries: &[Binary], sets: &[OwnSet]) -> Result<Vec<u8>, PackageError> {
    described(unit, unit.describe(), version, binaries, sets)
}

/// [`package`] of FMI 2.0 with integers in the place of enumerations ([`Description::without_enumerations`]), which
/// importers of FMI 2.0 set by the same functions.
///
/// # Errors
/// As [`package`].
pub fn package_without_enumerations(unit: &Entry, binaries: &[Binary]) -> Result<Vec<u8>, PackageError> {
    described(unit, &unit.describe().without_enumerations(), Version::Two, binaries, &[])
}

fn described(
    unit: &Entry,
    description: &Description,
    version: Version,
    binaries: &[Binary],
    sets: &[OwnSet],
) -> Result<Vec<u8>, PackageError> {
    let mut zip = Zip(ZipWriter::new(Cursor::new(Vec::new())));
    let model = match version {
        Version::Two => description.fmi2(),
        Version::Three => description.fmi3(),
    };
    zip.add("modelDescription.xml", model.as_bytes())?;
    for binary in binaries {
        for folder in binary.platform.folders(version) {
            let name = format!("binaries/{folder}/{}{}", description.identifier, binary.platform.extension());
            zip.add(&name, &binary.library)?;
        }
    }
    zip.add("documentation/index.html", documentation::page(description, version).as_bytes())?;
    for (name, text) in LICENCES {
        zip.add(&format!("documentation/licenses/{name}"), text.as_bytes())?;
    }
    zip.add("documentation/licenses/license.spdx", format!("{}\n", crate::description::LICENCE).as_bytes())?;
    let shipped = description.sets.iter().copied();
    for (name, text) in shipped.chain(sets.iter().map(|set| (set.name.as_str(), set.text.as_str()))) {
        zip.add(&format!("resources/tools/{name}.toml"), text.as_bytes())?;
    }
    let icon = icon::svg(description);
    let folder = if version == Version::Two { "" } else { "terminalsAndIcons/" };
    if version == Version::Three {
        zip.add("terminalsAndIcons/terminalsAndIcons.xml", description.terminals().as_bytes())?;
    }
    zip.add(&format!("{folder}{}.svg", if version == Version::Two { "model" } else { "icon" }), icon.as_bytes())?;
    let png = icon::png(description);
    zip.add(&format!("{folder}{}.png", if version == Version::Two { "model" } else { "icon" }), &png)?;
    for (name, text) in reference::files(unit, description)? {
        zip.add(&format!("extra/org.fmi-standard.fmi-ls-ref/{name}"), text.as_bytes())?;
    }
    Ok(zip.0.finish()?.into_inner())
}

/// A zip file of entries in this order, whose bytes depend on nothing but them: name and content.
///
/// # Errors
/// [`PackageError`] of a name that a zip file cannot hold.
pub fn archive(entries: &[(String, Vec<u8>)]) -> Result<Vec<u8>, PackageError> {
    let mut zip = Zip(ZipWriter::new(Cursor::new(Vec::new())));
    entries.iter().try_for_each(|(name, content)| zip.add(name, content))?;
    Ok(zip.0.finish()?.into_inner())
}

/// A zip file whose bytes depend on nothing but its content.
struct Zip(ZipWriter<Cursor<Vec<u8>>>);

impl Zip {
    fn add(&mut self, name: &str, content: &[u8]) -> Result<(), PackageError> {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default())
            .unix_permissions(if name.starts_with("binaries/") { 0o755 } else { 0o644 });
        self.0.start_file(name, options)?;
        Ok(self.0.write_all(content)?)
    }
}

/// Names of the shipped units' packages: `toolroom_turning_fmi2.fmu`.
pub fn file_name(description: &Description, version: Version) -> String {
    format!("{}_fmi{}.fmu", description.identifier, version.number())
}
