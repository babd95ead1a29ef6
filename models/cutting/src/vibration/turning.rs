//! What vibrates in turning.

use super::{
    Boundary, Cell, Memo, ModeFactors, Regeneration, RoundedVerdict, SPEED_STEP, STIFFNESS_STEP, Vibration,
    coarse_damping, damping_grade, one_step, rounded, rounded_damping,
};
use std::f64::consts::TAU;
use toolroom_chatter::paper::Reduced;
use toolroom_chatter::{Bar, ChatterError, ChatterKind, Mode, SpeedModes, SpeedVariation, Turning};

/// Tool, workpiece and chuck around a turned cut.
///
/// The cutting coefficient is that of the sharp nominal edge in nominal material, per depth of
/// cut and along the chip thickness, which counts as the feed.
///
/// # Examples
/// ```
/// use std::sync::Arc;
/// use toolroom_chatter::Mode;
/// use toolroom_cutting::{Regeneration, Turning, TurningInput, TurningStructure};
/// use toolroom_process::Process;
/// let mode = Mode { direction: [1.0, 0.0], natural_frequency: 180.0, damping_ratio: 0.03, stiffness: 8e6 };
/// let cut = toolroom_chatter::Turning::orthogonal(vec![mode], 2e9, 0.04);
/// let structure = TurningStructure::new(cut, None, Regeneration::default()).unwrap();
/// let turning = Turning { structure: Some(Arc::new(structure)), ..Turning::named("c45_t15k6").unwrap() };
/// let deep = TurningInput { cutting_speed: 2.5, depth_of_cut: 2e-3, workpiece_diameter: 0.04, ..Default::default() };
/// let output = turning.output(&turning.initial(), &deep);
/// assert!(output.stable == 0.0 && output.stability_margin < 0.0 && output.vibration_amplitude > 1e-5);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct TurningStructure {
    /// Modes but for the bar's, coefficient, process damping of the sharp edge.
    cut: Turning,
    /// The workpiece, and the place of the tool where none is given (m from the jaws).
    bar: Option<(Bar, f64)>,
    /// What wear changes.
    pub regeneration: Regeneration,
    boundaries: Memo<Key, Boundary>,
    chucks: Memo<ChuckKey, f64>,
    /// By steps of the depth.
    growth: Memo<(Key, i32), f64>,
}

/// What a verdict depends on, rounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Key {
    speed: i32,
    damping: i32,
    place: u32,
    frequency_factor: u64,
    damping_factor: u64,
    diameter: u64,
    variation: (u64, u32),
}

/// What the verdict on a modulated chuck depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct ChuckKey {
    cut: Key,
    stiffness: i32,
    modulation: u64,
}

/// All that a verdict is rounded to: the key of the limit, the steps of the cutting stiffness in which growth and a modulated
/// chuck are judged, and the modulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct EdgeCell {
    key: Key,
    growth: i32,
    stiffness: i32,
    modulation: u64,
}

impl Cell for EdgeCell {
    fn is_beside(&self, other: &Self) -> bool {
        let varies = self.key.variation.0 != 0;
        let (grade, place) = (damping_grade(varies), if varies { COARSE } else { 1 });
        let steps = |Self { key, growth, stiffness, .. }: &Self| {
            [key.speed, key.damping / grade, *growth, *stiffness, (key.place / place) as i32].map(i64::from)
        };
        let rest = |cell: &Self| (Key { speed: 0, damping: 0, place: 0, ..cell.key }, cell.modulation);
        rest(self) == rest(other) && one_step(steps(self), steps(other))
    }
}

/// Chatter of an edge as it was judged at one instant, held while a step of an integration goes on: rates of wear are then
/// smooth, which jump where a verdict is rounded to another one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HeldChatter {
    /// At nominal coefficient.
    boundary: Boundary,
    /// Whether the cut chatters by regeneration, else by its chuck.
    regenerates: bool,
}

/// Places along a bar at which its compliance is taken.
const PLACES: f64 = 64.0;
/// Of these, every so many at varying speed, where verdicts cost much.
const COARSE: u32 = 8;
/// Steps in which it is searched.
const VARYING_STEPS: usize = 8;
/// Depths over the limit of constant speed to which the limit of varying speed is searched.
const SEARCHED: f64 = 4.0;
/// Ratio of depth to limit at which the limit cycle of a modulated chuck is taken; assumption.
const PARAMETRIC_RATIO: f64 = 1.05;

