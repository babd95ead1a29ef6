//! What the words of a SINUMERIK block do.

use super::Siemens;
use super::parse::{Count, Item};
use crate::error::{Fault, unknown};
use crate::frame::Frame;
use crate::kernel::{FeedMode, Kernel, Round, Target};
use crate::motion::{AXES, EventKind, Sense, circle, tangent};
use crate::offset::{Corner, Offsetting};
use crate::run::Flow;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Move {
    Rapid,
    Line,
    Arc {
        left: bool,
    },
    /// An arc through a point.
    Through,
    /// An arc that goes on from the path before.
    Tangent,
}

#[derive(Clone, Debug)]
pub(super) struct Modes {
    motion: Move,
    /// Programmable frame: TRANS, ROT, SCALE, MIRROR.
    frame: Frame,
    work: u32,
    corner: Corner,
    next_tool: Option<u32>,
    edge: u32,
    /// Direction of the last motion in X Y Z.
    pub direction: [f64; 3],
}

impl Default for Modes {
    fn default() -> Self {
        Self {
            motion: Move::Rapid,
            frame: Frame::IDENTITY,
            work: 500,
            corner: Corner::Round,
            next_tool: None,
            edge: 1,
            direction: [0.0; 3],
        }
    }
}

#[derive(Clone, Debug)]
struct Value {
    address: String,
    count: Count,
    value: f64,
    column: usize,
    used: bool,
}

#[derive(Default)]
struct Values(Vec<Value>);

impl Values {
    fn take(&mut self, address: &str) -> Option<(f64, Count, usize)> {
        let own = self.0.iter_mut().find(|own| own.address == address && !own.used)?;
        own.used = true;
        Some((own.value, own.count, own.column))
    }

    fn has(&self, address: &str) -> bool {
        self.0.iter().any(|own| own.address == address)
    }
}

/// Words that change how the control computes, but neither the path nor the time at programmed feeds.
const QUIET: [&str; 34] = [
    "FFWON",
    "FFWOF",
    "SOFT",
    "BRISK",
    "DRIVE",
    "COMPON",
    "COMPCURV",
    "COMPCAD",
    "COMPOF",
    "NORM",
    "KONT",
    "KONTC",
    "KONTT",
    "CFC",
    "CFTCP",
    "CFIN",
    "WALIMON",
    "WALIMOF",
    "STOPRE",
    "ORIWKS",
    "ORIMKS",
    "ORIAXES",
    "DIAMOF",
    "UPATH",
    "SPATH",
    "STARTFIFO",
    "STOPFIFO",
    "DYNNORM",
    "DYNPOS",
    "DYNROUGH",
    "DYNSEMIFIN",
    "DYNFINISH",
    "SBLON",
    "SBLOF",
];

