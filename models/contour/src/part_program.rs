//! Part programs with the planned feeds.

use crate::track::distance;
use crate::{
    Contour, ContourError, CornerMove, CornerPolicy, CutterSide, Plan, PlannedSection, Planner, Point, Section, Shape,
};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Distance from the stock at which the cutter comes down, m (assumption).
const CLEARANCE: f64 = 2e-3;
/// Height above the work at which the cutter moves over it, m (assumption).
const ABOVE: f64 = 5e-3;
/// Way along the first section that is cut twice, so that no mark is left where a closed contour begins, m (assumption).
const OVERLAP: f64 = 1e-3;
/// Least radius of the arcs of entry and exit as a share of the cutter's; where there is no room for it the cutter moves
/// straight (spec of this project).
const LEAST_LEAD: f64 = 0.25;
/// Points of an arc of entry at which its distance from the wall is measured.
const LEAD_POINTS: u32 = 32;
/// Name of the tool in the program.
const TOOL: u32 = 1;

impl Planner<'_> {
    /// By how much the cutter that bends cuts deeper than its path, at most, m; 0 where it only leaves material.
    pub fn overcut(&self, plan: &Plan) -> f64 {
        plan.sections.iter().map(|section| -section.evaluation.deflection).fold(0.0, f64::max)
    }

    /// [`Planner::part_program_leaving`] nothing.
    ///
    /// # Errors
    /// As there.
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
        self.part_program_leaving(plan, name, 0.0)
    }

    /// A part program for a Fanuc control of the cutter-centre path with the plan's spindle speeds and feeds, `leave` m
    /// away from where it would finish the wall: what later passes remove, and what this one cuts too deep. No radius
    /// compensation is called for.
    ///
    /// It calls tool 1, switches the spindle, work offset G54, length offset H1 and coolant on, comes down to the depth of the
    /// pass below Z 0, enters on an arc that is tangential to the wall, runs the contour with some overlap, leaves on
    /// such an arc, lifts, switches all off and returns along Z. Arcs of entry are fitted to the room; where there is none the
    /// cutter moves straight. The lines between `(CONTOUR)` and `(EXIT)` are the contour.
    ///
    /// With M3, a cutter on the left of the path mills down. Where the contour is drawn the
    /// other way for the chosen milling, the program runs it backwards. Loops, exact stops (G9)
    /// and slow corners are written out; changes of edge stop the program (M0).
    ///
    /// # Errors
    /// [`ContourError::SettingCount`] for a plan of another contour, [`ContourError::CutterTooLarge`] and
    /// [`ContourError::Neck`] where the cutter with what it leaves does not fit into a hollow section or between two.
    pub fn part_program_leaving(&self, plan: &Plan, name: &str, leave: f64) -> Result<String, ContourError> {
        let (settings, sections) = (plan.sections.len(), self.contour.sections.len());
        if settings != sections {
            return Err(ContourError::SettingCount { settings, sections });
        }
        self.drawn().clears(self.parameters.cutter.radius() + leave, self.pass.gouge())?;
        let backwards = self.backwards();
        let reversed;
        let contour = if backwards {
            reversed = self.contour.reversed();
            &reversed
        } else {
            &self.contour
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
        let mut writer = Writer { planner: self, contour, leave, text: String::new(), spindle_speed: f64::NAN };
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
        writer.tail(planned(0));
        Ok(writer.text)
    }
}

