//! Values of a parameter set as its file gives them, each with its place.

use super::Origin;
use std::collections::BTreeMap;
use std::ops::Range;

/// A value with its place in the file.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    pub value: f64,
    pub source: String,
    pub origin: Origin,
    pub span: Range<usize>,
}

/// Values by group and name.
pub(super) type Values = BTreeMap<(&'static str, &'static str), Placed>;