impl Siemens {
    pub(super) fn block(&mut self, items: &[Item], kernel: &mut Kernel) -> Result<Flow, Fault> {
        let mut values = Values::default();
        let mut keywords: Vec<(&str, usize)> = Vec::new();
        let mut calls: Vec<(&str, &[Option<crate::expression::Expression>], usize)> = Vec::new();
        let mut g: Vec<(u32, usize)> = Vec::new();
        let mut m: Vec<(u32, usize)> = Vec::new();
        let mut named_tool = false;
        for item in items {
            match item {
                Item::Assign(target, value) => {
                    let value = self.value(value)?;
                    self.assign(target, value)?;
                }
                Item::Define(name, value) => {
                    let value = self.value(value)?;
                    self.store.named.insert(name.clone(), value);
                }
                Item::Text { address, text, column } => {
                    if address != "T" {
                        return Err(Fault::at(
                            *column,
                            format!("{address}=\"{text}\" is not understood; only T takes a name"),
                        ));
                    }
                    named_tool = true;
                }
                Item::Keyword(word, column) => keywords.push((word, *column)),
                Item::Call(word, arguments, column) => calls.push((word, arguments, *column)),
                Item::Word { address, count, value, column } => {
                    let value = self.value(value).map_err(|fault| fault.or_at(*column))?;
                    let code = |limit: f64| {
                        if (0.0..=limit).contains(&value) && value.fract() == 0.0 {
                            Ok((value as u32, *column))
                        } else {
                            Err(Fault::at(*column, format!("{address}{value} is no code")))
                        }
                    };
                    match address.as_str() {
                        "G" => g.push(code(9999.0)?),
                        "M" | "M1" => m.push(code(99_999.0)?),
                        _ => {
                            if values.has(address) {
                                return Err(Fault::at(
                                    *column,
                                    format!("{address} stands twice in the block; leave one out"),
                                ));
                            }
                            values.0.push(Value {
                                address: address.clone(),
                                count: *count,
                                value,
                                column: *column,
                                used: false,
                            });
                        }
                    }
                }
            }
        }
        let (mut motions, mut machine, mut stop, mut dwell, mut home) = (0, false, false, false, false);
        for (code, column) in g {
            match code {
                4 => dwell = true,
                9 => stop = true,
                53 | 153 => machine = true,
                74 | 75 => home = true,
                _ => motions += u32::from(self.code(code, &mut values, kernel).map_err(|fault| fault.or_at(column))?),
            }
        }
        let mut frame: Option<(&str, usize)> = None;
        let mut modal_call = false;
        let mut sub: Option<(&str, usize)> = None;
        for (word, column) in keywords {
            match word {
                "SUPA" => machine = true,
                "CIP" | "CT" => {
                    self.modes.motion = if word == "CIP" { Move::Through } else { Move::Tangent };
                    motions += 1;
                }
                "TRANS" | "ATRANS" | "ROT" | "AROT" | "SCALE" | "ASCALE" | "MIRROR" | "AMIRROR" => {
                    frame = Some((word, column))
                }
                "MCALL" => modal_call = true,
                "RET" => m.push((17, column)),
                "DIAMON" => {
                    return Err(Fault::at(
                        column,
                        "DIAMON is a word of lathes; SINUMERIK programs are followed for mills",
                    ));
                }
                _ if QUIET.contains(&word) => {}
                _ => sub = Some((word, column)),
            }
        }
        if motions > 1 {
            return Err(Fault::new("two motions stand in one block; give each a block of its own"));
        }
        if dwell {
            self.dwell(&mut values, kernel)?;
        } else {
            self.technology(&mut values, kernel)?;
        }
        if named_tool {
            self.modes.next_tool = None;
            kernel.note("a tool is called by its name, so its number is not known");
            if self.turret {
                kernel.change_tool(None);
            }
        }
        let (before, after): (Vec<_>, Vec<_>) =
            m.into_iter().partition(|(code, _)| !matches!(code, 0 | 1 | 2 | 5 | 9 | 17 | 30));
        for (code, _) in before {
            self.function(code, kernel);
        }
        if modal_call {
            self.modal = None;
        }
        for (word, arguments, column) in calls {
            let mut list = Vec::with_capacity(arguments.len());
            for argument in arguments {
                list.push(argument.as_ref().map(|argument| self.value(argument)).transpose()?);
            }
            if word == "MSG" {
                continue;
            }
            self.cycle(word, &list, modal_call, kernel).map_err(|fault| fault.or_at(column))?;
        }
        if let Some((word, column)) = frame {
            self.frame(word, &mut values, kernel).map_err(|fault| fault.or_at(column))?;
        } else if home {
            let axes: Vec<usize> = (0..6)
                .filter(|axis| {
                    values
                        .take(&format!("{}1", AXES[*axis]))
                        .or_else(|| values.take(&AXES[*axis].to_string()))
                        .is_some()
                })
                .collect();
            kernel.machine_motion(&axes)?;
            kernel.push(EventKind::Home);
        } else if machine {
            let axes: Vec<usize> = (0..6).filter(|axis| values.take(&AXES[*axis].to_string()).is_some()).collect();
            // D0 and G0 of the block have been taken; the axes go where only the machine knows.
            kernel.machine_motion(&axes)?;
        } else if !dwell {
            kernel.moved = false;
            self.motion(&mut values, kernel)?;
            if kernel.moved {
                if stop || kernel.exact {
                    kernel.push(EventKind::ExactStop);
                }
                if let Some(modal) = self.modal.clone() {
                    self.bore(&modal, kernel)?;
                }
            }
        }
        if let Some((_, column)) = sub.filter(|_| modal_call) {
            return Err(Fault::at(column, "MCALL of a subprogram is not followed; call it behind each place"));
        }
        if let Some((word, column)) = sub {
            let count = values.take("P").map_or(1.0, |(count, ..)| count);
            if !(0.0..=1e8).contains(&count) {
                return Err(Fault::at(column, format!("P={count} is no number of runs")));
            }
            let line = kernel.line;
            self.call(word, count as u32, line).map_err(|fault| fault.or_at(column))?;
        } else if let Some((number, _, column)) = values.take("L") {
            let count = values.take("P").map_or(1.0, |(count, ..)| count);
            let line = kernel.line;
            self.call(&format!("L{number}"), count.clamp(0.0, 1e8) as u32, line)
                .map_err(|fault| fault.or_at(column))?;
        }
        if let Some(left) = values.0.iter().find(|own| !own.used) {
            let message = format!(
                "{} {} has no meaning for siemens in this block; it might move axes or take time: mend the block",
                left.address, left.value
            );
            return Err(Fault::at(left.column, message));
        }
        for (code, _) in after {
            match code {
                0 => kernel.push(EventKind::Stop(false)),
                1 => kernel.push(EventKind::Stop(true)),
                5 => kernel.spindle(Sense::Still),
                9 => kernel.push(EventKind::Coolant(false)),
                _ => {
                    kernel.push(EventKind::Auxiliary(code, 0.0));
                    if matches!(code, 2 | 30) || !self.back() {
                        kernel.end()?;
                        return Ok(Flow::Ended);
                    }
                }
            }
        }
        Ok(Flow::Going)
    }