struct Writer<'p> {
    planner: &'p Planner<'p>,
    contour: &'p Contour,
    /// Distance that is left to the finished wall, m.
    leave: f64,
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

    /// Distance of the path from the finished wall.
    fn radius(&self) -> f64 {
        self.planner.parameters.cutter.radius() + self.leave
    }

    /// Cutter centre beside a point of the wall, `gap` off it.
    fn beside(&self, point: Point, heading: f64, gap: f64) -> Point {
        point.ahead(heading + self.contour.side.sign() * FRAC_PI_2, self.radius() + gap)
    }

    /// Centre and far end of an arc that touches the path at `contact` in the direction `heading`: before it, or behind it.
    /// `None` where there is no room for one.
    fn lead(&self, contact: Point, heading: f64, entry: bool) -> Option<(Point, Point)> {
        let planner = self.planner;
        let least = LEAST_LEAD * planner.parameters.cutter.radius();
        let away = heading + self.contour.side.sign() * FRAC_PI_2;
        let mut radius = (planner.pass.allowance + CLEARANCE).max(least);
        loop {
            let centre = contact.ahead(away, radius);
            let far = centre.ahead(heading, if entry { -radius } else { radius });
            let point = |i: u32| {
                let turned = FRAC_PI_2 * f64::from(i) / f64::from(LEAD_POINTS);
                let (sin, cos) = turned.sin_cos();
                let along = if entry { -sin } else { sin };
                contact.ahead(heading, radius * along).ahead(away, radius * (1.0 - cos))
            };
            let clear = |point: Point| {
                self.contour.sections.iter().all(|section| distance(section, point) >= self.radius() - 1e-7)
            };
            if (0..=LEAD_POINTS).all(|i| clear(point(i))) {
                return Some((centre, far));
            }
            if radius <= least {
                return None;
            }
            radius = (0.7 * radius).max(least);
        }
    }

    fn head(&mut self, name: &str, first: &PlannedSection) {
        // Parentheses would end the comment.
        let name: String = name.chars().filter(|c| !matches!(c, '(' | ')' | '\n' | '\r')).collect();
        let cutter = &self.planner.parameters.cutter;
        let tool = format!("(T{TOOL}: END MILL {:.2} MM, {:.0} TEETH)", cutter.diameter * 1e3, cutter.teeth);
        for line in
            ["%", "O0001", &format!("({name})"), &tool, "G21 G17 G90 G94 G40 G49 G80", &format!("T{TOOL} M6"), "G54"]
        {
            self.line(line);
        }
        self.spindle(first);
        let start = self.contour.sections[0];
        let contact = self.beside(start.start, start.heading, 0.0);
        let lead = self.lead(contact, start.heading, true);
        let gap = self.planner.pass.allowance + CLEARANCE;
        let approach = lead.map_or_else(|| self.beside(start.start, start.heading, gap), |(_, far)| far);
        let feed = feed_word(first.evaluation.feed);
        self.line(&format!("G0 {}", xy(approach)));
        self.line(&format!("G43 H{TOOL} Z{:.4}", ABOVE * 1e3));
        self.line("M8");
        self.line(&format!("G1 Z{:.4} {feed}", clean(-self.planner.pass.depth_of_cut * 1e3)));
        self.line("(ENTRY)");
        match lead {
            Some((centre, far)) => self.arc(self.contour.side == CutterSide::Left, far, contact, centre, &feed),
            None => self.line(&format!("G1 {} {feed}", xy(contact))),
        }
        self.line("(CONTOUR)");
    }

    fn spindle(&mut self, planned: &PlannedSection) {
        if planned.setting.spindle_speed != self.spindle_speed {
            self.spindle_speed = planned.setting.spindle_speed;
            self.line(&format!("S{:.0} M3", self.spindle_speed * 60.0 / TAU));
        }
    }

    fn section(&mut self, section: &Section, planned: &PlannedSection) {
        self.spindle(planned);
        self.along(section, planned);
    }

    fn along(&mut self, section: &Section, planned: &PlannedSection) {
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

    fn arc(&mut self, left: bool, start: Point, target: Point, center: Point, feed: &str) {
        let code = if left { "G3" } else { "G2" };
        let (i, j) = (clean((center.x - start.x) * 1e3), clean((center.y - start.y) * 1e3));
        self.line(&format!("{code} {} I{i:.4} J{j:.4} {feed}", xy(target)));
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

    fn tail(&mut self, first: &PlannedSection) {
        self.line("(EXIT)");
        let (start, end) = (self.contour.sections[0], self.contour.sections[self.contour.sections.len() - 1]);
        // A closed contour ends beside its first section, of which a little is cut again.
        let exit = if self.contour.closed {
            let overlap = Section { length: start.length.min(OVERLAP), ..start };
            self.along(&overlap, first);
            overlap
        } else {
            end
        };
        let (point, heading) = (exit.end(), exit.end_heading());
        let contact = self.beside(point, heading, 0.0);
        let feed = feed_word(first.evaluation.feed);
        match self.lead(contact, heading, false) {
            Some((centre, far)) => self.arc(self.contour.side == CutterSide::Left, contact, far, centre, &feed),
            None => {
                let away = self.beside(point, heading, CLEARANCE);
                self.line(&format!("G1 {} {feed}", xy(away)));
            }
        }
        self.line(&format!("G0 Z{:.4}", ABOVE * 1e3));
        for line in ["M9", "M5", "G91 G28 Z0.", "G90", "M30", "%"] {
            self.line(line);
        }
    }
}
