//! Paths as a drawing in DXF.

use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::fmt::Write;
use toolroom_program::{Arc, Motion, Path};

/// Lines, arcs and circles in layers, mm, as an ASCII file of the format of Release 12, which every drawing program reads.
///
/// # Source
/// Autodesk, "DXF Reference": group codes of LINE, ARC and CIRCLE, of the header and of the table of layers.
///
/// ```
/// use toolroom_post::Drawing;
/// let mut drawing = Drawing::default();
/// drawing.line("Outer wall", [0.0, 0.0, 0.0], [10.0, 0.0, 0.0]);
/// drawing.arc("Outer wall", [10.0, 5.0, 0.0], 5.0, (-90.0, 90.0));
/// assert!(drawing.text().contains("ARC\n  8\nOUTER_WALL\n 10\n10.0\n 20\n5.0"));
/// ```
#[derive(Clone, Debug, Default)]
pub struct Drawing {
    layers: BTreeSet<String>,
    entities: String,
}

/// Angle of a piece of a helix or of an arc in another plane than XY, which becomes lines, rad: 1°.
const CHORD: f64 = TAU / 360.0;
/// Lines that a helix of very many turns becomes at most (assumption).
const LINES: f64 = 1e5;
/// Longest name of a layer in that format.
const NAME: usize = 31;

/// A number with at least one decimal and no exponent, to a nanometre.
fn number(value: f64) -> String {
    let text = format!("{:.6}", value + 0.0);
    let text = text.trim_end_matches('0');
    let text = if text.ends_with('.') { format!("{text}0") } else { text.to_owned() };
    if text == "-0.0" { "0.0".to_owned() } else { text }
}

/// A name as layers have it: capitals, digits and underlines.
fn layer(name: &str) -> String {
    let fit = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c.to_ascii_uppercase() } else { '_' };
    name.chars().map(fit).take(NAME).collect()
}

impl Drawing {
    fn entity(&mut self, kind: &str, name: &str, numbers: &[(u32, f64)]) {
        let name = layer(name);
        let _ = write!(self.entities, "  0\n{kind}\n  8\n{name}\n");
        for (code, value) in numbers {
            let _ = write!(self.entities, "{code:>3}\n{}\n", number(*value));
        }
        self.layers.insert(name);
    }

    /// A straight line.
    pub fn line(&mut self, layer: &str, start: [f64; 3], end: [f64; 3]) {
        let [a, b] = [start, end];
        self.entity("LINE", layer, &[(10, a[0]), (20, a[1]), (30, a[2]), (11, b[0]), (21, b[1]), (31, b[2])]);
    }

    /// An arc that turns left around a centre between two angles, degrees; a circle where it is a full turn.
    pub fn arc(&mut self, layer: &str, centre: [f64; 3], radius: f64, (from, to): (f64, f64)) {
        let place = [(10, centre[0]), (20, centre[1]), (30, centre[2]), (40, radius)];
        if to - from >= 360.0 - 1e-9 {
            self.entity("CIRCLE", layer, &place);
        } else {
            let angles = [(50, from.rem_euclid(360.0)), (51, to.rem_euclid(360.0))];
            self.entity("ARC", layer, &[&place[..], &angles[..]].concat());
        }
    }

    /// The path of a motion of X, Y and Z: a line or an arc, or a line a degree where it is a helix or an arc in another plane
    /// than XY. Motions from places that only the machine knows are left out.
    pub fn motion(&mut self, layer: &str, motion: &Motion) {
        if motion.unknown {
            return;
        }
        let place = |axes: &[f64; 9]| [axes[0], axes[1], axes[2]];
        let (start, end) = (place(&motion.start), place(&motion.end));
        match motion.path {
            Path::Line if start == end => {}
            Path::Line => self.line(layer, start, end),
            Path::Arc(Arc { plane: [0, 1, 2], centre, left, angle, radius }) if start[2] == end[2] => {
                let at = |place: [f64; 3]| (place[1] - centre[1]).atan2(place[0] - centre[0]).to_degrees();
                let from = if left { at(start) } else { at(end) };
                let turn = angle.to_degrees().min(360.0);
                self.arc(layer, [centre[0], centre[1], start[2]], radius, (from, from + turn));
            }
            Path::Arc(Arc { angle, .. }) => {
                let parts = (angle / CHORD).ceil().clamp(1.0, LINES) as u32;
                let mut from = start;
                for i in 1..=parts {
                    let to = if i == parts { end } else { place(&motion.position(f64::from(i) / f64::from(parts))) };
                    self.line(layer, from, to);
                    from = to;
                }
            }
        }
    }

    /// The file.
    pub fn text(&self) -> String {
        let mut text =
            "  0\nSECTION\n  2\nHEADER\n  9\n$ACADVER\n  1\nAC1009\n  9\n$INSUNITS\n 70\n4\n  0\nENDSEC\n".to_owned();
        let _ = write!(text, "  0\nSECTION\n  2\nTABLES\n  0\nTABLE\n  2\nLAYER\n 70\n{}\n", self.layers.len());
        for (i, name) in self.layers.iter().enumerate() {
            let _ = write!(text, "  0\nLAYER\n  2\n{name}\n 70\n0\n 62\n{}\n  6\nCONTINUOUS\n", i % 6 + 1);
        }
        let _ = write!(
            text,
            "  0\nENDTAB\n  0\nENDSEC\n  0\nSECTION\n  2\nENTITIES\n{}  0\nENDSEC\n  0\nEOF\n",
            self.entities
        );
        text
    }
}
