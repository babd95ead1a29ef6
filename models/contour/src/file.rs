//! Contour files: contour, passes, models and parameters in TOML.

use crate::file_form::{Approximation, CONTOUR, CornerWord, Direction, PathErrorWord, SETUP};
use crate::lobed::Profile;
use crate::{
    ConditionScatter, Contour, ContourError, CornerPolicy, CutterSide, EngagementModel, FileError, FormError, Milling,
    Models, Parameters, Pass, PathError, Planner, Point, Trace, VelocityLoop, dxf, gcode,
};
use std::ops::Range;
use std::sync::Arc;
use toolroom_form::{
    ContentFault, Fault, FormFile, ReadError, Section, SectionValue, Value, Walk, example, fill_record, parse,
};
use toolroom_process::parameters::places;
use toolroom_program::Control;

/// A contour file as understood.
///
/// ```toml
/// schema = 1
/// name = "plate"
/// title = "Plate with one round corner"
/// parameter_set = "mill_t15k6_d32"   # then [machine], [cutter], [force], [life], [economics] change it
/// # [scatter] says how allowance, hardness and table feed scatter in a sensitivity study
/// closed = false
/// cutter_side = "right"              # side of the path, seen in the direction of travel
/// milling = "down"
/// path_error = { model = "servo" }   # or "empirical", "off", "explicit_euler" with step
/// form_error = "mean"                # or "helical"
/// engagement = "path"                # or "section": one engagement a section, as in the paper
/// corners = { policy = "slow_down" } # or "exact_stop", "loop" with radius
/// start = ["0 mm", "0 mm"]
/// heading = "0 deg"
///
/// [[pass]]
/// name = "finish"
/// allowance = "0.5 mm"
///
/// [[section]]
/// line = "50 mm"                     # straight on
/// [[section]]
/// arc = "90 deg"                     # positive to the left
/// radius = "10 mm"
/// [[section]]
/// turn = "45 deg"                    # a corner, then
/// line_to = ["80 mm", "90 mm"]
/// [[section]]
/// arc_to = ["80 mm", "110 mm"]
/// center = ["80 mm", "100 mm"]       # or radius
/// direction = "left"
/// [[section]]
/// spline_to = [["70 mm", "120 mm"], ["50 mm", "120 mm"]]
/// ```
/// A section may also be `lobed = { diameter, eccentricity, lobes, tolerance }`, a whole profile
/// of equal width within 1 um where no tolerance is given.
#[derive(Clone, Debug, PartialEq)]
pub struct ContourFile {
    /// Name.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// The contour.
    pub contour: Contour,
    /// Parameter set with the changes of the file.
    pub parameters: Parameters,
    /// Passes by name, in the order of the file.
    pub passes: Vec<(String, Pass)>,
    /// Models.
    pub models: Models,
    /// How conditions scatter in a sensitivity study.
    pub scatter: ConditionScatter,
    /// Greatest distance between the contour and the curves that it stands for, m; 0 where lines and arcs are drawn.
    pub residual: f64,
    /// Line and column, from 1, of every section of the contour in the file, or in the G-code
    /// program, that draws it.
    pub places: Vec<(usize, usize)>,
}

/// What draws a contour beside its file.
#[derive(Clone, Copy, Debug)]
pub enum Drawing<'a> {
    /// A part program in the language of a control.
    Program(&'a str, &'a Control),
    /// A DXF file, with the layer to read where it has more than one contour.
    Dxf {
        /// What the file holds.
        text: &'a str,
        /// Layer; `None` where the drawing is one contour.
        layer: Option<&'a str>,
        /// Unit of a drawing that names none, m.
        unit: Option<f64>,
        /// Distance of ends that are one point, m; 1 µm where it is not given.
        join: Option<f64>,
    },
}

/// A contour with the places of its sections.
pub(crate) type Placed = (Contour, Vec<(usize, usize)>);

