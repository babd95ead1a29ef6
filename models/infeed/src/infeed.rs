//! The process.

use crate::law::{REFERENCE_DEPTH, chip, depth_of_chip, share_out};
use crate::{Input, Output, Parameters, State, revolutions_to};
use toolroom_effects::{Context, Effect, EffectError, Effects, Terms};
use toolroom_process::{Advance, AnyRecord, ModelError, Number, Process, ProcessEvent, Record};

/// Least missing share of a revolution that still counts as missing: keeps a revolution whole
/// when its time has been cut into steps.
const WHOLE: f64 = 1e-9;

/// How wheel and part press on each other.
struct ContactForces<N> {
    terms: Terms<N>,
    process_stiffness: N,
    system_stiffness: N,
    /// Normal force that takes no chip.
    uncut: N,
    normal_force: N,
}

/// Plunge grinding, revolution by revolution.
///
/// At the end of each work revolution the wheel has cut
/// `h = max(0, (u − w − F0/J − r)/(1 + c + g))` with `c = Cp/J` and `g = (1/G) d_w/d_s`; then
/// `r += h`, `w += g h`, `V' += π d_w h` and `F_n = F0 + Cp h`. With `g = F0 = 0` this is
/// `h_i = (1 − K) S + K h_{i−1}`.
///
/// Between the ends of revolutions only the commanded infeed and the phase run on: forces,
/// stock and temperature are staircases. Infeed that changes within a revolution counts for
/// the part of the revolution that it lasted.
///
/// # Validity
/// Contact all around; depth of cut far below wheel and work diameter.
///
/// # Source
/// Sizyi, Fesenko & Lyubimyi, eqs. (1)–(4); wheel wear, threshold force and dulling as in King &
/// Hahn (recalled).
///
/// # Force exponent
/// With a force exponent m below one the depth is the root of
/// `J (u − w − r − h) = F0 + Cp h0 (h/h0)^m`, `h0 = 1 um`, of which `w = g h` belongs to the same revolution; then
/// `F_n = F0 + Cp h0 (h/h0)^m`. The equations above are those of m = 1.
///
/// ```
/// use toolroom_infeed::{Infeed, Input};
/// use toolroom_process::Process;
/// let (grinding, input) = (Infeed::default(), Input::default());
/// let mut part = grinding.initial();
/// grinding.advance(&mut part, &input, 16.0 * 60.0 / 292.0).unwrap();
/// assert!((part.stock_removed - 65.4e-6).abs() < 1e-9);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Infeed<N: Copy = f64> {
    /// Machine, wheel and work.
    pub parameters: Parameters<N>,
    /// Effects that are switched on.
    pub effects: Effects<N>,
}

impl Default for Infeed {
    /// The set `zb153u_40kh` without effects.
    fn default() -> Self {
        Self { parameters: Parameters::default(), effects: Effects::default() }
    }
}

impl Infeed {
    /// A grinding process.
    ///
    /// # Errors
    /// [`EffectError::NotOfProcess`] for an effect that does not act on plunge grinding.
    pub fn new(parameters: Parameters, effects: Effects) -> Result<Self, EffectError> {
        effects.check(Self::NAME)?;
        Ok(Self { parameters, effects })
    }

    /// The same wheel, dressed: sharp, true and set back to its size.
    pub fn dress(&self, state: &State) -> State {
        State { wheel_wear: 0.0, removed_volume: 0.0, ..*state }
    }

    /// The next part on the same wheel, positioned by command: what the wheel has worn since
    /// dressing is missing from the infeed. Where the machine finds contact anew on each part,
    /// set `commanded_infeed` to `wheel_wear`.
    pub fn new_part(&self, state: &State) -> State {
        State { wheel_wear: state.wheel_wear, removed_volume: state.removed_volume, ..State::default() }
    }
}

impl<N: Number> Infeed<N> {
    /// The same process over another number type.
    pub fn map<M: Copy>(&self, mut convert: impl FnMut(N) -> M) -> Infeed<M> {
        Infeed { parameters: self.parameters.map(&mut convert), effects: self.effects.map(convert) }
    }

    fn terms(&self, x: &State<N>, u: &Input<N>) -> Terms<N> {
        self.effects.terms(&Context {
            coolant_age: u.coolant_age,
            coolant_changed: u.coolant_changed,
            removed_volume: x.removed_volume,
            machine_time: u.machine_time,
            wait_time: u.wait_time,
            ..Context::neutral()
        })
    }

