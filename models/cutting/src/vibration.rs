//! How a cut vibrates: stability, chatter and what they do to wear, force and surface.
//!
//! A process without a structure does not ask. With one, each operating point has a verdict; it
//! is judged at rounded speed and process damping and kept, so that the state equations can ask
//! for it at every step. Rounding makes the verdict a function of state and input alone.

mod memo;
mod milling;
mod switch;
mod turning;

pub use milling::MillingStructure;
pub(crate) use milling::{Tooth, ToothCell};
use switch::{Cell, one_step};
pub(crate) use switch::{Ends, RoundedVerdict, first_switch};
pub use turning::TurningStructure;
pub(crate) use turning::{Edge, EdgeCell, HeldChatter};

use memo::Memo;
use toolroom_chatter::{AmplitudeTable, ChatterKind, LimitCycle, Mode, SpeedVariation};
use toolroom_effects::Terms;
use toolroom_process::{Number, record};

record! {
    /// How wear changes the regenerative cut, and how chatter wears the edge.
    ///
    /// | quantity | equation |
    /// |---|---|
    /// | coefficient | `K (1 + coefficient_growth · wear_ratio)`, the ratio at most 20 |
    /// | process damping | `C_i + indentation_force · VB²/2`, VB at most 10 mm |
    /// | wear under chatter | `· (<F^wear_power>/F0^wear_power)^wear_exponent`; in milling F0^wear_power is the mean power of the force without vibration |
    ///
    /// The mean force does not change under chatter, so wear can only follow a convex function of
    /// it.
    ///
    /// # Source
    /// Indentation volume: form of Chiou and Liang (1998). That chatter shortens tool life: Kayhan
    /// and Budak, Proc. IMechE B (2009). All numbers are assumptions: the indentation force gives the
    /// 6.11e5 N/m of Altintas et al. (2008) at a land of 0.17 mm.
    pub struct Regeneration {
        /// Share by which the cutting coefficient has grown at the wear limit.
        coefficient_growth: Real = 0.2, 0.0..=5.0;
        /// Indentation force per displaced volume of the flank land, K_sp.
        indentation_force: Real["N/m3" => "N/mm3"] = 4e13, 0.0..=1e16;
        /// Power of the force that wear follows under chatter, p.
        wear_power: Real = 2.0, 2.0..=3.0;
        /// Exponent of the mean power, s; 0 leaves wear alone.
        wear_exponent: Real = 1.0, 0.0..=5.0;
    }
}

/// Longest flank land whose indentation damps (m). Assumption: some ten times the criteria of ISO 3685; an edge so worn
/// is gone, and only a step of the integration that is given up asks for it.
const LONGEST_LAND: f64 = 10e-3;

/// Greatest ratio of wear to its limit with which the coefficient grows (1). Assumption, as for [`LONGEST_LAND`].
const GREATEST_WEAR_RATIO: f64 = 20.0;

impl Regeneration {
    /// Factor of wear on the cutting coefficient, at a `wear_ratio` of the wear to its limit.
    fn coefficient_factor(&self, wear_ratio: f64) -> f64 {
        1.0 + self.coefficient_growth * wear_ratio.min(GREATEST_WEAR_RATIO)
    }

    /// Process damping by the land of an edge with `flank_wear` (m), in N/m.
    fn land_damping(&self, flank_wear: f64) -> f64 {
        0.5 * self.indentation_force * flank_wear.min(LONGEST_LAND).powi(2)
    }

    /// Factor of a limit `cycle` on force-driven wear.
    fn wear_factor(&self, cycle: &LimitCycle) -> f64 {
        let power = self.wear_power;
        let mean_power = cycle.mean_square_force.powf(3.0 - power) * cycle.mean_cube_force.powf(power - 2.0);
        mean_power.max(1.0).powf(self.wear_exponent)
    }
}

/// Vibration of one operating point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vibration {
    /// Depth at which the cut becomes unstable (m); infinite where none does.
    pub limit: f64,
    /// `1 − depth/limit`; less where a modulated chuck leaves less.
    pub margin: f64,
    /// How the cut is unstable.
    pub kind: ChatterKind,
    /// Frequency at the limit (Hz).
    pub frequency: f64,
    /// Amplitude of chatter (m), half of peak to peak; 0 in a stable cut.
    pub chatter: f64,
    /// Amplitude of the vibration that the teeth of a mill force in a stable cut (m), from the
    /// cutting part of the force alone.
    pub forced: f64,
    /// Factor of chatter on force-driven wear.
    pub wear_factor: f64,
    /// Root mean square of the force about its mean, by chatter, over the mean.
    pub force_ripple: f64,
}

impl Vibration {
    /// No structure, no vibration.
    pub const NONE: Self = Self {
        limit: f64::INFINITY,
        margin: 1.0,
        kind: ChatterKind::Stable,
        frequency: 0.0,
        chatter: 0.0,
        forced: 0.0,
        wear_factor: 1.0,
        force_ripple: 0.0,
    };

    /// Whether the cut is stable.
    pub fn stable(&self) -> bool {
        self.kind == ChatterKind::Stable
    }

    /// A stable cut of `depth` (m) below or beyond `boundary`.
    fn quiet(boundary: &Boundary, depth: f64) -> Self {
        let limit = boundary.limit;
        Self { limit, margin: 1.0 - depth / limit, frequency: boundary.frequency, ..Self::NONE }
    }

