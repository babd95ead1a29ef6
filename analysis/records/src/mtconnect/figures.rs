//! What of a stretch of a program drives and spindle spend their time on.

use std::f64::consts::TAU;
use toolroom_program::{Action, Block, Motion, Program, Sense, Stretch};

/// What a stretch asks of drives and spindle, beside its length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Figures {
    /// Commanded speed of the spindle before it and behind it, rad/s; 0 at rest.
    pub spindle: [f64; 2],
    /// Changes between feed and rapid motion.
    pub stops: f64,
    /// Way in rapid motion, m.
    pub rapid_length: f64,
    /// Sum of the sine of half the turn where motions at feed follow each other.
    pub corner_sum: f64,
    /// Least programmed time of a block at feed, s; not a number without one.
    pub shortest_block: f64,
    /// Blocks that wait for the spindle: the first feed or coolant behind its command, stops, tool changes and the end.
    pub waits: f64,
}

/// The figures of each stretch, in order.
pub(super) fn figures(program: &Program, parts: &[Stretch]) -> Vec<Figures> {
    let (mut speed, mut pending) = (0.0, false);
    let mut before: Option<&Motion> = None;
    let mut list = Vec::with_capacity(parts.len());
    for part in parts {
        let mut sums = Figures { shortest_block: f64::NAN, ..Figures::default() };
        sums.spindle[0] = speed;
        for block in &program.blocks[part.blocks.clone()] {
            let mut actions = block.actions.iter().peekable();
            let mut waits = false;
            for (count, motion) in block.motions.iter().enumerate() {
                while let Some((_, action)) = actions.next_if(|(place, _)| *place <= count) {
                    waits |= act(*action, &mut speed, &mut pending);
                }
                if !motion.rapid {
                    waits |= std::mem::take(&mut pending);
                }
                sums.take(motion, before);
                before = Some(motion);
            }
            for (_, action) in actions {
                waits |= act(*action, &mut speed, &mut pending);
            }
            sums.waits += f64::from(u8::from(waits));
            // Whatever stops the axes parts the motions on both sides of it.
            if block.dwell > 0.0 || block.tool_change || block.auxiliary || block.exact_stop {
                before = None;
            }
            sums.shortest_block = sums.shortest_block.min(time_at_feed(block));
        }
        sums.spindle[1] = speed;
        list.push(sums);
    }
    list
}

/// Programmed time of a block at feed, s; not a number without any.
fn time_at_feed(block: &Block) -> f64 {
    let time = block.feed_time();
    if time > 0.0 { time } else { f64::NAN }
}

/// What an action does to the spindle; whether the control waits for it.
fn act(action: Action, speed: &mut f64, pending: &mut bool) -> bool {
    match action {
        Action::Spindle(rpm, sense) => {
            let commanded = match sense {
                Sense::Clockwise | Sense::Counterclockwise => rpm * TAU / 60.0,
                Sense::Still | Sense::Oriented => 0.0,
            };
            *pending |= commanded != *speed && commanded > 0.0;
            *speed = commanded;
            false
        }
        Action::Coolant(on) => on && std::mem::take(pending),
        Action::Stop => *speed == 0.0,
        Action::Change(_) | Action::End => {
            *speed = 0.0;
            *pending = false;
            true
        }
        Action::Home(_) => false,
    }
}

impl Figures {
    fn take(&mut self, motion: &Motion, before: Option<&Motion>) {
        if motion.rapid {
            self.rapid_length += 1e-3 * motion.length;
        }
        let Some(before) = before else { return };
        if before.rapid != motion.rapid {
            self.stops += 1.0;
        } else if !motion.rapid && before.length > 0.0 && motion.length > 0.0 {
            let ((_, leaving), (entering, _)) = (before.directions(), motion.directions());
            let dot: f64 = leaving.iter().zip(entering).map(|(a, b)| a * b).sum();
            self.corner_sum += (0.5 * (1.0 - dot.clamp(-1.0, 1.0))).sqrt();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_program::Control;

    #[test]
    fn a_stretch_tells_what_drives_and_spindle_have_to_do() {
        let text = "G21 G90 G17 T1 M6\nG0 X0 Y0 Z2\nZ1\nS3000 M3\nG1 Z0 F60\nX60 F600\nY30\nG0 Z50\nM5\nM30\n";
        let program = Program::read(text, &Control::default()).expect("a program");
        let parts = program.stretches(1e6, 0.5);
        let all = figures(&program, &parts);
        let sum = |of: fn(&Figures) -> f64| all.iter().map(of).sum::<f64>();
        // Out of the cut, before which M3 stops the axes; the ways down and up, the first being unknown; two square corners, at the bottom and in the plane.
        assert_eq!(sum(|figures| figures.stops), 1.0);
        assert!((sum(|figures| figures.rapid_length) - 0.051).abs() < 1e-9, "{all:?}");
        assert!((sum(|figures| figures.corner_sum) - 2.0 * 0.5f64.sqrt()).abs() < 1e-9, "{all:?}");
        // The tool change, the first feed and the end.
        assert_eq!(sum(|figures| figures.waits), 3.0);
        let cut = all.iter().find(|figures| figures.corner_sum > 0.0).expect("a cut");
        assert_eq!(cut.shortest_block, 1.0);
        assert!((cut.spindle[1] - 3000.0 * TAU / 60.0).abs() < 1e-9, "{cut:?}");
    }
}
