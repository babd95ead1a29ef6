//! Files that the program holds: `builtin:NAME` wherever a file is taken.
//!
//! A name is the path below `scenarios/`, with or without its folder and the ending `.toml`: `builtin:policies`,
//! `builtin:life/policies`. Files that a shipped file names are found beside it, among the shipped ones.

use std::borrow::Cow;
use std::io;
use std::path::Path;

/// What stands before the name of a shipped file.
pub const SHIPPED: &str = "builtin:";

/// Paths below `scenarios/`, each with its text.
macro_rules! held {
    ($($path:literal)*) => { &[$(($path, include_str!(concat!("../../../scenarios/", $path)))),*] };
}

/// Shipped files by their path.
static FILES: &[(&str, &str)] = held![
    "adverse.toml"
    "chatter-policies.toml"
    "chatter/chuck-fig2.toml"
    "chatter/chuck-fig4.toml"
    "chatter/endmill.toml"
    "chatter/endmill12.toml"
    "chatter/milling-slot.toml"
    "chatter/shaft.toml"
    "chatter/speed-variation.toml"
    "chatter/spindle.toml"
    "chatter/turning-bar.toml"
    "chuck-fig3.toml"
    "constant-vs-adaptive.toml"
    "contour-milling.toml"
    "contour/cam.toml"
    "contour/mc1.toml"
    "contour/rk3.toml"
    "data/zb153u_trials.csv"
    "demo.toml"
    "fmu-lathe-native.toml"
    "fmu-lathe.toml"
    "gap/18-tools.toml"
    "gap/grinding.toml"
    "gap/map-18-tools.toml"
    "gap/map-nasa-mill.toml"
    "gap/map-phm2010.toml"
    "gap/map-vicomtech.toml"
    "gap/milling.toml"
    "gap/nasa-mill.toml"
    "gap/phm2010.toml"
    "gap/program.toml"
    "gap/shop.toml"
    "gap/turning.toml"
    "gap/vicomtech.toml"
    "grinder-bottleneck.toml"
    "grinding-policies.toml"
    "grinding/cycle.toml"
    "life/constant.toml"
    "life/early.toml"
    "life/policies.toml"
    "life/taylor-grid.toml"
    "shop/cell.toml"
    "shop/ft06.toml"
    "shop/line.toml"
    "shop/operators.toml"
    "shop/orders.csv"
    "shop/orders.toml"
    "shop/queue.toml"
    "steel-shafts.toml"
    "template.toml"
];

/// Names of the shipped files: paths without the ending `.toml`.
pub fn shipped_names() -> impl Iterator<Item = &'static str> {
    FILES.iter().map(|(path, _)| path.strip_suffix(".toml").unwrap_or(path))
}

/// The name behind `builtin:`, with `/` between folders.
fn name(path: &Path) -> Option<String> {
    Some(path.to_str()?.strip_prefix(SHIPPED)?.replace('\\', "/"))
}

/// The shipped file of a name.
fn held(name: &str) -> Option<(&'static str, &'static str)> {
    let whole = |path: &str| path == name || path.strip_suffix(".toml") == Some(name);
    let last = |path: &str| path.rsplit('/').next().is_some_and(whole);
    FILES.iter().find(|(path, _)| whole(path)).or_else(|| FILES.iter().find(|(path, _)| last(path))).copied()
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
    fn a_name_without_folder_and_ending_is_enough_and_means_one_file() {
        for (path, text) in FILES {
            let stem = path.strip_suffix(".toml").unwrap_or(path);
            let last = stem.rsplit('/').next().expect("a name");
            for name in [*path, stem, last] {
                let place = format!("{SHIPPED}{name}");
                assert_eq!(bytes(Path::new(&place)).expect(name), text.as_bytes(), "{name}");
                assert_eq!(place_of(Path::new(&place)), Path::new(&format!("{SHIPPED}{path}")), "{name}");
            }
        }
    }

    #[test]
    fn every_file_of_the_scenarios_is_shipped() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios");
        let mut folders = vec![root.clone()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).expect("a folder") {
                let path = entry.expect("an entry").path();
                let below = path.strip_prefix(&root).expect("below").to_str().expect("text").replace('\\', "/");
                // Parameter sets have their own names, and samples are given by `new`.
                if path.is_dir() && !["parameters", "schema", "new"].contains(&below.as_str()) {
                    folders.push(path);
                } else if path.extension().is_some_and(|ending| ending == "toml") {
                    assert!(held(&below).is_some_and(|(own, _)| own == below), "{below} is not shipped");
                }
            }
        }
    }

    #[test]
    fn an_unknown_name_is_answered_with_the_nearest() {
        let error = bytes(Path::new("builtin:polices")).expect_err("unknown").to_string();
        assert!(error.contains("did you mean builtin:policies?") && error.contains("life/policies"), "{error}");
    }
}
