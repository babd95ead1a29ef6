//! Plunge cycles: fixed, switched by the measured force, or as long as the measured time constant
//! asks for; and when the wheel is dressed.
//!
//! The controller knows the machine's stiffness J and what it commands. Of wheel and part it sees
//! the normal force at the end of each work revolution, with noise.

use crate::{CycleWork, DressingRule, GrindingPhase, GrindingRule, SensorSheet};
use rand_distr::{Distribution as _, StandardNormal};
use toolroom_infeed::{CycleError, Infeed, Input, State, depth_at_temperature};
use toolroom_process::Process;

/// Weight of the parts before this one in the estimate of the lag (assumption).
const MEMORY: f64 = 0.5;
/// Dulling from one design to the next where cycles are designed anew (assumption).
const STEP: f64 = 0.05;
/// Greatest dulling designed for, over that of the first design (assumption).
const GREATEST: f64 = 2.0;
/// A spark-out never lasts longer than this many times the designed one, and five revolutions
/// (assumption): a sensor that shows no end must not stop the machine.
const LONGEST_SPARK_OUT: u32 = 5;
/// Share of the rough infeed below which the low infeed of the rough phase never is (assumption).
const LOW_INFEED: f64 = 0.25;

/// What the force has told about a wheel since it was dressed.
///
/// With `F = F0 + Cp h` and `(1 − K) Cp = J K` the recursion of depth reads
/// `F_i − F0 = K (F_{i−1} − F0 + J S_i)`: one unknown, found by least squares.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WheelEstimate {
    /// Σ x² and Σ x y of the regression.
    squares: f64,
    products: f64,
    /// Force above the threshold force at the last revolution, N.
    force: f64,
    /// Dulling as it was known when the part began.
    dulling: f64,
}

impl WheelEstimate {
    /// The lag K, where any revolution was seen.
    pub fn lag(&self) -> Option<f64> {
        (self.squares > 0.0).then(|| (self.products / self.squares).clamp(0.01, 0.99))
    }
}

/// One revolution as the machine saw it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceReading {
    /// Revolutions ground on this part.
    pub revolution: f64,
    /// Commanded infeed, m.
    pub infeed_per_rev: f64,
    /// Measured normal force, N.
    pub force: f64,
}

/// Cycle and dressing for one grinding operation.
#[derive(Clone, Debug, PartialEq)]
pub struct GrindingController {
    /// Cycles by dulling, in steps of [`STEP`]; one where nothing is designed anew.
    cycles: Vec<Vec<GrindingPhase>>,
    /// Dulling of the first of them.
    dulling: f64,
    adaptation: Adaptation,
    dressing: DressingRule,
    sensors: SensorSheet,
    /// Stiffness of the machine J, N/m.
    system_stiffness: f64,
    /// Compliance Cp/J of a dressed wheel.
    compliance: f64,
    /// Threshold force F0, N.
    threshold_force: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Adaptation {
    None,
    /// Forces above the threshold force, N.
    Force {
        rough: f64,
        end: f64,
    },
    /// Deflection that the size allows and depth that the finish allows, m.
    TimeConstant {
        deflection: f64,
        last_depth: f64,
    },
}

impl GrindingController {
    /// For a cycle given by its phases.
    pub(super) fn programmed(
        phases: &[GrindingPhase],
        wheel: &Infeed,
        dressing: DressingRule,
        sensors: &SensorSheet,
    ) -> Self {
        let believed = Infeed { parameters: wheel.parameters, ..Infeed::default() };
        Self::new(vec![phases.to_vec()], 1.0, Adaptation::None, dressing, sensors, &believed, &Input::default())
    }