/// One operating point of an edge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    /// rad/s.
    pub spindle_speed: f64,
    pub depth: f64,
    pub feed: f64,
    pub diameter: f64,
    pub flank_wear: f64,
    pub wear_ratio: f64,
    /// Factor on the cutting coefficient of the sharp edge.
    pub coefficient: f64,
    /// Process damping on top of the structure's (N/m).
    pub process_damping: f64,
    /// Amplitude of the chuck's stiffness.
    pub modulation: f64,
    /// Of the tool, from the jaws (m); 0 where not given.
    pub position: f64,
    pub modes: ModeFactors,
    pub variation: Option<SpeedVariation>,
}

impl TurningStructure {
    /// Modes, coefficient and process damping of `cut`; a `bar` adds its bending at the tool, at a
    /// place (m from the jaws) that the input may change.
    ///
    /// # Errors
    /// What the stability model refuses.
    pub fn new(cut: Turning, bar: Option<(Bar, f64)>, regeneration: Regeneration) -> Result<Self, ChatterError> {
        let structure = Self {
            cut,
            bar,
            regeneration,
            boundaries: Memo::default(),
            chucks: Memo::default(),
            growth: Memo::default(),
        };
        // Refuses now what would be refused in every verdict.
        match structure
            .at_place(structure.bar.map_or(0.0, |(_, place)| place))?
            .limit(structure.speeds().map_or(1.0, |speeds| speeds.0))
        {
            Err(ChatterError::NoLimit { .. }) | Ok(_) => Ok(structure),
            Err(error) => Err(error),
        }
    }

    /// The cut of a sharp edge with all modes, the bar's at `place`.
    ///
    /// # Errors
    /// A place off the bar.
    pub fn at_place(&self, place: f64) -> Result<Turning, ChatterError> {
        Ok(match &self.bar {
            Some((bar, _)) => self.cut.clone().with_mode(bar.mode_at(place)?),
            None => self.cut.clone(),
        })
    }

    /// Least and greatest spindle speed (rad/s) at which the modes are known, where they change with it. A cut outside
    /// counts as unstable: nobody measured there.
    pub fn speeds(&self) -> Option<(f64, f64)> {
        self.cut.by_speed.as_ref().map(SpeedModes::range)
    }

    /// Length of the workpiece out of the jaws (m), where it bends.
    pub fn bar_length(&self) -> Option<f64> {
        self.bar.map(|(bar, _)| bar.length)
    }

    /// Process damping of a worn edge over the factor of the stiffness (N/m).
    fn process_damping(&self, edge: &Edge) -> f64 {
        let land = self.regeneration.land_damping(edge.flank_wear);
        (self.cut.process_damping + edge.process_damping + land) / edge.modes.stiffness
    }

    /// Factor of wear, hardness and effects on the cutting coefficient, over that of the stiffness.
    fn coefficient(&self, edge: &Edge) -> f64 {
        edge.coefficient * self.regeneration.coefficient_factor(edge.wear_ratio) / edge.modes.stiffness
    }

    /// Process damping over the coefficient (m), in the grades at which it is judged: coarse
    /// ones at varying speed.
    fn damping_ratio(&self, edge: &Edge) -> f64 {
        let ratio = self.process_damping(edge) / (self.coefficient(edge) * self.cut.cutting_coefficient);
        if edge.variation.is_some() { coarse_damping(ratio) } else { ratio }
    }

    fn key(&self, edge: &Edge) -> Key {
        let ratio = self.damping_ratio(edge);
        let place = self.bar.map_or(0, |(bar, place)| {
            let place = if edge.position > 0.0 { edge.position } else { place };
            place_on(bar.length, place, edge.variation.is_some())
        });
        Key {
            speed: rounded(edge.spindle_speed, SPEED_STEP).0,
            damping: rounded_damping(ratio).0,
            place,
            frequency_factor: edge.modes.frequency.to_bits(),
            damping_factor: edge.modes.damping.to_bits(),
            diameter: edge.diameter.to_bits(),
            variation: edge.variation.map_or((0, 0), |v| (v.amplitude.to_bits(), v.revolutions)),
        }
    }

    /// The place on the bar of a key (m from the jaws).
    fn place(&self, key: &Key) -> f64 {
        self.bar.map_or(0.0, |(bar, _)| f64::from(key.place) / PLACES * bar.length)
    }

    /// The nominal cut of a key: only the ratio of damping to coefficient matters, the limit goes
    /// with the inverse of the coefficient.
    fn nominal(&self, edge: &Edge, key: &Key) -> Result<(Turning, f64), ChatterError> {
        let cut = self.at_place(self.place(key))?;
        let damping = rounded_damping(self.damping_ratio(edge)).1 * cut.cutting_coefficient;
        let speed = rounded(edge.spindle_speed, SPEED_STEP).1;
        let nominal = cut.at_spindle_speed(speed)?.into_owned();
        let modes = edge.modes.of_all(&nominal.modes);
        let along_path = nominal.along_path.as_ref().map(|path| path.map(|_, mode| edge.modes.of(mode)));
        Ok((Turning { modes, process_damping: damping, diameter: edge.diameter, along_path, ..nominal }, speed))
    }

