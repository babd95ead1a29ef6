//! A contour, a pass and a parameter set together: what a setting does on a section.

use crate::constraint::exceeds;
use crate::path_error::ArcError;
use crate::{
    Along, Constraint, Contour, ContourError, Corner, CornerMove, Cutter, CutterSide, Engagement, EngagementModel,
    Forces, FormError, HelicalCut, Machine, MeanForces, Milling, Models, Parameters, Pass, PathError, Piece, Ratios,
    Section, Shape,
};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use toolroom_process::{ModelError, Record};

/// Spindle speed and feed of a section: what a plan chooses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Spindle speed, rad/s.
    pub spindle_speed: f64,
    /// Feed per tooth, m.
    pub feed_per_tooth: f64,
}

impl Setting {
    /// Feed of the cutter centre, m/s.
    pub fn feed(&self, teeth: f64) -> f64 {
        self.spindle_speed / TAU * self.feed_per_tooth * teeth
    }
}

/// What a setting does on a section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Evaluation {
    /// Feed of the cutter centre, m/s.
    pub feed: f64,
    /// Cutting speed, m/s.
    pub cutting_speed: f64,
    /// Engagement with the stock.
    pub engagement: Engagement,
    /// Forces averaged over a revolution.
    pub forces: Forces,
    /// Cutting power, W.
    pub power: f64,
    /// Deflection of the cutter off the wall as the accuracy constraint sees it, m.
    pub deflection: f64,
    /// Error of the drives, m, positive where material is left.
    pub path_error: f64,
    /// Roughness Rz, m.
    pub roughness: f64,
    /// Tool life, s.
    pub tool_life: f64,
    /// Every constraint's value over its limit.
    pub ratios: Ratios,
}

impl Evaluation {
    /// Signed error of the wall, m, positive where material is left: deflection and path error
    /// with their directions. The accuracy constraint adds their magnitudes.
    pub fn wall_error(&self) -> f64 {
        self.deflection + self.path_error
    }
}

/// What a plan should be warned of.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Warning {
    /// The path error is one of the calculation.
    #[error("the path error is the truncation error of explicit Euler at {:.3} ms: halving the step halves it; no machine behaves so", step * 1e3)]
    ExplicitEuler {
        /// Time step, s.
        step: f64,
    },
    /// The path error is empirical.
    #[error("the empirical path error has the size of a truncation error; the servo law is the physical one")]
    EmpiricalPathError,
    /// A cutter outside the recommended range.
    #[error("cutter radius over smallest concave radius is {ratio:.3}; 0.70 to 0.75 is recommended")]
    CutterRadius {
        /// Cutter radius over smallest concave radius.
        ratio: f64,
    },
    /// The average force hides the form over the height.
    #[error("the average force hides the form over the height, up to {:.1} um more on this contour", excess * 1e6)]
    MeanForce {
        /// Greatest additional error, m, at the plan's settings.
        excess: f64,
    },
}

/// Everything about a wall shape that does not depend on the setting.
#[derive(Clone, Debug)]
struct Wall {
    shape: Shape,
    engagement: Engagement,
    forces: MeanForces,
    chip_thickness_ratio: f64,
    life: f64,
    /// Roughness per feed per tooth squared, 1/m.
    cusp: f64,
    arc_error: ArcError,
    /// Finishing force, N, and its slope, N/m, at the heights that matter; empty for the mean.
    heights: Vec<(f64, f64)>,
}

/// A candidate on a wall: feed index, time and edge life used per length of centre path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Candidate {
    pub feed: usize,
    pub time: f64,
    pub life: f64,
}

/// The settings of one point with what depends on them alone.
#[derive(Clone, Copy)]
struct Operating {
    spindle_speed: f64,
    feed_per_tooth: f64,
    feed: f64,
    cutting_speed: f64,
    life: f64,
}

