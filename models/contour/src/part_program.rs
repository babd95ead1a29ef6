//! Part programs with the planned feeds.

use crate::{
    Contour, ContourError, CornerMove, CornerPolicy, CutterSide, Plan, PlannedSection, Planner, Point, Section, Shape,
};
use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt::Write;

/// Distance from the stock at which the cutter comes down, m (assumption).
const CLEARANCE: f64 = 2e-3;

impl Planner<'_> {
    /// A part program of the cutter-centre path with the plan's spindle speeds and feeds: G0 to
    /// G3 in millimetres with I and J, feed per minute, M3. No radius compensation is called for.
    ///
    /// With M3, a cutter on the left of the path mills down. Where the contour is drawn the
    /// other way for the chosen milling, the program runs it backwards. Loops, exact stops (G9)
    /// and slow corners are written out; changes of edge stop the program (M0).
    ///
    /// # Errors
    /// [`ContourError::SettingCount`] for a plan of another contour.
    ///
    /// # Examples
    /// ```
    /// use toolroom_contour::{CutterSide, Models, Objective, Parameters, Pass, Planner, Point, Trace};
    /// let mut trace = Trace::new(Point::default(), 0.0);
    /// trace.arc(0.03, std::f64::consts::TAU).unwrap();
    /// let bore = trace.finish(CutterSide::Left, true).unwrap();
    /// let (parameters, pass, models) = (Parameters::default(), Pass::default(), Models::default());
    /// let planner = Planner::new(&bore, &parameters, &pass, &models).unwrap();
    /// let program = planner.part_program(&planner.optimal(Objective::Time).unwrap(), "bore").unwrap();
    /// assert!(program.contains("G3 X0.0000 Y16.0000 I0.0000 J14.0000 F"));
    /// ```
    pub fn part_program(&self, plan: &Plan, name: &str) -> Result<String, ContourError> {
        let (settings, sections) = (plan.sections.len(), self.contour.sections.len());
        if settings != sections {
            return Err(ContourError::SettingCount { settings, sections });
        }
        let backwards = self.backwards();
        let reversed;
        let contour = if backwards {
            reversed = self.contour.reversed();
            &reversed
        } else {
            self.contour
        };
        let last = plan.sections.len() - 1;
        let planned = |i: usize| &plan.sections[if backwards { last - i } else { i }];
        // Corners were sorted along the contour: backwards they come in reverse, but the closing
        // corner stays the last one.
        let corner_after = |i: usize| {
            let after = if !backwards || i == last { i } else { last - 1 - i };
            plan.corners.iter().find(|corner| corner.corner.after == after)
        };
        let edge_changed = |i: usize| plan.edge_changes.contains(&if backwards { last - i } else { i });
        let mut writer = Writer { planner: self, contour, text: String::new(), spindle_speed: f64::NAN };
        writer.head(name, planned(0));
        for (i, section) in contour.sections.iter().enumerate() {
            if edge_changed(i) {
                writer.line("M0 (CHANGE EDGE)");
            }
            writer.section(section, planned(i));
            if let Some(corner) = corner_after(i) {
                let next = &contour.sections[(i + 1) % contour.sections.len()];
                writer.corner(section, next, corner);
            }
        }
        writer.tail();
        Ok(writer.text)
    }
}

struct Writer<'p> {
    planner: &'p Planner<'p>,
    contour: &'p Contour,
    text: String,
    spindle_speed: f64,
}

/// Path words of a point, mm.
fn xy(point: Point) -> String {
    format!("X{:.4} Y{:.4}", clean(point.x * 1e3), clean(point.y * 1e3))
}

/// Rounded to the last digit written, without a negative zero.
fn clean(mm: f64) -> f64 {
    (mm * 1e4).round() / 1e4 + 0.0
}

/// Feed word, mm/min.
fn feed_word(feed: f64) -> String {
    format!("F{:.1}", feed * 60e3)
}

