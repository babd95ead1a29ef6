//! Contours drawn in DXF files: lines, arcs, circles, polylines, ellipses and splines of one layer, joined end to end.
//!
//! The tagged pairs of an ASCII file are read: a group code on a line, its value on the next. Ellipses and splines become tangent
//! arcs within 1 µm, and blocks are drawn where they are inserted. What is none of these (splines that only name points, blocks scaled
//! differently along X and Y) is refused on the layer that is read, since leaving them out would change the contour; texts,
//! dimensions, hatches and points are passed over.
//!
//! # Source
//! Autodesk, "DXF Reference": group codes, bulge as the tangent of a quarter of the angle, `$INSUNITS`, and the extrusion
//! direction (0, 0, −1) that mirrors X.

mod curve;
mod elements;
mod insert;
mod join;
mod tags;
#[cfg(test)]
mod tests;

use crate::file::Placed;
use crate::geometry::wrapped;
use crate::trace::CORNER_ANGLE;
use crate::{CutterSide, FileError, Section, Trace};
use elements::{Element, elements};
use tags::{Entity, drawing, fault};

/// Greatest distance of ends that are one point where no other is given, m.
pub(crate) const JOIN: f64 = 1e-6;
/// Where ends within [`JOIN`] make no closed contour, those within this distance are one point as well, m: coordinates with four decimals of
/// an inch put ends up to 3.6 um apart.
const ROUNDED: f64 = 5e-6;

/// Joins elements end to end, ends within `join`, m, being one point; each chain with whether it is closed.
fn chains(mut left: Vec<Element>, join: f64) -> Result<Vec<(Vec<Element>, bool)>, FileError> {
    let mut list = Vec::new();
    while !left.is_empty() {
        let mut chain = std::collections::VecDeque::from([left.remove(0)]);
        // First on from its end, then back from its start.
        for ahead in [true, false] {
            loop {
                let end = if ahead { chain[chain.len() - 1].end } else { chain[0].start };
                let closed = chain[0].start.distance(chain[chain.len() - 1].end) < join;
                if closed {
                    break;
                }
                let touches =
                    |element: &&Element| element.start.distance(end) < join || element.end.distance(end) < join;
                let found: Vec<usize> = (0..left.len()).filter(|index| touches(&&left[*index])).collect();
                let index = match found[..] {
                    [] => break,
                    [index] => index,
                    [first, second, ..] => {
                        return Err(fault(
                            left[second].line,
                            format!(
                                "the contour branches: this element and that of line {} go on from one point",
                                left[first].line
                            ),
                        ));
                    }
                };
                let element = left.remove(index);
                let fits = if ahead { element.start } else { element.end }.distance(end) < join;
                let element = if fits { element } else { element.reversed() };
                if ahead { chain.push_back(element) } else { chain.push_front(element) }
            }
        }
        let closed = chain[0].start.distance(chain[chain.len() - 1].end) < join;
        let mut chain: Vec<Element> = chain.into();
        join::close_gaps(&mut chain, closed);
        list.push((chain, closed));
    }
    Ok(list)
}

/// Reads the one contour of a layer, or of the whole drawing where it has only one. `unit` is that of a drawing without
/// `$INSUNITS`, m. A closed contour is travelled counterclockwise, so that a cutter on its left is inside; an open one as its
/// first element was drawn.
///
/// # Errors
/// [`FileError`] with the line of the first fault: what is no DXF, a curve that is not followed, a branch, several contours,
/// or a contour that is not closed where it has to be.
///
/// ```
/// use toolroom_contour::{CutterSide, read_dxf};
/// let text = "0\nSECTION\n2\nENTITIES\n0\nCIRCLE\n8\nHOLE\n10\n5\n20\n5\n40\n20\n0\nENDSEC\n0\nEOF\n";
/// let contour = read_dxf(text, Some("HOLE"), Some(1e-3), CutterSide::Left, true).unwrap();
/// assert!((contour.length() - 0.04 * std::f64::consts::PI).abs() < 1e-9);
/// ```
pub fn read(
    text: &str,
    layer: Option<&str>,
    unit: Option<f64>,
    side: CutterSide,
    closed: bool,
) -> Result<crate::Contour, FileError> {
    Ok(read_placed(text, (layer, unit, JOIN), Some(side), closed)?.0.0)
}