    fn process_stiffness(&self, x: &State<N>, u: &Input<N>, terms: &Terms<N>) -> N {
        let dulling = self.parameters.dulling_rate * x.removed_volume + 1.0;
        let factors = u.coolant_factor * u.process_stiffness_factor * terms.process_stiffness;
        self.parameters.process_stiffness * dulling * factors
    }

    /// What a revolution shares out: compliance `c = Cp/J`, wheel wear per depth g, and the
    /// infeed that stays uncut, the deflection F0/J and what is commanded before contact.
    pub(crate) fn shares(&self, x: &State<N>, u: &Input<N>) -> [N; 3] {
        let p = &self.parameters;
        let terms = self.terms(x, u);
        let system_stiffness = p.system_stiffness * terms.system_stiffness;
        [
            self.process_stiffness(x, u, &terms) / system_stiffness,
            (p.wheel_wear_ratio + terms.wheel_wear_ratio) * p.work_diameter / p.wheel_diameter,
            (p.threshold_force + terms.threshold_force) / system_stiffness + terms.start_offset,
        ]
    }

    /// Growth of the normal force with the depth, N/m: the process stiffness for a force exponent of 1, and where nothing
    /// is cut.
    fn tangent(&self, process_stiffness: N, depth: N) -> N {
        let exponent = self.parameters.force_exponent;
        if exponent.re() == 1.0 || depth.re() <= 0.0 {
            return process_stiffness;
        }
        process_stiffness * exponent * chip(depth, exponent, REFERENCE_DEPTH) / depth
    }

    /// Normal force that a depth of cut adds to the threshold force, N, on the wheel of `x`.
    ///
    /// ```
    /// use toolroom_infeed::{Infeed, Input, State};
    /// let mut grinding = Infeed::default();
    /// (grinding.parameters.process_stiffness, grinding.parameters.force_exponent) = (50e6, 0.8);
    /// let force = grinding.cutting_force(&State::default(), &Input::default(), 2e-6);
    /// assert!((force - 87.055).abs() < 1e-3);
    /// ```
    pub fn cutting_force(&self, x: &State<N>, u: &Input<N>, depth: N) -> N {
        let terms = self.terms(x, u);
        self.process_stiffness(x, u, &terms) * chip(depth, self.parameters.force_exponent, REFERENCE_DEPTH)
    }

    /// Share of a waviness of the part that a revolution leaves at the depth of `x`: `c/(1 + c + g)`, the lag where the
    /// wheel does not wear.
    pub(crate) fn decay(&self, x: &State<N>, u: &Input<N>) -> N {
        let [compliance, wear, _] = self.shares(x, u);
        let compliance = self.tangent(compliance, x.depth_of_cut);
        compliance / (compliance + wear + 1.0)
    }

    /// Infeed that is commanded before contact.
    pub(crate) fn start_offset(&self, x: &State<N>, u: &Input<N>) -> N {
        self.terms(x, u).start_offset
    }

    /// State after the end of a work revolution at the commanded infeed of `x`.
    pub fn revolution(&self, x: &State<N>, u: &Input<N>) -> State<N> {
        let mut next = self.cold_revolution(x, u);
        let rise = self.output_in_cut(&next, u).temperature_rise;
        if rise.re() > next.peak_temperature_rise.re() {
            next.peak_temperature_rise = rise;
        }
        next
    }

    /// [`Infeed::revolution`] where nobody asks for the peak temperature, which stays.
    pub fn cold_revolution(&self, x: &State<N>, u: &Input<N>) -> State<N> {
        let p = &self.parameters;
        let [compliance, wear, threshold] = self.shares(x, u);
        let engagement = x.commanded_infeed - x.wheel_wear - threshold - x.stock_removed;
        let (depth, _) = share_out(positive(engagement), compliance, wear, p.force_exponent, REFERENCE_DEPTH);
        State {
            stock_removed: x.stock_removed + depth,
            depth_of_cut: depth,
            revolutions: x.revolutions + 1.0,
            wheel_wear: x.wheel_wear + wear * depth,
            removed_volume: x.removed_volume + p.work_diameter * depth * std::f64::consts::PI,
            ..*x
        }
    }

