//! What vibrates in milling.

use super::{
    Boundary, Cell, DAMPING_STEP, LITTLE_DAMPING, Memo, ModeFactors, Regeneration, RoundedVerdict, SPEED_STEP,
    STIFFNESS_STEP, Vibration, coarse_damping, damping_grade, one_step, rounded, rounded_damping,
};
use std::borrow::Cow;
use std::f64::consts::TAU;
use toolroom_chatter::{
    AtSpeed, ChatterError, ChatterKind, Cutter, Direction, Engagement, LimitCycle, Milling, MillingForce, Mode,
    PathModes, SpeedModes, SpeedVariation,
};

/// Tool, holder, spindle and workpiece around a milled cut, in (feed, normal).
///
/// Teeth, diameter, engagement and cutting coefficients are those of the process.
#[derive(Clone, Debug, PartialEq)]
pub struct MillingStructure {
    modes: Vec<Mode>,
    by_speed: Option<SpeedModes>,
    along_path: Option<PathModes>,
    /// Radius of the corner (m), taper (rad), and the axial over the tangential coefficient, which acts with either.
    corner: Corner,
    helix_angle: f64,
    process_damping: f64,
    /// What wear changes.
    pub regeneration: Regeneration,
    boundaries: Memo<Key, Boundary>,
    /// By steps of the depth where a corner makes it count.
    forced: Memo<(Key, i32), f64>,
    /// By steps of the depth.
    growth: Memo<(Key, i32), f64>,
    /// By steps of the ratio of depth to limit.
    cycles: Memo<(Key, i32), Option<LimitCycle>>,
}

/// How the edge is turned from the axis, and the axial over the tangential coefficient.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Corner {
    radius: f64,
    taper: f64,
    axial: f64,
}

impl Corner {
    /// Whether the depth changes radius and angles of the teeth.
    fn turns(&self) -> bool {
        self.radius > 0.0 || self.taper > 0.0
    }
}

/// What a verdict depends on, rounded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Key {
    speed: i32,
    damping: i32,
    /// Steps of the tangential coefficient where the helix makes the depth count.
    coefficient: i32,
    /// Steps of [`RATIO_STEP`] of the radial over the tangential coefficient.
    radial: i64,
    immersion: u64,
    down: bool,
    runout: u64,
    teeth: usize,
    diameter: u64,
    /// Power of two up to which limits are searched.
    searched: i32,
    frequency_factor: u64,
    damping_factor: u64,
    variation: (u64, u32),
}

/// All that a verdict is rounded to: the key of the limit, and the steps of the depth in which growth is judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ToothCell {
    key: Key,
    growth: i32,
}

impl Cell for ToothCell {
    fn is_beside(&self, other: &Self) -> bool {
        let grade = damping_grade(self.key.variation.0 != 0);
        let steps = |Self { key, growth }: &Self| {
            let [speed, damping, coefficient, searched, growth] =
                [key.speed, key.damping / grade, key.coefficient, key.searched, *growth].map(i64::from);
            [speed, damping, coefficient, searched, growth, key.radial]
        };
        let rest = |cell: &Self| Key { speed: 0, damping: 0, coefficient: 0, searched: 0, radial: 0, ..cell.key };
        rest(self) == rest(other) && one_step(steps(self), steps(other))
    }
}

/// One operating point of a cutter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tooth {
    /// rad/s.
    pub spindle_speed: f64,
    pub depth: f64,
    pub feed_per_tooth: f64,
    pub diameter: f64,
    pub teeth: u32,
    pub width: f64,
    pub down: bool,
    pub flank_wear: f64,
    pub wear_ratio: f64,
    /// Coefficients of the sharp cutter with all its factors (Pa).
    pub tangential: f64,
    pub radial: f64,
    pub process_damping: f64,
    pub runout: f64,
    pub modes: ModeFactors,
    pub variation: Option<SpeedVariation>,
}

/// Depths that are sampled for a limit at constant speed, and at varying speed, where the islands of
/// lobes are blurred and a verdict costs far more.
const STEPS: usize = 24;
const VARYING_STEPS: usize = 6;
/// Depths over the present one to which limits are searched, at least.
const SEARCHED: f64 = 2.0;

