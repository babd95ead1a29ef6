//! Shapes in which an effect is tried on records, by its row of the catalogue; or why it is not tried.

use super::features::{self, standardised};
use super::{Candidate, EffectId, Untried};
use toolroom_effects::{CatalogueEntry, Definition, Effect, Effects, Search, UserEffect};
use toolroom_records::Records;
use toolroom_statistics::median;

/// Effects of the catalogue that act on a process, then those that a user has defined for it.
pub(super) fn effects_of(process: &'static str, defined: &[&'static Definition]) -> Vec<Effect> {
    let every = Effects::every(process);
    // What is a constant everywhere is an effect on parts of the records only.
    let is_searched = |effect: &&&'static Definition| {
        effect.entry().search(process).is_some() && !EffectId::from(**effect).is_wear_rate()
    };
    let searched = defined.iter().filter(is_searched);
    every.iter().copied().chain(searched.map(|effect| Effect::User(UserEffect::new(effect)))).collect()
}

/// Effects of a catalogue that are not among the candidates, each with what the records lack.
pub(super) fn missing(catalogue: &'static [CatalogueEntry], candidates: &[Candidate]) -> Vec<Untried> {
    let absent = catalogue.iter().map(EffectId::from).filter(|id| candidates.iter().all(|own| own.id != *id));
    absent.map(|id| Untried { id, reason: format!("the records do not show {}", id.entry().regime) }).collect()
}

/// Rows on which a shape acts, where it is not all of them.
pub(super) enum Rows {
    All,
    /// 1 on those of one lot.
    Lot(String, Vec<f64>),
    /// 1 on those of one coolant.
    Coolant(Vec<f64>),
    /// All, and infeed is positioned by command since the dressing.
    SinceDressing,
}

/// An effect in a shape that the records can tell.
pub(super) struct Shape {
    /// What distinguishes it from others of the same effect; may be empty.
    pub name: String,
    pub effect: Effect,
    /// An ordinary size, SI.
    pub typical: f64,
    /// Greatest admissible size, SI.
    pub greatest: f64,
    pub rows: Rows,
}

/// What the records and their model can tell of effects.
pub(super) struct SearchContext<'a> {
    pub process: &'static str,
    pub records: &'a Records,
    /// Greatest value of a quantity of the context, where it varies.
    pub greatest: &'a dyn Fn(&str) -> Option<f64>,
    /// Ways to act on some rows only that the model has.
    pub ways: &'static [Way],
}

/// A way to act on some rows only.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Way {
    Lots,
    Coolants,
    WheelPosition,
}

