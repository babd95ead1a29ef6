//! What each key figure is called, measured in, and wanted to be.

use super::machine_tally::MachineTally;
use super::tally::Tally;
use toolroom_process::unit;
use toolroom_scenario::Scenario;

/// Unit of amounts of money: what they are in, the scenario says.
pub const CURRENCY: &str = "currency";

/// Which way a figure should go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// More is better.
    More,
    /// Less is better.
    Less,
    /// Neither is better by itself.
    Neither,
}

/// A key figure in words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Definition {
    /// Stable name in files.
    pub id: &'static str,
    /// For people.
    pub title: &'static str,
    /// SI unit of the value; `1` for a number, `currency` for money.
    pub unit: &'static str,
    /// Unit in tables; `%` only for people, files keep the share.
    pub display: &'static str,
    /// Which way is better.
    pub better: Better,
    /// What it is, in one sentence.
    pub doc: &'static str,
}

/// A key figure of the shop or of one machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Kpi {
    /// What it is.
    pub definition: Definition,
    /// The machine; `None` for the shop.
    pub machine: Option<usize>,
}

impl Kpi {
    /// Key in JSON: the id, with its unit where it has one: `tool_life [min]`.
    pub fn key(&self) -> String {
        self.definition.key()
    }
}

impl Definition {
    /// Key in JSON: the id, with its unit where it has one: `tool_life [min]`.
    pub fn key(&self) -> String {
        match self.file_unit() {
            "1" | CURRENCY => self.id.to_owned(),
            unit => format!("{} [{unit}]", self.id),
        }
    }

    /// Unit in files.
    pub fn file_unit(&self) -> &'static str {
        if self.display == "%" { "1" } else { self.display }
    }

    /// Unit in files, with the currency of the scenario for amounts of money.
    pub fn file_unit_in<'a>(&self, scenario: &'a Scenario) -> &'a str {
        if self.unit == CURRENCY { &scenario.currency } else { self.file_unit() }
    }

    /// Unit in tables for people: empty for plain numbers, the currency of the scenario for amounts of money.
    pub fn shown_unit_in<'a>(&self, scenario: &'a Scenario) -> &'a str {
        match self.display {
            "1" => "",
            CURRENCY => &scenario.currency,
            unit => unit,
        }
    }

    /// Factor from the SI value to the unit of files.
    pub fn file_scale(&self) -> f64 {
        if self.unit == self.file_unit() { 1.0 } else { unit::convert(1.0, self.unit, self.file_unit()) }
    }

    /// Factor from the SI value to the unit of tables for people.
    pub fn display_scale(&self) -> f64 {
        if self.unit == self.display { 1.0 } else { unit::convert(1.0, self.unit, self.display) }
    }
}

pub(super) const fn define(
    id: &'static str,
    title: &'static str,
    unit: &'static str,
    display: &'static str,
    better: Better,
    doc: &'static str,
) -> Definition {
    Definition { id, title, unit, display, better, doc }
}

/// Availability · effectiveness · quality ratio, in which production time cancels. Where nothing was
/// earned it is 0 without a quality; where nothing was completed it is not defined.
pub(super) fn oee(earned: f64, planned_busy_time: f64, quality_ratio: f64) -> f64 {
    if earned > 0.0 { earned / planned_busy_time * quality_ratio } else { 0.0 / planned_busy_time }
}

/// OEE with setup counted as production.
pub(super) fn net(production: f64, setup: f64, oee: f64) -> f64 {
    if production > 0.0 { (production + setup) / production * oee } else { oee }
}

/// A figure of the shop and how it follows from the sums.
pub(super) type ShopFigure = (Definition, fn(&Scenario, &Tally) -> f64);

/// A figure of a machine.
pub(super) type MachineFigure = (Definition, fn(&Tally, &MachineTally) -> f64);
