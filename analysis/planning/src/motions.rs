//! The motions of a part program as a table.

use crate::explain::purpose;
use crate::tables::table;
use toolroom_drives::Drives;
use toolroom_process::table::Cell;
use toolroom_program::{AXES, Control, EventKind, ProgramError, Run, Source};

/// Every motion of a program as CSV: the line, the tool, what the motion is for, its time without acceleration (s), the length
/// of its path (mm), and where its moving axes are behind it (mm and degrees; X of a lathe is a diameter, as in the program). The time of a
/// rapid motion is that of its slowest axis on `drives`.
///
/// # Errors
/// [`ProgramError`]: the program is refused.
pub fn motion_table(text: &Source, control: &Control, drives: &Drives) -> Result<String, ProgramError> {
    let (mut rows, mut tool) = (Vec::new(), None);
    let mut run = Run::new(text.clone(), control)?;
    for event in run.by_ref() {
        let event = event?;
        match event.kind {
            EventKind::ToolChange(number) => tool = number,
            EventKind::Motion(motion) => rows.push((event.line, tool, motion)),
            EventKind::Block
            | EventKind::Spindle { .. }
            | EventKind::Home(_)
            | EventKind::Dwell(_)
            | EventKind::Coolant(_)
            | EventKind::Stop(_)
            | EventKind::Auxiliary(..)
            | EventKind::Hole
            | EventKind::ExactStop
            | EventKind::Offset(_)
            | EventKind::End => {}
        }
    }
    let factors = run.factors();
    // Axes that never move may not be there.
    let axes: Vec<usize> = (0..AXES.len())
        .filter(|axis| rows.iter().any(|(.., motion)| motion.start[*axis] != motion.end[*axis]))
        .collect();
    let names = axes.iter().map(|axis| {
        // A, B and C turn.
        let unit = if (3..6).contains(axis) { "deg" } else { "mm" };
        format!("{} [{unit}]", AXES[*axis].to_string().to_lowercase())
    });
    let columns = ["line", "tool", "purpose", "rapid", "time [s]", "length [mm]"].map(str::to_owned);
    let header: Vec<String> = columns.into_iter().chain(names).collect();
    let row = |(line, tool, motion): &(usize, Option<u32>, toolroom_program::Motion)| -> Vec<Cell<'static>> {
        let mut cells = vec![
            (*line).into(),
            (*tool).into(),
            purpose(motion).into(),
            u32::from(motion.rapid).into(),
            Cell::Fixed(drives.rapid_time(motion) + motion.time, 6),
            Cell::Fixed(motion.length, 6),
        ];
        cells.extend(axes.iter().map(|axis| Cell::from(factors[*axis] * motion.end[*axis])));
        cells
    };
    Ok(table(header, rows.iter().map(row)))
}