impl SearchContext<'_> {
    /// Shapes of an effect that acts on the process.
    ///
    /// # Errors
    /// Why there is none.
    pub fn shapes(&self, effect: Effect) -> Result<Vec<Shape>, String> {
        let entry = effect.entry();
        let most = entry.size.max;
        let shape = |name: String, effect: Effect, typical: f64| Shape {
            name,
            effect,
            typical,
            greatest: most,
            rows: Rows::All,
        };
        let one = |typical: f64| vec![shape(String::new(), effect, typical)];
        let search = entry.search(self.process).ok_or_else(|| format!("it does not act on {}", self.process))?;
        let shapes = match search {
            Search::Untried(reason) => return Err(reason.to_owned()),
            Search::Shaped => return Err(format!("nothing shapes it in records of {}", self.process)),
            Search::Size(size) => one(size),
            Search::ShareOfMedian { column, share } => {
                let level = self.level(column).ok_or_else(|| format!("{column} is not recorded"))?;
                one(share * level)
            }
            Search::AtGreatest { quantity, change, most: admitted } => {
                let greatest =
                    (self.greatest)(quantity).ok_or_else(|| format!("{quantity} is not recorded or does not vary"))?;
                vec![Shape {
                    greatest: most.min(admitted / greatest),
                    ..shape(String::new(), effect, change / greatest)
                }]
            }
            Search::Values { parameter, values, told_by, size } => {
                let told = |column: &str| self.records.numbers(column).and_then(standardised).is_some();
                let usual = told_by.filter(|(column, _)| !told(column)).map(|(_, usual)| [usual]);
                let values = usual.as_ref().map_or(values, |usual| &usual[..]);
                let each = |value: &f64| {
                    Some(shape(shown(effect, parameter, *value)?, with(effect, parameter, *value)?, size))
                };
                values.iter().filter_map(each).collect()
            }
            Search::Window { column, centre, width, count, size } => {
                let (low, high) = self.range(column).ok_or_else(|| format!("{column} does not vary by {SPREAD}"))?;
                let window = |i: usize, narrow: bool| {
                    let middle = low * (high / low).powf(i as f64 / (count - 1) as f64);
                    let placed = with(effect, centre, middle)?;
                    let placed = if narrow { with(placed, width.0, width.1)? } else { placed };
                    let narrow = if narrow { ", narrow" } else { "" };
                    Some(shape(format!("{:.0} m/min{narrow}", middle * 60.0), placed, size))
                };
                [false, true].into_iter().flat_map(|narrow| (0..count).filter_map(move |i| window(i, narrow))).collect()
            }
            Search::Below { column, bound, size } => {
                let below = |values: &[f64]| values.iter().any(|value| *value < bound);
                if !self.records.numbers(column).is_some_and(below) {
                    return Err(format!("no {column} below {bound} is recorded"));
                }
                one(size)
            }
            Search::Lots(size) => {
                let rows = self.levels(Way::Lots, "lot")?.into_iter();
                let lot = |(level, rows): (String, Vec<f64>)| {
                    let named = shape(format!("lot {level}"), effect, size);
                    Shape { rows: Rows::Lot(level, rows), ..named }
                };
                rows.map(lot).collect()
            }
            Search::CoolantStiffness(size) => {
                let rows = self.levels(Way::Coolants, "coolant_id")?.into_iter();
                let coolant = |(level, rows): (String, Vec<f64>)| Shape {
                    rows: Rows::Coolant(rows),
                    ..shape(format!("coolant {level}"), effect, size)
                };
                rows.map(coolant).collect()
            }
            Search::WheelPosition { each_part, since_dressing } => {
                self.has(Way::WheelPosition)?;
                let positioned = shape("positioned since dressing".to_owned(), effect, since_dressing);
                vec![
                    shape("each part finds contact".to_owned(), effect, each_part),
                    Shape { rows: Rows::SinceDressing, ..positioned },
                ]
            }
        };
        Ok(shapes)
    }

    fn has(&self, way: Way) -> Result<(), String> {
        if self.ways.contains(&way) {
            return Ok(());
        }
        let what = match way {
            Way::Lots => "lots",
            Way::Coolants => "coolants",
            Way::WheelPosition => "the position of a wheel",
        };
        Err(format!("the model of {} tells nothing of {what}", self.process))
    }

    /// Levels of a text column by name, each with 1 on its rows.
    fn levels(&self, way: Way, column: &str) -> Result<Vec<(String, Vec<f64>)>, String> {
        self.has(way)?;
        let levels = features::indicators(self.records, &[column]);
        let named: Vec<_> = levels.into_iter().map(|(_, level, rows)| (level, rows)).collect();
        if named.is_empty() { Err(format!("{column} does not vary")) } else { Ok(named) }
    }

    fn level(&self, column: &str) -> Option<f64> {
        let values = self.records.numbers(column)?.iter().copied().filter(|value| value.is_finite());
        let mut values: Vec<f64> = values.collect();
        (!values.is_empty()).then(|| median(&mut values))
    }

    /// Least and greatest positive value of a column, where they differ enough.
    fn range(&self, column: &str) -> Option<(f64, f64)> {
        let values = self.records.numbers(column)?;
        let known = || values.iter().copied().filter(|value| value.is_finite() && *value > 0.0);
        let (low, high) = (known().fold(f64::INFINITY, f64::min), known().fold(0.0, f64::max));
        (high >= SPREAD * low).then_some((low, high))
    }
}

/// Least ratio of the ends of a range in which windows are told apart (assumption).
const SPREAD: f64 = 1.2;

/// A value of a parameter for people, with the name of the parameter where the effect is a user's.
fn shown(effect: Effect, name: &str, value: f64) -> Option<String> {
    let field = effect.parameters().fields().iter().find(|field| field.name == name)?;
    let Some(definition) = effect.definition() else { return Some(format!("{value} {}", field.unit)) };
    let unit = if field.display == "1" { String::new() } else { format!(" {}", field.display) };
    let shown = format!("{:.4}", field.to_display(value));
    let shown = shown.trim_end_matches('0').trim_end_matches('.');
    Some(format!("{}{name} {shown}{unit}", if definition.is_empirical() { "empirical, " } else { "" }))
}

/// The effect with another value of a parameter, SI.
fn with(mut effect: Effect, name: &str, value: f64) -> Option<Effect> {
    let i = effect.parameters().fields().iter().position(|field| field.name == name)?;
    effect.parameters_mut().set_value(i, value);
    Some(effect)
}

/// Greatest value of a recorded column that varies.
pub(super) fn greatest(records: &Records, column: &str) -> Option<f64> {
    let values = records.numbers(column)?;
    standardised(values)?;
    Some(values.iter().copied().filter(|value| value.is_finite()).fold(0.0, f64::max))
}