impl ContourFile {
    /// Reads the text of a contour file, with values replaced as after `--set`: `economics.edge_cost=20 EUR`,
    /// of every pass `pass.tolerance=0.03 mm`, of one `pass.finish.tolerance=0.03 mm`. `file` is its name for
    /// messages.
    ///
    /// # Errors
    /// [`ReadError::Faults`] with every fault and its place.
    ///
    /// # Examples
    /// ```
    /// let text = r#"
    /// schema = 1
    /// name = "slot"
    /// title = "Slot end"
    /// cutter_side = "left"
    /// closed = false
    /// pass = [{ name = "finish" }]
    /// section = [{ line = "50 mm" }, { arc = "180 deg", radius = "20 mm" }, { line = "50 mm" }]
    /// "#;
    /// let set = ["pass.finish.tolerance=0.03 mm".to_owned()];
    /// let file = toolroom_contour::ContourFile::parse("slot.toml", text, &set).unwrap().content;
    /// assert!((file.contour.length() - (0.1 + 0.02 * std::f64::consts::PI)).abs() < 1e-12);
    /// assert!((file.pass("finish").unwrap().tolerance - 0.03e-3).abs() < 1e-15);
    /// ```
    pub fn parse(file: &str, text: &str, overrides: &[String]) -> Result<FormFile<Self>, ReadError> {
        let text = text.strip_prefix('\u{FEFF}').unwrap_or(text);
        parse(file, text, overrides, &CONTOUR, |walk, root| {
            let contour = draw(walk, text, root);
            assemble(walk, root, contour)
        })
    }

    /// Reads a contour file whose contour is drawn by a part program or a DXF file instead of sections. The compensation of the
    /// radius in a program says on which side the cutter runs, else `cutter_side` in the file.
    ///
    /// # Errors
    /// [`GcodeFileError`] says which of the two is at fault and where.
    pub fn parse_with_drawing(
        file: &str,
        text: &str,
        overrides: &[String],
        drawing: Drawing<'_>,
    ) -> Result<FormFile<Self>, GcodeFileError> {
        let mut refused = None;
        let read = parse(file, text, overrides, &CONTOUR, |walk, root| {
            let side = root.chosen("cutter_side", CutterSide::from_word);
            let closed = root.flag("closed").unwrap_or(true);
            let placed = match drawing {
                Drawing::Program(program, control) => {
                    gcode::read_placed(program, control, side, closed).map(|placed| (placed, 0.0))
                }
                Drawing::Dxf { text, layer, unit, join } => {
                    dxf::read_placed(text, (layer, unit, join.unwrap_or(dxf::JOIN)), side, closed)
                }
            };
            let placed = placed.map_err(|error| refused = Some(error)).ok();
            assemble(walk, root, placed)
        });
        match refused {
            // The faults of the file decide what the program means.
            Some(error) if !matches!(&read, Err(ReadError::Faults(list)) if !list.problems.is_empty()) => {
                Err(GcodeFileError::Program(error))
            }
            _ => read.map_err(GcodeFileError::File),
        }
    }

    /// Reads the text of a setup file, to whose contour a part program will be given: number of its passes.
    ///
    /// # Errors
    /// [`ReadError::Faults`] with every fault and its place.
    pub fn parse_setup(file: &str, text: &str, overrides: &[String]) -> Result<FormFile<usize>, ReadError> {
        parse(file, text, overrides, &SETUP, |walk, root| settings(walk, root).map(|settings| settings.passes.len()))
    }

    /// The pass called `name`.
    ///
    /// # Errors
    /// [`ContourError::UnknownPass`].
    pub fn pass(&self, name: &str) -> Result<&Pass, ContourError> {
        let found = self.passes.iter().find(|(known, _)| known == name).map(|(_, pass)| pass);
        found.ok_or_else(|| {
            let known = self.passes.iter().map(|(known, _)| known.as_str()).collect::<Vec<_>>().join(", ");
            ContourError::UnknownPass { name: name.to_owned(), known }
        })
    }

