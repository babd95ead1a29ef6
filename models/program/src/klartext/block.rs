//! Blocks that position, call tools and define cycles.

use super::contour::{Corner, Element, Joint};
use super::{Klartext, Statement};
use crate::error::Fault;
use crate::kernel::{FeedMode, Kernel, Round, Target};
use crate::motion::{AXES, EventKind, Offset, PLANES, Sense, tangent};
use crate::offset::{self, Offsetting};
use crate::run::Flow;

/// Words of a positioning block.
#[derive(Default)]
pub(super) struct Words {
    pub target: Target,
    feed: Option<f64>,
    pub fmax: bool,
    auto: bool,
    pub side: Option<char>,
    pub radius: Option<f64>,
    left: Option<bool>,
    polar_radius: Option<(f64, bool)>,
    polar_angle: Option<(f64, bool)>,
    /// MB of M140: the way off the workpiece, mm, or as far as the axis goes.
    back: Option<Back>,
    pub m: Vec<(u32, usize)>,
}

/// How far M140 draws the tool back along its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Back {
    Way(f64),
    Limit,
}

impl Klartext {
    pub(super) fn block(&mut self, statement: &Statement, kernel: &mut Kernel) -> Result<Flow, Fault> {
        let words = &statement.words;
        let word = |index: usize| words.get(index).map_or("", |(word, _)| word.as_str());
        let column = |index: usize| words.get(index).map_or(1, |(_, column)| *column);
        let mut repositioned = false;
        let flow = match word(0) {
            "TOOL" if word(1) == "DEF" => {
                let number = self.value(word(2), column(2))?;
                let radius =
                    words[2..].iter().find_map(|(word, at)| word.strip_prefix('R').map(|rest| self.value(rest, *at)));
                if let Some(radius) = radius.transpose()? {
                    let radius = kernel.length(radius)?;
                    self.radii.insert(number.clamp(0.0, 1e9) as u32, radius);
                }
                Flow::Going
            }
            "TOOL" if word(1) == "CALL" => {
                self.flush(kernel)?;
                self.tool(&words[2..], kernel)?;
                Flow::Going
            }
            "CYCL" if word(1) == "DEF" => {
                self.flush(kernel)?;
                self.define(statement, kernel)?;
                Flow::Going
            }
            "CYCL" if word(1) == "CALL" => {
                self.flush(kernel)?;
                if matches!(word(2), "PAT") {
                    return Err(
                        Fault::at(column(2), "CYCL CALL PAT needs a table of points, which is not followed").refusing()
                    );
                }
                let rest = if word(2) == "POS" { &words[3..] } else { &words[2..] };
                let given = self.words(rest, kernel)?;
                let frame = kernel.frame;
                if word(2) == "POS" {
                    self.feed(&given, kernel)?;
                    self.call_place(&given, kernel)?;
                }
                self.before(&given.m, kernel)?;
                self.bore(kernel)?;
                kernel.frame = frame;
                self.after(&given.m, kernel)?
            }
            "CC" => {
                let given = self.words(&words[1..], kernel)?;
                let position = kernel.program_at();
                let [u, v, _] = kernel.plane;
                for (slot, axis) in [u, v].into_iter().enumerate() {
                    self.pole[slot] = match (given.target.absolute[axis], given.target.step[axis]) {
                        (Some(place), _) => place,
                        (None, Some(step)) => position[axis] + step,
                        (None, None) if given.target.is_empty() => position[axis],
                        (None, None) => self.pole[slot],
                    };
                }
                self.has_pole = true;
                Flow::Going
            }
            "RND" | "CHF" => {
                let chamfer = word(0) == "CHF";
                let text = if chamfer { word(1) } else { word(1).strip_prefix('R').unwrap_or_default() };
                let size = kernel.length(self.value(text, column(1))?)?;
                let rest = self.words(words.get(2..).unwrap_or_default(), kernel)?;
                if size <= 0.0 {
                    return Err(Fault::at(column(1), "the size of the corner must be above 0"));
                }
                let feed = rest.feed.map(|feed| feed * kernel.scale.unwrap_or(1.0));
                let waits =
                    self.corner.as_mut().ok_or_else(|| Fault::new("a corner stands between two motions at feed"))?;
                waits.joint = Some(if chamfer { Joint::Chamfer(size) } else { Joint::Round(size, feed) });
                Flow::Going
            }
            "L" | "LP" | "C" | "CP" | "CR" | "CT" | "CTP" | "LN" => {
                if word(0) == "LN" {
                    return Err(
                        Fault::at(column(0), "LN moves by vectors in five axes, which is not followed").refusing()
                    );
                }
                repositioned = true;
                self.position(word(0), &words[1..], kernel)?
            }
            "STOP" => {
                self.flush(kernel)?;
                kernel.push(EventKind::Stop(false));
                let given = self.words(&words[1..], kernel)?;
                self.before(&given.m, kernel)?;
                self.after(&given.m, kernel)?
            }
            "APPR" => {
                self.approach(words, kernel)?;
                Flow::Going
            }
            "DEP" => {
                self.depart(words, kernel)?;
                Flow::Going
            }
            "FK" | "FPOL" | "FL" | "FC" | "FLT" | "FCT" | "FSELECT" => {
                return Err(Fault::at(
                    column(0),
                    "free contour programming (FK) is solved by the control; post L and C instead",
                ));
            }
            // Tilted planes are refused, so none is in force that could end.
            "PLANE" if word(1) == "RESET" => Flow::Going,
            "FUNCTION" if matches!((word(1), word(2)), ("RESET", "TCPM") | ("MODE", "MILL")) => Flow::Going,
            "PLANE" => {
                return Err(
                    Fault::at(column(0), "tilted planes are not followed; post the motions in machine axes").refusing()
                );
            }
            first if first.starts_with('M') && first[1..].bytes().all(|b| b.is_ascii_digit()) && first.len() > 1 => {
                self.flush(kernel)?;
                let given = self.words(words, kernel)?;
                self.before(&given.m, kernel)?;
                self.draw_back(&given, kernel)?;
                self.after(&given.m, kernel)?
            }
            other => {
                return Err(Fault::at(
                    column(0),
                    format!(
                        "{other} is not understood for heidenhain; it might move axes or take time: mend the block"
                    ),
                )
                .refusing());
            }
        };
        if repositioned && self.modal_call && flow == Flow::Going {
            self.flush(kernel)?;
            self.bore(kernel)?;
        }
        Ok(flow)
    }