impl MillingStructure {
    /// Modes in (feed, normal), helix of the cutter (rad) and process damping of the sharp edge
    /// (N/m).
    ///
    /// # Errors
    /// What the stability model refuses.
    pub fn new(
        modes: Vec<Mode>,
        helix_angle: f64,
        process_damping: f64,
        regeneration: Regeneration,
    ) -> Result<Self, ChatterError> {
        let force = MillingForce { process_damping, ..MillingForce::new(1e9, 3e8) };
        let cutter = Cutter { helix_angle, ..Cutter::straight(2, 0.01) };
        let engagement = Engagement::new(0.5, Direction::Down)?;
        let trial =
            Milling { modes, cutter, engagement, force, feed_per_tooth: 1e-4, by_speed: None, along_path: None };
        trial.at_speed(100.0)?;
        let modes = trial.modes;
        Ok(Self {
            modes,
            by_speed: None,
            along_path: None,
            corner: Corner::default(),
            helix_angle,
            process_damping,
            regeneration,
            boundaries: Memo::default(),
            forced: Memo::default(),
            growth: Memo::default(),
            cycles: Memo::default(),
        })
    }

    /// The structure with modes that change with the spindle speed. A cut outside the speeds of the table counts as
    /// unstable: nobody measured there.
    #[must_use]
    pub fn by_speed(self, by_speed: Option<SpeedModes>) -> Self {
        Self { by_speed, ..self }
    }

    /// The structure with modes that change along the path of the tool: a pass is judged at its worst place.
    #[must_use]
    pub fn along_path(self, along_path: Option<PathModes>) -> Self {
        Self { along_path, ..self }
    }

    /// The structure of a cutter with the corner or the taper of `cutter`; `axial_ratio` is the axial over the tangential
    /// coefficient. Stability and vibration are those of this cutter.
    #[must_use]
    pub fn with_profile(self, cutter: &Cutter, axial_ratio: f64) -> Self {
        let corner = Corner { radius: cutter.corner_radius, taper: cutter.taper_angle, axial: axial_ratio };
        Self { corner, ..self }
    }

    /// Whether the depth changes the angles of the teeth, so that limits do not go with the inverse of the coefficient.
    fn depth_counts(&self) -> bool {
        self.helix_angle != 0.0 || self.corner.turns()
    }

    /// Least and greatest spindle speed (rad/s) at which the modes are known, where they change with it.
    pub fn speeds(&self) -> Option<(f64, f64)> {
        self.by_speed.as_ref().map(SpeedModes::range)
    }

    /// Tangential coefficient of the worn edge over the factor of the stiffness (Pa), and process damping over the coefficient (m).
    fn worn(&self, tooth: &Tooth) -> (f64, f64) {
        let tangential = tooth.tangential * self.regeneration.coefficient_factor(tooth.wear_ratio);
        let land = self.regeneration.land_damping(tooth.flank_wear);
        let damping = (self.process_damping + tooth.process_damping + land) / tangential;
        (tangential / tooth.modes.stiffness, damping)
    }

    /// Process damping in the grades at which it is judged: coarse ones at varying speed.
    fn graded(&self, damping: f64, tooth: &Tooth) -> f64 {
        if tooth.variation.is_some() { coarse_damping(damping) } else { damping }
    }

    fn key(&self, tooth: &Tooth) -> Key {
        let (tangential, damping) = self.worn(tooth);
        let helical = self.depth_counts();
        let damping = self.graded(damping, tooth);
        Key {
            speed: rounded(tooth.spindle_speed, SPEED_STEP).0,
            damping: rounded_damping(damping).0,
            coefficient: if helical { rounded(tangential, STIFFNESS_STEP).0 } else { 0 },
            radial: radial_ratio(tooth).0,
            immersion: (tooth.width / tooth.diameter).min(1.0).to_bits(),
            down: tooth.down,
            runout: if tooth.runout > 0.0 { (tooth.runout / tooth.feed_per_tooth).to_bits() } else { 0 },
            teeth: tooth.teeth as usize,
            diameter: tooth.diameter.to_bits(),
            searched: (SEARCHED * tooth.depth * if helical { 1.0 } else { tangential / NOMINAL }).log2().ceil() as i32,
            frequency_factor: tooth.modes.frequency.to_bits(),
            damping_factor: tooth.modes.damping.to_bits(),
            variation: tooth.variation.map_or((0, 0), |v| (v.amplitude.to_bits(), v.revolutions)),
        }
    }

