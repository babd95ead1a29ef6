//! Arcs and helices in the words of a control.

use crate::{Writer, number};
use std::f64::consts::TAU;
use toolroom_program::{Arc, Dialect, Motion, PLANES, plane_code};

impl Writer {
    pub(crate) fn arc(&mut self, motion: &Motion, arc: &Arc) -> Result<(), &'static str> {
        let [u, v, w] = arc.plane;
        if self.klartext() && arc.plane != PLANES[0] {
            return Err("an arc out of the plane XY has no words in Klartext with the tool along Z");
        }
        if !self.known[u] || !self.known[v] {
            return Err(
                "an arc from a place that only the machine knows has no end: name a place before it, or give --start",
            );
        }
        if arc.plane != self.plane {
            self.plane = arc.plane;
            self.line(&format!("G{}", plane_code(arc.plane)));
        }
        // The end is rounded first; the centre keeps its distance from the start as it was written.
        let from = [u, v].map(|axis| self.position[axis].unwrap_or(motion.start[axis]));
        let centre = [Self::round(arc.centre[0]), Self::round(arc.centre[1])];
        let turns = ((arc.angle - 1e-9) / TAU).floor().max(0.0);
        // An arc so short that its ends are written alike would be read as a full circle.
        let alike = [u, v].into_iter().zip(from).all(|(axis, from)| Self::round(motion.end[axis]) == Self::round(from));
        if alike && arc.angle < 0.5 * TAU && motion.start[w] == motion.end[w] {
            return Ok(());
        }
        let mut forced = [false; 9];
        (forced[u], forced[v]) = (true, true);
        if self.klartext() {
            let sense = if arc.left { "DR+" } else { "DR-" };
            let rise = motion.end[w] - motion.start[w];
            if rise != 0.0 || turns > 0.0 {
                let sign = if arc.left { '+' } else { '-' };
                let angle = number(arc.angle.to_degrees(), 7, false);
                let height = self.value(Self::round(motion.end[w]));
                let feed = self.feed(motion);
                // The end follows from the rounded pole. The next helix begins there and its pole makes up for it, so that
                // helices that follow each other do not drift.
                let end = [u, v].map(|axis| Self::round(motion.end[axis]));
                let turn = if arc.left { arc.angle } else { -arc.angle };
                let pole = pole(from, end, turn).unwrap_or(arc.centre).map(Self::round);
                self.line(&format!("CC X{} Y{}", self.value(pole[0]), self.value(pole[1])));
                self.line(&format!("CP IPA{sign}{angle} Z{height} {sense}{feed}"));
                let [x, y] = turned(from, pole, turn);
                (self.position[u], self.position[v], self.position[w]) =
                    (Some(x), Some(y), Some(Self::round(motion.end[w])));
            } else {
                self.line(&format!("CC X{} Y{}", self.value(centre[0]), self.value(centre[1])));
                let words = self.axes(&motion.end, forced);
                let feed = self.feed(motion);
                self.line(&format!("C{words} {sense}{feed}"));
            }
            return Ok(());
        }
        let words = self.axes(&motion.end, forced);
        let letters = ['I', 'J', 'K'];
        let offset = |slot: usize, axis: usize| format!(" {}{}", letters[axis], self.value(centre[slot] - from[slot]));
        let middle = offset(0, u) + &offset(1, v);
        let count = if turns == 0.0 {
            String::new()
        } else {
            match self.dialect {
                Dialect::Siemens => format!(" TURN={turns}"),
                Dialect::Fanuc | Dialect::FanucLathe => format!(" L{}", turns + 1.0),
                Dialect::Haas | Dialect::LinuxCnc | Dialect::Heidenhain => format!(" P{}", turns + 1.0),
            }
        };
        let code = if arc.left { "G3" } else { "G2" };
        let feed = self.feed(motion);
        self.line(&format!("{code}{words}{middle}{count}{feed}"));
        Ok(())
    }
}

/// `point` turned about `pole` by `angle`, rad.
fn turned(point: [f64; 2], pole: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = angle.sin_cos();
    let [x, y] = [point[0] - pole[0], point[1] - pole[1]];
    [pole[0] + cos * x - sin * y, pole[1] + sin * x + cos * y]
}

/// The pole about which `angle` turns `from` to `end`; `None` where turns so near a whole number tell little of it.
fn pole(from: [f64; 2], end: [f64; 2], angle: f64) -> Option<[f64; 2]> {
    /// Twice the sine of half the angle that still tells the pole (assumption).
    const LEAST: f64 = 0.05;
    let (sin, cos) = angle.sin_cos();
    let determinant = 2.0 * (1.0 - cos);
    // (1 − R)·pole = end − R·from.
    let [x, y] = turned(from, [0.0, 0.0], angle);
    let [x, y] = [end[0] - x, end[1] - y];
    let side = 1.0 - cos;
    (determinant > LEAST * LEAST).then(|| [(side * x - sin * y) / determinant, (sin * x + side * y) / determinant])
}