/// Reads the closed outlines of a layer, along which no cutter runs, as [`read`] reads a contour: what lies within an odd number of them
/// is enclosed, so that contours within another one are its holes.
///
/// # Errors
/// As [`read`].
///
/// ```
/// use toolroom_contour::read_dxf_outline;
/// let text = "0\nSECTION\n2\nENTITIES\n0\nCIRCLE\n8\nHOLE\n10\n5\n20\n5\n40\n20\n0\nENDSEC\n0\nEOF\n";
/// let outline = read_dxf_outline(text, None, Some(1e-3)).unwrap();
/// assert!((outline.iter().map(|section| section.length).sum::<f64>() - 0.04 * std::f64::consts::PI).abs() < 1e-9);
/// ```
pub fn read_outline(text: &str, layer: Option<&str>, unit: Option<f64>) -> Result<Vec<Section>, FileError> {
    let of = (layer, unit, JOIN);
    let list = drawn(text, of)?;
    if list.len() > 1 && list.iter().any(|(_, closed)| !closed) {
        return Err(several(&list));
    }
    let mut sections = Vec::new();
    for (chain, closed) in list {
        let first = chain[0].line;
        let Traced { trace, lines, .. } = traced(chain, closed)?;
        let outline = trace.outline().map_err(|fault| {
            let line = lines.last().copied().unwrap_or(first);
            FileError { line, column: 1, fault: Box::new(fault) }
        })?;
        sections.extend(outline);
    }
    Ok(sections)
}

/// A contour as it was drawn.
struct Traced {
    trace: Trace,
    /// Line of the element that draws each section.
    lines: Vec<usize>,
    /// Whether it draws a curve that is no arc.
    curves: Vec<bool>,
    /// How far the curves stray from their arcs, m.
    residual: f64,
}

/// [`read`] with the line of the element that draws each section, of a layer, with a unit and the distance of ends that are one
/// point, m, and how far curves stray from their arcs, m.
pub(crate) fn read_placed(
    text: &str,
    of: (Option<&str>, Option<f64>, f64),
    side: Option<CutterSide>,
    closed: bool,
) -> Result<(Placed, f64), FileError> {
    let list = drawn(text, of)?;
    let [(chain, is_closed)] = &list[..] else { return Err(several(&list)) };
    let first = chain[0].line;
    let Traced { trace, lines, curves, residual } = traced(chain.clone(), *is_closed)?;
    let side =
        side.ok_or_else(|| fault(first, "a drawing does not say where the cutter runs: give cutter_side in the file"))?;
    let mut contour = trace.finish(side, closed).map_err(|fault| {
        let line = fault.section().and_then(|section| lines.get(section)).or(lines.last()).copied().unwrap_or(first);
        FileError { line, column: 1, fault: Box::new(fault) }
    })?;
    join_curves(&mut contour.sections, &curves);
    Ok(((contour, lines.into_iter().map(|line| (line, 1)).collect()), residual))
}