    /// A modal code; whether it chooses a motion.
    fn code(&mut self, code: u32, values: &mut Values, kernel: &mut Kernel) -> Result<bool, Fault> {
        match code {
            0 => self.modes.motion = Move::Rapid,
            1 => self.modes.motion = Move::Line,
            2 | 3 => self.modes.motion = Move::Arc { left: code == 3 },
            17..=19 => {
                let plane = [[0, 1, 2], [2, 0, 1], [1, 2, 0]][code as usize - 17];
                if plane != kernel.plane && kernel.offset.is_some() {
                    return Err(Fault::new(
                        "the plane changes while the compensation of the radius is in force; end it before",
                    ));
                }
                kernel.plane = plane;
            }
            40..=42 => self.compensate(code, kernel)?,
            450 => self.modes.corner = Corner::Round,
            451 => self.modes.corner = Corner::Extended,
            60 => kernel.exact = true,
            64 | 641..=645 => {
                kernel.exact = false;
                values.take("ADIS");
                values.take("ADISPOS");
            }
            601..=603 | 62 => {}
            70 | 700 | 71 | 710 => {
                kernel.scale = Some(if matches!(code, 70 | 700) { 25.4 } else { 1.0 });
                // With G70 and G71 feeds stay in the basic unit of the control.
                self.store.named.insert("$FEED_UNIT".to_owned(), if code == 700 { 25.4 } else { 1.0 });
                if code == 70 {
                    kernel.note("with G70 feeds stay in the basic unit of the control, taken as mm");
                }
            }
            90 => kernel.absolute = true,
            91 => kernel.absolute = false,
            93..=95 => {
                let mode = [FeedMode::Inverse, FeedMode::Minute, FeedMode::Revolution][code as usize - 93];
                if mode != kernel.feed_mode {
                    kernel.feed_mode = mode;
                    kernel.feed = None;
                }
            }
            97 => {}
            96 => {
                return Err(Fault::new(
                    "constant surface speed is one of lathes; SINUMERIK programs are followed for mills",
                ));
            }
            54..=57 | 500 | 505..=599 => {
                if self.modes.work != code {
                    // The first offset is the one in which the program counts.
                    if self.modes.work != 500 || kernel.known.iter().take(3).all(|known| *known) && code == 500 {
                        kernel.forget(0..3);
                    }
                    self.modes.work = code;
                }
            }
            _ => {
                let Some(time) = kernel.control.g.get(&(10 * code)).copied() else {
                    return Err(Fault::new(unknown(&format!("G{code}"), "g", &code.to_string())));
                };
                kernel.dwell(time)?;
            }
        }
        Ok(code <= 3)
    }