    /// The boundary at nominal coefficient. What cannot be judged counts as unstable.
    fn boundary(&self, edge: &Edge, key: &Key) -> Boundary {
        let judge = || -> Result<Boundary, ChatterError> {
            let (cut, speed) = self.nominal(edge, key)?;
            let period = TAU / speed;
            let still = match cut.limit(speed) {
                Ok(limit) => Boundary::at(limit.depth, limit.kind, limit.chatter_frequency, &cut.modes, period),
                // The mode of a cut that no depth makes unstable does not matter.
                Err(ChatterError::NoLimit { .. }) => {
                    return Ok(Boundary::at(f64::INFINITY, ChatterKind::Stable, 0.0, &cut.modes, period));
                }
                Err(error) => return Err(error),
            };
            let Some(variation) = edge.variation else { return Ok(still) };
            let searched = SEARCHED * still.limit;
            let limit = match cut.limit_width_at_varying_speed(speed, variation, searched, VARYING_STEPS) {
                Ok(width) => width,
                Err(ChatterError::NoLimit { searched }) => searched,
                // Not found: that of constant speed, which variation seldom lowers.
                Err(_) => still.limit,
            };
            Ok(Boundary { limit, ..still })
        };
        let refused = |_| Boundary::at(0.0, ChatterKind::Hopf, 0.0, &self.cut.modes, TAU / edge.spindle_speed);
        self.boundaries.of(*key, || judge().unwrap_or_else(refused))
    }

    /// Depth (m) and frequency (Hz) of the least limit.
    pub(crate) fn limit(&self, edge: &Edge) -> (f64, f64) {
        let boundary = self.boundary(edge, &self.key(edge));
        (boundary.limit / self.coefficient(edge), boundary.frequency)
    }

    /// The boundary under the coefficient of the edge.
    fn boundary_of(&self, edge: &Edge, key: &Key) -> Boundary {
        let nominal = self.boundary(edge, key);
        Boundary { limit: nominal.limit / self.coefficient(edge), ..nominal }
    }

    /// Whether the cut chatters by regeneration.
    fn regenerates(&self, edge: &Edge, boundary: &Boundary) -> bool {
        // Nearer to the limit the verdict on a rounded depth could lie on its other side.
        let beyond = edge.depth > boundary.limit * (1.0 + STIFFNESS_STEP);
        let stable_again = || beyond && edge.variation.is_none() && self.growth_rate(edge) < 0.0;
        Vibration::quiet(boundary, edge.depth).margin < 0.0 && !stable_again()
    }

    /// Whether the cut is unstable, as [`TurningStructure::vibration`] has it but at less cost, and what this was rounded to.
    pub(crate) fn judge(&self, edge: &Edge) -> RoundedVerdict<EdgeCell> {
        let key = self.key(edge);
        let stiffness = edge.depth * self.coefficient(edge);
        let cell = EdgeCell {
            key,
            growth: rounded(stiffness, STIFFNESS_STEP).0,
            stiffness: rounded(stiffness * self.cut.cutting_coefficient, STIFFNESS_STEP).0,
            modulation: edge.modulation.to_bits(),
        };
        let modulated = || edge.modulation > 0.0 && self.critical_modulation(edge, &key) < edge.modulation;
        let boundary = self.boundary_of(edge, &key);
        let unstable = self.regenerates(edge, &boundary) || modulated();
        let limit = boundary.limit * self.coefficient(edge);
        RoundedVerdict { cell: Some(cell), unstable, load: stiffness, limits: [limit, limit * (1.0 + STIFFNESS_STEP)] }
    }

    /// How an unstable cut chatters, to be held.
    pub(crate) fn chatter(&self, edge: &Edge) -> HeldChatter {
        let key = self.key(edge);
        let regenerates = self.regenerates(edge, &self.boundary_of(edge, &key));
        HeldChatter { boundary: self.boundary(edge, &key), regenerates }
    }

    /// Factor on force-driven wear under chatter that is held: that of [`TurningStructure::vibration`] where the edge is still
    /// rounded to it, and behind the limit that just beyond it.
    pub(crate) fn wear_factor(&self, edge: &Edge, held: &HeldChatter) -> f64 {
        let ratio = if held.regenerates {
            (edge.depth * self.coefficient(edge) / held.boundary.limit).max(1.0 + f64::EPSILON)
        } else {
            PARAMETRIC_RATIO
        };
        self.regeneration.wear_factor(&held.boundary.tabulated(ratio))
    }