/// The contours of a layer, with a unit and the distance of ends that are one point, m: each with whether it is closed.
fn drawn(
    text: &str,
    (layer, unit, join): (Option<&str>, Option<f64>, f64),
) -> Result<Vec<(Vec<Element>, bool)>, FileError> {
    let drawing = drawing(text)?;
    let entities = &drawing.entities;
    let first = entities.first().map_or(1, |entity| entity.line);
    let unit = drawing
        .unit
        .or(unit)
        .ok_or_else(|| fault(1, "nothing says the unit of the drawing ($INSUNITS): give --units mm or --units inch (units = \"mm\" in a [stock])"))?;
    let inserted = drawing.blocks.iter().flat_map(|block| &block.entities);
    let drawn = || entities.iter().chain(inserted.clone());
    if let Some(layer) = layer.filter(|layer| drawn().all(|entity| entity.layer() != *layer)) {
        let mut known: Vec<&str> = drawn().map(Entity::layer).collect();
        known.sort_unstable();
        known.dedup();
        return Err(fault(first, format!("nothing is drawn on layer {layer}; there are {}", known.join(", "))));
    }
    let elements = elements(&drawing, layer, unit)?;
    let list = chains(elements.clone(), join.max(JOIN))?;
    if list.is_empty() {
        return Err(fault(first, "the drawing has no lines, arcs or other curves on this layer"));
    }
    if join > JOIN || list.iter().all(|(_, closed)| *closed) {
        return Ok(list);
    }
    let rounded = chains(elements, ROUNDED).ok().filter(|rounded| rounded.iter().all(|(_, closed)| *closed));
    Ok(rounded.unwrap_or(list))
}

/// The error of a drawing with several contours where one is asked for: each with its line, elements, length and ends.
fn several(list: &[(Vec<Element>, bool)]) -> FileError {
    let contour = |(chain, closed): &(Vec<Element>, bool)| {
        let ends = chain[0].start.distance(chain[chain.len() - 1].end);
        let ends = if *closed { "closed".to_owned() } else { format!("open, {:.4} mm between its ends", ends * 1e3) };
        format!("line {} ({} elements, {ends})", chain[0].line, chain.len())
    };
    let named: Vec<String> = list.iter().take(10).map(contour).collect();
    let message = format!(
        "{} contours are drawn, at {}; name the layer of one, or say with --join which ends are one point",
        list.len(),
        named.join(", ")
    );
    fault(list[1].0[0].line, message)
}

/// A contour as it was drawn; a closed one counterclockwise.
fn traced(mut chain: Vec<Element>, is_closed: bool) -> Result<Traced, FileError> {
    if is_closed && chain.iter().map(Element::area).sum::<f64>() < 0.0 {
        chain.reverse();
        chain.iter_mut().for_each(|element| *element = element.reversed());
    }
    let mut trace = Trace::new(chain[0].start, 0.0);
    let (mut lines, mut curves): (Vec<usize>, Vec<bool>) = (Vec::new(), Vec::new());
    for element in &chain {
        let place = |fault| FileError { line: element.line, column: 1, fault: Box::new(fault) };
        match element.arc {
            None => trace.line_to(element.end).map_err(place)?,
            Some((centre, left)) => trace.arc_to(element.end, centre, left).map_err(place)?,
        }
        lines.resize(trace.sections(), element.line);
        curves.resize(trace.sections(), element.curve.is_some());
    }
    let residual = chain.iter().filter_map(|element| element.curve).fold(0.0, f64::max);
    Ok(Traced { trace, lines, curves, residual })
}

/// The natural arc of a part of a curve is the run of one sign of curvature around it, as that of a spline is.
fn join_curves(sections: &mut [Section], curves: &[bool]) {
    let runs = |a: usize, b: usize| {
        curves.get(a) == Some(&true)
            && curves.get(b) == Some(&true)
            && sections[a].curvature.signum() == sections[b].curvature.signum()
            && wrapped(sections[b].heading - sections[a].end_heading()).abs() < CORNER_ANGLE
    };
    let mut ends: Vec<usize> = (1..sections.len()).filter(|index| !runs(index - 1, *index)).collect();
    ends.push(sections.len());
    let mut start = 0;
    for end in ends {
        if curves.get(start) == Some(&true) {
            let angle: f64 = sections[start..end].iter().map(|section| section.sweep().abs()).sum();
            for section in &mut sections[start..end] {
                section.arc_angle = if section.curvature == 0.0 { 0.0 } else { angle.min(std::f64::consts::TAU) };
            }
        }
        start = end;
    }
}
