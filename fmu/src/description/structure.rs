//! Which unknown depends on which known, found by trying.
//!
//! The equations are the only place that knows. Each known is moved at several points of the
//! range with every effect switched on; what changes in the last bit depends on it.

use crate::configured::Configured;
use crate::instance::nominal_of;
use crate::unit::Unit;
use crate::variable::Slot;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use toolroom_process::{Field, Kind, Record};

/// Points at which dependencies are looked for.
const POINTS: u64 = 200;
/// Points with a verdict on chatter, on each of two machines.
const JUDGED_POINTS: u64 = 2;
/// Share by which a known is moved: more than a verdict is rounded by.
const NUDGE: f64 = 0.25;
/// Share of the shipped stiffness that makes usual cuts unstable.
const SOFT: f64 = 0.02;

/// Knowns of each unknown that is continuous: outputs, derivatives, indicators.
#[derive(Clone, Debug, Default)]
pub struct Dependencies(BTreeMap<u32, Vec<u32>>);

impl Dependencies {
    /// Value references of the knowns of `unknown`; `None` where they were not looked for.
    pub fn of_unknown(&self, unknown: u32) -> Option<&[u32]> {
        self.0.get(&unknown).map(Vec::as_slice)
    }

    /// Tries the unit `U`.
    pub fn new<U: Unit>() -> Self {
        let mut found = Self::default();
        for unknown in unknowns::<U>() {
            found.0.insert(unknown.reference(), Vec::new());
        }
        let mut process = Configured::<U>::shipped();
        let fields = Arc::clone(&process.fields);
        let size = |field: &Field| (0.2 * nominal_of(field.display, field.unit)).min(field.max);
        let set = |wanted: fn(&str) -> bool| {
            let chosen = fields.iter().enumerate().filter(move |(_, (name, _))| wanted(name));
            chosen.map(|(i, (_, field))| (i, if field.kind == Kind::Boolean { 1.0 } else { size(field) }))
        };
        // A fifth of a display unit lies in the range of every effect's size.
        let effects: Vec<_> = set(|name| name.starts_with("effect.")).collect();
        if process.assign(&effects).is_ok() {
            found.try_points(&process.process, POINTS, Scatter::Everything);
        }
        // Verdicts on chatter take long, those at varying speed very long.
        let chatter: Vec<_> = set(|name| name == "machine.chatter").collect();
        if !chatter.is_empty() && process.assign(&chatter).is_ok() {
            let mut judged = Self::default();
            judged.try_points(&process.process, JUDGED_POINTS, Scatter::WhatIsNotZero);
            // Usual cuts are stable on the shipped machine, and unstable on a soft one that the
            // process does not damp.
            let mut soft: Vec<_> = set(|name| name.ends_with(".process_damping")).map(|(i, _)| (i, 0.0)).collect();
            soft.extend(set(|name| name == "machine.stiffness").map(|(i, _)| (i, SOFT * fields[i].1.start)));
            if process.assign(&soft).is_ok() {
                judged.try_points(&process.process, JUDGED_POINTS, Scatter::WhatIsNotZero);
            }
            found.add_verdict(&judged);
        }
        found.0.values_mut().for_each(|knowns| knowns.sort_unstable());
        found
    }

    /// Adds what depends on the verdict on chatter: all of it hangs on the same knowns, of which a
    /// few points show each output only a part (a stable cut has no frequency, and a verdict is
    /// kept at rounded speed and damping).
    fn add_verdict(&mut self, judged: &Self) {
        let gain = |(unknown, knowns): (&u32, &Vec<u32>)| -> (u32, Vec<u32>) {
            (*unknown, knowns.iter().filter(|known| !self.0[unknown].contains(known)).copied().collect())
        };
        let gains: Vec<(u32, Vec<u32>)> = judged.0.iter().map(gain).filter(|(_, gain)| !gain.is_empty()).collect();
        let verdict: BTreeSet<u32> = gains.iter().flat_map(|(_, gain)| gain).copied().collect();
        for (unknown, _) in gains {
            let knowns = self.0.entry(unknown).or_default();
            let whole: BTreeSet<u32> = knowns.iter().chain(&verdict).copied().collect();
            *knowns = whole.into_iter().collect();
        }
    }

