//! The controller of cutting speed as a unit.

use super::TurningMachine;
use crate::unit::{Renewal, Unit};
use toolroom_control::{CHANGE_RULES, SPEED_RULES, SpeedController};
use toolroom_effects::Effects;
use toolroom_wear::PARAMETER_SETS;

/// Samples that are worked out within a second: each takes a few tens of microseconds in a development build (assumption,
/// with half of the second in reserve).
const SAMPLES: f64 = 10_000.0;

impl Unit for SpeedController {
    // Never requested.
    type Machine = TurningMachine;
    type Memory = ();
    const IDENTIFIER: &'static str = "toolroom_controller";
    const TITLE: &'static str = "Controller of cutting speed: measured channels in, speed and tool change out";
    const ABSTRACT: &'static str = "The adaptive policy of a lathe as a sampled controller: it estimates flank wear from \
        spindle power, feed force and thermo-EMF by a Kalman filter, takes readings of wear between passes, plans each \
        pass on the model that it believes in, and says when the edge is changed. Co-Simulation only.";
    const EQUATIONS: &'static [(&'static str, &'static str)] = &[
        ("speed between samples", "mean over the interval of the ramp from start_speed to end_speed of the pass"),
        ("least wear", "the speed at which mechanical and thermal wear per path balance, by the believed set"),
        ("set path per edge", "wear intensity = (wear_limit - flank_wear)/(path_per_edge - edge_path)"),
    ];
    const VALIDITY: &'static [&'static str] = &[
        "Sensors are as exact as the unit that is connected; the filter reckons with the noise of its parameters.",
        "A pass that ends between two communication points is planned anew at its end with the inputs held.",
        "Not modelled: cooling of the tool in pauses, chatter, schedules of speed against path.",
    ];
    const STATE_GROUP: &'static str = "control";
    const SETS: &'static [(&'static str, &'static str)] = PARAMETER_SETS;
    const RENEWALS: &'static [Renewal<Self>] = &[];
    const ENUMERATIONS: &'static [(&'static str, &'static [&'static str])] =
        &[("rule.speed_rule", SPEED_RULES), ("change.change_rule", CHANGE_RULES)];
    const CONTINUOUS: bool = false;
    const VIBRATES: bool = false;
    const ADAPTIVE: bool = false;
    const EXPERIMENT: (f64, f64) = (600.0, 1.0);

    fn read(text: &str) -> Result<Self, String> {
        let pair = toolroom_wear::Pair::read(text).map_err(|error| error.to_string())?;
        Ok(Self { pair, ..Self::default() })
    }

    fn longest_step(&self, _u: &Self::Input) -> (f64, &'static str) {
        (SAMPLES * self.sensing.sampling_period, "a sample is taken every sensing.sampling_period")
    }

    fn effects_mut(&mut self) -> &mut Effects {
        &mut self.effects
    }
}
