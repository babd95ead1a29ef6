//! Contours from G-code.

use crate::file::Placed;
use crate::{Contour, ContourError, CutterSide, FileError, Point, Trace};
use gcode::{Argument, Code, Value};

/// Reads a contour from a G-code program: G1, G2 and G3 with X, Y and I, J or R after the last
/// G0, as wall of the part. G0 positions; G20 and G21 choose inches and millimetres, G90 and G91
/// absolute and incremental coordinates; G41 and G42 say on which side the cutter runs. Feeds,
/// speeds, tools, M codes and Z are passed over; words G9, G17, G40 and G94 are accepted.
///
/// `side` stands where the program has neither G41 nor G42.
///
/// # Errors
/// [`FileError`] with line and column of the first fault: another G code, an arc that misses its
/// end, an open contour where a closed one is due.
///
/// # Examples
/// ```
/// let program = "G21 G90 G42\nG0 X0 Y0\nG1 X40\nG3 X60 Y20 I0 J20\nG1 Y60";
/// let contour = toolroom_contour::read_gcode(program, None, false).unwrap();
/// assert!((contour.sections[1].curvature - 50.0).abs() < 1e-9);
/// ```
pub fn read(program: &str, side: Option<CutterSide>, closed: bool) -> Result<Contour, FileError> {
    Ok(read_placed(program, side, closed)?.0)
}

/// [`read`] with line and column of the block that draws each section.
pub(crate) fn read_placed(program: &str, side: Option<CutterSide>, closed: bool) -> Result<Placed, FileError> {
    let syntax = |diagnostics: gcode::Diagnostics| {
        let first = diagnostics.iter().next();
        let at = first.map_or(0, |diagnostic| diagnostic.span.start);
        let message = first.map_or_else(String::new, |diagnostic| diagnostic.kind.to_string());
        FileError::at(program, at, ContourError::Syntax { message })
    };
    let blocks = gcode::parse(program).map_err(syntax)?.blocks;
    let mut reader = Reader { at: Point::default(), scale: 1e-3, absolute: true, motion: 0, side, trace: None };
    let mut last = 0;
    let mut places: Vec<usize> = Vec::new();
    for block in &blocks {
        last = block.span.start;
        let mut words: Vec<&Argument> = Vec::new();
        let mut motions = 0;
        for code in &block.codes {
            let Code::General(code) = code else { continue };
            motions += u32::from(code.number.major() <= 3);
            if motions > 1 {
                return Err(FileError::at(program, code.span.start, ContourError::GcodeTwoMotions));
            }
            let minor = code.number.minor().map_or(0, std::num::NonZeroU32::get);
            reader.modal(code.number.major(), minor).map_err(|fault| FileError::at(program, code.span.start, fault))?;
            words.extend(&code.args);
        }
        let mut coordinates = Coordinates::default();
        for word in words {
            coordinates
                .take(word.letter, &word.value)
                .map_err(|fault| FileError::at(program, word.span.start, fault))?;
        }
        for word in &block.word_addresses {
            coordinates
                .take(word.letter, &word.value)
                .map_err(|fault| FileError::at(program, word.span.start, fault))?;
        }
        reader.move_by(&coordinates).map_err(|fault| FileError::at(program, last, fault))?;
        places.resize(reader.trace.as_ref().map_or(0, Trace::sections), last);
    }
    let end = |fault| FileError::at(program, last, fault);
    let side = reader.side.ok_or_else(|| end(ContourError::GcodeSide))?;
    let trace = reader.trace.ok_or_else(|| end(ContourError::Empty))?;
    let contour = trace.finish(side, closed).map_err(|fault| {
        let at = fault.section().and_then(|section| places.get(section)).copied().unwrap_or(last);
        FileError::at(program, at, fault)
    })?;
    Ok((contour, toolroom_process::parameters::places(program, &places)))
}

/// Coordinate words of a block, program units.
#[derive(Default)]
struct Coordinates {
    x: Option<f64>,
    y: Option<f64>,
    i: Option<f64>,
    j: Option<f64>,
    r: Option<f64>,
}

impl Coordinates {
    fn take(&mut self, letter: char, value: &Value) -> Result<(), ContourError> {
        let slot = match letter.to_ascii_uppercase() {
            'X' => &mut self.x,
            'Y' => &mut self.y,
            'I' => &mut self.i,
            'J' => &mut self.j,
            'R' => &mut self.r,
            _ => return Ok(()),
        };
        let Value::Literal(number) = value else { return Err(ContourError::GcodeVariable { letter }) };
        // The parser keeps single precision; the shortest decimal of that is what was written,
        // up to seven digits.
        *slot = number.to_string().parse().ok();
        Ok(())
    }
}

struct Reader {
    at: Point,
    scale: f64,
    absolute: bool,
    /// Number of the motion code in force.
    motion: u32,
    side: Option<CutterSide>,
    trace: Option<Trace>,
}