/// Plans the milling of a contour: checks everything once, then answers for any section and
/// setting, and searches.
///
/// # Examples
/// ```
/// use toolroom_contour::{Contour, Models, Objective, Parameters, Pass, Planner, Trace, CutterSide, Point};
/// let mut trace = Trace::new(Point::default(), 0.0);
/// trace.lobed(0.1, 0.0035, 3, 18).unwrap();
/// let hole = trace.finish(CutterSide::Left, true).unwrap();
/// let (parameters, pass, models) = (Parameters::default(), Pass::default(), Models::default());
/// let planner = Planner::new(&hole, &parameters, &pass, &models).unwrap();
/// let (handbook, plan) = (planner.handbook().unwrap(), planner.optimal(Objective::Time).unwrap());
/// assert!((handbook.time / plan.time - 2.1508).abs() < 1e-4); // servo instead of empirical error
/// ```
#[derive(Clone, Debug)]
pub struct Planner<'a> {
    /// The contour as it is drawn.
    drawn: &'a Contour,
    /// The contour whose sections are planned: those that are drawn, or pieces of them.
    pub(crate) contour: Cow<'a, Contour>,
    pieces: Vec<Piece>,
    pub(crate) parameters: &'a Parameters,
    pub(crate) pass: &'a Pass,
    pub(crate) models: &'a Models,
    walls: Vec<Wall>,
    /// Wall and length of the cutter-centre path of every section.
    sections: Vec<(usize, f64)>,
    stiffness: f64,
    pub(crate) speeds: Vec<f64>,
    pub(crate) feeds: Vec<f64>,
    life_of_speed: Vec<f64>,
    life_of_feed: Vec<f64>,
    tooth_force: (f64, f64),
}

impl<'a> Planner<'a> {
    /// Checks contour, parameters and pass against each other.
    ///
    /// # Errors
    /// A value outside its range, a contour that the cutter cannot follow, a gear series
    /// without speed.
    pub fn new(
        contour: &'a Contour,
        parameters: &'a Parameters,
        pass: &'a Pass,
        models: &'a Models,
    ) -> Result<Self, ContourError> {
        let Parameters { machine, cutter, force, life, economics, .. } = parameters;
        machine.check()?;
        cutter.check()?;
        force.check()?;
        life.check()?;
        economics.check()?;
        pass.check()?;
        if contour.sections.is_empty() {
            return Err(ContourError::Empty);
        }
        contradiction(
            machine.highest_feed < machine.lowest_feed,
            ("lowest_feed", machine.lowest_feed),
            ("highest_feed", machine.highest_feed),
        )?;
        contradiction(
            pass.highest_feed_per_tooth < pass.lowest_feed_per_tooth,
            ("lowest_feed_per_tooth", pass.lowest_feed_per_tooth),
            ("highest_feed_per_tooth", pass.highest_feed_per_tooth),
        )?;
        contour.admits(cutter.radius())?;
        let (speeds, feeds) = (machine.spindle_speeds(), pass.feeds());
        if speeds.is_empty() {
            return Err(ContourError::NoSpindleSpeed);
        }
        let coefficients = force.under(pass.hardness_ratio, pass.flank_wear);
        let backwards = backwards(contour, models);
        let (refined, pieces) = match models.engagement {
            EngagementModel::Section => (Cow::Borrowed(contour), whole(contour, cutter.radius(), pass.allowance)),
            EngagementModel::Path => {
                let pieces = Along::new(contour, cutter.radius(), pass.allowance, backwards).pieces();
                (Cow::Owned(cut(contour, &pieces)), pieces)
            }
        };
        let mut planner = Self {
            drawn: contour,
            contour: refined,
            pieces,
            parameters,
            pass,
            models,
            walls: Vec::new(),
            sections: Vec::new(),
            stiffness: cutter.stiffness(),
            life_of_speed: speeds.iter().map(|speed| life.of_speed(*speed, cutter.diameter)).collect(),
            life_of_feed: feeds.iter().map(|feed| life.of_feed(*feed)).collect(),
            speeds,
            feeds,
            tooth_force: (coefficients.tangential_edge, coefficients.on_tooth(1.0) - coefficients.tangential_edge),
        };
        // Sections of one shape share a wall; great contours repeat few shapes or none.
        let mut known: BTreeMap<(u64, u64, u64), usize> = BTreeMap::new();
        for i in 0..planner.contour.sections.len() {
            let section = planner.contour.sections[i];
            let (shape, engagement) = (planner.contour.shape(&section), planner.pieces[i].engagement);
            let key = (shape.curvature().to_bits(), section.arc_angle.to_bits(), engagement.angle.to_bits());
            let wall = *known.entry(key).or_insert_with(|| {
                planner.walls.push(planner.wall(shape, engagement, section.arc_angle, &coefficients));
                planner.walls.len() - 1
            });
            planner.sections.push((wall, section.length * shape.centre_path_ratio(cutter.radius())));
        }
        Ok(planner)
    }