    pub(super) fn words(&self, list: &[(String, usize)], kernel: &Kernel) -> Result<Words, Fault> {
        let mut parsed = Words::default();
        let mut index = 0;
        while let Some((word, column)) = list.get(index) {
            index += 1;
            // A letter may stand apart from its value.
            let mut word = word.clone();
            const APART: &str = "F X Y Z A B C U V W IX IY IZ PR PA IPA M MB";
            if APART.split(' ').any(|letter| letter == word)
                && let Some((next, _)) = list.get(index)
            {
                word.push_str(next);
                index += 1;
            }
            self.word(&word, *column, kernel, &mut parsed)?;
        }
        Ok(parsed)
    }

    fn word(&self, word: &str, column: usize, kernel: &Kernel, parsed: &mut Words) -> Result<(), Fault> {
        let length = |text: &str| -> Result<f64, Fault> {
            kernel.length(self.value(text, column)?).map_err(|fault| fault.or_at(column))
        };
        match word {
            "FMAX" => parsed.fmax = true,
            "FAUTO" => parsed.auto = true,
            "R0" => parsed.side = Some('0'),
            "RL" | "RR" => parsed.side = word.chars().nth(1),
            "DR+" => parsed.left = Some(true),
            "DR-" => parsed.left = Some(false),
            "MBMAX" => parsed.back = Some(Back::Limit),
            _ => {
                if let Some(rest) = word.strip_prefix("IPA") {
                    parsed.polar_angle = Some((self.value(rest, column)?, true));
                } else if let Some(rest) = word.strip_prefix("PA") {
                    parsed.polar_angle = Some((self.value(rest, column)?, false));
                } else if let Some(rest) = word.strip_prefix("IPR") {
                    parsed.polar_radius = Some((length(rest)?, true));
                } else if let Some(rest) = word.strip_prefix("PR") {
                    parsed.polar_radius = Some((length(rest)?, false));
                } else if let Some(rest) = word.strip_prefix("MB") {
                    parsed.back = Some(Back::Way(length(rest)?.abs()));
                } else if let Some(rest) = word.strip_prefix('F').filter(|rest| !rest.is_empty()) {
                    if rest.starts_with(|c: char| c.is_ascii_alphabetic() && c != 'Q') {
                        return Err(Fault::at(
                            column,
                            format!(
                                "{word} is a feed by time, tooth or turn, which is not followed; write F in mm/min"
                            ),
                        )
                        .refusing());
                    }
                    parsed.feed = Some(self.value(rest, column)?);
                } else if let Some(rest) =
                    word.strip_prefix('M').filter(|rest| rest.bytes().all(|b| b.is_ascii_digit()) && !rest.is_empty())
                {
                    parsed.m.push((rest.parse().unwrap_or(u32::MAX), column));
                } else if let Some(rest) = word
                    .strip_prefix('R')
                    .filter(|rest| rest.starts_with(['+', '-', 'Q']) || rest.starts_with(|c: char| c.is_ascii_digit()))
                {
                    parsed.radius = Some(length(rest)?);
                } else {
                    let (step, rest) = word.strip_prefix('I').map_or((false, word), |rest| (true, rest));
                    let axis = rest.chars().next().and_then(|letter| AXES.iter().position(|known| *known == letter));
                    let Some(axis) = axis else {
                        return Err(Fault::at(
                            column,
                            format!(
                                "{word} is not understood for heidenhain; it might move axes or take time: mend the block"
                            ),
                        ).refusing());
                    };
                    let value =
                        if (3..6).contains(&axis) { self.value(&rest[1..], column)? } else { length(&rest[1..])? };
                    if parsed.target.names(axis) {
                        return Err(Fault::at(column, format!("{} stands twice in the block", AXES[axis])));
                    }
                    if step {
                        parsed.target.step[axis] = Some(value)
                    } else {
                        parsed.target.absolute[axis] = Some(value)
                    }
                }
            }
        }
        Ok(())
    }

