//! What a controller does about chatter.
//!
//! Rules reckon with the nominal structure of the tool; the machine's own differs from it. Only the
//! reactive rule hears the true chatter frequency, with the error of its sensor.

use super::{Conditions, Observation, PolicyError};
use crate::{Cut, ProcessModel, StabilityRule, Uncertainty};
use std::sync::Arc;
use toolroom_chatter::{Axis, ChatterError, Scatter, SpeedVariation};
use toolroom_cutting::{Milling, MillingInput, MillingState, Turning, TurningInput, TurningState};
use toolroom_effects::Effects;

/// Share of the programmed speed by which a rule moves it at most, up or down (assumption): farther
/// off, wear and power are no longer those that the process was planned for.
const WINDOW: f64 = 0.35;
/// Speeds that are compared within the window.
const SPEEDS: usize = 141;
/// Samples of uncertain constants.
const SAMPLES: u64 = 64;
/// Seed of these samples: every controller reckons with the same.
const SEED: u64 = 1;
/// Places along a pass at which the limit is requested.
const PLACES: usize = 5;
/// Layers of a pass at most (assumption).
const MOST_LAYERS: f64 = 20.0;

/// Depth (m) at which `cut` chatters somewhere along its pass at `cutting_speed` (m/s) with a land
/// of `flank_wear` (m), by the nominal structure of its tool; infinite where it never does, `None`
/// where no structure is known.
pub fn nominal_limit(process: &ProcessModel, cut: &Cut, cutting_speed: f64, flank_wear: f64) -> Option<f64> {
    Some(Nominal::of(process, cut)?.limit(cutting_speed, flank_wear))
}

/// A rule against chatter for one nominal cut.
#[derive(Clone, Debug, PartialEq)]
pub struct Stability {
    plan: Plan,
    cut: Nominal,
}

#[derive(Clone, Debug, PartialEq)]
enum Plan {
    /// A speed chosen beforehand, m/s.
    Fixed(f64),
    Reactive {
        reaction_time: f64,
    },
    Variation(SpeedVariation),
    Layers {
        share: f64,
    },
    Constraint {
        margin: f64,
    },
}

/// What is known of a cut: process and structure as the file describes them, without effects.
#[derive(Clone, Debug, PartialEq)]
enum Nominal {
    Turning { process: Arc<Turning>, input: TurningInput, run: f64 },
    Milling { process: Arc<Milling>, input: MillingInput },
}

impl Stability {
    /// Works out `rule` for `cut` within the `range` of speeds of the machine; `None` where nothing
    /// is to be done or no structure is known.
    pub(super) fn from_stability_rule(
        rule: StabilityRule,
        process: &ProcessModel,
        cut: &Cut,
        range: (f64, f64),
    ) -> Result<Option<Self>, PolicyError> {
        let Some(cut) = Nominal::of(process, cut) else { return Ok(None) };
        let plan = match rule {
            StabilityRule::Ignore => return Ok(None),
            StabilityRule::BestLobe => Plan::Fixed(cut.best_lobe(range)),
            StabilityRule::RobustLobe { uncertainty } => Plan::Fixed(cut.robust_lobe(range, uncertainty)?),
            StabilityRule::Reactive { reaction_time } => Plan::Reactive { reaction_time },
            StabilityRule::SpeedVariation { amplitude, revolutions } => {
                Plan::Variation(SpeedVariation { amplitude, revolutions, phase: None })
            }
            StabilityRule::DepthReduction { share } => Plan::Layers { share },
            StabilityRule::Constraint { margin } => Plan::Constraint { margin },
        };
        Ok(Some(Self { plan, cut }))
    }

    /// The command with the rule applied, within the `range` of the machine.
    pub(super) fn applied(
        &self,
        requested: Conditions,
        observation: &Observation<'_>,
        range: (f64, f64),
    ) -> Conditions {
        match self.plan {
            Plan::Fixed(speed) => Conditions::constant(speed),
            Plan::Reactive { .. } => observation.reaction.map_or(requested, Conditions::constant),
            Plan::Variation(variation) => {
                // The greatest speed of the variation is the machine's to give as well.
                let most = range.1 / (1.0 + variation.amplitude);
                let held = |speed: f64| speed.min(most).max(range.0);
                let (start_speed, end_speed) = (held(requested.start_speed), held(requested.end_speed));
                Conditions { start_speed, end_speed, variation: Some(variation), ..requested }
            }
            Plan::Layers { share } => {
                let limit = self.cut.limit(requested.start_speed, observation.flank_wear().unwrap_or(0.0));
                let layers = (self.cut.depth() / (share * limit)).ceil().clamp(1.0, MOST_LAYERS);
                Conditions { layers: layers as u32, ..requested }
            }
            Plan::Constraint { margin } => {
                let wanted = 0.5 * (requested.start_speed + requested.end_speed);
                let flank_wear = observation.flank_wear().unwrap_or(0.0);
                let deep_enough = self.cut.depth() / (1.0 - margin);
                let fits = |speed: f64| self.cut.limit(speed, flank_wear) >= deep_enough;
                match nearest(&self.cut.speeds(range), wanted, fits) {
                    Some(speed) if speed == wanted => requested,
                    Some(speed) => Conditions::constant(speed),
                    // Nowhere stable: where it is the least unstable.
                    None => Conditions::constant(self.cut.steadiest(&self.cut.speeds(range), flank_wear)),
                }
            }
        }
    }

