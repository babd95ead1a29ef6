//! Lines and arcs of the entities of a layer.

use super::tags::{Drawing, Entity, fault, number};
use super::{JOIN, curve, insert};
use crate::{FileError, Point};

/// Greatest number of elements of a layer: a bound against drawings that are no contour (assumption).
const ELEMENTS: usize = 20_000;

/// What draws and what does not; everything else is refused on the layer that is read.
const PASSED_OVER: [&str; 14] = [
    "TEXT",
    "MTEXT",
    "DIMENSION",
    "HATCH",
    "POINT",
    "LEADER",
    "MLEADER",
    "ATTDEF",
    "ATTRIB",
    "VIEWPORT",
    "IMAGE",
    "TOLERANCE",
    "XLINE",
    "RAY",
];

/// A piece of a drawing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Element {
    pub start: Point,
    pub end: Point,
    /// Centre, and whether it turns left.
    pub arc: Option<(Point, bool)>,
    /// Line of the file where it begins.
    pub line: usize,
    /// How far a curve, whose arcs count as one, strays from them, m; `None` of what is no part of a curve.
    pub curve: Option<f64>,
}

impl Element {
    pub fn reversed(self) -> Self {
        Self { start: self.end, end: self.start, arc: self.arc.map(|(centre, left)| (centre, !left)), ..self }
    }

    /// Twice the area between the element and the origin, m²: its sign says how a closed contour turns.
    pub fn area(&self) -> f64 {
        let chord = self.start.x * self.end.y - self.end.x * self.start.y;
        let Some((centre, left)) = self.arc else { return chord };
        let radius = centre.distance(self.start);
        let (from, to) = (centre.heading_to(self.start), centre.heading_to(self.end));
        let turn = if left {
            (to - from).rem_euclid(std::f64::consts::TAU)
        } else {
            -(from - to).rem_euclid(std::f64::consts::TAU)
        };
        // The chord and the segment between it and the arc.
        chord + radius * radius * (turn - turn.sin())
    }
}

/// Elements of polylines by their corners, each with the bulge of the way to the next.
fn polyline(corners: &[Corner], closed: bool, list: &mut Vec<Element>) {
    let count = corners.len();
    let ways = if closed { count } else { count.saturating_sub(1) };
    for index in 0..ways {
        let ((start, bulge, line), (end, ..)) = (corners[index], corners[(index + 1) % count]);
        if start.distance(end) < JOIN {
            continue;
        }
        let arc = (bulge != 0.0).then(|| {
            let away = (1.0 - bulge * bulge) / (4.0 * bulge);
            let (dx, dy) = (end.x - start.x, end.y - start.y);
            let centre = Point { x: 0.5 * (start.x + end.x) - dy * away, y: 0.5 * (start.y + end.y) + dx * away };
            (centre, bulge > 0.0)
        });
        list.push(Element { start, end, arc, line, curve: None });
    }
}

/// A corner of a polyline: its place, the bulge of the side that begins there, its line.
type Corner = (Point, f64, usize);

/// Elements of a layer.
pub(super) fn elements(drawing: &Drawing<'_>, layer: Option<&str>, unit: f64) -> Result<Vec<Element>, FileError> {
    let mut list = Vec::new();
    collect(drawing, &drawing.entities, &EntityFilter { layer, from: None, depth: 0 }, unit, &mut list)?;
    Ok(list)
}

/// Which entities are wanted.
pub(super) struct EntityFilter<'a> {
    /// The layer that is read; `None` for all.
    pub layer: Option<&'a str>,
    /// The layer of the insertion, which layer 0 of a block stands for.
    pub from: Option<&'a str>,
    /// Insertions within insertions.
    pub depth: usize,
}

