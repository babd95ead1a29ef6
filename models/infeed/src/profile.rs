//! The delay equation: the profile of the part, station by station.

use crate::infeed::positive;
use crate::law::{REFERENCE_DEPTH, share_out};
use crate::{Infeed, Input, Output, State};
use toolroom_effects::EffectError;
use toolroom_process::{Advance, AnyRecord, ModelError, Number, Process, ProcessEvent, Record, record};

/// Stations of the circumference at which the profile is kept.
pub const STATIONS: usize = 360;

/// Least missing share of a station that still counts as missing.
const WHOLE: f64 = 1e-9;

record! {
    /// What changes: position, part all around, wheel.
    pub struct ProfileState {
        /// Infeed commanded since the wheel touched the part, u.
        commanded_infeed: Real["m" => "um"] = 0.0, -1.0..=1.0;
        /// Radial stock removed at each station; what lacks at the start counts as removed.
        profile: Real["m" => "um"; 360] = 0.0, -1.0..=1.0;
        /// The station that was ground last.
        station: Integer = 359.0, 0.0..=359.0;
        /// Share of the way to the next station that has passed.
        station_phase: Real = 0.0, -1e-6..=1.0;
        /// Depth of cut at the last station, h.
        depth_of_cut: Real["m" => "um"] = 0.0, 0.0..=1.0;
        /// Revolutions ground on this part.
        revolutions: Real = 0.0, 0.0..=1e12;
        /// Greatest temperature rise of the grinding zone on this part.
        peak_temperature_rise: Real["K" => "K"] = 0.0, 0.0..=1e5;
        /// Radial wear of the wheel since dressing, w.
        wheel_wear: Real["m" => "um"] = 0.0, 0.0..=1.0;
        /// Volume removed per width since dressing, V'.
        removed_volume: Real["m2" => "mm3/mm"] = 0.0, 0.0..=1e4;
    }
}

impl ProfileState {
    /// A new part that is out of round by `amplitude` in `lobes` waves:
    /// `amplitude cos(lobes φ)` lacks at the angle φ.
    ///
    /// ```
    /// let part = toolroom_infeed::ProfileState::wavy(2e-6, 3.0);
    /// assert_eq!(part.profile[0], 2e-6);
    /// ```
    pub fn wavy(amplitude: f64, lobes: f64) -> Self {
        let step = lobes * std::f64::consts::TAU / STATIONS as f64;
        Self { profile: std::array::from_fn(|i| amplitude * (step * i as f64).cos()), ..Self::default() }
    }
}

impl<N: Number> ProfileState<N> {
    /// Mean radial stock removed.
    pub fn mean_stock(&self) -> N {
        self.profile.iter().fold(N::from(0.0), |sum, stock| sum + *stock) / STATIONS as f64
    }

    /// Out-of-roundness, from the lowest point to the highest: spiral step, waves, flats. Where the wheel is, the profile has
    /// both the radius that it has just cut and the one before it, of which stations have only one: by them alone the step of a
    /// spiral is 1/360 less than the depth of cut.
    pub fn roundness_error(&self) -> N {
        let station = self.profile[self.station.re() as usize];
        let first = station - self.depth_of_cut;
        let by = |better: fn(f64, f64) -> bool| {
            self.profile.iter().fold(first, |best, stock| if better(stock.re(), best.re()) { *stock } else { best })
        };
        by(|a, b| a > b) - by(|a, b| a < b)
    }
}

/// Plunge grinding around the circumference: the delay equation
/// `r(t) = (1 − K) u(t) + K r(t − T)` at 360 stations, T being one work revolution.
///
/// At each station the wheel cuts `h = max(0, (u − w − F0/J − r)/(1 + c + g/360))` of what the
/// last revolution left there; then `r += h`, `w += g h/360`. Without wheel wear it is
/// [`Infeed`] at whole revolutions; between them it has what the recursion has not: infeed that
/// goes on within the revolution (the spiral), waves, and contact over a part of the
/// circumference. [`Output::stock_removed`] is the mean radius removed, and
/// [`Output::roundness_error`] runs from the lowest to the highest point of the profile: on an even part it is the last
/// depth of cut, as in [`Infeed`].
///
/// # Source
/// The recursion of Sizyi, Fesenko & Lyubimyi, eq. (1), with the time of one revolution as delay.
///
/// ```
/// use toolroom_infeed::{InfeedProfile, Input};
/// use toolroom_process::Process;
/// let (grinding, input) = (InfeedProfile::default(), Input::default());
/// let mut part = grinding.initial();
/// grinding.advance(&mut part, &input, 16.0 * 60.0 / 292.0).unwrap();
/// assert!((part.roundness_error() - 4.42966e-6).abs() < 1e-11); // the spiral
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InfeedProfile {
    /// Machine, wheel, work and effects.
    pub grinding: Infeed,
}