    fn tool(&mut self, words: &[(String, usize)], kernel: &mut Kernel) -> Result<(), Fault> {
        let (mut changes, mut number, mut oversize) = (false, None, 0.0);
        for (index, (word, column)) in words.iter().enumerate() {
            let first = word.chars().next().unwrap_or(' ');
            match first {
                '"' => changes = true,
                '0'..='9' | 'Q' if index == 0 => {
                    changes = true;
                    let value = self.value(word, *column)?;
                    if !(0.0..=1e8).contains(&value) {
                        return Err(Fault::at(*column, format!("{value} is no tool number")));
                    }
                    number = Some(value as u32);
                }
                'X' | 'Y' | 'Z' if word.len() == 1 => {
                    kernel.plane = match first {
                        'Z' => PLANES[0],
                        'Y' => PLANES[1],
                        _ => PLANES[2],
                    };
                }
                'S' => kernel.set_speed(self.value(&word[1..], *column)?).map_err(|fault| fault.or_at(*column))?,
                'F' => {
                    let feed = self.value(&word[1..], *column)?;
                    let scale = kernel.unit().map_err(|fault| fault.or_at(*column))?;
                    self.tool_feed = Some(feed * scale);
                    kernel.set_feed(feed, scale)?;
                }
                'D' => {
                    // DR is an oversize of the radius; DL and DR2 change the length and the corner.
                    if let Some(rest) = word.strip_prefix("DR").filter(|rest| rest.starts_with(['+', '-'])) {
                        oversize = kernel.length(self.value(rest, *column)?)?;
                    }
                }
                _ => return Err(Fault::at(*column, format!("{word} is not understood behind TOOL CALL")).refusing()),
            }
        }
        if changes {
            self.oversize = oversize;
            kernel.finish_offset()?;
            kernel.change_tool(number);
            // The length of the tool is added from here on.
            kernel.offset_by(Offset::Length(number));
            if number.is_none() {
                kernel.note("a tool is called by its name, so its number is not known");
            }
        }
        Ok(())
    }