    fn pressed(&self, x: &State<N>, u: &Input<N>) -> ContactForces<N> {
        let p = &self.parameters;
        let terms = self.terms(x, u);
        let process_stiffness = self.process_stiffness(x, u, &terms);
        let threshold = p.threshold_force + terms.threshold_force;
        // Below the threshold the wheel rubs, pressed on by the deflection that is there.
        let system_stiffness = p.system_stiffness * terms.system_stiffness;
        let deflection = x.commanded_infeed - x.stock_removed - x.wheel_wear - terms.start_offset;
        let pressed = positive(deflection * system_stiffness);
        let rubbing = if pressed.re() < threshold.re() { pressed } else { threshold };
        let uncut = if x.depth_of_cut.re() > 0.0 { threshold } else { rubbing };
        let normal_force = uncut + process_stiffness * chip(x.depth_of_cut, p.force_exponent, REFERENCE_DEPTH);
        ContactForces { terms, process_stiffness, system_stiffness, uncut, normal_force }
    }

    /// [`Output::normal_force`] (N) of a wheel in contact, by itself.
    pub fn normal_force(&self, x: &State<N>, u: &Input<N>) -> N {
        self.pressed(x, u).normal_force
    }

    /// Outputs while the wheel touches the part.
    ///
    /// Temperature: `rise = (2/√π) ε q √(l_c/(v_w k ρ c))`, `q = F_t v_s/(b l_c)`,
    /// `l_c = √(h d_e)`, `d_e = d_w d_s/(d_w ± d_s)`, in a bore with minus; `ε = (u − share·u_ch)/u` of the specific
    /// energy u stays in the work, all of it where the wheel only rubs. The contact is no shorter than that of the depth
    /// whose force is the threshold force: else it would shrink to nothing with h under a force that stays.
    ///
    /// # Source
    /// Jaeger's moving band at high Péclet number; energy partition by Malkin (recalled); least contact
    /// length under a threshold force: assumption.
    pub(crate) fn output_in_cut(&self, x: &State<N>, u: &Input<N>) -> Output<N> {
        let p = &self.parameters;
        let ContactForces { terms, process_stiffness, system_stiffness, uncut, normal_force } = self.pressed(x, u);
        let zero = N::from(0.0);
        let depth = x.depth_of_cut;
        let size_error = x.commanded_infeed - x.stock_removed;
        let tangential_force = normal_force * p.friction * u.friction_factor;
        let spindle_power = tangential_force * p.wheel_speed;
        let work_speed = u.work_rotation_speed * p.work_diameter * 0.5;
        let removal_rate = p.width * depth * work_speed;
        let (mut specific_energy, mut temperature_rise) = (zero, zero);
        let mut into_work = N::from(1.0);
        if removal_rate.re() > 0.0 {
            specific_energy = spindle_power / removal_rate;
            into_work = positive(-p.chip_formation_energy * p.chip_heat_share / specific_energy + 1.0);
        }
        if normal_force.re() > 0.0 && work_speed.re() > 0.0 {
            let equivalent_diameter = p.equivalent_diameter();
            // No shorter than the contact that the threshold force alone presses on.
            let rubbed = depth_of_chip(uncut / process_stiffness, p.force_exponent, REFERENCE_DEPTH);
            let pressed = if depth.re() > rubbed.re() { depth } else { rubbed };
            let contact_length = (pressed * equivalent_diameter).sqrt();
            let flux = spindle_power / (p.width * contact_length);
            let spread = (contact_length / (work_speed * p.conductivity * p.density * p.heat_capacity)).sqrt();
            temperature_rise = into_work * flux * spread * std::f64::consts::FRAC_2_SQRT_PI * terms.temperature_rise;
        }
        let lag = crate::lag(self.tangent(process_stiffness, depth), system_stiffness);
        // Revolutions from the commanded start to contact.
        let feeds = u.infeed_per_rev.re() > 0.0;
        let late = if feeds { terms.start_offset / u.infeed_per_rev } else { zero };
        let warm = terms.thermal_growth * normal_force * x.revolutions;
        Output {
            normal_force,
            tangential_force,
            spindle_power,
            depth_of_cut: depth,
            stock_removed: x.stock_removed - warm,
            size_error: size_error + warm,
            roundness_error: depth,
            temperature_rise,
            temperature: temperature_rise + p.ambient_temperature,
            specific_energy,
            burn_margin: -temperature_rise / p.burn_temperature_rise + 1.0,
            wheel_wear: x.wheel_wear,
            process_stiffness,
            lag,
            // A plunge that begins early has risen before it is commanded.
            rise_revolutions: positive(revolutions_to(N::from(0.95), lag) + late),
        }
    }