    /// For a designed cycle.
    ///
    /// # Errors
    /// [`CycleError`] where the limits cannot be kept on a wheel of the dulling designed for.
    pub(super) fn designed(
        work: &CycleWork,
        rule: GrindingRule,
        dressing: DressingRule,
        sensors: &SensorSheet,
    ) -> Result<Self, CycleError> {
        let CycleWork { believed, conditions, limits, .. } = work;
        let (dulling, redesign) = match rule {
            GrindingRule::Fixed { dulling } | GrindingRule::ForceAdaptive { dulling, .. } => (dulling, false),
            GrindingRule::TimeConstantAdaptive { dulling, redesign } => (dulling, redesign),
        };
        let mut cycles = vec![work.design(dulling)?.to_vec()];
        if redesign {
            let steps = (1..).map(|step| dulling * (1.0 + STEP * f64::from(step)));
            // Where a duller wheel cannot keep the limits any more, the last cycle that does has to do.
            let more = steps.take_while(|each| *each <= dulling * GREATEST).map_while(|each| work.design(each).ok());
            cycles.extend(more.map(|cycle| cycle.to_vec()));
        }
        let system_stiffness = believed.parameters.system_stiffness;
        let threshold = believed.parameters.threshold_force;
        // What the wear of the wheel on this part takes of the size cannot be seen in the force.
        let p = &believed.parameters;
        let wear = p.wheel_wear_ratio * p.work_diameter / p.wheel_diameter * limits.stock;
        let deflection = limits.size_error - threshold / system_stiffness - wear;
        let adaptation = match rule {
            GrindingRule::Fixed { .. } => Adaptation::None,
            GrindingRule::ForceAdaptive { rough_force, .. } => {
                let rough = match rough_force {
                    Some(force) => force - threshold,
                    None => {
                        let allowed = limits.rough_temperature_rise;
                        let depth = depth_at_temperature(
                            believed,
                            &State::default(),
                            conditions,
                            allowed,
                            limits.greatest_infeed,
                        )
                        .map_err(|least| CycleError::TooHotAtAnyDepth {
                            limit: "rough_temperature_rise",
                            allowed,
                            least,
                        })?;
                        believed.cutting_force(&State::default(), conditions, depth)
                    }
                };
                let last = believed.cutting_force(&State::default(), conditions, limits.last_depth);
                let end = (system_stiffness * deflection).min(last);
                Adaptation::Force { rough, end }
            }
            GrindingRule::TimeConstantAdaptive { .. } => {
                Adaptation::TimeConstant { deflection, last_depth: limits.last_depth }
            }
        };
        Ok(Self::new(cycles, dulling, adaptation, dressing, sensors, believed, conditions))
    }

    fn new(
        cycles: Vec<Vec<GrindingPhase>>,
        dulling: f64,
        adaptation: Adaptation,
        dressing: DressingRule,
        sensors: &SensorSheet,
        infeed_model: &Infeed,
        conditions: &Input,
    ) -> Self {
        let system_stiffness = infeed_model.parameters.system_stiffness;
        let dressed = infeed_model.output(&State::default(), conditions);
        Self {
            cycles,
            dulling,
            adaptation,
            dressing,
            sensors: *sensors,
            system_stiffness,
            compliance: dressed.process_stiffness / system_stiffness,
            threshold_force: infeed_model.parameters.threshold_force,
        }
    }

    /// Whether the force is looked at.
    pub fn observes(&self) -> bool {
        self.adaptation != Adaptation::None || matches!(self.dressing, DressingRule::Dulling { .. })
    }

    /// What the sensor shows of a normal force, N.
    pub fn measured(&self, force: f64, noise: &mut toolroom_kernel::Stream) -> f64 {
        let z: f64 = StandardNormal.sample(noise);
        force * (1.0 + self.sensors.normal_force_bias) + self.sensors.normal_force * z
    }

    /// A part comes before the wheel.
    pub fn begin_part(&self, wheel: &mut WheelEstimate) {
        wheel.dulling = self.measured_dulling(wheel).unwrap_or(1.0);
        wheel.squares *= MEMORY;
        wheel.products *= MEMORY;
        wheel.force = 0.0;
    }

    /// A revolution is over.
    pub fn see(&self, wheel: &mut WheelEstimate, reading: &ForceReading) {
        let x = wheel.force + self.system_stiffness * reading.infeed_per_rev;
        wheel.force = reading.force - self.threshold_force;
        wheel.squares += x * x;
        wheel.products += x * wheel.force;
    }

