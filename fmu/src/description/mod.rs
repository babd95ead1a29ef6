//! What a package says about its unit: model descriptions of both versions.

mod date;
mod fmi2;
mod fmi3;
mod quantity;
mod structure;
mod terminals;
mod xml;

pub use quantity::unit_powers;
pub use structure::Dependencies;
pub(crate) use xml::escaped;
pub use xml::{Attributes, Xml};

use crate::unit::Unit;
use crate::variable::{Variable, variables};

/// Version of a unit's variables and behaviour: that of the crate.
pub(crate) const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Tool that generated the description.
pub(crate) const TOOL: &str = concat!("toolroom ", env!("CARGO_PKG_VERSION"));
/// Licence of code and parameters, an SPDX expression.
pub(crate) const LICENCE: &str = env!("CARGO_PKG_LICENSE");

/// Who wrote it, as in the licence texts.
pub(crate) const AUTHOR: &str = "The toolroom authors";
/// Whose it is, as in the licence texts.
pub(crate) const COPYRIGHT: &str = "Copyright (c) 2026 The toolroom authors";

/// Everything that a package says about its unit, without its types.
#[derive(Clone, Debug)]
pub struct Description {
    /// Model identifier.
    pub identifier: &'static str,
    /// One line for people.
    pub title: &'static str,
    /// What it computes.
    pub summary: &'static str,
    /// Name and formula.
    pub equations: &'static [(&'static str, &'static str)],
    /// Where it holds.
    pub validity: &'static [&'static str],
    /// Parameter sets: name and file.
    pub sets: &'static [(&'static str, &'static str)],
    /// Whether Model Exchange is offered.
    pub continuous: bool,
    /// End and step of the default experiment, s.
    pub experiment: (f64, f64),
    /// Instantiation token.
    pub token: String,
    /// When it was made, from `SOURCE_DATE_EPOCH`; nothing where that is not set.
    pub generated: Option<String>,
    /// Every variable.
    pub variables: Vec<Variable>,
    /// Which variable depends on which.
    pub dependencies: Dependencies,
}

impl Description {
    /// Describes the unit `U`.
    pub fn new<U: Unit>() -> Self {
        let variables = variables::<U>();
        Self {
            identifier: U::IDENTIFIER,
            title: U::TITLE,
            summary: U::ABSTRACT,
            equations: U::EQUATIONS,
            validity: U::VALIDITY,
            sets: U::SETS,
            continuous: U::CONTINUOUS,
            experiment: U::EXPERIMENT,
            token: token_text(token::<U>()),
            generated: date::generated(),
            dependencies: Dependencies::new::<U>(),
            variables,
        }
    }

    /// The same unit with integers in the place of enumerations, for importers that read none. What it computes and its
    /// token stay.
    #[must_use]
    pub fn without_enumerations(&self) -> Self {
        let mut plain = self.clone();
        plain.variables.iter_mut().for_each(|variable| variable.items = &[]);
        plain
    }

    /// `modelDescription.xml` of FMI 2.0.
    pub fn fmi2(&self) -> String {
        fmi2::write(self)
    }

    /// `modelDescription.xml` of FMI 3.0.
    pub fn fmi3(&self) -> String {
        fmi3::write(self)
    }

    /// `terminalsAndIcons.xml`, the same in both versions.
    pub fn terminals(&self) -> String {
        terminals::write(self)
    }
}

/// Hash of everything in the variables that an importer relies on (FNV-1a, 128 bits).
pub(crate) fn token<U: Unit>() -> u128 {
    let mut hash: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    let mut feed = |text: &str| {
        for byte in text.bytes().chain([0]) {
            hash = (hash ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
        }
    };
    feed(U::IDENTIFIER);
    feed(VERSION);
    for variable in variables::<U>() {
        let Variable { name, slot, value_type, role, field, items } = variable;
        feed(&format!(
            "{name} {} {value_type:?} {role:?} {} {} {:?}",
            slot.reference(),
            field.unit,
            field.len,
            field.start
        ));
        items.iter().for_each(|item| feed(item));
    }
    hash
}

/// A token in the form of a GUID.
pub(crate) fn token_text(token: u128) -> String {
    let digits = format!("{token:032x}");
    let parts = [&digits[..8], &digits[8..12], &digits[12..16], &digits[16..20], &digits[20..]];
    format!("{{{}}}", parts.join("-"))
}
