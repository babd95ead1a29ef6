//! Contour files: contour, passes, models and parameters in TOML.

use crate::file_form::{
    self, Corners, Direction, NAME, PathErrorModel, Policy, RawFile, RawPathError, RawSection, Table, Text, Value,
};
use crate::{
    ConditionScatter, Contour, ContourError, CornerPolicy, FileError, Models, Parameters, Pass, PathError, Planner,
    Point, Trace, VelocityLoop, gcode,
};
use toml::Spanned;
use toolroom_process::{AnyRecord, unit};

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
/// A section may also be `lobed = { diameter, eccentricity, lobes, sections }`, a whole profile
/// of equal width.
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
    /// Line and column, from 1, of every section of the contour in the file, or in the G-code
    /// program, that draws it.
    pub places: Vec<(usize, usize)>,
}

/// A contour with the places of its sections.
pub(crate) type Placed = (Contour, Vec<(usize, usize)>);

impl ContourFile {
    /// Reads a contour file.
    ///
    /// # Errors
    /// [`FileError`] with line and column of the first fault.
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
    /// let file = toolroom_contour::ContourFile::read(text).unwrap();
    /// assert!((file.contour.length() - (0.1 + 0.02 * std::f64::consts::PI)).abs() < 1e-12);
    /// ```
    pub fn read(text: &str) -> Result<Self, FileError> {
        let raw = parse(text)?;
        assemble(text, &raw, |raw| draw(text, raw))
    }

    /// Reads a contour file whose contour is a G-code program instead of sections. G41 or G42
    /// in the program say on which side the cutter runs, else `cutter_side` in the file.
    ///
    /// # Errors
    /// [`GcodeFileError`] says which of the two is at fault and where.
    pub fn read_with_gcode(text: &str, program: &str) -> Result<Self, GcodeFileError> {
        let raw = parse(text).map_err(GcodeFileError::File)?;
        let placed = gcode::read_placed(program, raw.cutter_side, raw.closed).map_err(GcodeFileError::Program)?;
        assemble(text, &raw, |_| Ok(placed)).map_err(GcodeFileError::File)
    }

    /// Replaces one value of a record, as `economics.edge_cost` and `20 EUR`; of every pass as
    /// `pass.tolerance`, of one as `pass.finish.tolerance`.
    ///
    /// # Errors
    /// [`ContourError`] where there is no such key, or the value is none.
    ///
    /// ```
    /// let text = include_str!("../../../scenarios/contour/rk3.toml");
    /// let mut file = toolroom_contour::ContourFile::read(text).unwrap();
    /// file.set("pass.finish.tolerance", "0.03 mm").unwrap();
    /// assert!((file.pass("finish").unwrap().tolerance - 0.03e-3).abs() < 1e-15);
    /// ```
    pub fn set(&mut self, path: &str, value: &str) -> Result<(), ContourError> {
        let (group, rest) = path.split_once('.').unwrap_or((path, ""));
        if group == "scatter" {
            return file_form::assign("scatter", rest, value, &mut self.scatter);
        }
        if group != "pass" {
            let mut groups = self.parameters.parameters_mut();
            let Some((group, record)) = groups.iter_mut().find(|(known, _)| *known == group) else {
                return Err(ContourError::UnknownGroup { group: group.to_owned() });
            };
            return file_form::assign(group, rest, value, *record);
        }
        let (name, key) = rest.split_once('.').map_or((None, rest), |(name, key)| (Some(name), key));
        if let Some(name) = name {
            self.pass(name)?;
        }
        for (_, pass) in self.passes.iter_mut().filter(|(known, _)| name.is_none_or(|name| name == known)) {
            file_form::assign("pass", key, value, pass)?;
        }
        Ok(())
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
    /// As [`Planner::new`].
    pub fn planners(&self) -> Result<Vec<(&str, Planner<'_>)>, ContourError> {
        let mut planners = Vec::new();
        for (name, pass) in &self.passes {
            planners.push((name.as_str(), Planner::new(&self.contour, &self.parameters, pass, &self.models)?));
        }
        Ok(planners)
    }
}

/// Which of the two texts is at fault.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GcodeFileError {
    /// The contour file.
    #[error("contour file: {0}")]
    File(FileError),
    /// The G-code program.
    #[error("G-code: {0}")]
    Program(FileError),
}

fn parse(text: &str) -> Result<RawFile, FileError> {
    let raw: RawFile = toml::from_str(text).map_err(|error| {
        let at = error.span().map_or(0, |span| span.start);
        FileError::at(text, at, ContourError::Syntax { message: error.message().to_owned() })
    })?;
    match *raw.schema.get_ref() {
        1 => Ok(raw),
        read => Err(FileError::at(text, raw.schema.span().start, ContourError::Schema { read })),
    }
}

