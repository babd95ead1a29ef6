//! Effects that timed stretches of part programs are asked for, and why others are not.

use super::action::{Action, EACH_ALIKE};
use super::rows::Rows;
use super::{ProgramModel, Stretches};
use crate::{Candidate, EffectId, Untried, search};
use std::collections::BTreeSet;
use toolroom_drives::{Deviation, Drives};
use toolroom_form::significant as rounded;
use toolroom_program::{Action as Happens, Block};
use toolroom_scenario::effects::{PROGRAM_EFFECTS, SHOP_EFFECTS};

/// Corner deviations, um, and jerk times, ms, with which an acceleration is tried (assumptions). The least
/// deviations are those of controllers that nearly stop at every corner.
const CORNERS: [f64; 5] = [0.01, 0.1, 1.0, 10.0, 100.0];
const JERKS: [f64; 3] = [0.0, 10.0, 30.0];

/// Base speeds of a spindle over its greatest speed, with which a ramp is tried: from constant power throughout to constant
/// torque throughout (assumptions).
const BASES: [f64; 5] = [0.0, 0.15, 0.3, 0.5, 1.0];
/// Settling behind a rapid motion over that behind a motion at feed (assumptions).
const BEHIND_RAPID: [f64; 3] = [0.0, 0.15, 1.0];
/// Times of blocks, ms, at which a block time is looked for (assumptions): from a control of today to one of the eighties.
const BLOCKS: [f64; 4] = [4.0, 8.0, 16.0, 64.0];

/// Corner deviations over that of the file at which slower corners are looked for (assumptions). Several are tried, since a corner that
/// the file lets pass at full speed is slowed only by a deviation that is far less.
const TIGHTER: [f64; 3] = [0.5, 0.1, 0.01];

/// Speeds of the spindle that tell a ramp from a constant time of every start. Source: two give the constant and the ramp, a third
/// its base speed.
const SPEEDS: usize = 3;
/// Rapid motions that tell settling behind them from that behind motions at feed (assumption).
const RAPIDS: usize = 30;

impl ProgramModel {
    fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.programs.iter().flat_map(|(_, program)| &program.blocks)
    }

    /// Speeds of the spindle that the programs command, rad/s, by their bits.
    fn speeds(&self) -> BTreeSet<u64> {
        let speeds = self.blocks().flat_map(|block| &block.actions).filter_map(|(_, action)| match action {
            Happens::Spindle(speed, _) => Some(speed * std::f64::consts::TAU / 60.0),
            Happens::Coolant(_) | Happens::Stop | Happens::Change(_) | Happens::Home(_) | Happens::End => None,
        });
        // Positive numbers are in the order of their bits.
        speeds.filter(|speed| *speed > 0.0).map(f64::to_bits).collect()
    }

    fn rapids(&self) -> usize {
        self.blocks().flat_map(|block| &block.motions).filter(|motion| motion.rapid).count()
    }
}

/// Whether changes to pockets of different distances are among the rows: else the distance is a constant of every change.
fn distances_differ(rows: &Rows) -> bool {
    // Of a change from a tool that is not known nobody knows the distance.
    let changes =
        rows.changes.iter().zip(&rows.pockets).filter(|(changes, pockets)| **changes > 0.0 && **pockets > 0.0);
    let mut distances = changes.map(|(changes, pockets)| pockets / changes);
    distances.next().is_some_and(|first| distances.any(|other| (other - first).abs() > 1e-9))
}

impl Stretches {
    /// Lists the candidates and what is not tried; of `whole` runs nobody knows the blocks.
    pub(super) fn catalogue(&mut self, whole: bool) {
        self.features_of_events();
        let mut untried: Vec<Untried> = Vec::new();
        if !whole {
            self.axes(&mut untried);
            self.spindle_and_changer(&mut untried);
        }
        for catalogue in [SHOP_EFFECTS, PROGRAM_EFFECTS] {
            let told = |id: EffectId| untried.iter().any(|own| own.id == id);
            let others = search::missing(catalogue, &self.frame.candidates).into_iter().filter(|own| !told(own.id));
            untried.extend(others.collect::<Vec<_>>());
        }
        self.frame.untried = untried;
    }

    fn add(&mut self, id: EffectId, shape: String, typical: f64, action: Action) {
        let greatest = id.entry().size.max;
        self.frame.candidates.push(Candidate { id, shape, typical, greatest, least: 0.0, onset: 0.0 });
        self.actions.push(action);
    }

    /// An effect that may do nothing up to its ordinary size.
    fn add_late(&mut self, id: EffectId, shape: String, typical: f64, deviation: Deviation) {
        self.add(id, shape, typical, Action::Drives(deviation));
        self.frame.candidates.iter_mut().last().expect("the one that was added").onset = 1.0;
    }

    /// A time on rows, where any has it.
    fn feature(&mut self, id: EffectId, shape: &str, typical: f64, feature: Vec<f64>) -> bool {
        let acts = feature.iter().any(|value| *value != 0.0);
        if acts {
            self.add(id, shape.to_owned(), typical, Action::Feature(self.features.len()));
            self.features.push(feature);
        }
        acts
    }

    fn features_of_events(&mut self) {
        let rows = &self.rows;
        let known = [
            (EffectId::FEED_OVERRIDE, "as logged", 1.0, rows.overridden.clone()),
            (EffectId::TOOL_CHANGE_DELAY, "", 5.0, rows.changes.clone()),
            (EffectId::CANNED_CYCLE_DWELL, "", 1.0, rows.holes.clone()),
            (EffectId::FEED_HOLD, EACH_ALIKE, 10.0, rows.holds.clone()),
            (EffectId::FEED_HOLD, "as long as logged", 10.0, rows.hold_share.clone()),
        ];
        for (id, shape, typical, feature) in known {
            self.feature(id, shape, typical, feature);
        }
    }