    /// How the cut vibrates.
    pub(crate) fn vibration(&self, edge: &Edge) -> Vibration {
        let key = self.key(edge);
        let boundary = self.boundary_of(edge, &key);
        let quiet = Vibration::quiet(&boundary, edge.depth);
        let vibration = if !self.regenerates(edge, &boundary) {
            quiet
        } else {
            let cycle = boundary.tabulated(edge.depth / boundary.limit);
            quiet.chattering(boundary.kind, &cycle, edge.feed, &self.regeneration)
        };
        if edge.modulation <= 0.0 || !vibration.stable() {
            return vibration;
        }
        let critical = self.critical_modulation(edge, &key);
        let modulated = 1.0 - edge.modulation / critical;
        let judged = Vibration { margin: vibration.margin.min(modulated), ..vibration };
        if modulated >= 0.0 {
            return judged;
        }
        let cycle = boundary.tabulated(PARAMETRIC_RATIO);
        judged.chattering(ChatterKind::Parametric, &cycle, edge.feed, &self.regeneration)
    }

    /// Modulation of the chuck's stiffness at which the softest mode becomes unstable; twice the
    /// present one where it is not below that.
    fn critical_modulation(&self, edge: &Edge, key: &Key) -> f64 {
        let stiffness = edge.depth * self.cut.cutting_coefficient * self.coefficient(edge);
        let (stiffness, rounded_stiffness) = rounded(stiffness, STIFFNESS_STEP);
        let key = ChuckKey { cut: *key, stiffness, modulation: edge.modulation.to_bits() };
        self.chucks.of(key, || {
            let searched = 2.0 * edge.modulation;
            let judge = || -> Result<f64, ChatterError> {
                let (cut, speed) = self.nominal(edge, &key.cut)?;
                let softest = cut.modes.iter().min_by(|a, b| a.stiffness.total_cmp(&b.stiffness));
                let Some(mode) = softest else { return Err(ChatterError::NoModes) };
                let chuck = modulated(mode, rounded_stiffness);
                Ok(chuck.critical_modulation(3.0 * speed / chuck.natural_frequency(), searched)?.unwrap_or(searched))
            };
            judge().unwrap_or(0.5 * edge.modulation)
        })
    }

    /// The cut of an operating point as the stability model sees it, nothing rounded but the place; a factor of the stiffness
    /// divides its forces.
    pub(crate) fn regenerative(&self, edge: &Edge) -> Result<Turning, ChatterError> {
        let key = self.key(edge);
        let (cut, _) = self.nominal(edge, &key)?;
        let by_speed = self.at_place(self.place(&key))?.by_speed.map(|table| table.map(|_, mode| edge.modes.of(mode)));
        let cutting_coefficient = cut.cutting_coefficient * self.coefficient(edge);
        Ok(Turning { cutting_coefficient, process_damping: self.process_damping(edge), by_speed, ..cut })
    }

    /// Rate at which a disturbance grows (1/s): negative in a stable cut.
    pub(crate) fn growth_rate(&self, edge: &Edge) -> f64 {
        let key = self.key(edge);
        let (step, depth) = rounded(edge.depth * self.coefficient(edge), STIFFNESS_STEP);
        let judge = || -> Result<f64, ChatterError> {
            let (cut, speed) = self.nominal(edge, &key)?;
            let verdict = match edge.variation {
                Some(variation) => cut.verdict_at_varying_speed(speed, variation, depth)?,
                None => cut.verdict_without_margin(speed, depth)?,
            };
            Ok(verdict.spectral_radius.ln() / verdict.period)
        };
        self.growth.of((key, step), || judge().unwrap_or(0.0))
    }
}

/// Number of the place along a bar of `length` at which its compliance is taken.
fn place_on(length: f64, place: f64, coarse: bool) -> u32 {
    let step = if coarse { COARSE } else { 1 };
    let number = (place / length * PLACES / f64::from(step)).round() as u32 * step;
    number.clamp(1, PLACES as u32 - 1)
}

/// The mode as the system of one degree of freedom in a chuck of three jaws, without lag.
fn modulated(mode: &Mode, cutting_stiffness: f64) -> Reduced {
    let mass = mode.mass();
    let damping = 2.0 * mode.damping_ratio * mode.angular_frequency() * mass;
    Reduced { mass, damping, stiffness: mode.stiffness, cutting_stiffness, lag: 0.0 }
}
