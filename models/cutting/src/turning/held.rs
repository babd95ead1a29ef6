//! Turning under an input that stays: what the input decides is worked out once.

use super::equations::Engagement;
use super::{Turning, TurningInput, TurningOutput, TurningState};
use toolroom_effects::Terms;
use toolroom_process::Process;
use toolroom_wear::{Contact, Cut, Load};

/// Turning under one input, for whoever asks it many times: rates and outputs are those of the
/// process but for rounding.
///
/// # Examples
/// ```
/// use toolroom_cutting::{Turning, TurningInput};
/// use toolroom_process::Process;
/// let (turning, u) = (Turning::default(), TurningInput::default());
/// let x = turning.initial();
/// let (held, anew) = (turning.held(&u).output(&x), turning.output(&x, &u));
/// assert!((held.cutting_force / anew.cutting_force - 1.0).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct HeldTurning<'a> {
    turning: &'a Turning,
    input: TurningInput,
    contact: Contact<'a>,
    load: Load<f64>,
}

impl Turning {
    /// The process under `u`, which stays.
    pub fn held(&self, u: &TurningInput) -> HeldTurning<'_> {
        let cut = self.cut(u, &Terms::neutral());
        HeldTurning { turning: self, input: *u, contact: self.pair.contact(&cut), load: self.pair.force.load(&cut) }
    }
}

impl HeldTurning<'_> {
    /// [`Process::derivative`] with another factor on the rate of wear, which multiplies that of the input.
    #[inline]
    pub fn rates(&self, x: &TurningState, wear_factor: f64) -> TurningState {
        if self.turning.structure.is_some() {
            let u = TurningInput { wear_rate_factor: self.input.wear_rate_factor * wear_factor, ..self.input };
            return self.turning.rates(x, &u);
        }
        self.turning.mean_rates(&self.engagement(x, wear_factor), x, &self.input)
    }

    /// [`Process::output`]; the rates of wear in it are those of the input.
    #[inline]
    pub fn output(&self, x: &TurningState) -> TurningOutput {
        if self.turning.structure.is_some() {
            return self.turning.output(x, &self.input);
        }
        self.turning.observe_in(&self.engagement(x, 1.0), x, &self.input)
    }

    /// Names of the outputs that [`HeldTurning::readings`] gives.
    pub const READINGS: &'static [&'static str] = &["cutting_force", "feed_force", "spindle_power", "temperature"];

    /// [`HeldTurning::output`] where nothing is asked but [`HeldTurning::READINGS`]: the others stay at their
    /// defaults, which costs half as much.
    ///
    /// # Examples
    /// ```
    /// use toolroom_cutting::{Turning, TurningInput};
    /// use toolroom_process::Process;
    /// let (turning, u) = (Turning::default(), TurningInput::default());
    /// let x = turning.initial();
    /// assert_eq!(turning.held(&u).readings(&x).cutting_force, turning.held(&u).output(&x).cutting_force);
    /// ```
    #[inline]
    pub fn readings(&self, x: &TurningState) -> TurningOutput {
        if self.turning.structure.is_some() {
            return self.turning.output(x, &self.input);
        }
        let sensed = self.engagement(x, 1.0).sensed(x, &self.input);
        TurningOutput {
            cutting_force: sensed.cutting_force,
            feed_force: sensed.feed_force,
            spindle_power: sensed.spindle_power,
            temperature: sensed.temperature,
            ..TurningOutput::default()
        }
    }

    #[inline]
    fn engagement(&self, x: &TurningState, wear_factor: f64) -> Engagement<'_> {
        let turning = self.turning;
        if turning.effects.is_empty() {
            return Engagement::settled(self.contact.wearing(wear_factor), self.load, Terms::neutral());
        }
        let terms = turning.effect_terms(x, &self.input);
        let cut = turning.cut(&self.input, &terms);
        let cut = Cut { wear_factor: cut.wear_factor * wear_factor, ..cut };
        let load = self.load.times(terms.specific_cutting_force);
        Engagement::settled(self.contact.with_factors(&cut), load, terms)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_effects::{Effect, Effects};
    use toolroom_process::Record;

    fn assert_close<R: Record>(held: &R, anew: &R, what: &str) {
        for i in 0..R::LEN {
            let (a, b) = (held.get(i).unwrap(), anew.get(i).unwrap());
            assert!((a - b).abs() <= 1e-12 * b.abs() + 1e-300, "{what}: element {i} is {a} instead of {b}");
        }
    }

    #[test]
    fn a_held_input_gives_what_the_process_gives_under_every_effect() {
        let turning_state = TurningState {
            flank_wear: 0.23e-3,
            tool_body_temperature_rise: 310.0,
            thermal_damage: 0.2,
            cutting_time: 900.0,
            cutting_path: 2700.0,
            ..TurningState::default()
        };
        let u = TurningInput {
            cutting_speed: 3.1,
            feed_per_rev: 0.27e-3,
            depth_of_cut: 1.3e-3,
            hardness_ratio: 1.1,
            lot_deviation: 0.5,
            coolant_age: 2e6,
            sensor_time: 7200.0,
            pass_time: 70.0,
            feed_override: 0.2,
            ..TurningInput::default()
        };
        for set in ["c45_t15k6", "ni_vk6om_hb", "ni_vk6om"] {
            let nominal = Turning::named(set).unwrap();
            let every: Vec<Effect> = Effects::every(Turning::NAME).iter().map(|effect| effect.with_size(0.3)).collect();
            for effects in every.iter().map(|effect| vec![*effect]).chain([Vec::new(), every.clone()]) {
                let turning = Turning { effects: Effects::new(effects.clone()).unwrap(), ..nominal.clone() };
                let case =
                    format!("{set} with {:?}", effects.iter().map(|effect| effect.entry().id).collect::<Vec<_>>());
                let held = turning.held(&u);
                let output = held.output(&turning_state);
                assert_close(&output, &turning.output(&turning_state, &u), &case);
                let readings = held.readings(&turning_state);
                for name in HeldTurning::READINGS {
                    let i = TurningOutput::<f64>::index_of(name).unwrap();
                    let (some, all) = (readings.get(i).unwrap(), output.get(i).unwrap());
                    assert!((some - all).abs() <= 1e-12 * all.abs(), "{case}: {name} is {some} instead of {all}");
                }
                let faster = TurningInput { wear_rate_factor: 1.7, ..u };
                assert_close(&held.rates(&turning_state, 1.7), &turning.rates(&turning_state, &faster), &case);
            }
        }
    }
}