    /// The cut as it is judged, its speed, and the factor from its depth to the real one.
    fn judged(&self, tooth: &Tooth, key: &Key) -> Result<(Milling, f64, f64), ChatterError> {
        let (tangential, damping) = self.worn(tooth);
        let helical = self.depth_counts();
        let judged = if helical { rounded(tangential, STIFFNESS_STEP).1 } else { NOMINAL };
        let corner_radius = self.corner.radius.min(0.5 * tooth.diameter);
        // With a corner or a taper the teeth count as true: runout is not calculated there.
        let runout = if self.corner.turns() { 0.0 } else { tooth.runout };
        let taper_angle = self.corner.taper;
        let straight = Cutter::straight(key.teeth, tooth.diameter);
        let cutter = Cutter { helix_angle: self.helix_angle, runout, corner_radius, taper_angle, ..straight };
        let direction = if tooth.down { Direction::Down } else { Direction::Up };
        let force = MillingForce {
            process_damping: rounded_damping(self.graded(damping, tooth)).1 * judged,
            axial: judged * self.corner.axial,
            ..MillingForce::new(judged, judged * radial_ratio(tooth).1)
        };
        let speed = rounded(tooth.spindle_speed, SPEED_STEP).1;
        let modes = match &self.by_speed {
            Some(table) => Cow::Owned(table.at(speed)?),
            None => Cow::Borrowed(&self.modes),
        };
        let cut = Milling {
            modes: tooth.modes.of_all(&modes),
            cutter,
            engagement: Engagement::new((tooth.width / tooth.diameter).min(1.0), direction)?,
            force,
            feed_per_tooth: tooth.feed_per_tooth,
            by_speed: None,
            along_path: self.path(tooth),
        };
        Ok((cut, speed, if helical { 1.0 } else { judged / tangential }))
    }

    /// The modes along the path with the factors of the machine.
    fn path(&self, tooth: &Tooth) -> Option<PathModes> {
        let scatter = |_, mode: &Mode| tooth.modes.of(mode);
        self.along_path.as_ref().map(|path| path.map(scatter))
    }

    /// Boundary in depths of the judged cut. A cut that the model refuses, as one without a tooth in
    /// cut, counts as unstable, and so does one whose eigenvalue does not converge and that is too large
    /// for dense ones.
    fn boundary(&self, tooth: &Tooth, key: &Key) -> Boundary {
        let judge = || -> Result<Boundary, ChatterError> {
            let (cut, speed, _) = self.judged(tooth, key)?;
            let period = TAU / (speed * tooth.teeth as f64);
            let searched = 2f64.powi(key.searched);
            let found = match tooth.variation {
                None => cut.at_speed(speed)?.rough_limit(searched, STEPS),
                Some(variation) => {
                    cut.at_varying_speed(speed, entering(variation, &cut))?.rough_limit(searched, VARYING_STEPS)
                }
            };
            match found {
                Ok(limit) => Ok(Boundary::at(limit.depth, limit.kind, limit.chatter_frequency, &cut.modes, period)),
                Err(ChatterError::NoLimit { searched }) => {
                    Ok(Boundary::at(searched, ChatterKind::Hopf, 0.0, &cut.modes, period))
                }
                Err(error) => Err(error),
            }
        };
        let refused = |_| Boundary::at(0.0, ChatterKind::Hopf, 0.0, &self.modes, TAU / tooth.spindle_speed);
        self.boundaries.of(*key, || judge().unwrap_or_else(refused))
    }

    /// Amplitude that the teeth force in a stable cut, for each metre of judged depth and of feed;
    /// process damping does not change what repeats from tooth to tooth.
    fn forced(&self, tooth: &Tooth, key: &Key) -> f64 {
        // The response goes with depth and feed; with a helix nearly so.
        const DEPTH: f64 = 1e-3;
        let key = Key { damping: 0, searched: 0, variation: (0, 0), ..*key };
        // A corner meets the work at other angles at every depth.
        let (step, depth) =
            if self.corner.turns() { rounded(tooth.depth, SPEED_STEP * CYCLE_SPEED) } else { (0, DEPTH) };
        self.forced.of((key, step), || {
            let respond = || -> Result<f64, ChatterError> {
                let (cut, speed, _) = self.judged(tooth, &key)?;
                Ok(0.5 * cut.forced(speed, depth)?.peak_to_peak[1] / (depth * tooth.feed_per_tooth))
            };
            // Teeth whose surfaces overlap by runout have no forced response without simulation.
            respond().unwrap_or(0.0)
        })
    }

