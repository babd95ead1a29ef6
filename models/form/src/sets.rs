//! Parameter sets that a crate ships, found by their names.

use crate::nearest;

/// No shipped set has a name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no parameter set `{name}` of {process}; there are {known}{}",
    nearest.map(|name| format!("; did you mean `{name}`?")).unwrap_or_default()
)]
pub struct UnknownSet {
    /// What the sets are of.
    pub process: &'static str,
    /// The name that was read.
    pub name: String,
    /// Names of the sets, separated by commas.
    pub known: String,
    /// The name nearest to it, where one is near enough to be meant.
    pub nearest: Option<&'static str>,
}

/// The text of the set called `name` among `sets` (names and texts), which are of `process`.
///
/// # Errors
/// [`UnknownSet`] with the names that there are.
///
/// ```
/// let sets = &[("c45_t15k6", "…"), ("ni_vk6om", "…")];
/// assert_eq!(toolroom_form::shipped_set("turning", sets, "c45_t15k6"), Ok("…"));
/// let unknown = toolroom_form::shipped_set("turning", sets, "c45_t15").unwrap_err();
/// assert_eq!(unknown.nearest, Some("c45_t15k6"));
/// ```
pub fn shipped_set(
    process: &'static str,
    sets: &'static [(&'static str, &'static str)],
    name: &str,
) -> Result<&'static str, UnknownSet> {
    let names = || sets.iter().map(|(name, _)| *name);
    sets.iter().find(|(known, _)| *known == name).map(|(_, text)| *text).ok_or_else(|| UnknownSet {
        process,
        name: name.to_owned(),
        known: names().collect::<Vec<_>>().join(", "),
        nearest: nearest(name, names()),
    })
}