    /// Time from the sound of chatter to another speed, s; `None` where nobody listens.
    pub fn reaction_time(&self) -> Option<f64> {
        match self.plan {
            Plan::Reactive { reaction_time } => Some(reaction_time),
            Plan::Fixed(_) | Plan::Variation(_) | Plan::Layers { .. } | Plan::Constraint { .. } => None,
        }
    }

    /// Smith and Tlusty's answer to chatter at `frequency` (Hz) and `speed` (m/s): the nearest
    /// cutting speed in `range` at which teeth pass in step with it, `N n = f/j`, that was not tried before.
    ///
    /// # Source
    /// Smith and Tlusty, CIRP Annals 41 (1992), regulation of spindle speed.
    pub fn reaction(&self, frequency: f64, speed: f64, tried: &[f64], range: (f64, f64)) -> Option<f64> {
        let per_frequency = self.cut.speed_per_passing_frequency();
        let known = |candidate: f64| tried.iter().any(|each| (candidate / each - 1.0).abs() < 0.01);
        (1..=400)
            .map(|j| frequency / f64::from(j) * per_frequency)
            .filter(|each| (range.0..=range.1).contains(each) && !known(*each))
            .min_by(|a, b| (a / speed).ln().abs().total_cmp(&(b / speed).ln().abs()))
    }
}

/// The speed nearest to `wanted`, itself first, that fits.
fn nearest(speeds: &[f64], wanted: f64, fits: impl Fn(f64) -> bool) -> Option<f64> {
    if fits(wanted) {
        return Some(wanted);
    }
    let mut order = speeds.to_vec();
    order.sort_by(|a, b| (a / wanted).ln().abs().total_cmp(&(b / wanted).ln().abs()));
    order.into_iter().find(|speed| fits(*speed))
}

impl Nominal {
    fn of(process: &ProcessModel, cut: &Cut) -> Option<Self> {
        match process {
            ProcessModel::Turning(turning) if turning.structure.is_some() => {
                let input = TurningInput {
                    cutting_speed: cut.cutting_speed,
                    feed_per_rev: cut.feed,
                    depth_of_cut: cut.depth_of_cut,
                    workpiece_diameter: cut.diameter,
                    position: cut.position,
                    ..TurningInput::default()
                };
                let process = Arc::new(Turning { effects: Effects::default(), ..Turning::clone(turning) });
                let length = cut.path_length * cut.feed / (std::f64::consts::PI * cut.diameter);
                Some(Self::Turning { process, input, run: length.min(cut.position) })
            }
            ProcessModel::Milling(milling) if milling.structure.is_some() => {
                let input = MillingInput {
                    cutting_speed: cut.cutting_speed,
                    feed_per_tooth: cut.feed,
                    depth_of_cut: cut.depth_of_cut,
                    width_of_cut: cut.width_of_cut,
                    ..MillingInput::default()
                };
                let process = Arc::new(Milling { effects: Effects::default(), ..Milling::clone(milling) });
                Some(Self::Milling { process, input })
            }
            ProcessModel::Turning(_) | ProcessModel::Milling(_) | ProcessModel::Infeed(_) | ProcessModel::Other(_) => {
                None
            }
        }
    }

    fn depth(&self) -> f64 {
        match self {
            Self::Turning { input, .. } => input.depth_of_cut,
            Self::Milling { input, .. } => input.depth_of_cut,
        }
    }

    fn programmed(&self) -> f64 {
        match self {
            Self::Turning { input, .. } => input.cutting_speed,
            Self::Milling { input, .. } => input.cutting_speed,
        }
    }

    /// Cutting speed at which teeth pass once a second, m.
    fn speed_per_passing_frequency(&self) -> f64 {
        match self {
            Self::Turning { input, .. } => std::f64::consts::PI * input.workpiece_diameter,
            Self::Milling { process, .. } => std::f64::consts::PI * process.cutter.diameter / process.cutter.teeth,
        }
    }

