//! Holes of canned cycles, as the motions that a control makes of them.

use crate::error::Fault;
use crate::kernel::{Kernel, Target};
use crate::motion::{EventKind, Purpose, Sense};

/// How the tool leaves the bottom.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Exit {
    /// At rapid speed.
    Rapid,
    /// At the feed of the cycle, up to the reference plane.
    Feed,
    /// At the feed of the cycle all the way.
    FeedAllTheWay,
    /// At another feed, mm/min.
    FeedOf(f64),
    /// The spindle turns the other way, at feed.
    Tap,
    /// The same at another feed, mm/min or a revolution as the feed counts.
    TapAt(f64),
    /// The spindle stands, at rapid speed.
    Stopped,
    /// The spindle stands oriented and the tool is shifted by so much in the plane.
    Shifted([f64; 2]),
    /// The operator draws the tool out.
    Operator,
}

impl Exit {
    fn is_tap(self) -> bool {
        matches!(self, Self::Tap | Self::TapAt(_))
    }
}

/// Depths that are drilled one after the other.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Pecks {
    /// Depths below the reference plane, mm, rising up to the whole depth.
    pub stops: Vec<f64>,
    /// Distance of retraction between pecks, mm; `None` draws out to the reference plane.
    pub retract: Option<f64>,
    /// Distance above the last depth at which feed begins again, mm; a control may take it from the depth.
    pub clearance: Clearance,
    /// After so many retractions within the hole comes one to the reference plane; 0 means none.
    pub breaks: usize,
    /// Dwell outside, s, and at the bottom of each peck, s.
    pub outside: f64,
    pub inside: f64,
    /// Whether the tool is drawn up within the hole at feed, and out of it at feed, that of the exit where it has one.
    pub slow_within: bool,
    pub slow_out: bool,
    /// Feed of the first peck over that of the others.
    pub first: f64,
}

impl Pecks {
    /// Pecks between which the tool retracts at rapid speed, without dwell.
    pub fn new(stops: Vec<f64>, retract: Option<f64>, clearance: Clearance) -> Self {
        Self {
            stops,
            retract,
            clearance,
            breaks: 0,
            outside: 0.0,
            inside: 0.0,
            slow_within: false,
            slow_out: false,
            first: 1.0,
        }
    }
}

/// Distance above the last depth at which feed begins again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Clearance {
    /// mm.
    Fixed(f64),
    /// 0.6 mm up to a depth of 30 mm, then a fiftieth of the depth, at most 7 mm: CYCLE83 of SINUMERIK, cycle 1 of
    /// Heidenhain (cited from memory of their manuals: assumption).
    Depth,
}

impl Clearance {
    fn at(self, depth: f64) -> f64 {
        match self {
            Self::Fixed(clearance) => clearance,
            Self::Depth if depth <= 30.0 => 0.6,
            Self::Depth => (depth / 50.0).min(7.0),
        }
    }
}

/// Depths of a hole: the first peck, each next one less by `decrement` but not below `least`.
pub(crate) fn stops(depth: f64, first: f64, decrement: f64, least: f64) -> Result<Vec<f64>, Fault> {
    let (mut list, mut step, mut reached) = (Vec::new(), first, 0.0);
    while depth - reached > 1e-9 {
        if list.len() >= PECKS || step <= 0.0 {
            return Err(Fault::new(format!("a hole in more than {PECKS} pecks; check the depth of one")));
        }
        reached = (reached + step).min(depth);
        list.push(reached);
        step = (step - decrement).max(least);
    }
    Ok(list)
}

/// A hole along the axis across the plane, program coordinates in mm.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Hole {
    /// Where feed begins.
    pub reference: f64,
    pub bottom: f64,
    /// Where the tool goes at the end.
    pub level: f64,
    pub pecks: Option<Pecks>,
    /// Dwell at the bottom, s.
    pub dwell: f64,
    pub exit: Exit,
    /// Feed of plunging, mm/min, where it is none of the program's.
    pub feed: Option<f64>,
}

/// Greatest number of pecks of one hole: a bound against programs without end (assumption).
pub(crate) const PECKS: usize = 100_000;

impl Kernel {
    fn across(&mut self, place: f64, rapid: bool) -> Result<(), Fault> {
        self.straight(&Target::one(self.plane[2], place), rapid)
    }

    /// Bores a hole where the tool stands.
    pub fn hole(&mut self, hole: &Hole) -> Result<(), Fault> {
        if self.feed.is_none() && hole.feed.is_none() {
            return Err(self.no_feed());
        }
        let (feed, scale) = (self.feed, self.feed_scale);
        self.purpose = Some(if hole.exit.is_tap() { Purpose::Thread } else { Purpose::Cycle });
        if let Some(feed) = hole.feed {
            self.set_feed(feed, 1.0)?;
        }
        let done = self.bore(hole);
        self.purpose = None;
        (self.feed, self.feed_scale) = (feed, scale);
        done?;
        self.push(EventKind::Hole);
        Ok(())
    }