impl Writer<'_> {
    fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn radius(&self) -> f64 {
        self.planner.parameters.cutter.radius()
    }

    /// Cutter centre beside a point of the wall, `gap` off it.
    fn beside(&self, point: Point, heading: f64, gap: f64) -> Point {
        point.ahead(heading + self.contour.side.sign() * FRAC_PI_2, self.radius() + gap)
    }

    fn head(&mut self, name: &str, first: &PlannedSection) {
        // Parentheses would end the comment.
        let name: String = name.chars().filter(|c| !matches!(c, '(' | ')' | '\n' | '\r')).collect();
        self.line(&format!("({name})"));
        self.line("G21 G17 G90 G94 G40");
        self.spindle(first);
        let start = self.contour.sections[0];
        let gap = self.planner.pass.allowance + CLEARANCE;
        let approach = self.beside(start.start, start.heading, gap);
        let contact = self.beside(start.start, start.heading, 0.0);
        self.line(&format!("G0 {}", xy(approach)));
        self.line(&format!("G1 {} {}", xy(contact), feed_word(first.evaluation.feed)));
    }

    fn spindle(&mut self, planned: &PlannedSection) {
        if planned.setting.spindle_speed != self.spindle_speed {
            self.spindle_speed = planned.setting.spindle_speed;
            self.line(&format!("S{:.0} M3", self.spindle_speed * 60.0 / TAU));
        }
    }

    fn section(&mut self, section: &Section, planned: &PlannedSection) {
        self.spindle(planned);
        let feed = feed_word(planned.evaluation.feed);
        let from = self.beside(section.start, section.heading, 0.0);
        let to = self.beside(section.end(), section.end_heading(), 0.0);
        match section.shape(self.contour.side) {
            Shape::Straight => self.line(&format!("G1 {} {feed}", xy(to))),
            Shape::Convex(radius) | Shape::Concave(radius) => {
                let left = section.curvature > 0.0;
                let side = if left { FRAC_PI_2 } else { -FRAC_PI_2 };
                let center = section.start.ahead(section.heading + side, radius);
                self.arc(left, from, to, center, &feed);
            }
        }
    }

    fn arc(&mut self, left: bool, from: Point, to: Point, center: Point, feed: &str) {
        let code = if left { "G3" } else { "G2" };
        let (i, j) = (clean((center.x - from.x) * 1e3), clean((center.y - from.y) * 1e3));
        self.line(&format!("{code} {} I{i:.4} J{j:.4} {feed}", xy(to)));
    }

    fn corner(&mut self, before: &Section, after: &Section, corner: &CornerMove) {
        let models = self.planner.models;
        let cot = 1.0 / (0.5 * corner.corner.interior_angle).tan();
        let (into, out) = (before.end_heading(), after.heading);
        let air = feed_word(self.planner.parameters.machine.highest_feed);
        let foot = self.beside(after.start, out, 0.0);
        let meeting = self.beside(before.end(), into, 0.0).ahead(into, self.radius() * cot);
        match models.corners {
            CornerPolicy::Loop { radius, .. } => {
                let feed = feed_word(corner.feed);
                let (enter, leave) = (meeting.ahead(into, radius * cot), meeting.ahead(out, -radius * cot));
                // The loop turns away from the material: towards the cutter's side.
                let side = self.contour.side;
                let center = enter.ahead(into + side.sign() * FRAC_PI_2, radius);
                self.line(&format!("G1 {} {feed}", xy(enter)));
                self.arc(side == CutterSide::Left, enter, leave, center, &feed);
                self.line(&format!("G1 {} {feed}", xy(foot)));
            }
            CornerPolicy::ExactStop => {
                self.line(&format!("G9 G1 {} {air}", xy(meeting)));
                self.line(&format!("G1 {} {air}", xy(foot)));
            }
            CornerPolicy::SlowDown { .. } => {
                let machine = &self.planner.parameters.machine;
                let room = self.radius() * cot;
                let braking = machine.ramp_length(machine.highest_feed, corner.feed).min(room);
                let slow = feed_word(corner.feed);
                if braking < room {
                    self.line(&format!("G1 {} {air}", xy(meeting.ahead(into, -braking))));
                }
                self.line(&format!("G1 {} {slow}", xy(meeting)));
                self.line(&format!("G1 {} {slow}", xy(meeting.ahead(out, braking))));
                if braking < room {
                    self.line(&format!("G1 {} {air}", xy(foot)));
                }
            }
        }
    }

    fn tail(&mut self) {
        let end = self.contour.sections[self.contour.sections.len() - 1];
        let gap = self.planner.pass.allowance + CLEARANCE;
        let away = self.beside(end.end(), end.end_heading(), gap);
        let air = feed_word(self.planner.parameters.machine.highest_feed);
        // Closing corners were passed already: the cutter stands beside the first section.
        let closed = self.planner.contour.corners.iter().any(|corner| corner.after + 1 == self.contour.sections.len());
        let start = self.contour.sections[0];
        let away = if closed { self.beside(start.start, start.heading, gap) } else { away };
        let _ = writeln!(self.text, "G1 {} {air}", xy(away));
        self.line("M5");
        self.line("M30");
    }
}