    /// A planner for each pass.
    ///
    /// # Errors
    /// As [`Planner::new`], and [`ContourError::Neck`] where the cutter does not clear the whole contour.
    pub fn planners(&self) -> Result<Vec<(&str, Planner<'_>)>, ContourError> {
        let mut planners = Vec::new();
        for (name, pass) in &self.passes {
            self.contour.clears(self.parameters.cutter.radius(), pass.gouge())?;
            planners.push((name.as_str(), Planner::new(&self.contour, &self.parameters, pass, &self.models)?));
        }
        Ok(planners)
    }
}

/// Which of the two texts is at fault.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GcodeFileError {
    /// The contour file.
    #[error(transparent)]
    File(ReadError),
    /// The part program or the drawing.
    #[error("drawing: {0}")]
    Program(FileError),
}

impl ContentFault for ContourError {
    fn code(&self) -> &'static str {
        ContourError::code(self)
    }
}

fn refuse(walk: &mut Walk, span: Range<usize>, error: ContourError) {
    walk.fault(span, Fault::Content(Arc::new(error)));
}

/// The point that a list of two lengths is; `None` where a problem was noted.
fn point_of(walk: &mut Walk, key: &str, got: &SectionValue<'_>) -> Option<Point> {
    let Value::List(list) = &got.value else { return None };
    match list.as_slice() {
        [x, y] => match (&x.value, &y.value) {
            (Value::Si(x), Value::Si(y)) => Some(Point { x: *x, y: *y }),
            _ => None,
        },
        other => {
            walk.fault(
                got.span.clone(),
                Fault::WrongType {
                    key: key.to_owned(),
                    read: format!("a list of {}", other.len()),
                    expected: "a point of two lengths".to_owned(),
                    example: "[\"50 mm\", \"0 mm\"]".to_owned(),
                },
            );
            None
        }
    }
}

fn point(walk: &mut Walk, section: &Section<'_>, key: &str) -> Option<Point> {
    point_of(walk, key, section.got(key)?)
}

fn draw(walk: &mut Walk, text: &str, root: &Section<'_>) -> Option<(Placed, f64)> {
    let noted = walk.problems.len();
    let start = if root.given("start") { point(walk, root, "start") } else { Some(Point::default()) };
    let side = root.chosen("cutter_side", CutterSide::from_word);
    if !root.given("cutter_side") {
        let example = root.form.key("cutter_side").map_or_else(String::new, |key| example(&key.kind));
        walk.fault(
            root.span.clone(),
            Fault::MissingKey { section: root.form.title.to_owned(), key: "cutter_side", example },
        );
    }
    let sections = walk.sections(root, "section", None);
    let steps: Vec<_> = sections.iter().map(|section| (section.span.start, step(walk, section))).collect();
    if walk.problems.len() > noted {
        return None;
    }
    let mut trace = Trace::new(start?, root.si("heading").unwrap_or(0.0));
    // Where each drawn section stands in the file.
    let mut starts: Vec<usize> = Vec::new();
    let mut residual: f64 = 0.0;
    for ((start, step), section) in steps.into_iter().zip(&sections) {
        if let Some(turn) = section.si("turn") {
            trace.turn(turn);
        }
        match step?.draw(&mut trace) {
            Ok(gap) => residual = gap.max(residual),
            Err(error) => {
                refuse(walk, start..section.span.end, error);
                return None;
            }
        }
        starts.resize(trace.sections(), start);
    }
    match trace.finish(side?, root.flag("closed").unwrap_or(true)) {
        Ok(contour) => Some(((contour, places(text, &starts)), residual)),
        Err(error) => {
            let section = error.section().unwrap_or(starts.len().saturating_sub(1));
            let place = starts.get(section).copied().unwrap_or(0);
            refuse(walk, place..place, error);
            None
        }
    }
}

/// What a section draws.
enum Step {
    Line(f64),
    LineTo(Point),
    Arc {
        radius: f64,
        angle: f64,
    },
    ArcTo {
        end: Point,
        center: Point,
        left: bool,
    },
    ArcByRadius {
        end: Point,
        radius: f64,
        left: bool,
    },
    Spline(Vec<Point>),
    /// One arc of the mean radius a section.
    MeanRadius {
        diameter: f64,
        eccentricity: f64,
        lobes: u32,
        sections: u32,
    },
    /// Pairs of arcs within a tolerance.
    Lobed {
        diameter: f64,
        eccentricity: f64,
        lobes: u32,
        sections: Option<u32>,
        tolerance: f64,
    },
}