    /// Accelerations, corners, settling and the preparation of blocks.
    fn axes(&mut self, untried: &mut Vec<Untried>) {
        let drives = self.model.accelerated(&self.model.drives);
        // Of drives that accelerate corners and jerk are known, and deviate by effects of their own.
        let accelerates = drives.inverse_acceleration > 0.0;
        let all = || CORNERS.into_iter().flat_map(|corner| JERKS.map(|jerk| (1e-6 * corner, 1e-3 * jerk))).collect();
        let own = (drives.corner_deviation, drives.jerk_time);
        let shapes: Vec<(f64, f64)> = if accelerates { vec![own] } else { all() };
        for (corner_deviation, jerk_time) in shapes {
            let mut shape = format!("corners within {} um", rounded(corner_deviation * 1e6));
            if jerk_time > 0.0 {
                shape += &format!(", jerk time {} ms", rounded(jerk_time * 1e3));
            }
            let deviation = Deviation::Acceleration { corner_deviation, jerk_time };
            self.add(EffectId::AXIS_ACCELERATION, shape, 0.5, Action::Drives(deviation));
        }
        let mut untold = |id: EffectId, reason: &str| untried.push(Untried { id, reason: reason.to_owned() });
        if accelerates {
            let rapid = Action::Drives(Deviation::RapidAcceleration);
            self.add(EffectId::RAPID_ACCELERATION, String::new(), 0.2, rapid);
            self.add(EffectId::JERK, String::new(), 0.02, Action::Drives(Deviation::Jerk));
            if drives.corner_step > 0.0 || drives.corner_cosine >= 0.5 {
                untold(EffectId::CORNER_SLOWING, "corners of this machine follow another rule than a deviation");
            } else {
                for share in TIGHTER {
                    let shape = format!("looked for at {} um", rounded(1e6 * share * drives.corner_deviation));
                    let size = (1.0 / share - 1.0) / drives.corner_deviation;
                    self.add_late(EffectId::CORNER_SLOWING, shape, size, Deviation::CornerSlowing);
                }
            }
        } else {
            let reason = "the model has no acceleration yet: that of the axes is tried for all motions, with corner deviations and jerk times";
            for id in [EffectId::RAPID_ACCELERATION, EffectId::JERK, EffectId::CORNER_SLOWING] {
                untold(id, reason);
            }
        }
        self.blocks();
        for rapid in BEHIND_RAPID {
            let shape = format!("{} of it behind rapid motions", rounded(rapid));
            self.add(EffectId::STOP_SETTLING, shape, 0.2, Action::Drives(Deviation::StopSettling { rapid }));
        }
        let rapids = self.model.rapids();
        if rapids < RAPIDS {
            self.frame.notes.push(format!(
                "stop_settling and jerk are told apart by stops at several feeds, and from rapid motions by {RAPIDS} of these or more: the programs have {rapids}"
            ));
        }
    }

    /// Block times that are longer than the shortest block of these programs. A block time below that changes nothing, so that the
    /// derivative is taken from none to times of today's and of older controls.
    fn blocks(&mut self) {
        let own = self.model.drives.block_time;
        let motions = self.model.blocks().flat_map(|block| &block.motions);
        let shortest = motions.filter(|motion| !motion.rapid && motion.time > 0.0).map(|motion| motion.time);
        let shortest = shortest.fold(f64::INFINITY, f64::min);
        for time in BLOCKS.map(|time| 1e-3 * time).into_iter().filter(|time| own + time > shortest) {
            let shape = format!("looked for at {} ms", rounded(1e3 * (own + time)));
            self.add_late(EffectId::BLOCK_TIME, shape, time, Deviation::BlockTime);
        }
    }

    fn spindle_and_changer(&mut self, untried: &mut Vec<Untried>) {
        let drives: Drives = self.model.drives;
        let speeds = self.model.speeds();
        if let Some(reference_speed) = speeds.last().map(|bits| f64::from_bits(*bits)) {
            // A spindle that ramps already only gets slower: its base speed is known.
            let known = (drives.spindle_constant > 0.0).then_some(drives.spindle_base_speed);
            let all = || BASES.map(|share| share * reference_speed).to_vec();
            for base_speed in known.map_or_else(all, |base| vec![base]) {
                let rpm = |speed: f64| rounded(speed * 60.0 / std::f64::consts::TAU);
                let shape = format!("from rest to {} rpm, base speed {} rpm", rpm(reference_speed), rpm(base_speed));
                let deviation = Deviation::SpindleRamp { base_speed, reference_speed };
                self.add(EffectId::SPINDLE_RAMP, shape, 3.0, Action::Drives(deviation));
            }
            if speeds.len() < SPEEDS {
                self.frame.notes.push(format!(
                    "spindle_ramp and tool_change_delay are told apart by changes at {SPEEDS} speeds of the spindle or more: the programs have {}",
                    speeds.len()
                ));
            }
        }
        let (ends, pockets) = (self.rows.ends.clone(), self.rows.pockets.clone());
        self.feature(EffectId::PROGRAM_END, "", 2.0, ends);
        let differ = distances_differ(&self.rows);
        if !differ || !self.feature(EffectId::MAGAZINE_DISTANCE, "", 0.5, pockets) {
            let reason = if self.rows.changes.iter().any(|changes| *changes > 0.0) {
                "all recorded tool changes pass the same number of pockets: that is a constant of every change (tool_change_delay)"
            } else {
                "the records do not show tool changes"
            };
            untried.push(Untried { id: EffectId::MAGAZINE_DISTANCE, reason: reason.to_owned() });
        }
    }
}
