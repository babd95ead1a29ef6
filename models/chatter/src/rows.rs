//! Modes that are known at several values of something, and between them.

use crate::error::{ChatterError, finite, within};
use crate::structure::{Mode, check_modes};
use std::f64::consts::TAU;

/// A value and the modes that are known there.
pub(crate) type Row = (f64, Vec<Mode>);

/// Refuses rows that are no table: fewer than two, values that do not ascend, another number of modes in one of them. The
/// names are those of the value, of all values and of the number of modes.
pub(crate) fn check_rows(rows: &[Row], [quantity, values, number]: [&'static str; 3]) -> Result<(), ChatterError> {
    if rows.len() < 2 {
        return Err(ChatterError::TooFewPoints { quantity: values, points: rows.len() });
    }
    let count = rows[0].1.len() as f64;
    for (value, modes) in rows {
        finite(quantity, *value)?;
        within(number, modes.len() as f64, count, count)?;
        check_modes(modes)?;
    }
    for pair in rows.windows(2) {
        let [(start, _), (end, _)] = pair else { continue };
        if end <= start {
            return Err(ChatterError::EmptyRange { quantity, start: *start, end: *end });
        }
    }
    Ok(())
}

/// The modes at `value`, which lies within the rows: the pole of a mode and its shape over the square root of its mass
/// change linearly between two rows, so that no mode is doubled or averaged away as in a mean of responses.
pub(crate) fn interpolated(rows: &[Row], value: f64) -> Vec<Mode> {
    let after = rows.partition_point(|(known, _)| *known < value).clamp(1, rows.len() - 1);
    let ((from, before), (to, behind)) = (&rows[after - 1], &rows[after]);
    let share = (value - from) / (to - from);
    before.iter().zip(behind).map(|(a, b)| between(a, b, share)).collect()
}

/// The same values with other modes, of the number and the mode at each.
pub(crate) fn mapped(rows: &[Row], mut other: impl FnMut(usize, &Mode) -> Mode) -> Vec<Row> {
    let mut row =
        |(value, modes): &Row| (*value, modes.iter().enumerate().map(|(number, mode)| other(number, mode)).collect());
    rows.iter().map(&mut row).collect()
}

/// The mode at a `share` of the way from `a` to `b`.
fn between(a: &Mode, b: &Mode, share: f64) -> Mode {
    if a == b || share == 0.0 {
        return *a;
    }
    if share == 1.0 {
        return *b;
    }
    let mix = |a: f64, b: f64| a + (b - a) * share;
    let (from, to) = (a.pole(), b.pole());
    let pole = nalgebra::Complex::new(mix(from.re, to.re), mix(from.im, to.im));
    let frequency = pole.norm();
    // The sign of a direction says nothing: the shape that turns less is the one that goes on.
    let shape = |mode: &Mode| mode.unit().map(|component| component / mode.mass().sqrt());
    let (start, mut end) = (shape(a), shape(b));
    if start[0] * end[0] + start[1] * end[1] < 0.0 {
        end = end.map(|component| -component);
    }
    let shape = [mix(start[0], end[0]), mix(start[1], end[1])];
    let mass = 1.0 / (shape[0] * shape[0] + shape[1] * shape[1]);
    Mode {
        direction: shape.map(|component| component * mass.sqrt()),
        natural_frequency: frequency / TAU,
        damping_ratio: -pole.re / frequency,
        stiffness: mass * frequency * frequency,
    }
}