    fn compensate(&mut self, code: u32, kernel: &mut Kernel) -> Result<(), Fault> {
        kernel.finish_offset()?;
        if code == 40 {
            return Ok(());
        }
        let diameters = &kernel.control.diameters;
        let number = kernel.tool.or(self.modes.next_tool);
        let known =
            number.and_then(|number| diameters.get(&number)).or_else(|| diameters.get(&self.modes.edge)).copied();
        let Some(diameter) = known else {
            let edge = number.unwrap_or(self.modes.edge);
            kernel.note(format!(
                "the diameter of the tool is not known, so the contour is timed as programmed: give --tool D{edge}=\"10 mm\""
            ));
            return Ok(());
        };
        kernel.offset = Some(Offsetting::new(code == 41, 0.5 * diameter, kernel.plane, self.modes.corner));
        Ok(())
    }

    fn dwell(&mut self, values: &mut Values, kernel: &mut Kernel) -> Result<(), Fault> {
        let (seconds, turns) = (values.take("F"), values.take("S"));
        let time = match (seconds, turns) {
            (Some((seconds, ..)), None) => seconds,
            (None, Some((turns, _, column))) => {
                if kernel.speed <= 0.0 {
                    return Err(Fault::at(
                        column,
                        "S of G4 counts turns of the spindle, but no speed stands before it",
                    ));
                }
                60.0 * turns / kernel.speed
            }
            _ => {
                return Err(Fault::new("the length of the dwell is missing: write F (seconds) or S (turns) behind G4"));
            }
        };
        kernel.dwell(time)
    }

    fn technology(&mut self, values: &mut Values, kernel: &mut Kernel) -> Result<(), Fault> {
        if kernel.feed_mode == FeedMode::Inverse && !values.has("F") {
            kernel.feed = None;
        }
        if let Some((feed, _, column)) = values.take("F") {
            let scale = match kernel.feed_mode {
                FeedMode::Inverse => 1.0,
                FeedMode::Minute | FeedMode::Revolution => {
                    if feed != 0.0 {
                        kernel.unit().map_err(|fault| fault.or_at(column))?;
                    }
                    let given = self.store.named.get("$FEED_UNIT").copied();
                    given.unwrap_or_else(|| kernel.scale.unwrap_or(1.0))
                }
            };
            kernel.set_feed(feed, scale).map_err(|fault| fault.or_at(column))?;
        }
        if let Some((speed, _, column)) = values.take("S").or_else(|| values.take("S1")) {
            kernel.set_speed(speed).map_err(|fault| fault.or_at(column))?;
        }
        if let Some((edge, ..)) = values.take("D") {
            self.modes.edge = edge.clamp(0.0, 1e6) as u32;
        }
        values.take("H");
        if let Some((tool, _, column)) = values.take("T") {
            if !(0.0..=1e8).contains(&tool) {
                return Err(Fault::at(column, format!("T{tool} is no tool number")));
            }
            self.modes.next_tool = Some(tool as u32);
            if self.turret && tool > 0.0 && kernel.tool != self.modes.next_tool {
                kernel.change_tool(self.modes.next_tool);
            }
        }
        Ok(())
    }

    fn function(&mut self, code: u32, kernel: &mut Kernel) {
        match code {
            3 => kernel.spindle(Sense::Clockwise),
            4 => kernel.spindle(Sense::Counterclockwise),
            6 => kernel.change_tool(self.modes.next_tool),
            7 | 8 => kernel.push(EventKind::Coolant(true)),
            19 => kernel.spindle(Sense::Still),
            _ => {
                let time = kernel.control.m.get(&code).copied();
                if time.is_none() {
                    kernel.note(format!(
                        "M{code} is a function of the machine whose time is not known; it counts 0 s: give --set control.m.{code}=\"1 s\""
                    ));
                }
                kernel.push(EventKind::Auxiliary(code, time.unwrap_or(0.0)));
            }
        }
    }