impl InfeedProfile {
    /// A grinding process with profile.
    ///
    /// # Errors
    /// Those of [`Infeed::new`].
    pub fn new(parameters: crate::Parameters, effects: toolroom_effects::Effects) -> Result<Self, EffectError> {
        Ok(Self { grinding: Infeed::new(parameters, effects)? })
    }
}

impl<N: Number> Infeed<N> {
    /// Grinds the next station at the commanded infeed of `x`.
    pub fn station(&self, x: &mut ProfileState<N>, u: &Input<N>) {
        let share = 1.0 / STATIONS as f64;
        let last = x.station.re() as usize;
        let next = (last + 1) % STATIONS;
        let [compliance, wear, threshold] = self.shares(&at_station(x, last), u);
        let engagement = x.commanded_infeed - x.wheel_wear - threshold - x.profile[next];
        let exponent = self.parameters.force_exponent;
        let (depth, _) = share_out(positive(engagement), compliance, wear * share, exponent, REFERENCE_DEPTH);
        x.station = N::from(next as f64);
        x.profile[next] += depth;
        x.depth_of_cut = depth;
        x.revolutions += share;
        x.wheel_wear += wear * depth * share;
        x.removed_volume += self.parameters.work_diameter * depth * (std::f64::consts::PI * share);
        let rise = self.output_in_cut(&at_station(x, next), u).temperature_rise;
        if rise.re() > x.peak_temperature_rise.re() {
            x.peak_temperature_rise = rise;
        }
    }

    /// Outputs of a part with profile. Stock and size error are those where the wheel is, as in the recursion; the mean round
    /// the part is less by half a step of the spiral ([`ProfileState::mean_stock`]). Roundness is that of the profile.
    pub fn observe_profile(&self, x: &ProfileState<N>, u: &Input<N>) -> Output<N> {
        let output = self.observe(&at_station(x, x.station.re() as usize), u);
        Output { roundness_error: x.roundness_error(), ..output }
    }
}

/// The part as the wheel meets it at one station.
fn at_station<N: Number>(x: &ProfileState<N>, station: usize) -> State<N> {
    State {
        commanded_infeed: x.commanded_infeed,
        stock_removed: x.profile[station],
        depth_of_cut: x.depth_of_cut,
        revolution_phase: N::from(0.0),
        revolutions: x.revolutions,
        peak_temperature_rise: x.peak_temperature_rise,
        wheel_wear: x.wheel_wear,
        removed_volume: x.removed_volume,
    }
}

impl Process for InfeedProfile {
    type Input = Input;
    type State = ProfileState;
    type Output = Output;

    const NAME: &'static str = "infeed_profile";
    const EVENTS: &'static [ProcessEvent] = Infeed::EVENTS;

    fn initial(&self) -> ProfileState {
        ProfileState::default()
    }

    fn output(&self, x: &ProfileState, u: &Input) -> Output {
        self.grinding.observe_profile(x, u)
    }

    /// Events are raised at the station at which their limit is passed.
    fn advance(&self, x: &mut ProfileState, u: &Input, dt: f64) -> Result<Advance, ModelError> {
        u.check()?;
        if !(dt >= 0.0 && dt.is_finite()) {
            return Err(ModelError::Step { seconds: dt });
        }
        let per_second = u.work_rotation_speed / std::f64::consts::TAU * STATIONS as f64;
        let whole = Advance { elapsed: dt, event: None };
        if u.engaged <= 0.5 || per_second == 0.0 {
            return Ok(whole);
        }
        let infeed_per_station = u.infeed_per_rev / STATIONS as f64;
        let (mut left, mut reached) = (dt * per_second, false);
        let indicators = |x: &ProfileState| self.grinding.indicators(x.peak_temperature_rise, x.removed_volume);
        while x.station_phase + left >= 1.0 - WHOLE {
            let share = 1.0 - x.station_phase;
            x.commanded_infeed += infeed_per_station * share;
            left -= share;
            let before = indicators(x);
            (x.station_phase, reached) = (0.0, true);
            self.grinding.station(x, u);
            let after = indicators(x);
            if let Some(i) = (0..2).find(|i| before[*i] < 0.0 && after[*i] >= 0.0) {
                return Ok(Advance { elapsed: dt - left.max(0.0) / per_second, event: Some(Self::EVENTS[i]) });
            }
        }
        // What rounding leaves after a station is no way at all.
        if !reached || left.abs() > WHOLE {
            x.commanded_infeed += infeed_per_station * left;
            x.station_phase += left;
        }
        Ok(whole)
    }

    fn event_indicators(&self, x: &ProfileState, _u: &Input, indicators: &mut [f64]) {
        indicators.copy_from_slice(&self.grinding.indicators(x.peak_temperature_rise, x.removed_volume));
    }

    fn parameters_mut(&mut self) -> Vec<(&'static str, &mut dyn AnyRecord)> {
        self.grinding.parameters_mut()
    }
}
