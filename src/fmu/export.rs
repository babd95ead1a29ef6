//! `toolroom fmu export MODEL`.

use crate::args::FmuExportArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::json;
use std::path::{Path, PathBuf};
use toolroom_fmu::{Binary, Entry, LibraryError, OwnSet, Platform, Sources, Version, file_name, own_set, package};
use toolroom_output::Files;

pub fn run(args: &FmuExportArgs, voice: &Voice) -> Result<(), Failure> {
    let unit = args.model;
    let versions: &[Version] = match args.fmi {
        // A file holds one version: the newer one, which the last line says.
        None if is_file(&args.out) => &[Version::Three],
        None => &[Version::Two, Version::Three],
        Some(2) => &[Version::Two],
        Some(_) => &[Version::Three],
    };
    let description = unit.describe();
    let files = Files::new(args.parameters.iter().map(AsRef::as_ref), voice.force);
    let places = places(args, versions, |version| file_name(description, version));
    places.iter().try_for_each(|(_, path)| files.check(path))?;
    let sets = own_sets(args, unit)?;
    let binaries = binaries(&args.platforms, args.libraries.as_deref(), voice)?;
    let mut written = Vec::new();
    for (version, path) in places {
        let bytes = package(unit, version, &binaries, &sets).map_err(|error| Failure::work_error(&error))?;
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)
                .map_err(|source| Failure::Unwritable { path: folder.to_owned(), source })?;
        }
        files.put(&path, &bytes)?;
        written.push((version, path, bytes.len()));
    }
    let platforms: Vec<&str> = binaries.iter().map(|binary| binary.platform.name()).collect();
    if voice.json {
        let units: Vec<_> = written
            .iter()
            .map(|(version, path, size)| json!({ "fmi": version.number(), "file": path, "bytes": size }))
            .collect();
        return voice.json(&json!({
            "schema": 1,
            "model": unit.name,
            "token": description.token,
            "variables": description.variables.len(),
            "platforms": platforms,
            "units": units,
        }));
    }
    for (version, path, size) in &written {
        voice.data(format_args!(
            "{}  FMI {}.0, {} variables, {} kB, {}",
            path.display(),
            version.number(),
            description.variables.len(),
            size.div_ceil(1000),
            platforms.join(" ")
        ))?;
    }
    for set in &sets {
        voice.say(format_args!("to use the set: tool.set = \"{}\"", set.name));
    }
    if args.fmi.is_none() && is_file(&args.out) {
        voice.say("for importers of FMI 2.0 only: --fmi 2");
    }
    if let Some((_, path, _)) = written.first() {
        voice.say(format_args!("next: toolroom fmu check {}", path.display()));
    }
    Ok(())
}

/// The parameter sets of `--parameters`, resolved: a package needs no other file.
fn own_sets(args: &FmuExportArgs, unit: &Entry) -> Result<Vec<OwnSet>, Failure> {
    let read = |path: &PathBuf| own_set(unit, path).map_err(|error| Failure::of_file(path, &error, error.fix()));
    args.parameters.iter().map(read).collect()
}

/// Whether `--out` names the package itself.
fn is_file(folder: &Path) -> bool {
    folder.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("fmu"))
}

/// Where the package of each version goes: into a folder under its own name, or into the file that `--out` names.
fn places(args: &FmuExportArgs, versions: &[Version], name: impl Fn(Version) -> String) -> Vec<(Version, PathBuf)> {
    let place = |version: &Version| if is_file(&args.out) { args.out.clone() } else { args.out.join(name(*version)) };
    versions.iter().map(|version| (*version, place(version))).collect()
}

/// Libraries of the wanted platforms, from a folder where one is given.
pub(crate) fn binaries(wanted: &[String], folder: Option<&Path>, voice: &Voice) -> Result<Vec<Binary>, Failure> {
    let sources = Sources { folder, own: &own_library, say: &|line| voice.say(line) };
    sources.libraries(wanted).map_err(|error| match error.fix() {
        Some(fix) => Failure::argument(error, fix),
        None => Failure::work_error(&error),
    })
}

/// The library inside this program.
#[cfg(feature = "embedded-units")]
fn own_library(_platform: Platform) -> Result<Vec<u8>, LibraryError> {
    toolroom::unit_library().map_err(LibraryError::Damaged)
}

/// The library that was built with this program, beside it.
#[cfg(not(feature = "embedded-units"))]
fn own_library(platform: Platform) -> Result<Vec<u8>, LibraryError> {
    toolroom_fmu::library_beside_program(platform)
}