    fn bore(&mut self, hole: &Hole) -> Result<(), Fault> {
        let down = if hole.bottom <= hole.reference { -1.0 } else { 1.0 };
        self.across(hole.reference, true)?;
        match &hole.pecks {
            Some(pecks) if !pecks.stops.is_empty() => {
                let last = pecks.stops.len() - 1;
                for (count, reached) in pecks.stops.iter().copied().enumerate() {
                    let to = if count == last { hole.bottom } else { hole.reference + down * reached };
                    if count == 0 && pecks.first != 1.0 {
                        let feed = self.feed.ok_or_else(|| self.no_feed())?;
                        self.along_at(pecks.first * feed, to)?;
                    } else {
                        self.across(to, false)?;
                    }
                    if count == last {
                        break;
                    }
                    self.dwell(pecks.inside)?;
                    if hole.exit.is_tap() {
                        self.reverse();
                        self.out_of_thread(hole, reached, pecks, down)?;
                        self.reverse();
                        continue;
                    }
                    let clears = pecks.breaks > 0 && (count + 1) % (pecks.breaks + 1) == 0;
                    match pecks.retract.filter(|_| !clears) {
                        Some(retract) => {
                            self.across(hole.reference + down * (reached - retract).max(0.0), !pecks.slow_within)?;
                        }
                        None => {
                            if let (true, Exit::FeedOf(feed)) = (pecks.slow_out, hole.exit) {
                                self.along_at(feed, hole.reference)?;
                            } else {
                                self.across(hole.reference, !pecks.slow_out)?;
                            }
                            self.dwell(pecks.outside)?;
                            let again = (reached - pecks.clearance.at(reached)).max(0.0);
                            self.across(hole.reference + down * again, true)?;
                        }
                    }
                }
            }
            _ => self.across(hole.bottom, false)?,
        }
        self.dwell(hole.dwell)?;
        self.leave(hole)
    }

    /// Between pecks of a tap the tool is drawn out at feed.
    fn out_of_thread(&mut self, hole: &Hole, reached: f64, pecks: &Pecks, down: f64) -> Result<(), Fault> {
        let up = pecks.retract.map_or(0.0, |retract| (reached - retract).max(0.0));
        self.across(hole.reference + down * up, false)
    }

    fn reverse(&mut self) {
        if !self.sense.stands() {
            self.spindle(self.sense.reversed());
        }
    }

    fn leave(&mut self, hole: &Hole) -> Result<(), Fault> {
        let sense = self.sense;
        match hole.exit {
            Exit::Rapid => {}
            Exit::Feed => self.across(hole.reference, false)?,
            Exit::FeedAllTheWay => return self.across(hole.level, false),
            Exit::FeedOf(feed) => self.along_at(feed, hole.reference)?,
            Exit::TapAt(feed) => {
                self.reverse();
                self.along_at(feed, hole.reference)?;
                self.reverse();
            }
            Exit::Tap => {
                self.reverse();
                self.across(hole.reference, false)?;
                self.reverse();
            }
            Exit::Stopped => {
                self.spindle(Sense::Still);
                self.across(hole.level, true)?;
                self.restart(sense);
                return Ok(());
            }
            Exit::Shifted(shift) => {
                let [u, v, _] = self.plane;
                let mut step = Target::default();
                (step.step[u], step.step[v]) = (Some(shift[0]), Some(shift[1]));
                let mut target = Target::default();
                (target.step[u], target.step[v]) = (Some(-shift[0]), Some(-shift[1]));
                self.spindle(Sense::Oriented);
                self.straight(&step, true)?;
                self.across(hole.level, true)?;
                self.straight(&target, true)?;
                self.restart(sense);
                return Ok(());
            }
            Exit::Operator => {
                self.spindle(Sense::Still);
                self.push(EventKind::Stop(false));
                self.across(hole.level, true)?;
                self.restart(sense);
                return Ok(());
            }
        }
        self.across(hole.level, true)
    }

    /// Moves along the hole at another feed, mm/min.
    fn along_at(&mut self, feed: f64, place: f64) -> Result<(), Fault> {
        let (before, scale) = (self.feed, self.feed_scale);
        self.set_feed(feed, 1.0)?;
        self.across(place, false)?;
        (self.feed, self.feed_scale) = (before, scale);
        Ok(())
    }

    fn restart(&mut self, sense: Sense) {
        if !sense.stands() {
            self.spindle(sense);
        }
    }

    /// Back boring: down beside the hole, to its middle, up at feed, and out the same way.
    pub fn back_bore(&mut self, below: f64, top: f64, level: f64, shift: [f64; 2], dwell: f64) -> Result<(), Fault> {
        let [u, v, _] = self.plane;
        let sense = self.sense;
        let aside = |sign: f64| {
            let mut step = Target::default();
            (step.step[u], step.step[v]) = (Some(sign * shift[0]), Some(sign * shift[1]));
            step
        };
        self.purpose = Some(Purpose::Cycle);
        let done: Result<(), Fault> = (|| {
            self.spindle(Sense::Oriented);
            self.straight(&aside(1.0), true)?;
            self.across(below, true)?;
            self.straight(&aside(-1.0), true)?;
            self.restart(sense);
            self.across(top, false)?;
            self.dwell(dwell)?;
            self.spindle(Sense::Oriented);
            self.straight(&aside(1.0), true)?;
            self.across(level, true)?;
            self.straight(&aside(-1.0), true)?;
            self.restart(sense);
            Ok(())
        })();
        self.purpose = None;
        done?;
        self.push(EventKind::Hole);
        Ok(())
    }
}