    fn wall(&self, shape: Shape, engagement: Engagement, arc_angle: f64, coefficients: &crate::EdgeForce) -> Wall {
        let Parameters { machine, cutter, life, .. } = self.parameters;
        let (pass, models, radius) = (self.pass, self.models, cutter.radius());
        let contact = 1.0 / shape.centre_path_ratio(radius);
        let heights = match models.form_error {
            FormError::Mean => Vec::new(),
            FormError::Helical => helical_heights(&self.helical(engagement.angle, coefficients)),
        };
        Wall {
            shape,
            engagement,
            forces: coefficients.mean(engagement.angle, pass.depth_of_cut, cutter.teeth, models.milling),
            chip_thickness_ratio: engagement.chip_thickness_ratio(),
            life: life.of_cutter(pass.depth_of_cut, cutter.teeth, cutter.diameter)
                * life.of_immersion(engagement.immersion),
            // Run-out makes one cusp a revolution; the contact point is slower or faster than
            // the cutter centre.
            cusp: (cutter.teeth * contact).powi(2) / 8.0 * (1.0 / radius + shape.curvature()),
            arc_error: models.path_error.on_arc(shape.centre_radius(radius), arc_angle, machine.position_gain),
            heights,
        }
    }

    fn helical<'f>(&self, engagement_angle: f64, force: &'f crate::EdgeForce) -> HelicalCut<'f> {
        let cutter = &self.parameters.cutter;
        HelicalCut {
            force,
            milling: self.models.milling,
            engagement_angle,
            depth_of_cut: self.pass.depth_of_cut,
            teeth: cutter.teeth,
            // A straight edge is the limit of a slight helix.
            lag: cutter.helix_lag().max(1e-6 / self.pass.depth_of_cut),
        }
    }

    fn operating(&self, setting: Setting) -> Operating {
        let Cutter { diameter, teeth, .. } = self.parameters.cutter;
        let life = &self.parameters.life;
        Operating {
            spindle_speed: setting.spindle_speed,
            feed_per_tooth: setting.feed_per_tooth,
            feed: setting.feed(teeth),
            cutting_speed: setting.spindle_speed / TAU * PI * diameter,
            life: life.of_speed(setting.spindle_speed, diameter) * life.of_feed(setting.feed_per_tooth),
        }
    }

    /// The candidate of gear and feed index.
    fn candidate(&self, gear: usize, feed: usize) -> Operating {
        let Cutter { diameter, teeth, .. } = self.parameters.cutter;
        let (spindle_speed, feed_per_tooth) = (self.speeds[gear], self.feeds[feed]);
        Operating {
            spindle_speed,
            feed_per_tooth,
            feed: spindle_speed / TAU * feed_per_tooth * teeth,
            cutting_speed: spindle_speed / TAU * PI * diameter,
            life: self.life_of_speed[gear] * self.life_of_feed[feed],
        }
    }

    fn deflection(&self, wall: &Wall, feed_per_tooth: f64) -> f64 {
        let left = 1.0 - self.pass.deflection_compensation;
        let force = if wall.heights.is_empty() {
            wall.forces.edge.normal + wall.forces.per_feed.normal * feed_per_tooth
        } else {
            let at = |(edge, slope): &(f64, f64)| edge + slope * feed_per_tooth;
            wall.heights
                .iter()
                .map(at)
                .fold(0.0, |worst: f64, force| if force.abs() > worst.abs() { force } else { worst })
        };
        left * force / self.stiffness
    }

    fn ratio(&self, constraint: Constraint, wall: &Wall, operating: &Operating) -> f64 {
        let Parameters { machine, cutter, life, .. } = self.parameters;
        let pass = self.pass;
        match constraint {
            Constraint::HighestFeed => operating.feed / machine.highest_feed,
            Constraint::LowestFeed => machine.lowest_feed / operating.feed,
            Constraint::LowestSpindleSpeed => machine.lowest_spindle_speed / operating.spindle_speed,
            Constraint::HighestSpindleSpeed => operating.spindle_speed / machine.highest_spindle_speed,
            Constraint::Power => {
                let force = wall.forces.edge.tangential + wall.forces.per_feed.tangential * operating.feed_per_tooth;
                force * operating.cutting_speed / (machine.power * machine.efficiency)
            }
            Constraint::FeedForce => wall.forces.at(operating.feed_per_tooth).resultant() / machine.feed_force,
            Constraint::ToothStrength => {
                let force =
                    self.tooth_force.0 + self.tooth_force.1 * wall.chip_thickness_ratio * operating.feed_per_tooth;
                6.0 * cutter.tooth_height * force / (cutter.tooth_thickness.powi(2) * cutter.tooth_strength)
            }
            Constraint::BodyStrength => {
                let forces = wall.forces.at(operating.feed_per_tooth);
                let moment = (forces.resultant() * cutter.overhang).hypot(forces.tangential * cutter.radius());
                moment / (cutter.section_modulus_ratio * cutter.radius().powi(3) * cutter.body_strength)
            }
            Constraint::ChipSpace => {
                operating.feed_per_tooth * wall.engagement.immersion * cutter.chip_packing
                    / (cutter.chip_space_ratio * cutter.diameter.powi(2))
            }
            Constraint::ToolLife => life.nominal_life / (wall.life * operating.life),
            Constraint::Accuracy => {
                (self.deflection(wall, operating.feed_per_tooth).abs() + wall.arc_error.at(operating.feed))
                    / pass.tolerance
            }
            Constraint::Roughness => {
                (cutter.roughness_floor + wall.cusp * operating.feed_per_tooth * operating.feed_per_tooth)
                    / pass.roughness
            }
        }
    }

    fn admits(&self, wall: &Wall, operating: &Operating) -> bool {
        // Cheap and usually decisive ones first.
        const ORDER: [Constraint; 12] = [
            Constraint::HighestFeed,
            Constraint::LowestFeed,
            Constraint::Accuracy,
            Constraint::ToolLife,
            Constraint::ToothStrength,
            Constraint::Roughness,
            Constraint::Power,
            Constraint::BodyStrength,
            Constraint::FeedForce,
            Constraint::ChipSpace,
            Constraint::LowestSpindleSpeed,
            Constraint::HighestSpindleSpeed,
        ];
        ORDER.into_iter().all(|constraint| !exceeds(self.ratio(constraint, wall, operating)))
    }

    fn ratios(&self, wall: &Wall, operating: &Operating) -> Ratios {
        Ratios(Constraint::ALL.map(|constraint| self.ratio(constraint, wall, operating)))
    }

    /// What `setting` does on section `i`; `None` past the last section.
    pub fn evaluate(&self, i: usize, setting: Setting) -> Option<Evaluation> {
        let wall = &self.walls[self.sections.get(i)?.0];
        let operating = self.operating(setting);
        let forces = wall.forces.at(setting.feed_per_tooth);
        let sign = self.models.path_error.sign(wall.shape.curvature());
        Some(Evaluation {
            feed: operating.feed,
            cutting_speed: operating.cutting_speed,
            engagement: wall.engagement,
            forces,
            power: forces.tangential * operating.cutting_speed,
            deflection: self.deflection(wall, setting.feed_per_tooth),
            path_error: sign * wall.arc_error.at(operating.feed),
            roughness: self.parameters.cutter.roughness_floor + wall.cusp * setting.feed_per_tooth.powi(2),
            tool_life: wall.life * operating.life,
            ratios: self.ratios(wall, &operating),
        })
    }

    /// Constraints that `settings` break on some section, in the order of system (4).
    pub fn violated(&self, settings: &[Setting]) -> Vec<Constraint> {
        let evaluations = settings.iter().enumerate().filter_map(|(i, setting)| self.evaluate(i, *setting));
        let mut violated: Vec<Constraint> =
            evaluations.flat_map(|at| at.ratios.violated().collect::<Vec<_>>()).collect();
        violated.sort();
        violated.dedup();
        violated
    }

    /// The constraint that refuses the next higher feed on section `i`, the most violated one
    /// where several do.
    pub(crate) fn refuses_more(&self, i: usize, setting: Setting) -> Option<Constraint> {
        let wall = &self.walls[self.sections[i].0];
        let more = Setting { feed_per_tooth: setting.feed_per_tooth + self.pass.feed_step, ..setting };
        let (constraint, ratio) = self.ratios(wall, &self.operating(more)).tightest();
        exceeds(ratio).then_some(constraint)
    }

    /// Spindle speeds, rad/s, ascending.
    pub fn speeds(&self) -> &[f64] {
        &self.speeds
    }

    /// Candidates of the feed per tooth, m, ascending.
    pub fn feeds(&self) -> &[f64] {
        &self.feeds
    }

    /// Whether the machine travels the contour against the order in which it is drawn: with the
    /// spindle turning clockwise, a cutter on the left mills down.
    pub(crate) fn backwards(&self) -> bool {
        backwards(self.drawn, self.models)
    }

    /// The contour whose sections are planned: those that are drawn, or pieces of them where the engagement is taken along
    /// the path.
    pub fn contour(&self) -> &Contour {
        &self.contour
    }

    /// Pieces of the drawn sections that are planned, one entry a section of [`Planner::contour`].
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The contour as it is drawn.
    pub(crate) fn drawn(&self) -> &Contour {
        self.drawn
    }

    /// Constraints that the settings of another planner of the same contour break here, in the order of system (4).
    pub(crate) fn violated_by(&self, other: &Self, settings: &[Setting]) -> Vec<Constraint> {
        let mut violated: Vec<Constraint> = Vec::new();
        for (i, current) in self.pieces.iter().enumerate() {
            let overlaps =
                |piece: &Piece| piece.section == current.section && piece.from < current.to && current.from < piece.to;
            for (_, setting) in other.pieces.iter().zip(settings).filter(|(piece, _)| overlaps(piece)) {
                violated
                    .extend(self.evaluate(i, *setting).iter().flat_map(|at| at.ratios.violated().collect::<Vec<_>>()));
            }
        }
        violated.sort();
        violated.dedup();
        violated
    }

    /// Length of the cutter-centre path along section `i`, m.
    pub(crate) fn centre_length(&self, i: usize) -> f64 {
        self.sections[i].1
    }

    /// Number of sections.
    pub(crate) fn len(&self) -> usize {
        self.sections.len()
    }

    /// Number of different walls, and the wall of a section.
    pub(crate) fn wall_count(&self) -> usize {
        self.walls.len()
    }

    /// Wall of section `i`.
    pub(crate) fn wall_of(&self, i: usize) -> usize {
        self.sections[i].0
    }

    /// Every admissible feed of a gear on a wall, ascending.
    pub(crate) fn admissible(&self, wall: usize, gear: usize) -> Vec<Candidate> {
        (0..self.feeds.len()).filter_map(|feed| self.rates(wall, gear, feed)).collect()
    }

    /// Time and life per length, where the candidate is admissible.
    pub(crate) fn rates(&self, wall: usize, gear: usize, feed: usize) -> Option<Candidate> {
        let wall = &self.walls[wall];
        let operating = self.candidate(gear, feed);
        let admitted = self.admits(wall, &operating);
        admitted.then(|| Candidate {
            feed,
            time: 1.0 / operating.feed,
            life: 1.0 / (operating.feed * wall.life * operating.life),
        })
    }

    /// Admissible feeds of a gear on a wall that are not beaten in both time and life, fastest
    /// first.
    pub(crate) fn efficient(&self, wall: usize, gear: usize) -> Vec<Candidate> {
        let life = &self.parameters.life;
        // Life used per length goes with feed^(y/m − 1): below one, the greatest feed is best.
        let greatest_is_best = life.feed_exponent <= life.life_exponent;
        let mut kept: Vec<Candidate> = Vec::new();
        for feed in (0..self.feeds.len()).rev() {
            let Some(candidate) = self.rates(wall, gear, feed) else { continue };
            if kept.last().is_none_or(|last| candidate.life < last.life) {
                kept.push(candidate);
            }
            if greatest_is_best {
                break;
            }
        }
        kept
    }

    /// Constraints violated by every candidate of `walls` together: for each candidate the set,
    /// as bits, of constraints that some of the walls violates.
    fn conflicts(&self, walls: &[usize]) -> Vec<Constraint> {
        let mut sets: Vec<u16> = Vec::with_capacity(self.speeds.len() * self.feeds.len());
        for gear in 0..self.speeds.len() {
            for feed in 0..self.feeds.len() {
                let operating = self.candidate(gear, feed);
                let violated = walls
                    .iter()
                    .flat_map(|wall| self.ratios(&self.walls[*wall], &operating).violated().collect::<Vec<_>>());
                sets.push(violated.fold(0, |bits, constraint| bits | 1 << constraint as u16));
            }
        }
        // Deletion filter: drop every constraint without which there is still no candidate.
        let mut kept: u16 = (1 << Constraint::ALL.len()) - 1;
        for constraint in Constraint::ALL {
            let without = kept & !(1 << constraint as u16);
            if sets.iter().all(|violated| violated & without != 0) {
                kept = without;
            }
        }
        Constraint::ALL.into_iter().filter(|constraint| kept & (1 << *constraint as u16) != 0).collect()
    }

    /// The error of a section on which nothing is admissible.
    pub(crate) fn empty_set(&self, section: usize) -> ContourError {
        ContourError::EmptyFeasibleSet {
            section: self.pieces[section].section,
            conflicting: self.conflicts(&[self.sections[section].0]),
        }
    }

    /// The error of a contour on which no single setting is admissible.
    pub(crate) fn no_common_setting(&self) -> ContourError {
        let walls: Vec<usize> = (0..self.walls.len()).collect();
        ContourError::NoCommonSetting { conflicting: self.conflicts(&walls) }
    }

    /// Moves around the corners.
    pub fn corner_moves(&self) -> Vec<CornerMove> {
        let Parameters { machine, cutter, .. } = self.parameters;
        let moves = self.contour.corners.iter().map(|corner| {
            self.models.corners.pass(*corner, cutter.radius(), self.pass.tolerance, machine, &self.models.path_error)
        });
        moves.collect()
    }

    /// What the choice of models and cutter should be warned of, for the settings of a plan.
    pub(crate) fn warnings(&self, settings: &[Setting]) -> Vec<Warning> {
        let mut warnings = Vec::new();
        match self.models.path_error {
            PathError::ExplicitEuler { step } => warnings.push(Warning::ExplicitEuler { step }),
            PathError::Empirical => warnings.push(Warning::EmpiricalPathError),
            PathError::Servo { .. } | PathError::Off => {}
        }
        let ratio = self.parameters.cutter.radius() / self.contour.smallest_concave_radius();
        if ratio > 0.75 || (ratio > 0.0 && ratio < 0.70) {
            warnings.push(Warning::CutterRadius { ratio });
        }
        if self.models.form_error == FormError::Mean {
            let excess = self.hidden_form_error(settings);
            if excess > 0.1 * self.pass.tolerance {
                warnings.push(Warning::MeanForce { excess });
            }
        }
        warnings
    }

    /// By how much the form error over the height exceeds that of the average force, at most, m.
    fn hidden_form_error(&self, settings: &[Setting]) -> f64 {
        let force = self.parameters.force.under(self.pass.hardness_ratio, self.pass.flank_wear);
        let left = 1.0 - self.pass.deflection_compensation;
        let heights: Vec<Vec<(f64, f64)>> =
            self.walls.iter().map(|wall| helical_heights(&self.helical(wall.engagement.angle, &force))).collect();
        let excess = settings.iter().zip(&self.sections).map(|(setting, (wall, _))| {
            let at = |(edge, slope): &(f64, f64)| (edge + slope * setting.feed_per_tooth).abs();
            let worst = heights[*wall].iter().map(at).fold(0.0, f64::max);
            let mean = self.walls[*wall].forces.at(setting.feed_per_tooth).normal.abs();
            left * (worst - mean) / self.stiffness
        });
        excess.fold(0.0, f64::max)
    }
}