/// The number of a quantity in the unit `si`.
fn number(text: &str, key: &'static str, value: &Text, si: &'static str) -> Result<f64, FileError> {
    unit::quantity(value.get_ref(), si).map_err(|reason| {
        // One past the opening quote.
        FileError::at(text, value.span().start + 1 + reason.at(), ContourError::Quantity { key, reason })
    })
}

/// An angle in rad; the unit `rad` is part of a revolution there.
fn angle(text: &str, key: &'static str, value: &Text) -> Result<f64, FileError> {
    number(text, key, value, "rad")
}

fn point(text: &str, key: &'static str, value: &[Text; 2]) -> Result<Point, FileError> {
    Ok(Point { x: number(text, key, &value[0], "m")?, y: number(text, key, &value[1], "m")? })
}

fn draw(text: &str, raw: &RawFile) -> Result<Placed, FileError> {
    let start = raw.start.as_ref().map_or(Ok(Point::default()), |start| point(text, "start", start))?;
    let heading = raw.heading.as_ref().map_or(Ok(0.0), |heading| angle(text, "heading", heading))?;
    let Some(side) = raw.cutter_side else {
        return Err(FileError::at(text, 0, ContourError::Syntax { message: "missing field `cutter_side`".to_owned() }));
    };
    let mut trace = Trace::new(start, heading);
    // Where each drawn section stands in the file.
    let mut places: Vec<usize> = Vec::new();
    for section in &raw.section {
        draw_section(text, section, &mut trace)?;
        places.resize(trace.sections(), section.span().start);
    }
    let contour = trace.finish(side, raw.closed).map_err(|fault| {
        let at = fault.section().unwrap_or(places.len().saturating_sub(1));
        FileError::at(text, places.get(at).copied().unwrap_or(0), fault)
    })?;
    Ok((contour, toolroom_process::parameters::places(text, &places)))
}

fn draw_section(text: &str, spanned: &Spanned<RawSection>, trace: &mut Trace) -> Result<(), FileError> {
    let section = spanned.get_ref();
    let at = spanned.span().start;
    let here = |fault| FileError::at(text, at, fault);
    let length = |key, value: &Text| number(text, key, value, "m");
    if let Some(turn) = &section.turn {
        trace.turn(angle(text, "turn", turn)?);
    }
    let RawSection { line, line_to, arc, radius, arc_to, center, direction, spline_to, lobed, turn: _ } = section;
    let left = *direction == Some(Direction::Left);
    let drawn = match (line, line_to, arc, arc_to, spline_to, lobed) {
        (Some(line), None, None, None, None, None) => trace.line(length("line", line)?),
        (None, Some(to), None, None, None, None) => trace.line_to(point(text, "line_to", to)?),
        (None, None, Some(arc), None, None, None) => match radius {
            Some(radius) => trace.arc(length("radius", radius)?, angle(text, "arc", arc)?),
            None => Err(ContourError::SectionForm { read: section.keys() }),
        },
        (None, None, None, Some(to), None, None) if direction.is_some() => {
            let end = point(text, "arc_to", to)?;
            match (center, radius) {
                (Some(center), None) => trace.arc_to(end, point(text, "center", center)?, left),
                (None, Some(radius)) => trace.arc_by_radius(end, length("radius", radius)?, left),
                _ => Err(ContourError::SectionForm { read: section.keys() }),
            }
        }
        (None, None, None, None, Some(points), None) => {
            let through: Result<Vec<Point>, FileError> =
                points.iter().map(|each| point(text, "spline_to", each)).collect();
            trace.spline_to(&through?)
        }
        (None, None, None, None, None, Some(lobed)) => trace.lobed(
            length("diameter", &lobed.diameter)?,
            length("eccentricity", &lobed.eccentricity)?,
            lobed.lobes,
            lobed.sections,
        ),
        _ => Err(ContourError::SectionForm { read: section.keys() }),
    };
    drawn.map_err(here)
}

