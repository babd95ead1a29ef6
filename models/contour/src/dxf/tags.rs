//! Tagged pairs of a DXF file, and the entities that they describe.

use crate::{ContourError, FileError};

/// An entity with its pairs.
pub(super) struct Entity<'a> {
    pub name: &'a str,
    pub line: usize,
    pub pairs: Vec<(i32, &'a str, usize)>,
}

pub(super) fn fault(line: usize, message: impl Into<String>) -> FileError {
    FileError { line, column: 1, fault: Box::new(ContourError::Dxf { message: message.into() }) }
}

impl Entity<'_> {
    fn text(&self, code: i32) -> Option<&str> {
        self.pairs.iter().find(|(own, ..)| *own == code).map(|(_, value, _)| *value)
    }

    /// Name of the block that an INSERT draws.
    pub fn name_of_block(&self) -> Option<&str> {
        self.text(2)
    }

    pub fn layer(&self) -> &str {
        self.text(8).unwrap_or("0")
    }

    pub fn number(&self, code: i32) -> Result<Option<f64>, FileError> {
        let Some((_, value, line)) = self.pairs.iter().find(|(own, ..)| *own == code) else { return Ok(None) };
        number(value, *line).map(Some)
    }

    pub fn due(&self, code: i32) -> Result<f64, FileError> {
        self.number(code)?.ok_or_else(|| fault(self.line, format!("{} has no group {code}", self.name)))
    }

    /// All values of a group code, in the order of the file.
    pub fn all(&self, code: i32) -> Result<Vec<f64>, FileError> {
        let found = self.pairs.iter().filter(|(found, ..)| *found == code);
        found.map(|(_, value, line)| number(value, *line)).collect()
    }

    /// 1, or −1 where the extrusion direction mirrors X.
    pub fn mirror(&self) -> Result<f64, FileError> {
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

pub(super) fn number(text: &str, line: usize) -> Result<f64, FileError> {
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

/// What a file draws.
#[derive(Default)]
pub(super) struct Drawing<'a> {
    pub entities: Vec<Entity<'a>>,
    pub blocks: Vec<Block<'a>>,
    /// Unit of its header, m; `None` where it names none.
    pub unit: Option<f64>,
}

/// Entities under a name, which are drawn wherever they are inserted.
#[derive(Default)]
pub(super) struct Block<'a> {
    pub name: &'a str,
    /// Its point that comes to the place of insertion, in units of the drawing.
    pub base: [f64; 2],
    pub entities: Vec<Entity<'a>>,
}

/// Reads a file.
pub(super) fn drawing(text: &str) -> Result<Drawing<'_>, FileError> {
    let mut drawing = Drawing::default();
    let (mut section, mut variable) = ("", "");
    for (code, value, line) in pairs(text)? {
        match (code, value) {
            (0, "SECTION" | "ENDSEC") => section = "",
            (2, name) if section.is_empty() => section = name,
            (9, name) if section == "HEADER" => variable = name,
            (70, number) if section == "HEADER" && variable == "$INSUNITS" => {
                drawing.unit = match number {
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
            (0, name) if section == "ENTITIES" => drawing.entities.push(Entity { name, line, pairs: Vec::new() }),
            (code, value) if section == "ENTITIES" => {
                if let Some(entity) = drawing.entities.last_mut() {
                    entity.pairs.push((code, value, line));
                }
            }
            (0, "BLOCK") if section == "BLOCKS" => drawing.blocks.push(Block::default()),
            (code, value) if section == "BLOCKS" => {
                let Some(block) = drawing.blocks.last_mut() else { continue };
                match (code, block.entities.last_mut()) {
                    (0, _) => block.entities.push(Entity { name: value, line, pairs: Vec::new() }),
                    (code, Some(entity)) => entity.pairs.push((code, value, line)),
                    (2, None) => block.name = value,
                    (10, None) => block.base[0] = number(value, line)?,
                    (20, None) => block.base[1] = number(value, line)?,
                    _ => {}
                }
            }
            _ => {}
        }
    }
    Ok(drawing)
}