    pub(super) fn feed(&mut self, words: &Words, kernel: &mut Kernel) -> Result<(), Fault> {
        kernel.feed_mode = FeedMode::Minute;
        if let Some(feed) = words.feed {
            let scale = if feed == 0.0 { 1.0 } else { kernel.unit()? };
            kernel.set_feed(feed, scale)?;
        } else if words.auto {
            kernel.feed = self.tool_feed;
        }
        Ok(())
    }

    pub(super) fn side(&mut self, side: char, kernel: &mut Kernel) -> Result<(), Fault> {
        kernel.finish_offset()?;
        if side == '0' {
            return Ok(());
        }
        kernel.side = Some(side == 'L');
        let Some(radius) = self.cutter_radius(kernel) else {
            let number = kernel.tool.unwrap_or(1);
            kernel.note(format!(
                "the radius of tool {number} is not known, so the contour is timed as programmed: give --tool D{number}=\"10 mm\""
            ));
            return Ok(());
        };
        kernel.compensate(Offsetting::new(side == 'L', radius, kernel.plane, offset::Corner::Round));
        Ok(())
    }

    /// Radius of the tool in the spindle, mm, where it is known.
    pub(super) fn cutter_radius(&self, kernel: &Kernel) -> Option<f64> {
        let tool = kernel.tool?;
        let given = kernel.control.diameters.get(&tool).map(|diameter| 0.5 * diameter);
        given.or_else(|| self.radii.get(&tool).copied()).map(|radius| radius + self.oversize)
    }

    /// M140: off the workpiece along the axis of the tool, at rapid speed where no feed stands beside it.
    fn draw_back(&mut self, given: &Words, kernel: &mut Kernel) -> Result<(), Fault> {
        let Some((_, column)) = given.m.iter().find(|(code, _)| *code == 140) else { return Ok(()) };
        let w = kernel.plane[2];
        match given.back {
            None => Err(Fault::at(*column, "M140 needs MB, the way, or MB MAX")),
            Some(Back::Limit) => kernel.machine_motion(&[w]),
            Some(Back::Way(way)) => {
                self.feed(given, kernel)?;
                let mut target = Target::default();
                target.step[w] = Some(way);
                kernel.straight(&target, given.feed.is_none() && !given.auto)
            }
        }
    }

    /// Functions that act when the block begins.
    pub(super) fn before(&mut self, m: &[(u32, usize)], kernel: &mut Kernel) -> Result<(), Fault> {
        for (code, column) in m {
            match code {
                3 | 13 => kernel.spindle(Sense::Clockwise),
                4 | 14 => kernel.spindle(Sense::Counterclockwise),
                6 => kernel.change_tool(kernel.tool),
                7 | 8 => kernel.push(EventKind::Coolant(true)),
                19 => kernel.spindle(Sense::Oriented),
                0 | 1 | 2 | 5 | 9 | 30 | 89 | 99 | 91 | 92 | 126 | 127 | 120 | 140 => {}
                // Ends of modes that are not followed, and messages about oversizes.
                102 | 107 | 108 | 111 | 117 | 129 | 137 | 145 | 149 => {}
                97 | 98 | 101..=118 | 128..=149 => {
                    return Err(Fault::at(
                        *column,
                        format!("M{code} changes how the path is followed, and is not followed here"),
                    )
                    .refusing());
                }
                _ => kernel.auxiliary(*code),
            }
            if matches!(code, 13 | 14) {
                kernel.push(EventKind::Coolant(true));
            }
        }
        Ok(())
    }

    pub(super) fn after(&mut self, m: &[(u32, usize)], kernel: &mut Kernel) -> Result<Flow, Fault> {
        for (code, _) in m {
            match code {
                89 => self.modal_call = true,
                99 => {
                    self.modal_call = false;
                    self.flush(kernel)?;
                    self.bore(kernel)?;
                }
                _ => {}
            }
        }
        for (code, _) in m {
            match code {
                0 => kernel.push(EventKind::Stop(false)),
                1 => kernel.push(EventKind::Stop(true)),
                5 => kernel.spindle(Sense::Still),
                9 => kernel.push(EventKind::Coolant(false)),
                2 | 30 => {
                    self.flush(kernel)?;
                    kernel.push(EventKind::Auxiliary(*code, 0.0));
                    kernel.end()?;
                    return Ok(Flow::Ended);
                }
                _ => {}
            }
        }
        Ok(Flow::Going)
    }