impl Reader {
    fn modal(&mut self, major: u32, minor: u32) -> Result<(), ContourError> {
        match (major, minor) {
            (0..=3, 0) => self.motion = major,
            (9 | 17 | 40 | 94, 0) => {}
            (20, 0) => self.scale = 0.0254,
            (21, 0) => self.scale = 1e-3,
            (41, 0) => self.side = Some(CutterSide::Left),
            (42, 0) => self.side = Some(CutterSide::Right),
            (90, 0) => self.absolute = true,
            (91, 0) => self.absolute = false,
            _ => {
                let word = if minor == 0 { format!("G{major}") } else { format!("G{major}.{minor}") };
                return Err(ContourError::GcodeUnsupported { word });
            }
        }
        Ok(())
    }

    fn move_by(&mut self, words: &Coordinates) -> Result<(), ContourError> {
        let arc = words.i.is_some() || words.j.is_some() || words.r.is_some();
        if words.x.is_none() && words.y.is_none() && !arc {
            return Ok(());
        }
        let coordinate = |word: Option<f64>, from: f64| match word {
            None => from,
            Some(value) if self.absolute => value * self.scale,
            Some(value) => from + value * self.scale,
        };
        let end = Point { x: coordinate(words.x, self.at.x), y: coordinate(words.y, self.at.y) };
        if self.motion == 0 {
            self.trace = None;
        } else {
            let trace = self.trace.get_or_insert_with(|| Trace::new(self.at, 0.0));
            let left = self.motion == 3;
            match self.motion {
                1 => trace.line_to(end)?,
                _ if words.i.is_some() || words.j.is_some() => {
                    let offset = |word: Option<f64>| word.unwrap_or(0.0) * self.scale;
                    let center = Point { x: self.at.x + offset(words.i), y: self.at.y + offset(words.j) };
                    trace.arc_to(end, center, left)?;
                }
                _ => match words.r {
                    Some(radius) => trace.arc_by_radius(end, radius * self.scale, left)?,
                    None => return Err(ContourError::GcodeArc),
                },
            }
        }
        self.at = end;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fault(program: &str) -> (usize, ContourError) {
        let error = read(program, Some(CutterSide::Right), false).unwrap_err();
        (error.line, *error.fault)
    }

    #[test]
    fn modal_words_units_and_increments_are_followed() {
        let absolute = read("G21 G90\nG0 X25.4 Y0\nG1 X50.8 F100\nY25.4\n", Some(CutterSide::Right), false).unwrap();
        let incremental = read("G20 G91 G0 X1 Y0\nG1 X1\nY1 (up) ; done\nM30", Some(CutterSide::Right), false);
        assert_eq!(absolute.sections.len(), 2);
        for (a, b) in absolute.sections.iter().zip(&incremental.unwrap().sections) {
            assert!(a.start.distance(b.start) < 1e-12 && (a.length - b.length).abs() < 1e-12);
        }
    }

    #[test]
    fn radius_and_offsets_give_the_same_arc() {
        let by_offsets = read("G0 X0 Y0\nG3 X20 Y20 I0 J20", Some(CutterSide::Right), false).unwrap();
        let by_radius = read("G0 X0 Y0\nG3 X20 Y20 R20", Some(CutterSide::Right), false).unwrap();
        assert!((by_offsets.sections[0].length - by_radius.sections[0].length).abs() < 1e-12);
        let full = read("G0 X0 Y0\nG2 X0 Y0 I10 J0 G41", None, true).unwrap();
        assert!((full.length() - 0.02 * std::f64::consts::PI).abs() < 1e-12);
        assert_eq!(full.side, CutterSide::Left);
    }

    #[test]
    fn faults_name_their_line() {
        assert!(matches!(
            fault("G0 X0 Y0\nG1 X10\nG3 X20 Y10 I0 J9"),
            (3, ContourError::ArcMissesEnd { section: 1, .. })
        ));
        assert!(matches!(fault("G0 X0 Y0\nG2 X10 Y10"), (2, ContourError::GcodeArc)));
        assert!(matches!(fault("G0 X0 Y0\nG1 X1\nG81 Z1"), (3, ContourError::GcodeUnsupported { .. })));
        assert!(matches!(fault("G0 X0\nG1 X1 G2 X2 I1"), (2, ContourError::GcodeTwoMotions)));
        assert!(matches!(fault("M3 S1000"), (1, ContourError::Empty)));
        let open = read("G42 G0 X0 Y0\nG1 X10\nG1 Y10", None, true).unwrap_err();
        assert!(matches!(*open.fault, ContourError::Open { .. }));
        assert!(matches!(*read("G1 X1", None, false).unwrap_err().fault, ContourError::GcodeSide));
    }

    proptest! {
        #[test]
        fn any_text_is_answered_without_panic(text in "[GXYIJRMFS0-9. \\n(;%-]{0,60}") {
            let _ = read(&text, Some(CutterSide::Left), false);
        }
    }
}