    /// Depth (m) and frequency (Hz) of the least limit; where none lies below the depths that are searched, the last of these
    /// and no frequency.
    pub(crate) fn limit(&self, tooth: &Tooth) -> (f64, f64) {
        let boundary = self.boundary_of(tooth, &self.key(tooth));
        (boundary.limit, boundary.frequency)
    }

    /// Real depth for each judged one.
    fn scale(&self, tooth: &Tooth) -> f64 {
        if self.depth_counts() { 1.0 } else { NOMINAL / self.worn(tooth).0 }
    }

    /// The boundary in real depths.
    fn boundary_of(&self, tooth: &Tooth, key: &Key) -> Boundary {
        let judged = self.boundary(tooth, key);
        Boundary { limit: judged.limit * self.scale(tooth), ..judged }
    }

    /// Whether the cut chatters.
    fn regenerates(&self, tooth: &Tooth, boundary: &Boundary) -> bool {
        // Nearer to the limit the verdict on a rounded depth could lie on its other side.
        let beyond = tooth.depth > boundary.limit * (1.0 + STIFFNESS_STEP);
        let stable_again = || beyond && tooth.variation.is_none() && self.growth_rate(tooth) < 0.0;
        Vibration::quiet(boundary, tooth.depth).margin < 0.0 && !stable_again()
    }

    /// Whether the cut is unstable, as [`MillingStructure::vibration`] has it but at less cost, and what this was rounded to.
    pub(crate) fn judge(&self, tooth: &Tooth) -> RoundedVerdict<ToothCell> {
        let key = self.key(tooth);
        let cell = ToothCell { key, growth: rounded(tooth.depth / self.scale(tooth), STIFFNESS_STEP).0 };
        let boundary = self.boundary_of(tooth, &key);
        RoundedVerdict {
            cell: Some(cell),
            unstable: self.regenerates(tooth, &boundary),
            load: tooth.depth / self.scale(tooth),
            limits: [1.0, 1.0 + STIFFNESS_STEP].map(|factor| factor * boundary.limit / self.scale(tooth)),
        }
    }

    /// How the cut vibrates.
    pub(crate) fn vibration(&self, tooth: &Tooth) -> Vibration {
        let key = self.key(tooth);
        let scale = self.scale(tooth);
        let boundary = self.boundary_of(tooth, &key);
        let quiet = Vibration {
            forced: self.forced(tooth, &key) * tooth.depth / scale * tooth.feed_per_tooth,
            ..Vibration::quiet(&boundary, tooth.depth)
        };
        if !self.regenerates(tooth, &boundary) {
            return quiet;
        }
        let ratio = tooth.depth / boundary.limit;
        let cycle = self.cycle(tooth, ratio).unwrap_or_else(|| boundary.tabulated(ratio));
        let vibration = quiet.chattering(boundary.kind, &cycle, tooth.feed_per_tooth, &self.regeneration);
        // The cycle holds what the teeth force. Beyond the limit the response of a stable cut is none any more: what they
        // force stays that of the limit, and all else is chatter.
        let forced = quiet.forced / ratio;
        Vibration { forced, chatter: (vibration.chatter - forced).max(f64::MIN_POSITIVE), ..vibration }
    }

    /// The limit cycle at a `ratio` of depth to limit, between those of two ratios at a rounded speed and process damping; none
    /// where the cut cannot be simulated. At varying speed it is that of the constant one.
    fn cycle(&self, tooth: &Tooth, ratio: f64) -> Option<LimitCycle> {
        let calm = self.graded_for_cycles(tooth);
        let key = self.key(&calm);
        let place = ((ratio.ln() - LEAST_CYCLE) / CYCLE_STEP).clamp(0.0, CYCLES);
        let node = |step: f64| {
            self.cycles.of((key, step as i32), || {
                let boundary = self.boundary(&calm, &key);
                let (cut, speed, _) = self.judged(&calm, &key).ok()?;
                cut.limit_cycle(speed, (LEAST_CYCLE + CYCLE_STEP * step).exp() * boundary.limit).ok()
            })
        };
        let (before, after) = (node(place.floor())?, node(place.ceil())?);
        Some(before.towards(&after, place.fract()))
    }