    /// Moves each known at points of the range and notes what changes.
    fn try_points<U: Unit>(&mut self, process: &U, points: u64, scatter: Scatter) {
        let unknowns = unknowns::<U>();
        for point in 0..points {
            let x = scattered::<U::State>(point, Scatter::Everything);
            let u = scattered::<U::Input>(point + 1000, scatter);
            let before = evaluate(process, &x, &u);
            let mut compare = |known: Slot, x: &U::State, u: &U::Input| {
                let after = evaluate(process, x, u);
                // A force below zero: the effects together left the range of the equations.
                if outside::<U>(&before) || outside::<U>(&after) {
                    return;
                }
                for ((unknown, before), after) in unknowns.iter().zip(&before).zip(after) {
                    let knowns = self.0.entry(unknown.reference()).or_default();
                    if before.to_bits() != after.to_bits() && !knowns.contains(&known.reference()) {
                        knowns.push(known.reference());
                    }
                }
            };
            for (i, field) in U::Input::FIELDS.iter().enumerate() {
                compare(Slot::Input(i), &x, &nudged(&u, i, field));
            }
            let mut index = 0;
            for (i, field) in U::State::FIELDS.iter().enumerate() {
                // Elements at both ends and in the middle stand for an array.
                for element in [index, index + field.len / 2, index + field.len - 1] {
                    compare(Slot::State(i), &nudged(&x, element, field), &u);
                }
                index += field.len;
            }
        }
    }
}

/// Which elements of a record are moved away from their start values.
#[derive(Clone, Copy, PartialEq)]
enum Scatter {
    Everything,
    WhatIsNotZero,
}

fn unknowns<U: Unit>() -> Vec<Slot> {
    let outputs = (0..U::Output::FIELDS.len()).map(Slot::Output);
    let indicators = (0..U::EVENTS.len()).map(Slot::Indicator);
    let rates = (0..U::State::FIELDS.len()).map(Slot::Derivative).filter(|_| U::CONTINUOUS);
    outputs.chain(indicators).chain(rates).collect()
}

fn evaluate<U: Unit>(process: &U, x: &U::State, u: &U::Input) -> Vec<f64> {
    let output = process.output(x, u);
    let mut values: Vec<f64> = (0..U::Output::LEN).filter_map(|i| output.get(i)).collect();
    let mut indicators = vec![0.0; U::EVENTS.len()];
    process.event_indicators(x, u, &mut indicators);
    values.append(&mut indicators);
    if let Some(rates) = process.derivative(x, u).filter(|_| U::CONTINUOUS) {
        values.extend((0..U::State::LEN).filter_map(|i| rates.get(i)));
    }
    values
}

/// Whether an amplitude is below zero.
fn outside<U: Unit>(values: &[f64]) -> bool {
    let amplitude = |field: &Field| field.name == "vibration_amplitude";
    U::Output::FIELDS.iter().zip(values).any(|(field, value)| amplitude(field) && *value < 0.0)
}

/// A point of the range around the start values.
fn scattered<R: Record>(point: u64, scatter: Scatter) -> R {
    let mut record = R::default();
    let mut seed = point.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut share = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 53) as f64
    };
    let scale = [0.1, 1.0, 100.0][(point % 3) as usize];
    let elements = R::FIELDS.iter().flat_map(|field| std::iter::repeat_n(field, field.len));
    for (i, field) in elements.enumerate() {
        let value = match field.kind {
            Kind::Boolean => f64::from(share() > 0.3),
            Kind::Integer => field.start,
            Kind::Real if field.start != 0.0 => field.start * (0.6 + 0.8 * share()),
            Kind::Real if scatter == Scatter::WhatIsNotZero => 0.0,
            Kind::Real => scale * nominal_of(field.display, field.unit) * share(),
        };
        record.set(i, value.clamp(field.min, field.max));
    }
    record
}

/// The record with element `i` moved within its range.
fn nudged<R: Record>(record: &R, i: usize, field: &Field) -> R {
    let mut nudged = *record;
    let value = record.get(i).unwrap_or(0.0);
    let step = match field.kind {
        Kind::Real => NUDGE * value.abs() + 1e-3 * nominal_of(field.display, field.unit).abs(),
        Kind::Boolean | Kind::Integer => 1.0,
    };
    let up = value + step;
    nudged.set(i, if up <= field.max { up } else { value - step });
    nudged
}