    /// The same cut in its limit `cycle`, which has the kind of `boundary`; displacements are in units of `chip` (m).
    fn chattering(self, kind: ChatterKind, cycle: &LimitCycle, chip: f64, regeneration: &Regeneration) -> Self {
        Self {
            kind,
            chatter: 0.5 * cycle.amplitude * chip,
            wear_factor: regeneration.wear_factor(cycle),
            force_ripple: (cycle.mean_square_force - 1.0).max(0.0).sqrt(),
            ..self
        }
    }
}

/// The stability boundary at one speed, and what the limit cycle depends on.
#[derive(Clone, Copy, Debug)]
struct Boundary {
    /// Depth (m).
    limit: f64,
    kind: ChatterKind,
    /// Hz.
    frequency: f64,
    /// Natural oscillations of the chattering mode in a revolution or tooth period.
    waves: f64,
    damping_ratio: f64,
}

impl Boundary {
    /// Boundary at `limit`, where the cut chatters with `frequency` over `period` (s).
    fn at(limit: f64, kind: ChatterKind, frequency: f64, modes: &[Mode], period: f64) -> Self {
        let distance = |mode: &&Mode| (mode.natural_frequency - frequency).abs();
        let mode = modes.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let (natural, damping_ratio) = mode.map_or((1.0, 0.03), |mode| (mode.natural_frequency, mode.damping_ratio));
        Self { limit, kind, frequency, waves: natural * period, damping_ratio }
    }

    /// The limit cycle of turning at a ratio of depth to limit, from the table.
    fn tabulated(&self, ratio: f64) -> LimitCycle {
        AmplitudeTable::standard().limit_cycle(ratio, self.waves, self.damping_ratio).unwrap_or(LimitCycle::NONE)
    }
}

/// A mode whose frequency and damping differ by factors, at the same modal mass.
fn other(mode: &Mode, frequency_factor: f64, damping_factor: f64) -> Mode {
    Mode {
        natural_frequency: mode.natural_frequency * frequency_factor,
        stiffness: mode.stiffness * frequency_factor * frequency_factor,
        damping_ratio: (mode.damping_ratio * damping_factor).min(0.99),
        ..*mode
    }
}

/// How modes differ from those of the structure, by the machine and by effects.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ModeFactors {
    /// On natural frequencies, at the same modal masses.
    pub frequency: f64,
    /// On damping ratios.
    pub damping: f64,
    /// On stiffnesses beside what the frequency does to them. Only cutting force over stiffness counts for stability, so that it
    /// divides coefficient and process damping.
    pub stiffness: f64,
}

impl ModeFactors {
    /// Factors of a machine on frequencies at the same masses and on damping, and what effects change: their frequencies are
    /// at the same stiffness.
    pub fn new<N: Number>(machine_frequency: N, machine_damping: N, terms: &Terms<N>) -> Self {
        let frequency = terms.mode_frequency.re();
        Self {
            frequency: machine_frequency.re() * frequency,
            damping: machine_damping.re() * terms.mode_damping.re(),
            stiffness: terms.mode_stiffness.re() / (frequency * frequency),
        }
    }

    /// The mode with these factors, stiffness but for what the frequency does to it left out.
    fn of(&self, mode: &Mode) -> Mode {
        other(mode, self.frequency, self.damping)
    }

    /// The modes with these factors, as [`ModeFactors::of`].
    fn of_all(&self, modes: &[Mode]) -> Vec<Mode> {
        modes.iter().map(|mode| self.of(mode)).collect()
    }
}

/// The variation of the spindle speed that an input asks for.
pub(crate) fn variation(amplitude: f64, revolutions: f64) -> Option<SpeedVariation> {
    (amplitude > 0.0).then_some(SpeedVariation { amplitude, revolutions: revolutions as u32, phase: None })
}

/// Steps of the logarithm of speed to which verdicts are rounded: half a part in a thousand.
const SPEED_STEP: f64 = 5e-4;
/// Steps of the logarithm of cutting stiffness and coefficient.
const STIFFNESS_STEP: f64 = 2e-2;
/// Process damping over coefficient (m) below which steps are even, above which they are
/// relative: damping that matters is ten times as great (assumption).
const LITTLE_DAMPING: f64 = 1e-5;
/// Size of these steps, relative.
const DAMPING_STEP: f64 = 0.1;

/// A positive number on a logarithmic grid.
fn rounded(value: f64, step: f64) -> (i32, f64) {
    let index = (value.ln() / step).round();
    (index as i32, (index * step).exp())
}

/// Steps of [`DAMPING_STEP`] in one grade of process damping at varying speed.
const GRADE: f64 = 6.0;

/// Steps of process damping from one judged value to the next, at varying speed or not.
fn damping_grade(varies: bool) -> i32 {
    if varies { GRADE as i32 } else { 1 }
}

/// Process damping over coefficient on a coarser grid, for verdicts that cost much.
fn coarse_damping(ratio: f64) -> f64 {
    let step = GRADE * DAMPING_STEP;
    LITTLE_DAMPING * (((ratio / LITTLE_DAMPING).asinh() / step).floor() * step).sinh()
}

/// Process damping over coefficient on its grid.
fn rounded_damping(ratio: f64) -> (i32, f64) {
    let index = ((ratio / LITTLE_DAMPING).asinh() / DAMPING_STEP).round();
    (index as i32, LITTLE_DAMPING * (index * DAMPING_STEP).sinh())
}
