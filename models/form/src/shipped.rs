//! Files that the program holds: `builtin:NAME` wherever a file is taken.
//!
//! A name is the path below `scenarios/`, with or without its folder and the ending `.toml`: `builtin:policies`,
//! `builtin:life/policies`. Files that a shipped file names are found beside it, among the shipped ones.

use std::borrow::Cow;
use std::io;
use std::path::Path;

/// What stands before the name of a shipped file.
pub const SHIPPED: &str = "builtin:";

/// Every file of `scenarios/` that commands take, by its path there, with its text: listed by the build script.
static FILES: &[(&str, &str)] = include!(concat!(env!("OUT_DIR"), "/shipped.rs"));

/// Names of the shipped files: paths without the ending `.toml`.
pub fn shipped_names() -> impl Iterator<Item = &'static str> {
    FILES.iter().map(|(path, _)| path.strip_suffix(".toml").unwrap_or(path))
}

/// The name behind `builtin:`, with `/` between folders.
fn name(path: &Path) -> Option<String> {
    Some(path.to_str()?.strip_prefix(SHIPPED)?.replace('\\', "/"))
}

/// The shipped file of a name: of its whole path, or of its last part where only one file has it.
fn held(name: &str) -> Option<(&'static str, &'static str)> {
    let whole = |path: &str| path == name || path.strip_suffix(".toml") == Some(name);
    if let Some(file) = FILES.iter().find(|(path, _)| whole(path)) {
        return Some(*file);
    }
    let mut last = FILES.iter().filter(|(path, _)| path.rsplit('/').next().is_some_and(whole));
    match (last.next(), last.next()) {
        (Some(file), None) => Some(*file),
        _ => None,
    }
}

/// A path as it is; that of a shipped file with its whole name, so that what the file names is found beside it.
///
/// ```
/// use std::path::Path;
/// assert_eq!(toolroom_form::place_of(Path::new("builtin:policies")), Path::new("builtin:life/policies.toml"));
/// assert_eq!(toolroom_form::place_of(Path::new("policies.toml")), Path::new("policies.toml"));
/// ```
pub fn place_of(path: &Path) -> Cow<'_, Path> {
    match name(path).and_then(|name| held(&name)) {
        Some((whole, _)) => Cow::Owned(format!("{SHIPPED}{whole}").into()),
        None => Cow::Borrowed(path),
    }
}

/// Whether a path names a shipped file, be it there or not.
pub fn is_shipped(path: &Path) -> bool {
    name(path).is_some()
}

/// The bytes of a file of the disk, or of a shipped one.
///
/// # Errors
/// What the system says; of a name under which nothing is shipped [`io::ErrorKind::NotFound`] with what there is.
pub fn bytes(path: &Path) -> io::Result<Vec<u8>> {
    let Some(name) = name(path) else { return std::fs::read(path) };
    match held(&name) {
        Some((_, text)) => Ok(text.as_bytes().to_vec()),
        None => {
            let names: Vec<&str> = shipped_names().collect();
            let short = |name: &'static str| name.rsplit('/').next().unwrap_or(name);
            let near = crate::nearest(&name, names.iter().copied().chain(names.iter().map(|name| short(name))));
            let near = near.map(|near| format!("did you mean {SHIPPED}{near}? ")).unwrap_or_default();
            let message = format!("no file of this name is shipped; {near}There are {}", names.join(", "));
            Err(io::Error::new(io::ErrorKind::NotFound, message))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_without_ending_is_enough_and_without_folder_where_it_is_the_only_one() {
        let last = |path: &'static str| path.rsplit('/').next().unwrap_or(path);
        for (path, text) in FILES {
            let stem = path.strip_suffix(".toml").unwrap_or(path);
            let alone = FILES.iter().filter(|(other, _)| last(other) == last(path)).count() == 1;
            for name in [*path, stem].into_iter().chain(alone.then(|| last(path))) {
                let place = format!("{SHIPPED}{name}");
                assert_eq!(bytes(Path::new(&place)).expect(name), text.as_bytes(), "{name}");
                assert_eq!(place_of(Path::new(&place)), Path::new(&format!("{SHIPPED}{path}")), "{name}");
            }
        }
    }

    #[test]
    fn scenarios_are_shipped_and_parameter_sets_have_their_own_names() {
        assert!(held("life/policies").is_some() && held("orders.csv").is_some());
        assert!(FILES.iter().all(|(path, _)| !path.starts_with("parameters/") && !path.starts_with("new/")));
    }

    #[test]
    fn every_file_of_the_root_is_listed() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
        for entry in std::fs::read_dir(root).expect("the shipped scenarios") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().and_then(|name| name.to_str()).expect("a name in UTF-8");
            let taken = ["toml", "csv", "nc"].iter().any(|ending| path.extension().is_some_and(|own| own == *ending));
            // The build script watches no folder for new files but those that it lists.
            assert!(!taken || FILES.iter().any(|(path, _)| *path == name), "{name} is new: touch models/form/build.rs");
        }
    }

    #[test]
    fn an_unknown_name_is_answered_with_the_nearest() {
        let error = bytes(Path::new("builtin:polices")).expect_err("unknown").to_string();
        assert!(error.contains("did you mean builtin:policies?") && error.contains("life/policies"), "{error}");
    }
}
