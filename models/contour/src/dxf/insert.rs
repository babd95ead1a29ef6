//! Blocks that are inserted: moved, turned, scaled and mirrored, once or in rows and columns.
//!
//! # Source
//! Autodesk, "DXF Reference", INSERT and BLOCK: what is on layer 0 of a block is drawn on the layer of its insertion.

use super::elements::{Element, EntityFilter, collect};
use super::tags::{Drawing, Entity, fault};
use crate::{FileError, Point};

/// Greatest depth of insertions within insertions (assumption: a block that inserts itself ends there).
const DEPTH: usize = 8;
/// Greatest number of copies by rows and columns: a bound against drawings without end (assumption).
const COPIES: f64 = 1000.0;
/// Relative difference of scales along X and Y that is none: the rounding of nine written digits.
const EQUAL: f64 = 1e-9;

/// Adds the elements of a block at the place of an insertion.
pub(super) fn insert(
    drawing: &Drawing<'_>,
    entity: &Entity<'_>,
    wanted: &EntityFilter<'_>,
    unit: f64,
    list: &mut Vec<Element>,
) -> Result<(), FileError> {
    let name = entity.name_of_block().unwrap_or_default();
    let block = drawing.blocks.iter().find(|block| block.name.eq_ignore_ascii_case(name));
    let block =
        block.ok_or_else(|| fault(entity.line, format!("INSERT of {name}, a block that is not in the file")))?;
    if wanted.depth >= DEPTH {
        return Err(fault(entity.line, format!("blocks are inserted in blocks more than {DEPTH} deep; explode them")));
    }
    let mut own = Vec::new();
    collect(drawing, &block.entities, &EntityFilter { depth: wanted.depth + 1, ..*wanted }, unit, &mut own)?;
    if own.is_empty() {
        return Ok(());
    }
    let number = |code: i32, otherwise: f64| entity.number(code).map(|value| value.unwrap_or(otherwise));
    let (sx, sy, mirror) = (number(41, 1.0)?, number(42, 1.0)?, entity.mirror()?);
    if sx == 0.0 || sy == 0.0 {
        return Err(fault(entity.line, "INSERT with a scale of 0"));
    }
    if (sx.abs() - sy.abs()).abs() > EQUAL * sx.abs() && own.iter().any(|element| element.arc.is_some()) {
        return Err(fault(
            entity.line,
            format!("INSERT of {name} scales X by {sx} and Y by {sy}, which makes ellipses of arcs; explode it"),
        ));
    }
    let (sin, cos) = number(50, 0.0)?.to_radians().sin_cos();
    let place = [entity.due(10)?, entity.due(20)?];
    let (columns, rows) = (number(70, 1.0)?.max(1.0), number(71, 1.0)?.max(1.0));
    if columns * rows > COPIES {
        return Err(fault(entity.line, format!("INSERT of {name} in {columns} columns and {rows} rows")));
    }
    let (across, along) = (number(44, 0.0)?, number(45, 0.0)?);
    let flips = (sx * sy * mirror) < 0.0;
    for (row, column) in (0..rows as u32).flat_map(|row| (0..columns as u32).map(move |column| (row, column))) {
        let at = |point: Point| {
            // Copies stand along the turned axes, and are not scaled apart.
            let x = sx * (point.x - block.base[0] * unit) + f64::from(column) * across * unit;
            let y = sy * (point.y - block.base[1] * unit) + f64::from(row) * along * unit;
            let (x, y) = (cos * x - sin * y, sin * x + cos * y);
            Point { x: mirror * (place[0] * unit + x), y: place[1] * unit + y }
        };
        list.extend(own.iter().map(|element| Element {
            start: at(element.start),
            end: at(element.end),
            arc: element.arc.map(|(centre, left)| (at(centre), left != flips)),
            curve: element.curve.map(|residual| residual * sx.abs().max(sy.abs())),
            ..*element
        }));
    }
    Ok(())
}