fn assemble(
    text: &str,
    raw: &RawFile,
    contour: impl FnOnce(&RawFile) -> Result<Placed, FileError>,
) -> Result<ContourFile, FileError> {
    let set = raw.parameter_set.as_ref();
    let mut parameters = match set {
        None => Parameters::default(),
        Some(set) => {
            Parameters::named(set.get_ref()).map_err(|fault| FileError::at(text, set.span().start, fault.into()))?
        }
    };
    let groups: [(&'static str, &Table); 5] = [
        ("machine", &raw.machine),
        ("cutter", &raw.cutter),
        ("force", &raw.force),
        ("life", &raw.life),
        ("economics", &raw.economics),
    ];
    for (group, table) in groups {
        if let Some((_, record)) = parameters.parameters_mut().into_iter().find(|(known, _)| *known == group) {
            file_form::fill(text, group, table, record)?;
        }
    }
    if raw.pass.is_empty() {
        return Err(FileError::at(text, 0, ContourError::NoPass));
    }
    let mut passes = Vec::with_capacity(raw.pass.len());
    for values in &raw.pass {
        let Some(Value::Quantity(name)) = values.get_ref().get(NAME).map(Spanned::get_ref) else {
            let message = "a pass needs its `name`, such as name = \"finish\"".to_owned();
            return Err(FileError::at(text, values.span().start, ContourError::Syntax { message }));
        };
        let mut pass = Pass::default();
        file_form::fill(text, "pass", values.get_ref(), &mut pass as &mut dyn AnyRecord)?;
        passes.push((name.clone(), pass));
    }
    let mut scatter = ConditionScatter::default();
    file_form::fill(text, "scatter", &raw.scatter, &mut scatter)?;
    let models = models(text, raw)?;
    let (contour, places) = contour(raw)?;
    let (name, title) = (raw.name.clone(), raw.title.clone());
    Ok(ContourFile { name, title, contour, parameters, passes, models, scatter, places })
}

fn models(text: &str, raw: &RawFile) -> Result<Models, FileError> {
    let defaults = Models::default();
    let path_error = raw.path_error.as_ref().map_or(Ok(defaults.path_error), |law| path_error(text, law))?;
    let corners = match &raw.corners {
        None => defaults.corners,
        Some(Corners { policy, radius, tolerance }) => {
            let tolerance =
                tolerance.as_ref().map(|tolerance| positive(text, "tolerance", tolerance, "m")).transpose()?;
            match (policy.get_ref(), radius) {
                (Policy::ExactStop, _) => CornerPolicy::ExactStop,
                (Policy::SlowDown, _) => CornerPolicy::SlowDown { tolerance },
                (Policy::Loop, Some(radius)) => {
                    CornerPolicy::Loop { radius: positive(text, "radius", radius, "m")?, tolerance }
                }
                (Policy::Loop, None) => {
                    let message = "a loop needs its `radius`, such as radius = \"2 mm\"".to_owned();
                    return Err(FileError::at(text, policy.span().start, ContourError::Syntax { message }));
                }
            }
        }
    };
    Ok(Models {
        milling: raw.milling.unwrap_or(defaults.milling),
        path_error,
        form_error: raw.form_error.unwrap_or(defaults.form_error),
        corners,
    })
}

fn path_error(text: &str, law: &RawPathError) -> Result<PathError, FileError> {
    let lacks = |message: &str| {
        Err(FileError::at(text, law.model.span().start, ContourError::Syntax { message: message.to_owned() }))
    };
    Ok(match (law.model.get_ref(), &law.step, &law.velocity_loop_frequency, law.velocity_loop_damping) {
        (PathErrorModel::Servo, None, None, None) => PathError::default(),
        (PathErrorModel::Servo, None, Some(frequency), Some(damping)) => {
            if damping.is_nan() || damping <= 0.0 {
                let fault = ContourError::NotPositive { key: "velocity_loop_damping" };
                return Err(FileError::at(text, law.model.span().start, fault));
            }
            let frequency = positive(text, "velocity_loop_frequency", frequency, "rad/s")?;
            PathError::Servo { velocity_loop: Some(VelocityLoop { frequency, damping }) }
        }
        (PathErrorModel::Servo, ..) => {
            return lacks("a velocity loop needs `velocity_loop_frequency` and `velocity_loop_damping`, and no `step`");
        }
        (PathErrorModel::ExplicitEuler, Some(step), None, None) => {
            PathError::ExplicitEuler { step: positive(text, "step", step, "s")? }
        }
        (PathErrorModel::ExplicitEuler, ..) => return lacks("explicit Euler needs `step`, such as step = \"10 ms\""),
        (PathErrorModel::Empirical, None, None, None) => PathError::Empirical,
        (PathErrorModel::Off, None, None, None) => PathError::Off,
        _ => return lacks("this path error has no parameters"),
    })
}

fn positive(text: &str, key: &'static str, value: &Text, si: &'static str) -> Result<f64, FileError> {
    let read = number(text, key, value, si)?;
    if read > 0.0 && read.is_finite() {
        return Ok(read);
    }
    Err(FileError::at(text, value.span().start, ContourError::NotPositive { key }))
}
