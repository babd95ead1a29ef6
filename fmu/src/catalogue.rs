//! The units that the shared library holds.

use crate::component::{Component, Interface};
use crate::description::{self, Description};
use crate::instance::Instance;
use crate::log::Log;
use crate::unit::Unit;
use crate::variable::{Variable, variables};
use std::path::PathBuf;
use std::sync::OnceLock;
use toolroom_control::SpeedController;
use toolroom_cutting::{Milling, Turning};
use toolroom_infeed::InfeedProfile;

/// One unit that can be instantiated and described.
#[derive(Debug)]
pub struct Entry {
    /// Name on the command line.
    pub name: &'static str,
    /// Whether Model Exchange is offered.
    pub continuous: bool,
    identifier: &'static str,
    token: fn() -> u128,
    known_token: OnceLock<u128>,
    describe: fn() -> Description,
    known_description: OnceLock<Description>,
    variables: fn() -> Vec<Variable>,
    make: fn(Interface, Option<PathBuf>, Log) -> Box<dyn Component>,
}

impl Entry {
    const fn of<U: Unit>(name: &'static str) -> Self {
        Self {
            name,
            continuous: U::CONTINUOUS,
            identifier: U::IDENTIFIER,
            token: description::token::<U>,
            known_token: OnceLock::new(),
            describe: Description::new::<U>,
            known_description: OnceLock::new(),
            variables: variables::<U>,
            make: |interface, resources, log| Box::new(Instance::<U>::new(interface, resources, log)),
        }
    }

    /// Instantiation token: changes with every change of the variables.
    pub fn token(&self) -> String {
        description::token_text(*self.known_token.get_or_init(self.token))
    }

    /// Every variable, without which depends on which.
    pub fn variables(&self) -> Vec<Variable> {
        (self.variables)()
    }

    /// Everything that the package says about the unit; finding out which output depends on which
    /// input takes seconds the first time.
    pub fn describe(&self) -> &Description {
        self.known_description.get_or_init(self.describe)
    }

    /// A new instance.
    pub fn instantiate(&self, interface: Interface, resources: Option<PathBuf>, log: Log) -> Box<dyn Component> {
        (self.make)(interface, resources, log)
    }
}

static ENTRIES: [Entry; 4] = [
    Entry::of::<Turning>("turning"),
    Entry::of::<Milling>("milling"),
    Entry::of::<InfeedProfile>("infeed"),
    Entry::of::<SpeedController>("controller"),
];

/// The units that are shipped.
///
/// ```
/// let names: Vec<_> = toolroom_fmu::units().map(|unit| unit.name).collect();
/// assert_eq!(names, ["turning", "milling", "infeed", "controller"]);
/// ```
pub fn units() -> impl Iterator<Item = &'static Entry> {
    ENTRIES.iter()
}

/// Token of a unit, worked out once in a program where the unit is shipped.
pub(crate) fn token<U: Unit>() -> u128 {
    let entry = units().find(|entry| entry.identifier == U::IDENTIFIER);
    entry.map_or_else(description::token::<U>, |entry| *entry.known_token.get_or_init(entry.token))
}

/// The unit with this instantiation token.
pub(crate) fn by_token(token: &str) -> Option<&'static Entry> {
    // FMI 2.0 importers may hand the GUID on in braces or without.
    let bare = |text: &str| text.trim_matches(['{', '}']).to_ascii_lowercase();
    units().find(|entry| bare(&entry.token()) == bare(token))
}