impl Step {
    /// Draws the section; the distance of the trace from the curve that it stands for is returned, m.
    fn draw(&self, trace: &mut Trace) -> Result<f64, ContourError> {
        let done = match self {
            Self::Line(length) => trace.line(*length),
            Self::LineTo(end) => trace.line_to(*end),
            Self::Arc { radius, angle } => trace.arc(*radius, *angle),
            Self::ArcTo { end, center, left } => trace.arc_to(*end, *center, *left),
            Self::ArcByRadius { end, radius, left } => trace.arc_by_radius(*end, *radius, *left),
            Self::Spline(points) => return trace.spline_to(points),
            Self::MeanRadius { diameter, eccentricity, lobes, sections } => {
                let from = trace.sections();
                trace.lobed(*diameter, *eccentricity, *lobes, *sections)?;
                let profile = Profile { diameter: *diameter, eccentricity: *eccentricity, lobes: *lobes };
                return Ok(trace.residual(profile, from));
            }
            Self::Lobed { diameter, eccentricity, lobes, sections, tolerance } => {
                return trace.lobed_within(*diameter, *eccentricity, *lobes, *tolerance, *sections);
            }
        };
        done.map(|()| 0.0)
    }
}

/// What a section draws; `None` where a problem was noted.
fn step(walk: &mut Walk, section: &Section<'_>) -> Option<Step> {
    let keys = section.form.keys.iter().map(|key| key.name).filter(|key| *key != "turn" && section.given(key));
    let keys: Vec<&str> = keys.collect();
    let left = section.chosen("direction", Direction::from_word) == Some(Direction::Left);
    Some(match keys.as_slice() {
        ["line"] => Step::Line(section.si("line")?),
        ["line_to"] => Step::LineTo(point(walk, section, "line_to")?),
        ["arc", "radius"] => Step::Arc { radius: section.si("radius")?, angle: section.si("arc")? },
        ["arc_to", "center", "direction"] => {
            Step::ArcTo { end: point(walk, section, "arc_to")?, center: point(walk, section, "center")?, left }
        }
        ["arc_to", "radius", "direction"] => {
            Step::ArcByRadius { end: point(walk, section, "arc_to")?, radius: section.si("radius")?, left }
        }
        ["spline_to"] => {
            let points = section.list("spline_to").iter().map(|got| point_of(walk, "spline_to", got));
            Step::Spline(points.collect::<Option<_>>()?)
        }
        ["lobed"] => {
            let lobed = walk.table(section, "lobed")?;
            let (diameter, eccentricity) = (lobed.si("diameter")?, lobed.si("eccentricity")?);
            let lobes = u32::try_from(lobed.count("lobes")?).ok()?;
            let sections = lobed.count("sections").and_then(|count| u32::try_from(count).ok());
            match lobed.chosen("approximation", Approximation::from_word)? {
                Approximation::MeanRadius => Step::MeanRadius { diameter, eccentricity, lobes, sections: sections? },
                Approximation::Biarc => {
                    Step::Lobed { diameter, eccentricity, lobes, sections, tolerance: lobed.si("tolerance")? }
                }
            }
        }
        other => {
            let read = if other.is_empty() { "none of their keys".to_owned() } else { other.join(", ") };
            refuse(walk, section.span.clone(), ContourError::SectionForm { read });
            return None;
        }
    })
}

/// What stands in a file whoever draws the contour.
struct Settings {
    parameters: Parameters,
    passes: Vec<(String, Pass)>,
    models: Models,
    scatter: ConditionScatter,
}

