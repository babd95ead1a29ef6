//! Contours drawn in DXF files: lines, arcs, circles and polylines of one layer, joined end to end.
//!
//! The tagged pairs of an ASCII file are read: a group code on a line, its value on the next. Curves that are none of these
//! (splines, ellipses, blocks) are refused on the layer that is read, since leaving them out would change the contour; texts,
//! dimensions, hatches and points are passed over.
//!
//! # Source
//! Autodesk, "DXF Reference": group codes, bulge as the tangent of a quarter of the angle, `$INSUNITS`, and the extrusion
//! direction (0, 0, −1) that mirrors X.

use crate::file::Placed;
use crate::{ContourError, CutterSide, FileError, Point, Trace};

/// Greatest distance of ends that are one point, m.
const JOIN: f64 = 1e-6;
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
struct Element {
    start: Point,
    end: Point,
    /// Centre, and whether it turns left.
    arc: Option<(Point, bool)>,
    /// Line of the file where it begins.
    line: usize,
}

impl Element {
    fn reversed(self) -> Self {
        Self { start: self.end, end: self.start, arc: self.arc.map(|(centre, left)| (centre, !left)), ..self }
    }

    /// Twice the area between the element and the origin, m²: its sign says how a closed contour turns.
    fn area(&self) -> f64 {
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

/// An entity with its pairs.
struct Entity<'a> {
    name: &'a str,
    line: usize,
    pairs: Vec<(i32, &'a str, usize)>,
}

fn fault(line: usize, message: impl Into<String>) -> FileError {
    FileError { line, column: 1, fault: Box::new(ContourError::Dxf { message: message.into() }) }
}

impl Entity<'_> {
    fn text(&self, code: i32) -> Option<&str> {
        self.pairs.iter().find(|(own, ..)| *own == code).map(|(_, value, _)| *value)
    }

    fn layer(&self) -> &str {
        self.text(8).unwrap_or("0")
    }

    fn number(&self, code: i32) -> Result<Option<f64>, FileError> {
        let Some((_, value, line)) = self.pairs.iter().find(|(own, ..)| *own == code) else { return Ok(None) };
        number(value, *line).map(Some)
    }

    fn due(&self, code: i32) -> Result<f64, FileError> {
        self.number(code)?.ok_or_else(|| fault(self.line, format!("{} has no group {code}", self.name)))
    }

    /// 1, or −1 where the extrusion direction mirrors X.
    fn mirror(&self) -> Result<f64, FileError> {
        let up = self.number(230)?.unwrap_or(1.0);
        match up {
            up if (up - 1.0).abs() < 1e-6 => Ok(1.0),
            up if (up + 1.0).abs() < 1e-6 => Ok(-1.0),
            _ => {
                Err(fault(self.line, format!("{} lies in a plane that is tilted; draw it in the plane XY", self.name)))
            }
        }
    }
}

fn number(text: &str, line: usize) -> Result<f64, FileError> {
    let value = text.parse().ok().filter(|value: &f64| value.is_finite() && value.abs() < 1e9);
    value.ok_or_else(|| fault(line, format!("{text} is no number")))
}

/// Pairs of a file: code, value, line of the value.
fn pairs(text: &str) -> Result<Vec<(i32, &str, usize)>, FileError> {
    if text.starts_with("AutoCAD Binary DXF") {
        return Err(fault(1, "a binary DXF file; save it as ASCII"));
    }
    let mut list = Vec::new();
    let mut lines = text.lines().enumerate();
    while let Some((index, code)) = lines.next() {
        let code = code.trim().trim_start_matches('\u{feff}');
        let Some((place, value)) = lines.next() else {
            if code.is_empty() {
                break;
            }
            return Err(fault(index + 1, "the file ends behind a group code"));
        };
        let code =
            code.parse().map_err(|_| fault(index + 1, format!("{code} is no group code: is this a DXF file?")))?;
        list.push((code, value.trim(), place + 1));
    }
    Ok(list)
}

/// Entities of the drawing and the unit of its header, m; `None` where it names none.
fn entities(text: &str) -> Result<(Vec<Entity<'_>>, Option<f64>), FileError> {
    let (mut list, mut unit): (Vec<Entity<'_>>, _) = (Vec::new(), None);
    let (mut section, mut variable) = ("", "");
    for (code, value, line) in pairs(text)? {
        match (code, value) {
            (0, "SECTION" | "ENDSEC") => section = "",
            (2, name) if section.is_empty() => section = name,
            (9, name) if section == "HEADER" => variable = name,
            (70, number) if section == "HEADER" && variable == "$INSUNITS" => {
                unit = match number {
                    "0" => None,
                    "1" => Some(25.4e-3),
                    "2" => Some(304.8e-3),
                    "4" => Some(1e-3),
                    "5" => Some(1e-2),
                    "6" => Some(1.0),
                    other => {
                        return Err(fault(
                            line,
                            format!("$INSUNITS {other} is no unit that is followed: 1 in, 2 ft, 4 mm, 5 cm, 6 m"),
                        ));
                    }
                };
            }
            (0, name) if section == "ENTITIES" => list.push(Entity { name, line, pairs: Vec::new() }),
            (code, value) if section == "ENTITIES" => {
                if let Some(entity) = list.last_mut() {
                    entity.pairs.push((code, value, line));
                }
            }
            _ => {}
        }
    }
    Ok((list, unit))
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
        list.push(Element { start, end, arc, line });
    }
}

/// A corner of a polyline: its place, the bulge of the side that begins there, its line.
type Corner = (Point, f64, usize);

/// Elements of a layer.
fn elements(entities: &[Entity<'_>], layer: Option<&str>, unit: f64) -> Result<Vec<Element>, FileError> {
    let mut list = Vec::new();
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
            polyline(&corners, closed, &mut list);
            if entity.name == "SEQEND" {
                continue;
            }
        }
        if layer.is_some_and(|layer| layer != entity.layer()) {
            continue;
        }
        let flags = entity.number(70)?.unwrap_or(0.0) as i64;
        match entity.name {
            "LINE" => {
                let start = Point { x: entity.due(10)? * unit, y: entity.due(20)? * unit };
                let end = Point { x: entity.due(11)? * unit, y: entity.due(21)? * unit };
                if start.distance(end) >= JOIN {
                    list.push(Element { start, end, arc: None, line: entity.line });
                }
            }
            "ARC" | "CIRCLE" => {
                let mirror = entity.mirror()?;
                let centre = Point { x: mirror * entity.due(10)? * unit, y: entity.due(20)? * unit };
                let radius = entity.due(40)? * unit;
                if radius <= 0.0 {
                    return Err(fault(entity.line, format!("{} has no radius", entity.name)));
                }
                let at = |degrees: f64| {
                    let (sin, cos) = degrees.to_radians().sin_cos();
                    Point { x: centre.x + mirror * radius * cos, y: centre.y + radius * sin }
                };
                let line = entity.line;
                let arc = Some((centre, mirror > 0.0));
                if entity.name == "ARC" {
                    let (from, to) = (entity.due(50)?, entity.due(51)?);
                    list.push(Element { start: at(from), end: at(to), arc, line });
                } else {
                    list.push(Element { start: at(0.0), end: at(180.0), arc, line });
                    list.push(Element { start: at(180.0), end: at(0.0), arc, line });
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
                polyline(&corners, flags & 1 == 1, &mut list);
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
            "SEQEND" | "VERTEX" => {}
            name if PASSED_OVER.contains(&name) => {}
            name => {
                let message = format!(
                    "{name} on layer {} is not followed, and without it the contour is another: draw it in lines and arcs",
                    entity.layer()
                );
                return Err(fault(entity.line, message));
            }
        }
        if list.len() > ELEMENTS {
            return Err(fault(entity.line, format!("more than {ELEMENTS} elements are no contour; name a layer")));
        }
    }
    Ok(list)
}

/// Joins elements end to end; each chain with whether it is closed.
fn chains(mut left: Vec<Element>) -> Result<Vec<(Vec<Element>, bool)>, FileError> {
    let mut list = Vec::new();
    while !left.is_empty() {
        let mut chain = std::collections::VecDeque::from([left.remove(0)]);
        // First on from its end, then back from its start.
        for ahead in [true, false] {
            loop {
                let end = if ahead { chain[chain.len() - 1].end } else { chain[0].start };
                let closed = chain[0].start.distance(chain[chain.len() - 1].end) < JOIN;
                if closed {
                    break;
                }
                let touches =
                    |element: &&Element| element.start.distance(end) < JOIN || element.end.distance(end) < JOIN;
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
                let fits = if ahead { element.start } else { element.end }.distance(end) < JOIN;
                let element = if fits { element } else { element.reversed() };
                if ahead { chain.push_back(element) } else { chain.push_front(element) }
            }
        }
        let closed = chain[0].start.distance(chain[chain.len() - 1].end) < JOIN;
        list.push((chain.into(), closed));
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
    Ok(read_placed(text, layer, unit, Some(side), closed)?.0)
}

/// [`read`] with the line of the element that draws each section.
pub(crate) fn read_placed(
    text: &str,
    layer: Option<&str>,
    unit: Option<f64>,
    side: Option<CutterSide>,
    closed: bool,
) -> Result<Placed, FileError> {
    let (entities, named) = entities(text)?;
    let first = entities.first().map_or(1, |entity| entity.line);
    let unit = named
        .or(unit)
        .ok_or_else(|| fault(1, "nothing says the unit of the drawing ($INSUNITS): give --units mm or --units inch"))?;
    if let Some(layer) = layer.filter(|layer| entities.iter().all(|entity| entity.layer() != *layer)) {
        let mut known: Vec<&str> = entities.iter().map(Entity::layer).collect();
        known.sort_unstable();
        known.dedup();
        return Err(fault(first, format!("nothing is drawn on layer {layer}; there are {}", known.join(", "))));
    }
    let list = chains(elements(&entities, layer, unit)?)?;
    let [(chain, is_closed)] = &list[..] else {
        if list.is_empty() {
            return Err(fault(first, "the drawing has no lines, arcs or polylines on this layer"));
        }
        let contour = |(chain, closed): &(Vec<Element>, bool)| {
            format!("line {} ({} elements, {})", chain[0].line, chain.len(), if *closed { "closed" } else { "open" })
        };
        let named: Vec<String> = list.iter().take(10).map(contour).collect();
        let message = format!("{} contours are drawn, at {}; name the layer of one", list.len(), named.join(", "));
        return Err(fault(list[1].0[0].line, message));
    };
    let mut chain = chain.clone();
    if *is_closed && chain.iter().map(Element::area).sum::<f64>() < 0.0 {
        chain.reverse();
        chain.iter_mut().for_each(|element| *element = element.reversed());
    }
    let side =
        side.ok_or_else(|| fault(first, "a drawing does not say where the cutter runs: give cutter_side in the file"))?;
    let mut trace = Trace::new(chain[0].start, 0.0);
    let mut lines: Vec<usize> = Vec::new();
    for element in &chain {
        let place = |fault| FileError { line: element.line, column: 1, fault: Box::new(fault) };
        match element.arc {
            None => trace.line_to(element.end).map_err(place)?,
            Some((centre, left)) => trace.arc_to(element.end, centre, left).map_err(place)?,
        }
        lines.resize(trace.sections(), element.line);
    }
    let contour = trace.finish(side, closed).map_err(|fault| {
        let line = fault.section().and_then(|section| lines.get(section)).or(lines.last()).copied().unwrap_or(first);
        FileError { line, column: 1, fault: Box::new(fault) }
    })?;
    Ok((contour, lines.into_iter().map(|line| (line, 1)).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// An entity: name, layer, pairs.
    type Drawn<'a> = (&'a str, &'a str, &'a [(i32, f64)]);

    /// A drawing of entities on layers.
    fn drawing(header: &str, list: &[Drawn<'_>]) -> String {
        let mut text = format!("{header}0\nSECTION\n2\nENTITIES\n");
        for (name, layer, pairs) in list {
            text.push_str(&format!("0\n{name}\n8\n{layer}\n"));
            for (code, value) in *pairs {
                text.push_str(&format!("{code}\n{value}\n"));
            }
        }
        text + "0\nENDSEC\n0\nEOF\n"
    }

    const MM: &str = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n";

    /// A slot of 40 mm between centres and 20 mm across, its elements in disorder and partly against each other.
    fn slot(header: &str) -> String {
        drawing(
            header,
            &[
                ("LINE", "OUTER", &[(10, 0.0), (20, -10.0), (11, 40.0), (21, -10.0)]),
                ("TEXT", "OUTER", &[(10, 0.0), (20, 0.0)]),
                ("ARC", "OUTER", &[(10, 0.0), (20, 0.0), (40, 10.0), (50, 90.0), (51, 270.0)]),
                ("LINE", "OUTER", &[(10, 0.0), (20, 10.0), (11, 40.0), (21, 10.0)]),
                ("ARC", "OUTER", &[(10, 40.0), (20, 0.0), (40, 10.0), (50, 270.0), (51, 90.0)]),
                ("CIRCLE", "HOLE", &[(10, 0.0), (20, 0.0), (40, 3.0)]),
            ],
        )
    }

    #[test]
    fn lines_and_arcs_of_a_layer_are_joined_in_the_order_of_travel() {
        let contour = read(&slot(MM), Some("OUTER"), None, CutterSide::Left, true).expect("a contour");
        assert!((contour.length() - (0.08 + 0.02 * PI)).abs() < 1e-9, "{}", contour.length());
        assert_eq!(contour.sections.len(), 4);
        // Counterclockwise: every arc turns left.
        assert!(contour.sections.iter().all(|section| section.curvature >= 0.0), "{contour:?}");
        // In inches by its header, and by the unit that is given where it has none.
        let inch = MM.replace("\n4\n", "\n1\n");
        let inches = read(&slot(&inch), Some("OUTER"), Some(1e-3), CutterSide::Left, true).expect("a contour");
        assert!((inches.length() / contour.length() - 25.4).abs() < 1e-6);
        let given = read(&slot(""), Some("OUTER"), Some(1e-3), CutterSide::Left, true).expect("a contour");
        assert!((given.length() - contour.length()).abs() < 1e-12);
    }

    #[test]
    fn polylines_with_bulges_are_lines_and_arcs() {
        // A square of 20 mm whose right side bulges out by a half circle, closed by its flag; drawn clockwise,
        // and milled outside.
        let corners: &[(i32, f64)] = &[
            (90, 4.0),
            (70, 1.0),
            (10, 0.0),
            (20, 0.0),
            (10, 0.0),
            (20, 20.0),
            (10, 20.0),
            (20, 20.0),
            (42, -1.0),
            (10, 20.0),
            (20, 0.0),
        ];
        let contour =
            read(&drawing(MM, &[("LWPOLYLINE", "0", corners)]), None, None, CutterSide::Right, true).expect("one");
        assert!((contour.length() - (0.06 + 0.01 * PI)).abs() < 1e-9, "{}", contour.length());
        // The old form, mirrored by its extrusion: the same length, on the other side of Y.
        let vertex: [&[(i32, f64)]; 4] = [
            &[(10, 0.0), (20, 0.0)],
            &[(10, 0.0), (20, 20.0)],
            &[(10, 20.0), (20, 20.0), (42, -1.0)],
            &[(10, 20.0), (20, 0.0)],
        ];
        let mut list: Vec<Drawn<'_>> = vec![("POLYLINE", "0", &[(70, 1.0), (230, -1.0)])];
        list.extend(vertex.iter().map(|pairs| ("VERTEX", "0", *pairs)));
        list.push(("SEQEND", "0", &[]));
        let mirrored = read(&drawing(MM, &list), None, None, CutterSide::Right, true).expect("one");
        assert!((mirrored.length() - contour.length()).abs() < 1e-9);
        assert!(
            mirrored.sections.iter().all(|section| section.start.x < 1e-9 && section.curvature >= 0.0),
            "{mirrored:?}"
        );
    }

    #[test]
    fn what_is_no_contour_is_refused_with_its_line() {
        let refused = |text: &str, layer: Option<&str>| {
            let error = read(text, layer, None, CutterSide::Left, true).expect_err("refused");
            (error.line, error.fault.to_string())
        };
        let (_, several) = refused(&slot(MM), None);
        assert!(several.contains("2 contours"), "{several}");
        let (_, layer) = refused(&slot(MM), Some("INNER"));
        assert!(layer.contains("HOLE, OUTER"), "{layer}");
        assert!(refused(&slot(""), Some("OUTER")).1.contains("--units"));
        let spline =
            drawing(MM, &[("LINE", "A", &[(10, 0.0), (20, 0.0), (11, 1.0), (21, 0.0)]), ("SPLINE", "A", &[(70, 8.0)])]);
        let (line, text) = refused(&spline, Some("A"));
        assert!(line == 28 && text.contains("SPLINE"), "{line}: {text}");
        let line = |to: [f64; 2]| [(10, 0.0), (20, 0.0), (11, to[0]), (21, to[1])];
        let (a, b, c) = (line([1.0, 0.0]), line([0.0, 1.0]), line([1.0, 1.0]));
        let (_, branch) = refused(&drawing(MM, &[("LINE", "0", &a), ("LINE", "0", &b), ("LINE", "0", &c)]), None);
        assert!(branch.contains("branches"), "{branch}");
        assert_eq!(refused("0\nSECTION\nX\nENTITIES\n", None).0, 3);
        assert!(refused("AutoCAD Binary DXF\r\n", None).1.contains("binary"));
        let open = drawing(MM, &[("LINE", "0", &a)]);
        assert!(
            read(&open, None, None, CutterSide::Left, false).is_ok()
                && read(&open, None, None, CutterSide::Left, true).is_err()
        );
    }
}