    fn frame(&mut self, word: &str, values: &mut Values, kernel: &mut Kernel) -> Result<(), Fault> {
        let mut parts: [Option<f64>; 9] = [None; 9];
        for (axis, part) in parts.iter_mut().enumerate() {
            *part = values.take(&AXES[axis].to_string()).map(|(value, ..)| value);
        }
        let (added, kind) = word.strip_prefix('A').map_or((false, word), |kind| (true, kind));
        let base = if added { self.modes.frame } else { Frame::IDENTITY };
        let own = match kind {
            "TRANS" => {
                let mut shift = [0.0; 9];
                for axis in 0..9 {
                    let value = parts[axis].unwrap_or(0.0);
                    shift[axis] = if (3..6).contains(&axis) { value } else { kernel.length(value)? };
                }
                Frame::shifted(shift)
            }
            "ROT" => {
                let angle = match values.take("RPL") {
                    Some((angle, ..)) => angle,
                    None => {
                        let w = kernel.plane[2];
                        if (0..3).any(|axis| axis != w && parts[axis].is_some_and(|angle| angle != 0.0)) {
                            return Err(Fault::new(
                                "a rotation out of the plane is not followed; post the motions in machine axes",
                            ));
                        }
                        parts[w].unwrap_or(0.0)
                    }
                };
                Frame::turned(angle, kernel.plane, [0.0; 2])
            }
            "SCALE" => {
                let factors = std::array::from_fn(|axis| parts[axis].unwrap_or(1.0));
                if factors.iter().any(|factor: &f64| !(1e-6..=1e6).contains(factor)) {
                    return Err(Fault::new("factors of SCALE must be above 0"));
                }
                Frame::scaled(factors, [0.0; 3])
            }
            _ => {
                let factors = std::array::from_fn(|axis| if parts[axis].is_some() { -1.0 } else { 1.0 });
                Frame::scaled(factors, [0.0; 3])
            }
        };
        self.modes.frame = base.after(&own);
        kernel.frame = self.modes.frame;
        Ok(())
    }

    fn motion(&mut self, values: &mut Values, kernel: &mut Kernel) -> Result<(), Fault> {
        let mut target = Target::default();
        let mut column = 0;
        for (axis, letter) in AXES.iter().enumerate() {
            let Some((value, count, at)) = values.take(&letter.to_string()) else { continue };
            column = at;
            let value =
                if (3..6).contains(&axis) { value } else { kernel.length(value).map_err(|fault| fault.or_at(at))? };
            let absolute = match count {
                Count::Modal => kernel.absolute,
                Count::Absolute => true,
                Count::Step => false,
            };
            if absolute { target.absolute[axis] = Some(value) } else { target.step[axis] = Some(value) }
        }
        let centred = ["I", "J", "K", "CR", "AR", "TURN"].iter().any(|word| values.has(word));
        if target.is_empty() && !centred {
            return Ok(());
        }
        let start = kernel.at;
        match self.modes.motion {
            Move::Rapid => kernel.straight(&target, true),
            Move::Line => kernel.straight(&target, false),
            Move::Arc { left } => self.arc(left, target, values, kernel),
            Move::Through => self.through(&target, values, kernel),
            Move::Tangent => self.tangent(&target, kernel),
        }
        .map_err(|fault| fault.or_at(column))?;
        if let Some(motion) = kernel.out.iter().rev().find_map(|event| match event.kind {
            EventKind::Motion(motion) => Some(motion),
            _ => None,
        }) {
            self.modes.direction = motion.directions().1;
        } else if start != kernel.at {
            self.modes.direction = [0.0; 3];
        }
        Ok(())
    }