fn settings(walk: &mut Walk, root: &Section<'_>) -> Option<Settings> {
    let mut parameters = Parameters::default();
    if let Some(set) = root.text("parameter_set") {
        match Parameters::named(set) {
            Ok(named) => parameters = named,
            Err(error) => refuse(walk, root.span_of("parameter_set"), error.into()),
        }
    }
    for (group, record) in parameters.parameters_mut() {
        if let Some(table) = walk.table(root, group) {
            fill_record(&table, record);
        }
    }
    let mut scatter = ConditionScatter::default();
    if let Some(table) = walk.table(root, "scatter") {
        fill_record(&table, &mut scatter);
    }
    let mut passes: Vec<(String, Pass)> = Vec::new();
    for section in walk.sections(root, "pass", None) {
        let mut pass = Pass::default();
        fill_record(&section, &mut pass);
        let Some(name) = section.text("name") else { continue };
        if passes.iter().any(|(known, _)| known == name) {
            walk.fault(section.span_of("name"), Fault::DuplicateName { kind: "pass", name: name.to_owned() });
        }
        passes.push((name.to_owned(), pass));
    }
    if !root.given("pass") {
        refuse(walk, root.span.clone(), ContourError::NoPass);
    }
    let models = models(walk, root)?;
    Some(Settings { parameters, passes, models, scatter })
}

fn assemble(walk: &mut Walk, root: &Section<'_>, contour: Option<(Placed, f64)>) -> Option<ContourFile> {
    let settings = settings(walk, root);
    let Settings { parameters, passes, models, scatter } = settings?;
    let ((contour, places), residual) = contour?;
    let (name, title) = (root.text("name")?.to_owned(), root.text("title")?.to_owned());
    Some(ContourFile { name, title, contour, parameters, passes, models, scatter, residual, places })
}

fn models(walk: &mut Walk, root: &Section<'_>) -> Option<Models> {
    let defaults = Models::default();
    let path_error = if root.given("path_error") { path_error(walk, root) } else { Some(defaults.path_error) };
    let corners = if root.given("corners") { corners(walk, root) } else { Some(defaults.corners) };
    Some(Models {
        milling: root.chosen("milling", Milling::from_word).unwrap_or(defaults.milling),
        path_error: path_error?,
        form_error: root.chosen("form_error", FormError::from_word).unwrap_or(defaults.form_error),
        corners: corners?,
        engagement: root.chosen("engagement", EngagementModel::from_word).unwrap_or(EngagementModel::Path),
    })
}

fn corners(walk: &mut Walk, root: &Section<'_>) -> Option<CornerPolicy> {
    let table = walk.table(root, "corners")?;
    let tolerance = table.si("tolerance");
    Some(match table.chosen("policy", CornerWord::from_word)? {
        CornerWord::ExactStop => CornerPolicy::ExactStop,
        CornerWord::SlowDown => CornerPolicy::SlowDown { tolerance },
        CornerWord::Loop => CornerPolicy::Loop { radius: table.si("radius")?, tolerance },
    })
}

fn path_error(walk: &mut Walk, root: &Section<'_>) -> Option<PathError> {
    let table = walk.table(root, "path_error")?;
    Some(match table.chosen("model", PathErrorWord::from_word)? {
        PathErrorWord::Empirical => PathError::Empirical,
        PathErrorWord::Off => PathError::Off,
        PathErrorWord::ExplicitEuler => PathError::ExplicitEuler { step: table.si("step")? },
        PathErrorWord::Servo => {
            let [frequency, damping] = ["velocity_loop_frequency", "velocity_loop_damping"];
            for (given, missing, value) in [(frequency, damping, "0.7"), (damping, frequency, "\"120 rad/s\"")] {
                if table.given(given) && !table.given(missing) {
                    let section = "a velocity loop".to_owned();
                    walk.fault(
                        table.span.clone(),
                        Fault::MissingKey { section, key: missing, example: value.to_owned() },
                    );
                }
            }
            if !table.given(frequency) && !table.given(damping) {
                return Some(PathError::default());
            }
            let velocity_loop = VelocityLoop { frequency: table.si(frequency)?, damping: table.si(damping)? };
            PathError::Servo { velocity_loop: Some(velocity_loop) }
        }
    })
}