    /// Outputs, over any number type; a retracted wheel carries no force and no heat.
    pub fn observe(&self, x: &State<N>, u: &Input<N>) -> Output<N> {
        let output = self.output_in_cut(x, u);
        if u.engaged.re() > 0.5 {
            return output;
        }
        let zero = N::from(0.0);
        Output {
            normal_force: zero,
            tangential_force: zero,
            spindle_power: zero,
            temperature_rise: zero,
            temperature: self.parameters.ambient_temperature,
            specific_energy: zero,
            burn_margin: N::from(1.0),
            ..output
        }
    }
}

/// `value` where it is positive, else 0.
pub(crate) fn positive<N: Number>(value: N) -> N {
    if value.re() > 0.0 { value } else { N::from(0.0) }
}

impl Process for Infeed {
    type Input = Input;
    type State = State;
    type Output = Output;

    const NAME: &'static str = "infeed";
    const EVENTS: &'static [ProcessEvent] = &[ProcessEvent::Burn, ProcessEvent::DressingDue];

    fn initial(&self) -> State {
        State::default()
    }

    fn output(&self, x: &State, u: &Input) -> Output {
        self.observe(x, u)
    }

    /// A machine whose stiffness has drifted away ([`ModelError::Contradiction`]) is refused.
    ///
    /// Events are raised at the end of the revolution in which their limit is passed; where both
    /// are passed in one revolution, burn is raised and the other shows in the indicators.
    fn advance(&self, x: &mut State, u: &Input, dt: f64) -> Result<Advance, ModelError> {
        let mut state = *x;
        let advance = self.effects.watched(|| self.advance_unwatched(&mut state, u, dt))?;
        *x = state;
        Ok(advance)
    }

    fn event_indicators(&self, x: &State, _u: &Input, indicators: &mut [f64]) {
        indicators.copy_from_slice(&self.indicators(x.peak_temperature_rise, x.removed_volume));
    }

    fn parameters_mut(&mut self) -> Vec<(&'static str, &mut dyn AnyRecord)> {
        let mut groups: Vec<(&'static str, &mut dyn AnyRecord)> = vec![("infeed", &mut self.parameters)];
        groups.extend(self.effects.parameters_mut());
        groups
    }
}

impl Infeed {
    /// [`Process::advance`] where nobody asks what the effects refuse.
    fn advance_unwatched(&self, x: &mut State, u: &Input, dt: f64) -> Result<Advance, ModelError> {
        u.check()?;
        if !(dt >= 0.0 && dt.is_finite()) {
            return Err(ModelError::Step { seconds: dt });
        }
        let per_second = u.work_rotation_speed / std::f64::consts::TAU;
        let whole = Advance { elapsed: dt, event: None };
        if u.engaged <= 0.5 || per_second == 0.0 {
            return Ok(whole);
        }
        if self.terms(x, u).system_stiffness <= 0.0 {
            let drifts = self.effects.iter().filter(|effect| matches!(effect, Effect::StiffnessDrift(_)));
            let drift = drifts.map(Effect::size);
            return Err(ModelError::Contradiction {
                first: "size of stiffness_drift",
                first_value: drift.sum(),
                second: "machine_time",
                second_value: u.machine_time,
                rule: "system_stiffness falls to zero, stiffness_drift leaves nothing of it: choose a smaller size",
            });
        }
        let indicators = |x: &State| self.indicators(x.peak_temperature_rise, x.removed_volume);
        let (mut state, mut left) = (*x, dt * per_second);
        while state.revolution_phase + left >= 1.0 - WHOLE {
            let share = 1.0 - state.revolution_phase;
            state.commanded_infeed += u.infeed_per_rev * share;
            left -= share;
            let before = indicators(&state);
            state = State { revolution_phase: 0.0, ..self.revolution(&state, u) };
            let after = indicators(&state);
            if let Some(i) = (0..2).find(|i| before[*i] < 0.0 && after[*i] >= 0.0) {
                *x = state;
                return Ok(Advance { elapsed: dt - left.max(0.0) / per_second, event: Some(Self::EVENTS[i]) });
            }
        }
        state.commanded_infeed += u.infeed_per_rev * left;
        state.revolution_phase += left;
        *x = state;
        Ok(whole)
    }

    /// Distance past the burn limit and past the dressing limit, relative.
    pub(crate) fn indicators(&self, temperature_rise: f64, removed_volume: f64) -> [f64; 2] {
        [
            temperature_rise / self.parameters.burn_temperature_rise - 1.0,
            removed_volume / self.parameters.dressing_limit - 1.0,
        ]
    }
}