/// Adds the elements of entities.
pub(super) fn collect(
    drawing: &Drawing<'_>,
    entities: &[Entity<'_>],
    wanted: &EntityFilter<'_>,
    unit: f64,
    list: &mut Vec<Element>,
) -> Result<(), FileError> {
    // Corners of a polyline of the old kind, which are entities of their own.
    let mut old: Option<(bool, f64, Vec<Corner>)> = None;
    for entity in entities {
        if let (Some((_, mirror, corners)), "VERTEX") = (&mut old, entity.name) {
            let (x, y) = (entity.due(10)?, entity.due(20)?);
            let bulge = entity.number(42)?.unwrap_or(0.0) * *mirror;
            corners.push((Point { x: *mirror * x * unit, y: y * unit }, bulge, entity.line));
            continue;
        }
        if let Some((closed, _, corners)) = old.take() {
            polyline(&corners, closed, list);
            if entity.name == "SEQEND" {
                continue;
            }
        }
        let drawn = wanted.from.filter(|_| entity.layer() == "0").unwrap_or(entity.layer());
        if entity.name == "INSERT" {
            // Its entities may be on other layers than itself.
            insert::insert(drawing, entity, &EntityFilter { from: Some(drawn), ..*wanted }, unit, list)?;
            continue;
        }
        if wanted.layer.is_some_and(|layer| layer != drawn) {
            continue;
        }
        let flags = entity.number(70)?.unwrap_or(0.0) as i64;
        match entity.name {
            "LINE" => {
                let start = Point { x: entity.due(10)? * unit, y: entity.due(20)? * unit };
                let end = Point { x: entity.due(11)? * unit, y: entity.due(21)? * unit };
                if start.distance(end) >= JOIN {
                    list.push(Element { start, end, arc: None, line: entity.line, curve: None });
                }
            }
            "ARC" | "CIRCLE" => {
                let mirror = entity.mirror()?;
                let centre = Point { x: mirror * entity.due(10)? * unit, y: entity.due(20)? * unit };
                let radius = entity.due(40)? * unit;
                if radius <= 0.0 {
                    return Err(fault(entity.line, format!("{} has no radius", entity.name)));
                }
                let point = |degrees: f64| {
                    let (sin, cos) = degrees.to_radians().sin_cos();
                    Point { x: centre.x + mirror * radius * cos, y: centre.y + radius * sin }
                };
                let line = entity.line;
                let arc = Some((centre, mirror > 0.0));
                if entity.name == "ARC" {
                    let (from, to) = (entity.due(50)?, entity.due(51)?);
                    list.push(Element { start: point(from), end: point(to), arc, line, curve: None });
                } else {
                    list.push(Element { start: point(0.0), end: point(180.0), arc, line, curve: None });
                    list.push(Element { start: point(180.0), end: point(0.0), arc, line, curve: None });
                }
            }
            "LWPOLYLINE" => {
                let mirror = entity.mirror()?;
                let mut corners: Vec<Corner> = Vec::new();
                for (code, value, line) in &entity.pairs {
                    let value = || number(value, *line);
                    match (code, corners.last_mut()) {
                        (10, _) => corners.push((Point { x: mirror * value()? * unit, y: 0.0 }, 0.0, *line)),
                        (20, Some((point, ..))) => point.y = value()? * unit,
                        (42, Some((_, bulge, _))) => *bulge = mirror * value()?,
                        _ => {}
                    }
                }
                polyline(&corners, flags & 1 == 1, list);
            }
            "POLYLINE" => {
                if flags & !0b1000_0001 != 0 {
                    return Err(fault(
                        entity.line,
                        "a POLYLINE in space, with curves fitted or as a mesh, is not followed",
                    ));
                }
                old = Some((flags & 1 == 1, entity.mirror()?, Vec::new()));
            }
            "ELLIPSE" => curve::ellipse(entity, unit, list)?,
            "SPLINE" => curve::spline(entity, unit, list)?,
            "SEQEND" | "VERTEX" | "ENDBLK" => {}
            name if PASSED_OVER.contains(&name) => {}
            name => {
                let message = format!(
                    "{name} on layer {} is not followed, and without it the contour is another: draw it in lines and arcs",
                    drawn
                );
                return Err(fault(entity.line, message));
            }
        }
        if list.len() > ELEMENTS {
            return Err(fault(entity.line, format!("more than {ELEMENTS} elements are no contour; name a layer")));
        }
    }
    Ok(())
}