/// Finishing force at zero feed and its slope at the kinks of the form and halfway between.
fn helical_heights(cut: &HelicalCut) -> Vec<(f64, f64)> {
    const UNIT_FEED: f64 = 1e-4;
    let kinks = cut.heights();
    let between = kinks.windows(2).map(|pair| 0.5 * (pair[0] + pair[1]));
    let line = |height: f64| {
        let edge = cut.finishing_force(0.0, height);
        (edge, (cut.finishing_force(UNIT_FEED, height) - edge) / UNIT_FEED)
    };
    kinks.iter().copied().chain(between).map(line).collect()
}

/// Whether the machine travels a contour against the order in which it is drawn.
fn backwards(contour: &Contour, models: &Models) -> bool {
    let due = match models.milling {
        Milling::Down => CutterSide::Left,
        Milling::Up => CutterSide::Right,
    };
    contour.side != due
}

/// Every section as one piece.
fn whole(contour: &Contour, radius: f64, allowance: f64) -> Vec<Piece> {
    let piece = |(section, own): (usize, &Section)| {
        let engagement = Engagement::new(contour.shape(own), radius, allowance);
        Piece { section, from: 0.0, to: own.length, engagement }
    };
    contour.sections.iter().enumerate().map(piece).collect()
}

/// The contour with its sections cut into pieces.
fn cut(contour: &Contour, pieces: &[Piece]) -> Contour {
    let section = |piece: &Piece| {
        let shape = &contour.sections[piece.section];
        let heading = shape.heading + shape.curvature * piece.from;
        Section { start: shape.at(piece.from), heading, length: piece.to - piece.from, ..*shape }
    };
    let last = |section: usize| pieces.iter().rposition(|piece| piece.section == section).unwrap_or(section);
    let corners = contour.corners.iter().map(|corner| Corner { after: last(corner.after), ..*corner }).collect();
    Contour { sections: pieces.iter().map(section).collect(), corners, side: contour.side, closed: contour.closed }
}

fn contradiction(
    broken: bool,
    (first, first_value): (&'static str, f64),
    (second, second_value): (&'static str, f64),
) -> Result<(), ModelError> {
    if !broken {
        return Ok(());
    }
    let rule = "the lowest must not exceed the highest";
    Err(ModelError::Contradiction { first, first_value, second, second_value, rule })
}

impl Machine {
    /// Time lost, s, by a ramp between two feeds in the faster section, against an instantaneous
    /// change: `(V_h − V_l)²/(2·a·V_h)`.
    pub(crate) fn ramp_time(&self, one: f64, other: f64) -> f64 {
        let fast = one.max(other);
        (one - other).powi(2) / (2.0 * self.highest_acceleration * fast)
    }

    /// Length of that ramp, m.
    pub(crate) fn ramp_length(&self, one: f64, other: f64) -> f64 {
        (one * one - other * other).abs() / (2.0 * self.highest_acceleration)
    }
}
