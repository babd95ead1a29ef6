//! A contour, a pass and a parameter set together: what a setting does on a section.

use crate::along::{cut, whole};
use crate::constraint::exceeds;
use crate::wall::{Candidate, Wall};
use crate::{
    Along, Constraint, Contour, ContourError, CornerMove, CutterSide, EngagementModel, Evaluation, FormError, Machine,
    Milling, Models, Parameters, Pass, PathError, Piece, Setting, Warning,
};
use std::borrow::Cow;
use std::collections::BTreeMap;
use toolroom_process::{ModelError, Record};

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
    pub(crate) walls: Vec<Wall>,
    /// Wall and length of the cutter-centre path of every section.
    pub(crate) sections: Vec<(usize, f64)>,
    pub(crate) stiffness: f64,
    pub(crate) speeds: Vec<f64>,
    pub(crate) feeds: Vec<f64>,
    pub(crate) life_of_speed: Vec<f64>,
    pub(crate) life_of_feed: Vec<f64>,
    pub(crate) tooth_force: (f64, f64),
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
        parameters.cutter.check()?;
        pass.check()?;
        contour.admits(parameters.cutter.radius())?;
        let (radius, allowance) = (parameters.cutter.radius(), pass.allowance);
        let pieces = match models.engagement {
            EngagementModel::Section => whole(contour, radius, allowance),
            EngagementModel::Path => Along::new(contour, radius, allowance, backwards(contour, models)).pieces(),
        };
        Self::over(contour, pieces, parameters, pass, models)
    }

    /// The same over pieces of the sections, each with its engagement, in the order of the contour: they cover every section.
    ///
    /// # Errors
    /// As [`Planner::new`].
    pub fn over(
        contour: &'a Contour,
        pieces: Vec<Piece>,
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
        let refined = match models.engagement {
            EngagementModel::Section => Cow::Borrowed(contour),
            EngagementModel::Path => Cow::Owned(cut(contour, &pieces)),
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
        let mut known: BTreeMap<[u64; 4], usize> = BTreeMap::new();
        for i in 0..planner.contour.sections.len() {
            let section = planner.contour.sections[i];
            let (shape, Piece { engagement, least, .. }) = (planner.contour.shape(&section), planner.pieces[i]);
            let key = [shape.curvature(), section.arc_angle, engagement.angle, least].map(f64::to_bits);
            let wall = *known.entry(key).or_insert_with(|| {
                planner.walls.push(planner.wall(shape, (engagement, least), section.arc_angle, &coefficients));
                planner.walls.len() - 1
            });
            planner.sections.push((wall, section.length * shape.centre_path_ratio(cutter.radius())));
        }
        Ok(planner)
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
}

/// Whether the machine travels a contour against the order in which it is drawn.
fn backwards(contour: &Contour, models: &Models) -> bool {
    let due = match models.milling {
        Milling::Down => CutterSide::Left,
        Milling::Up => CutterSide::Right,
    };
    contour.side != due
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
