//! Contours drawn by part programs.

use crate::file::Placed;
use crate::{Contour, ContourError, CutterSide, FileError, Point, Trace};
use toolroom_program::{Arc, Control, EventKind, Motion, Path, ProgramError, Run};

/// Reads a contour from a part program in the language of any control: what it moves at feed in the plane XY after the
/// last rapid motion in that plane which is followed by such motions, as wall of the part. Motions along Z alone are passed
/// over; subprograms, loops, rotations and cycles are followed as the control would. Compensation of the radius says on
/// which side the cutter runs, and is not worked out: the program draws the wall.
///
/// `side` stands where the program has no compensation of the radius. Feeds need not stand in the program.
///
/// # Errors
/// [`FileError`] with line and column of the first fault: a word that is not understood, an arc that misses its end or
/// lies in another plane, an open contour where a closed one is due.
///
/// # Examples
/// ```
/// use toolroom_program::Control;
/// let program = "G21 G90 G42\nG0 X0 Y0\nG1 X40\nG3 X60 Y20 I0 J20\nG1 Y60\nG0 Z50";
/// let contour = toolroom_contour::read_gcode(program, &Control::default(), None, false).unwrap();
/// assert!((contour.sections[1].curvature - 50.0).abs() < 1e-9);
/// ```
pub fn read(program: &str, control: &Control, side: Option<CutterSide>, closed: bool) -> Result<Contour, FileError> {
    Ok(read_placed(program, control, side, closed)?.0)
}

/// Feed that a contour is read with where its program has none, mm/min; it changes nothing.
const ANY_FEED: f64 = 1000.0;

/// [`read`] with line and column of the block that draws each section.
pub(crate) fn read_placed(
    program: &str,
    control: &Control,
    side: Option<CutterSide>,
    closed: bool,
) -> Result<Placed, FileError> {
    let refused = |error: ProgramError| FileError {
        line: error.line,
        column: error.column,
        fault: Box::new(ContourError::Program { message: error.to_string() }),
    };
    let control = Control { feed: control.feed.or(Some(ANY_FEED)), ..control.clone() };
    let mut run = Run::new(program, &control).map_err(refused)?;
    let mut reader = Reader { drawn: None, next: None };
    let mut last = 1;
    for event in run.by_ref() {
        let event = event.map_err(refused)?;
        last = event.main_line;
        if let EventKind::Motion(motion) = event.kind {
            reader.motion(&motion, last).map_err(|fault| at_line(last, fault))?;
        }
    }
    let side = run.side().map(|left| if left { CutterSide::Left } else { CutterSide::Right }).or(side);
    let side = side.ok_or_else(|| at_line(last, ContourError::GcodeSide))?;
    let (trace, lines) = reader.next.or(reader.drawn).ok_or_else(|| at_line(last, ContourError::Empty))?;
    let contour = trace.finish(side, closed).map_err(|fault| {
        let line = fault.section().and_then(|section| lines.get(section)).copied().unwrap_or(last);
        at_line(line, fault)
    })?;
    Ok((contour, lines.into_iter().map(|line| (line, 1)).collect()))
}

fn at_line(line: usize, fault: ContourError) -> FileError {
    FileError { line, column: 1, fault: Box::new(fault) }
}

/// A trace with the line that draws each of its sections.
type Drawn = (Trace, Vec<usize>);

struct Reader {
    /// The last path before a rapid motion in the plane.
    drawn: Option<Drawn>,
    /// The path behind it.
    next: Option<Drawn>,
}

/// A position in the plane, m.
fn point(axes: &[f64; 9]) -> Point {
    Point { x: 1e-3 * axes[0], y: 1e-3 * axes[1] }
}

impl Reader {
    fn motion(&mut self, motion: &Motion, line: usize) -> Result<(), ContourError> {
        let (start, end) = (point(&motion.start), point(&motion.end));
        let turns = matches!(motion.path, Path::Arc(_));
        if start == end && !turns {
            return Ok(());
        }
        if motion.rapid {
            self.drawn = self.next.take().or(self.drawn.take());
            return Ok(());
        }
        let (trace, lines) = self.next.get_or_insert_with(|| (Trace::new(start, 0.0), Vec::new()));
        match motion.path {
            Path::Line => trace.line_to(end)?,
            Path::Arc(Arc { plane: [0, 1, 2], angle, centre, left, .. }) if angle <= TURN => {
                trace.arc_to(end, Point { x: 1e-3 * centre[0], y: 1e-3 * centre[1] }, left)?;
            }
            Path::Arc(_) => return Err(ContourError::GcodePlane),
        }
        lines.resize(trace.sections(), line);
        Ok(())
    }
}

