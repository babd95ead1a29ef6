//! Milling under an input that stays: what the input decides is worked out once.

use super::equations::{Engagement, unworn};
use super::{Milling, MillingInput, MillingOutput, MillingState};
use toolroom_effects::Terms;
use toolroom_process::Process;

/// Milling under one input, for whoever asks it many times: rates and outputs are those of the
/// process but for rounding.
///
/// # Examples
/// ```
/// use toolroom_cutting::{Milling, MillingInput};
/// use toolroom_process::Process;
/// let (milling, u) = (Milling::default(), MillingInput::default());
/// let x = milling.initial();
/// let (held, anew) = (milling.held(&u).output(&x), milling.output(&x, &u));
/// assert!((held.cutting_force / anew.cutting_force - 1.0).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct HeldMilling<'a> {
    milling: &'a Milling,
    input: MillingInput,
    fresh: Engagement,
}

impl Milling {
    /// The process under `u`, which stays.
    pub fn held(&self, u: &MillingInput) -> HeldMilling<'_> {
        HeldMilling { milling: self, input: *u, fresh: self.engagement(&self.initial(), u) }
    }
}

impl HeldMilling<'_> {
    /// [`Process::derivative`] with another factor on the rate of wear, which multiplies that of the input.
    #[inline]
    pub fn rates(&self, x: &MillingState, wear_factor: f64) -> MillingState {
        self.milling.rates_in(&self.engagement(x, wear_factor), x)
    }

    /// [`Process::output`]; the life in it is that of the input.
    #[inline]
    pub fn output(&self, x: &MillingState) -> MillingOutput {
        self.milling.observe_in(&self.engagement(x, 1.0), &self.engagement(&unworn(x), 1.0), x)
    }

    /// Names of the outputs that [`HeldMilling::readings`] gives.
    pub const READINGS: &'static [&'static str] =
        &["cutting_force", "feed_force", "normal_force", "spindle_power", "form_error", "roughness_ra"];

    /// [`HeldMilling::output`] where nothing is asked but [`HeldMilling::READINGS`]: the others stay at their
    /// defaults and cost nothing.
    ///
    /// # Examples
    /// ```
    /// use toolroom_cutting::{Milling, MillingInput};
    /// use toolroom_process::Process;
    /// let (milling, u) = (Milling::default(), MillingInput::default());
    /// let x = milling.initial();
    /// assert_eq!(milling.held(&u).readings(&x).roughness_ra, milling.held(&u).output(&x).roughness_ra);
    /// ```
    #[inline]
    pub fn readings(&self, x: &MillingState) -> MillingOutput {
        if self.milling.structure.is_some() {
            return self.output(x);
        }
        let sensed = self.milling.sensed(&self.engagement(x, 1.0), x);
        MillingOutput {
            cutting_force: sensed.cutting_force,
            feed_force: sensed.feed_force,
            normal_force: sensed.normal_force,
            spindle_power: sensed.spindle_power,
            form_error: sensed.form_error,
            roughness_ra: sensed.roughness_ra,
            ..MillingOutput::default()
        }
    }

    #[inline]
    fn engagement(&self, x: &MillingState, wear_factor: f64) -> Engagement {
        let milling = self.milling;
        let anew = || {
            let u = MillingInput { wear_rate_factor: self.input.wear_rate_factor * wear_factor, ..self.input };
            milling.engagement(x, &u)
        };
        if milling.structure.is_some() {
            return anew();
        }
        let quiet = milling.effects.is_empty();
        let terms = if quiet { Terms::neutral() } else { milling.effect_terms(x, &self.input) };
        self.fresh.under(&terms, wear_factor).unwrap_or_else(anew)
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
        let worn = MillingState { flank_wear: 0.11e-3, cutting_time: 900.0, cutting_path: 800.0, ..Default::default() };
        let u = MillingInput {
            lot_deviation: 0.5,
            sensor_time: 7200.0,
            path_curvature: 40.0,
            helical_deviation: 2e-6,
            feed_override: 0.2,
            hardness_ratio: 1.1,
            ..MillingInput::default()
        };
        // An ordinary size of each, in SI.
        let size = |effect: &Effect| match effect.entry().id {
            "runout" => 8e-6,
            "stock_offset" => 0.2e-3,
            _ => 0.3,
        };
        let every: Vec<Effect> =
            Effects::every(Milling::NAME).iter().map(|effect| effect.with_size(size(effect))).collect();
        for effects in every.iter().map(|effect| vec![*effect]).chain([Vec::new(), every.clone()]) {
            let milling = Milling { effects: Effects::new(effects.clone()).unwrap(), ..Milling::default() };
            let case = format!("{:?}", effects.iter().map(|effect| effect.entry().id).collect::<Vec<_>>());
            let held = milling.held(&u);
            assert_close(&held.output(&worn), &milling.output(&worn, &u), &case);
            let (all, read) = (held.output(&worn), held.readings(&worn));
            for name in HeldMilling::READINGS {
                let output =
                    |output: &MillingOutput| MillingOutput::index_of(name).and_then(|i| output.get(i)).unwrap();
                assert_eq!(output(&read), output(&all), "{name}, {case}");
            }
            let faster = MillingInput { wear_rate_factor: 1.7, ..u };
            assert_close(&held.rates(&worn, 1.7), &milling.rates(&worn, &faster), &case);
        }
    }
}