    fn position(&mut self, kind: &str, list: &[(String, usize)], kernel: &mut Kernel) -> Result<Flow, Fault> {
        let mut given = self.words(list, kernel)?;
        if given.m.iter().any(|(code, _)| matches!(code, 91 | 92)) {
            self.flush(kernel)?;
            self.before(&given.m, kernel)?;
            let axes: Vec<usize> = (0..9).filter(|axis| given.target.names(*axis)).collect();
            kernel.machine_motion(&axes)?;
            return self.after(&given.m, kernel);
        }
        if given.m.iter().any(|(code, _)| *code == 140) {
            self.flush(kernel)?;
            self.before(&given.m, kernel)?;
            if !given.target.is_empty() {
                return Err(Fault::new(
                    "M140 moves the axis of the tool alone; give the other axes a block of their own",
                ));
            }
            self.draw_back(&given, kernel)?;
            return self.after(&given.m, kernel);
        }
        if let Some(side) = given.side
            && (side != '0' || kernel.offset.is_some())
        {
            self.flush(kernel)?;
            self.side(side, kernel)?;
        }
        if !given.m.is_empty() && self.approach.is_none() {
            self.flush(kernel)?;
        }
        self.before(&given.m, kernel)?;
        self.feed(&given, kernel)?;
        if given.left.is_some() {
            self.left = given.left;
        }
        let [u, v, _] = kernel.plane;
        let from = self.at(kernel);
        let mut turns = 0.0;
        if matches!(kind, "LP" | "CP" | "CTP") {
            if !self.has_pole {
                return Err(Fault::new("polar coordinates need a pole: write CC before"));
            }
            let arm = [from[u] - self.pole[0], from[v] - self.pole[1]];
            let (mut reach, mut angle) = (arm[0].hypot(arm[1]), arm[1].atan2(arm[0]).to_degrees());
            if let Some((value, step)) = given.polar_radius {
                reach = if step { reach + value } else { value };
            }
            if let Some((value, step)) = given.polar_angle {
                angle = if step { angle + value } else { value };
                if step && kind == "CP" {
                    // A helix by its whole angle.
                    let rounds = value.abs() / 360.0;
                    turns = if rounds.fract() < 1e-9 && rounds >= 1.0 { rounds.round() - 1.0 } else { rounds.floor() };
                    self.left = given.left.or(Some(value > 0.0));
                }
            }
            let (sin, cos) = crate::frame::turn(angle);
            (given.target.absolute[u], given.target.step[u]) = (Some(self.pole[0] + reach * cos), None);
            (given.target.absolute[v], given.target.step[v]) = (Some(self.pole[1] + reach * sin), None);
        }
        let sense = || self.left.ok_or_else(|| Fault::new("the arc needs its sense: DR+ or DR-"));
        let element = match kind {
            "L" | "LP" => Element::Line,
            "C" | "CP" => {
                if !self.has_pole {
                    return Err(Fault::new("the arc needs its centre: write CC before"));
                }
                Element::Arc(Round::Centre(self.pole), sense()?, turns)
            }
            "CR" => {
                let radius = given.radius.ok_or_else(|| Fault::new("CR needs R, the radius"))?;
                Element::Arc(Round::Radius(radius), sense()?, 0.0)
            }
            _ => {
                let direction = [self.direction[u], self.direction[v]];
                match tangent([from[u], from[v]], [given.target.end(u, &from), given.target.end(v, &from)], direction) {
                    Some((centre, left)) => Element::Arc(Round::Centre(centre), left, 0.0),
                    None if direction == [0.0; 2] => {
                        return Err(Fault::new("CT needs a motion before it in whose direction it begins"));
                    }
                    None => Element::Line,
                }
            }
        };
        if given.fmax && element != Element::Line {
            return Err(Fault::new("an arc at FMAX is not followed; write a feed").refusing());
        }
        if !given.target.is_empty() {
            let next = self.statements.at(self.pc)?;
            let joins = next
                .is_some_and(|next| matches!(next.words.first().map(|(word, _)| word.as_str()), Some("RND" | "CHF")));
            let corner = Corner { target: given.target, element, rapid: given.fmax, joint: None };
            self.follow(corner, joins, kernel)?;
        }
        self.after(&given.m, kernel)
    }
}