/// A full turn with the rounding of its ends, rad.
const TURN: f64 = std::f64::consts::TAU * (1.0 + 1e-9);

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(program: &str, side: Option<CutterSide>, closed: bool) -> Result<Contour, FileError> {
        super::read(program, &Control::default(), side, closed)
    }

    fn fault(program: &str) -> (usize, ContourError) {
        let error = read(program, Some(CutterSide::Right), false).unwrap_err();
        (error.line, *error.fault)
    }

    fn same(one: &Contour, other: &Contour) {
        assert_eq!(one.sections.len(), other.sections.len());
        for (a, b) in one.sections.iter().zip(&other.sections) {
            assert!(a.start.distance(b.start) < 1e-9 && (a.length - b.length).abs() < 1e-9);
        }
    }

    #[test]
    fn modal_words_units_and_increments_are_followed() {
        let absolute = read("G21 G90\nG0 X25.4 Y0\nG1 X50.8 F100\nY25.4\n", Some(CutterSide::Right), false).unwrap();
        let incremental = read("G20 G91 G0 X1 Y0\nG1 X1\nY1 (up)\nM30", Some(CutterSide::Right), false);
        assert_eq!(absolute.sections.len(), 2);
        same(&absolute, &incremental.unwrap());
    }

    #[test]
    fn programs_of_shops_draw_the_contour_of_the_plain_one() {
        let plain = read("G21 G42\nG0 X0 Y0\nG1 X40\nG3 X60 Y20 J20\nG1 Y60", None, false).unwrap();
        for program in [
            "%\nO1\nG21 G17 G40 G80 G90\nT1 M6\nG54 G0 X0 Y0 S3000 M3\nG43 H1 Z10 M8\nG1 Z-5 F100\nG42 D1\nX40 F200\n\
             G3 X60 Y20 R20\nG1 Y60\nG0 Z10\nG40\nG4 P500\nM9\nG28 G91 Z0\nM30\n%",
            "G21 G90 G42\nG0 X0 Y0\nM98 P10\nM30\nO10\nG1 X40\nG3 X60 Y20 I0 J20\nG1 Y60\nM99",
            "BEGIN PGM C MM\nTOOL CALL 1 Z S3000\nL X+0 Y+0 R0 FMAX M3\nL Z-5 F200\nL X+40 RR\nCC X+40 Y+20\nC X+60 Y+20 DR+\n\
             L Y+60\nL Z+50 R0 FMAX M30\nEND PGM C MM",
            "G71 G90 G42\nG0 X0 Y0\nG1 X40 F100\nG3 X60 Y20 CR=20\nG1 Y60\nG0 Z50\nM30",
        ] {
            same(&plain, &read(program, None, false).unwrap_or_else(|error| panic!("{error}\n{program}")));
        }
    }

    #[test]
    fn radius_and_offsets_give_the_same_arc() {
        let by_offsets = read("G21 G0 X0 Y0\nG3 X20 Y20 I0 J20", Some(CutterSide::Right), false).unwrap();
        let by_radius = read("G21 G0 X0 Y0\nG3 X20 Y20 R20", Some(CutterSide::Right), false).unwrap();
        assert!((by_offsets.sections[0].length - by_radius.sections[0].length).abs() < 1e-12);
        let full = read("G21 G41 G0 X0 Y0\nG2 X0 Y0 I10 J0", None, true).unwrap();
        assert!((full.length() - 0.02 * std::f64::consts::PI).abs() < 1e-12);
        assert_eq!(full.side, CutterSide::Left);
    }

    #[test]
    fn faults_name_their_line() {
        let program = |text: &str| {
            let (line, fault) = fault(text);
            assert!(matches!(fault, ContourError::Program { .. }), "{fault}");
            (line, fault.to_string())
        };
        assert_eq!(program("G21 G0 X0 Y0\nG1 X10\nG3 X20 Y10 I0 J9").0, 3);
        assert_eq!(program("G21 G0 X0 Y0\nG2 X10 Y10").0, 2);
        assert_eq!(program("G21 G0 X0 Y0\nG1 X1\nG411").0, 3);
        let (line, reason) = program("G0 X0 Y0\nG1 X1");
        assert!(line == 2 && reason.contains("--units"), "{line} {reason}");
        assert!(matches!(fault("G21 G0 X0 Y0 Z0\nG18 G2 X10 Z0 I5"), (2, ContourError::GcodePlane)));
        assert!(matches!(fault("M3 S1000"), (1, ContourError::Empty)));
        let open = read("G21 G42 G0 X0 Y0\nG1 X10\nG1 Y10", None, true).unwrap_err();
        assert!(matches!(*open.fault, ContourError::Open { .. }));
        assert!(matches!(*read("G21 G1 X1", None, false).unwrap_err().fault, ContourError::GcodeSide));
    }

    proptest! {
        #[test]
        fn any_text_is_answered_without_panic(text in "[GXYIJRMFS0-9. \\n(;%-]{0,60}") {
            let _ = read(&format!("G21 {text}"), Some(CutterSide::Left), false);
        }
    }
}
