//! Candidates of the search, run through the process itself.

use super::ROUNDING;
use super::candidate::{Candidate, LONGEST, Task};
use super::caps::keeps;
use super::law::Law;
use crate::law::{REFERENCE_DEPTH, chip};
use crate::load::Load;
use crate::{Input, State};
use std::cell::Cell;

/// Revolutions that a search may go through before it gives up (assumption: some seconds).
const MOST_TURNS: u64 = 20_000_000;

/// Runs candidates of a task where the closed form does not hold: the wheel becomes blunter within the part, or the force
/// is no straight line of the depth.
pub(super) struct Run<'a> {
    task: Task<'a>,
    start: State,
    /// A law whose depths are never above the real ones; none where the force is bent.
    pub below: Option<Law>,
    /// The straight law of the wheel as blunt as it gets.
    blunt: Law,
    /// The wheel as blunt as it gets on this part.
    end: State,
    /// Greatest deflection that the limits allow at the end of the rough phase, m.
    deflection: f64,
    /// Greatest infeed per revolution to which a rough phase can come, m.
    steady: f64,
    turns: Cell<u64>,
}

impl<'a> Run<'a> {
    /// Of a wheel that starts with `law` and whose limits allow `rough_depth`.
    pub fn new(task: Task<'a>, law: Law, rough_depth: f64) -> Self {
        let p = &task.grinding.parameters;
        // Contact is found anew on each part: earlier wear of the wheel does not enter its size.
        let start = State { wheel_wear: 0.0, ..task.grinding.new_part(task.wheel) };
        let ground = std::f64::consts::PI * p.work_diameter * task.limits.stock;
        let end = State { removed_volume: task.wheel.removed_volume + ground, ..*task.wheel };
        let [compliance, wear, threshold] = task.grinding.shares(&end, task.input);
        let exponent = p.force_exponent;
        let deflection = threshold.max(law.threshold)
            + compliance.max(law.compliance) * chip(rough_depth, exponent, REFERENCE_DEPTH);
        // Thin chips are the stiffest: the last ones bound the straight law.
        let last = task.limits.last_depth;
        let secant = compliance * chip(last, exponent, REFERENCE_DEPTH) / last;
        let blunt = Law::with([secant, wear, threshold]);
        let dulls = compliance >= law.compliance && exponent == 1.0;
        Self {
            task,
            start,
            below: dulls.then(|| law.below(&blunt)),
            blunt,
            end,
            deflection,
            steady: rough_depth * (1.0 + wear.max(law.wear)),
            turns: Cell::new(0),
        }
    }

    /// Whether the search has gone through as many revolutions as it may.
    pub fn spent(&self) -> bool {
        self.turns.get() > MOST_TURNS
    }

    /// The task for the wheel as blunt as it gets, with its straight law.
    pub fn blunt(&self) -> (Task<'_>, Law) {
        (Task { wheel: &self.end, ..self.task }, self.blunt)
    }

    /// A number of rough revolutions below which none keeps the limits: their depths and the deflection at the end make
    /// up the stock.
    pub fn fewest_rough(&self, rough_stock: f64) -> u32 {
        let by_depth = (rough_stock - self.deflection) / self.steady;
        let by_infeed = rough_stock / self.task.limits.greatest_infeed;
        (by_depth.max(by_infeed) * (1.0 - 1e-9)).ceil().clamp(1.0, f64::from(LONGEST) + 1.0) as u32
    }

    fn turn(&self, part: &mut State, infeed_per_rev: f64) -> Load {
        self.turns.set(self.turns.get() + 1);
        let input = Input { infeed_per_rev, engaged: 1.0, ..*self.task.input };
        part.commanded_infeed += infeed_per_rev;
        let sharp = part.removed_volume;
        *part = self.task.grinding.cold_revolution(part, &input);
        // The force is that of the wheel that has cut, not of the blunter one that it has become.
        self.task.grinding.load(&State { removed_volume: sharp, ..*part }, &input)
    }

    /// The cycle with the least spark-out, where these rough and finish revolutions can make one of up to `longest`
    /// revolutions.
    pub fn complete(&self, begun: Candidate, longest: u32) -> Option<Candidate> {
        let Task { grinding, input, limits, roughness, .. } = self.task;
        if begun.rough_infeed > limits.greatest_infeed * (1.0 + ROUNDING) {
            return None;
        }
        let mut part = self.start;
        let mut blank = limits.blank_roundness_error;
        let phases = [(begun.rough_infeed, begun.rough), (begun.finish_infeed, begun.finish)];
        let mut roughed = 0.0;
        for (index, (infeed, revolutions)) in phases.into_iter().enumerate() {
            for _ in 0..revolutions {
                let load = self.turn(&mut part, infeed);
                if !keeps(&load, limits) {
                    return None;
                }
                if blank > 0.0 {
                    blank *= grinding.decay(&part, input);
                }
            }
            if index == 0 {
                roughed = part.stock_removed;
            }
        }
        if begun.finish > 0 {
            let [_, wear, _] = grinding.shares(&part, input);
            let tends = State { depth_of_cut: begun.finish_infeed / (1.0 + wear), ..part };
            let rise = grinding.output_in_cut(&tends, input).temperature_rise;
            if rise > limits.finish_temperature_rise * (1.0 + ROUNDING) {
                return None;
            }
        }
        let infed = roughness.map(|roughness| (roughness, self.task.roughness_under(part.depth_of_cut)));
        let mut left = 1.0;
        for spark_out in 0.. {
            if begun.rough + begun.finish + spark_out > longest || self.spent() {
                return None;
            }
            let depth = part.depth_of_cut;
            let smooth = infed.is_none_or(|(roughness, infed)| {
                roughness.in_spark_out(infed, left) <= limits.roughness * (1.0 + ROUNDING)
            });
            let fine = depth <= limits.last_depth
                && part.commanded_infeed - part.stock_removed <= limits.size_error
                && depth + blank <= limits.roundness_error;
            let enough = part.stock_removed - roughed >= limits.finish_stock;
            if smooth && fine && enough {
                return (depth > 0.0).then_some(Candidate { spark_out, last_depth: depth, ..begun });
            }
            // What is still missing does not come any more.
            if depth < 1e-6 * limits.last_depth {
                return None;
            }
            let load = self.turn(&mut part, 0.0);
            if !keeps(&load, limits) {
                return None;
            }
            let decay = grinding.decay(&part, input);
            (blank, left) = (blank * decay, left * decay);
        }
        None
    }
}