    /// Speeds to choose from, evenly on the scale of ratios.
    fn speeds(&self, range: (f64, f64)) -> Vec<f64> {
        let programmed = self.programmed();
        let low = (programmed * (1.0 - WINDOW)).max(range.0).min(range.1);
        let high = (programmed * (1.0 + WINDOW)).min(range.1).max(low);
        (0..SPEEDS).map(|i| low * (high / low).powf(i as f64 / (SPEEDS - 1) as f64)).collect()
    }

    /// Nominal limit of the depth over the whole pass, m.
    fn limit(&self, cutting_speed: f64, flank_wear: f64) -> f64 {
        match self {
            Self::Turning { process, input, run } => {
                let places = if *run > 0.0 { PLACES } else { 1 };
                let x = TurningState { flank_wear, ..TurningState::default() };
                let limit_at = |i: usize| {
                    let position = input.position - run * i as f64 / (PLACES - 1) as f64;
                    let input = TurningInput { cutting_speed, position, ..*input };
                    process.stability_limit(&x, &input).map_or(f64::INFINITY, |(depth, _)| depth)
                };
                (0..places).map(limit_at).fold(f64::INFINITY, f64::min)
            }
            Self::Milling { process, input } => {
                let x = MillingState { flank_wear, ..MillingState::default() };
                let input = MillingInput { cutting_speed, ..*input };
                process.stability_limit(&x, &input).map_or(f64::INFINITY, |(depth, _)| depth)
            }
        }
    }

    fn steadiest(&self, speeds: &[f64], flank_wear: f64) -> f64 {
        let programmed = self.programmed();
        let far = |speed: f64| (speed / programmed).ln().abs();
        let better = |a: &&f64, b: &&f64| {
            self.limit(**a, flank_wear).total_cmp(&self.limit(**b, flank_wear)).then(far(**b).total_cmp(&far(**a)))
        };
        speeds.iter().max_by(better).copied().unwrap_or(programmed)
    }

    fn best_lobe(&self, range: (f64, f64)) -> f64 {
        self.steadiest(&self.speeds(range), 0.0)
    }

    /// Most probably stable; of equals the nearest to the programmed speed.
    fn robust_lobe(&self, range: (f64, f64), uncertainty: Uncertainty) -> Result<f64, ChatterError> {
        let Uncertainty { natural_frequency, damping_ratio, coefficients } = uncertainty;
        let scatter = Scatter { natural_frequency, damping_ratio, coefficients };
        let speeds = self.speeds(range);
        let (first, last) = (speeds[0], speeds[speeds.len() - 1]);
        if first >= last {
            return Ok(first);
        }
        let programmed = self.programmed();
        // Of speeds that are equally probable the nearest to the programmed one.
        let by_distance = |radius: f64| -> Result<Vec<f64>, ChatterError> {
            let axis = Axis { start: first / radius, end: last / radius, points: SPEEDS };
            let mut speeds = axis.values("speed")?;
            let far = |speed: f64| (speed * radius / programmed).ln().abs();
            speeds.sort_by(|a, b| far(*a).total_cmp(&far(*b)));
            Ok(speeds)
        };
        let (best, radius) = match self {
            Self::Turning { process, input, run } => {
                let places = (0..if *run > 0.0 { PLACES } else { 1 })
                    .map(|i| input.position - run * i as f64 / (PLACES - 1) as f64);
                let limit = |position: &f64| {
                    let input = TurningInput { position: *position, ..*input };
                    process.stability_limit(&TurningState::default(), &input).map_or(f64::INFINITY, |(depth, _)| depth)
                };
                let softest = places.min_by(|a, b| limit(a).total_cmp(&limit(b))).unwrap_or(input.position);
                let input = TurningInput { position: softest, ..*input };
                let radius = 0.5 * input.workpiece_diameter;
                let cut = process.regenerative(&TurningState::default(), &input).ok_or(ChatterError::NoModes)?;
                let speeds = by_distance(radius)?;
                (cut.most_probably_stable(&speeds, input.depth_of_cut, &scatter, SAMPLES, SEED)?, radius)
            }
            Self::Milling { process, input } => {
                let radius = 0.5 * process.cutter.diameter;
                let cut = process.regenerative(&MillingState::default(), input).ok_or(ChatterError::NoModes)?;
                let speeds = by_distance(radius)?;
                (cut.most_probably_stable(&speeds, input.depth_of_cut, &scatter, SAMPLES, SEED)?, radius)
            }
        };
        Ok(best.map_or(programmed, |speed| speed * radius))
    }
}