    /// The operating point at constant speed, with speed and process damping in the steps at which cycles are simulated.
    fn graded_for_cycles(&self, tooth: &Tooth) -> Tooth {
        let (tangential, damping) = self.worn(tooth);
        let step = DAMPING_STEP * CYCLE_DAMPING;
        let graded = LITTLE_DAMPING * (((damping / LITTLE_DAMPING).asinh() / step).round() * step).sinh();
        Tooth {
            spindle_speed: rounded(tooth.spindle_speed, SPEED_STEP * CYCLE_SPEED).1,
            process_damping: tooth.process_damping + (graded - damping) * tangential * tooth.modes.stiffness,
            variation: None,
            ..*tooth
        }
    }

    /// The cut of an operating point as the stability model sees it, nothing rounded; a factor of the stiffness divides its forces.
    pub(crate) fn regenerative(&self, tooth: &Tooth) -> Result<Milling, ChatterError> {
        let (cut, _, _) = self.judged(tooth, &self.key(tooth))?;
        let (tangential, damping) = self.worn(tooth);
        let radial = tangential * tooth.radial / tooth.tangential;
        let axial = tangential * self.corner.axial;
        let force =
            MillingForce { process_damping: damping * tangential, axial, ..MillingForce::new(tangential, radial) };
        let by_speed = self.by_speed.as_ref().map(|table| table.map(|_, mode| tooth.modes.of(mode)));
        Ok(Milling { force, by_speed, ..cut })
    }

    /// Rate at which a disturbance grows (1/s): negative in a stable cut.
    pub(crate) fn growth_rate(&self, tooth: &Tooth) -> f64 {
        let key = self.key(tooth);
        let (step, depth) = rounded(tooth.depth / self.scale(tooth), STIFFNESS_STEP);
        let judge = || -> Result<f64, ChatterError> {
            let (cut, speed, _) = self.judged(tooth, &key)?;
            let mut at_speed: AtSpeed<'_> = match tooth.variation {
                None => cut.at_speed(speed)?,
                Some(variation) => cut.at_varying_speed(speed, entering(variation, &cut))?,
            };
            let verdict = at_speed.verdict(depth)?;
            Ok(verdict.spectral_radius.ln() / verdict.period)
        };
        self.growth.of((key, step), || judge().unwrap_or(0.0))
    }
}

/// Logarithm of the least ratio of depth to limit at which a cycle is simulated: nearer to the limit a vibration grows too
/// slowly, and where contact is lost it jumps to this size at once (assumption).
const LEAST_CYCLE: f64 = 0.05;
/// Steps of that logarithm between which cycles are interpolated, and their number: up to 4.7 times the limit, beyond which
/// the cycle of that ratio stands (assumption; a test holds cuts up to three times their limit to 15 % of a simulation).
const CYCLE_STEP: f64 = 0.15;
const CYCLES: f64 = 10.0;
/// Steps of the speed and of process damping of a verdict in one of a cycle: a quarter of a percent of the speed, a fifth of
/// the damping (assumption; held by the same test).
const CYCLE_SPEED: f64 = 5.0;
const CYCLE_DAMPING: f64 = 2.0;

/// Steps in which the ratio of the coefficients is told apart: factors on both leave some noise in its last
/// digits, some 1e-16 each, and no force is known to nine (assumption).
const RATIO_STEP: f64 = 1e-9;

/// The radial over the tangential coefficient in steps of [`RATIO_STEP`].
fn radial_ratio(tooth: &Tooth) -> (i64, f64) {
    let steps = (tooth.radial / tooth.tangential / RATIO_STEP).round();
    (steps as i64, steps * RATIO_STEP)
}

/// Coefficient at which straight teeth are judged (Pa): limits go with its inverse.
const NOMINAL: f64 = 1e9;

/// The variation with its greatest speed as a tooth enters (assumption: no control holds the phase, and the worst one costs
/// three times as much; `toolroom lobes` takes the worst).
fn entering(variation: SpeedVariation, cut: &Milling) -> SpeedVariation {
    SpeedVariation { phase: Some(cut.engagement.entry), ..variation }
}