    /// Process stiffness over that of a dressed wheel, as the force tells it.
    pub fn measured_dulling(&self, wheel: &WheelEstimate) -> Option<f64> {
        wheel.lag().map(|lag| lag / (1.0 - lag) / self.compliance)
    }

    /// The revolutions of phase `pass`: what is commanded at once, and what the force makes of
    /// it. `turn` grinds one revolution at an infeed and tells the measured force, N; it is asked
    /// for nothing that does not happen.
    pub fn phase(&self, pass: usize, wheel: &WheelEstimate, mut turn: impl FnMut(f64) -> f64) -> Vec<GrindingPhase> {
        let steps = ((wheel.dulling / self.dulling - 1.0) / STEP).ceil().max(0.0) as usize;
        let cycle = &self.cycles[steps.min(self.cycles.len() - 1)];
        let mut ground = Ground::default();
        match (self.adaptation, pass) {
            (Adaptation::Force { rough, .. }, 0) => {
                let high = cycle[0].infeed_per_rev;
                let low = cycle[1].infeed_per_rev.max(LOW_INFEED * high).min(high);
                let stock = f64::from(cycle[0].revolutions) * high;
                let (mut commanded, mut force) = (0.0, 0.0);
                while commanded < stock * (1.0 - 1e-12) {
                    let infeed: f64 = if force < rough { high } else { low };
                    let infeed = infeed.min(stock - commanded);
                    force = ground.turn(infeed, &mut turn) - self.threshold_force;
                    commanded += infeed;
                }
            }
            (Adaptation::Force { end, .. }, 2) => {
                let mut force = wheel.force;
                for _ in 0..longest(cycle[2].revolutions) {
                    if force <= end {
                        break;
                    }
                    force = ground.turn(0.0, &mut turn) - self.threshold_force;
                }
            }
            (Adaptation::TimeConstant { deflection, last_depth }, 2) => {
                let lag = wheel.lag().unwrap_or(self.compliance / (1.0 + self.compliance));
                let process_stiffness = self.system_stiffness * lag / (1.0 - lag);
                let end = (self.system_stiffness * deflection).min(process_stiffness * last_depth);
                let due = ((end / wheel.force).ln() / lag.ln()).ceil();
                // Of a force that is no number nothing follows.
                let most = longest(cycle[2].revolutions);
                let revolutions = if due > 0.0 { due.min(f64::from(most)) as u32 } else { 0 };
                for _ in 0..revolutions {
                    ground.turn(0.0, &mut turn);
                }
            }
            (Adaptation::None | Adaptation::Force { .. } | Adaptation::TimeConstant { .. }, _) => {
                let GrindingPhase { infeed_per_rev, revolutions } = cycle[pass];
                if !self.observes() {
                    return vec![cycle[pass]];
                }
                for _ in 0..revolutions {
                    ground.turn(infeed_per_rev, &mut turn);
                }
            }
        }
        ground.phases
    }

    /// Whether the wheel is dressed after a part; `parts` counts those since the last dressing.
    /// `None` where its own dressing limit decides.
    pub fn dressing_due(&self, parts: u32, wheel: &WheelEstimate) -> Option<bool> {
        match self.dressing {
            DressingRule::Limit => None,
            DressingRule::PartCount { parts: limit } => Some(parts >= limit),
            DressingRule::Dulling { ratio } => Some(self.measured_dulling(wheel).is_some_and(|seen| seen >= ratio)),
        }
    }
}

fn longest(designed: u32) -> u32 {
    LONGEST_SPARK_OUT * designed + 5
}

/// Revolutions one after the other, equal infeeds together.
#[derive(Default)]
struct Ground {
    phases: Vec<GrindingPhase>,
}

impl Ground {
    fn turn(&mut self, infeed_per_rev: f64, turn: &mut impl FnMut(f64) -> f64) -> f64 {
        match self.phases.last_mut() {
            Some(last) if last.infeed_per_rev == infeed_per_rev => last.revolutions += 1,
            _ => self.phases.push(GrindingPhase { infeed_per_rev, revolutions: 1 }),
        }
        turn(infeed_per_rev)
    }
}

#[cfg(test)]
mod tests;