    fn arc(&mut self, left: bool, mut target: Target, values: &mut Values, kernel: &mut Kernel) -> Result<(), Fault> {
        let [u, v, w] = kernel.plane;
        let letters = ["I", "J", "K"];
        let from = kernel.program_at();
        let turns = values.take("TURN").map_or(0.0, |(turns, ..)| turns);
        let mut centre: Option<[f64; 2]> = None;
        for (slot, axis) in [u, v].into_iter().enumerate() {
            if let Some((value, count, _)) = values.take(letters[axis]) {
                let value = kernel.length(value)?;
                let middle = centre.get_or_insert([from[u], from[v]]);
                middle[slot] = if count == Count::Absolute { value } else { from[axis] + value };
            }
        }
        if let Some((value, _, column)) = values.take(letters[w])
            && value != 0.0
        {
            return Err(Fault::at(
                column,
                format!("{} is no part of an arc in this plane; choose the plane before", letters[w]),
            ));
        }
        let radius = values.take("CR");
        let opening = values.take("AR");
        let end = |axis: usize| target.absolute[axis].unwrap_or(from[axis] + target.step[axis].unwrap_or(0.0));
        let (start, stop) = ([from[u], from[v]], [end(u), end(v)]);
        let sign = if left { 1.0 } else { -1.0 };
        let round = match (centre, radius, opening) {
            (Some(centre), None, None) => Round::Centre(centre),
            (None, Some((radius, ..)), None) => Round::Radius(kernel.length(radius)?),
            (Some(centre), None, Some((angle, ..))) => {
                if target.names(u) || target.names(v) {
                    return Err(Fault::new("an arc by its opening angle takes its centre or its end, not both"));
                }
                if !(angle > 0.0 && angle < 360.0) {
                    return Err(Fault::new("AR is an angle above 0 and below 360 degrees"));
                }
                let (sin, cos) = crate::frame::turn(sign * angle);
                let arm = [start[0] - centre[0], start[1] - centre[1]];
                (target.absolute[u], target.step[u]) = (Some(centre[0] + cos * arm[0] - sin * arm[1]), None);
                (target.absolute[v], target.step[v]) = (Some(centre[1] + sin * arm[0] + cos * arm[1]), None);
                Round::Centre(centre)
            }
            (None, None, Some((angle, ..))) => {
                let chord = (stop[0] - start[0]).hypot(stop[1] - start[1]);
                if !(angle > 0.0 && angle < 360.0) || chord == 0.0 {
                    return Err(Fault::new(
                        "AR needs an end apart from the start and an angle between 0 and 360 degrees",
                    ));
                }
                let radius = 0.5 * chord / (0.5 * angle).to_radians().sin();
                Round::Radius(if angle > 180.0 { -radius } else { radius })
            }
            (None, None, None) => return Err(Fault::new("an arc needs I, J, K, CR= or AR=")),
            _ => return Err(Fault::new("the arc is given twice, by I J K, CR= or AR=; leave one")),
        };
        kernel.round(&target, round, left, turns)
    }

    /// An arc through the point I1 J1 K1.
    fn through(&mut self, target: &Target, values: &mut Values, kernel: &mut Kernel) -> Result<(), Fault> {
        let [u, v, w] = kernel.plane;
        let from = kernel.program_at();
        let mut middle = from;
        for (axis, address) in ["I1", "J1", "K1"].into_iter().enumerate() {
            if let Some((value, count, _)) = values.take(address) {
                let value = kernel.length(value)?;
                let absolute = count == Count::Absolute || (count == Count::Modal && kernel.absolute);
                middle[axis] = if absolute { value } else { from[axis] + value };
            }
        }
        let end = |axis: usize| target.absolute[axis].unwrap_or(from[axis] + target.step[axis].unwrap_or(0.0));
        if (end(w) - from[w]).abs() > 1e-9 || (middle[w] - from[w]).abs() > 1e-9 {
            return Err(Fault::new("an arc through a point out of the plane is not followed; write it in the plane"));
        }
        let (a, b, c) = ([from[u], from[v]], [middle[u], middle[v]], [end(u), end(v)]);
        let (centre, left) = circle(a, b, c).ok_or_else(|| Fault::new("the three points of the arc lie on a line"))?;
        kernel.round(target, Round::Centre(centre), left, 0.0)
    }

    /// An arc that begins in the direction of the last motion.
    fn tangent(&mut self, target: &Target, kernel: &mut Kernel) -> Result<(), Fault> {
        if kernel.frame != Frame::IDENTITY && kernel.frame.matrix != Frame::IDENTITY.matrix {
            return Err(Fault::new("CT within a rotation or scale is not followed; write the arc with CR="));
        }
        let [u, v, _] = kernel.plane;
        let from = kernel.program_at();
        let end = |axis: usize| target.absolute[axis].unwrap_or(from[axis] + target.step[axis].unwrap_or(0.0));
        let direction = [self.modes.direction[u], self.modes.direction[v]];
        match tangent([from[u], from[v]], [end(u), end(v)], direction) {
            Some((centre, left)) => kernel.round(target, Round::Centre(centre), left, 0.0),
            None if direction == [0.0; 2] => {
                Err(Fault::new("CT needs a motion before it in whose direction the arc begins"))
            }
            None => kernel.straight(target, false),
        }
    }
}
