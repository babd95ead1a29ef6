//! Cuts that tell of modes, out of the records of a shop.

use super::UpdateError;
use std::collections::BTreeSet;
use toolroom_dynamics::{ShopCut, ShopCutError, read_shop_cuts};
use toolroom_lobes::{LobesCut, LobesFile};
use toolroom_location::{Located, Location};
use toolroom_records::{RecordError, RecordKind, Records, parse_csv};

/// Land up to which an edge counts as sharp (m). Assumption: the indentation of such a land damps no more than the scatter of
/// damping ratios from mounting to mounting; a lobes file does not say how wear changes the force.
const SHARP: f64 = 0.1e-3;

/// Cuts out of records, with what was left out.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedCuts {
    /// The cuts.
    pub cuts: Vec<ShopCut>,
    /// Cuts that say nothing of chatter, or lack a condition.
    pub silent: usize,
    /// Cuts of edges that were worn.
    pub worn: usize,
}

impl RecordedCuts {
    /// In words; nothing where no cut was left out.
    pub fn words(&self) -> Option<String> {
        let Self { cuts, silent, worn } = self;
        let land = SHARP * 1e3;
        (silent + worn > 0).then(|| {
            format!(
                "{} cuts are used; {silent} say nothing of chatter, {worn} were cut with a land beyond {land} mm, of which \
                 the lobes file knows nothing",
                cuts.len()
            )
        })
    }
}

/// Why a table gives no cuts.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CutsError {
    /// A machine of a table that names none.
    #[error("--machine: a plain table of cuts names no machine")]
    NamesNoMachine,
    /// A plain table that cannot be read.
    #[error(transparent)]
    Plain(#[from] ShopCutError),
    /// Records that cannot be read.
    #[error(transparent)]
    Unreadable(#[from] RecordError),
    /// Records without such cuts.
    #[error(transparent)]
    Records(#[from] UpdateError),
}

impl Located for CutsError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::Plain(error) => error.location(),
            Self::Unreadable(error) => error.location(),
            Self::NamesNoMachine | Self::Records(..) => None,
        }
    }
}

/// Cuts of the table in the file `name`: a plain table of cuts, or the records of a shop, of `machine` where several are in
/// them. `file` tells the process.
///
/// # Errors
/// [`CutsError`]: a table that cannot be read, or records that do not tell which cuts are meant.
pub fn read_cuts(name: &str, bytes: &[u8], file: &LobesFile, machine: Option<&str>) -> Result<RecordedCuts, CutsError> {
    let text = String::from_utf8_lossy(bytes);
    if !is_records(&text) {
        if machine.is_some() {
            return Err(CutsError::NamesNoMachine);
        }
        return Ok(RecordedCuts { cuts: read_shop_cuts(name, &text)?, silent: 0, worn: 0 });
    }
    let milling = matches!(file.cut, LobesCut::Milling(_));
    let kind = if milling { RecordKind::Milling } else { RecordKind::Turning };
    let (records, _) = parse_csv(name, bytes, kind)?;
    Ok(recorded_cuts(&records, file, machine)?)
}

/// Cuts of the records of one machine: `chatter` (0 or 1), `depth_of_cut`, `spindle_speed` (of milling it may follow from
/// `cutting_speed` and the diameter of the cutter), `width_of_cut` in milling, and where it was read `chatter_frequency`.
///
/// # Errors
/// [`UpdateError`]: a lobes file of another process, records without `chatter` or spindle speed, machines among which nothing
/// was chosen, and a machine that is not in the records.
fn recorded_cuts(records: &Records, file: &LobesFile, machine: Option<&str>) -> Result<RecordedCuts, UpdateError> {
    let diameter = match &file.cut {
        LobesCut::Milling(milling) => Some(milling.cutter.diameter),
        LobesCut::Turning { .. } => None,
        LobesCut::Chuck(_) | LobesCut::ChipLag(_) | LobesCut::Lathe(_) => return Err(UpdateError::Process),
    };
    let heard = records.numbers("chatter").ok_or(UpdateError::Column { column: "chatter" })?;
    let machines = records.texts("machine").ok_or(UpdateError::Column { column: "machine" })?;
    let known: BTreeSet<&str> = machines.iter().map(String::as_str).collect();
    let names = || known.iter().copied().collect::<Vec<_>>().join(", ");
    match machine {
        Some(name) if !known.contains(name) => {
            return Err(UpdateError::NoMachine { name: name.to_owned(), known: names() });
        }
        None if known.len() > 1 => return Err(UpdateError::Machines { known: names() }),
        Some(_) | None => {}
    }
    let at = |name: &str, row: usize| records.numbers(name).map_or(f64::NAN, |values| values[row]);
    let speed = |row: usize| {
        let read = at("spindle_speed", row);
        match diameter {
            Some(diameter) if !read.is_finite() => 2.0 * at("cutting_speed", row) / diameter,
            Some(_) | None => read,
        }
    };
    let rows: Vec<usize> = (0..records.len()).filter(|row| machine.is_none_or(|name| machines[*row] == name)).collect();
    if diameter.is_none() && rows.iter().all(|row| !speed(*row).is_finite()) {
        return Err(UpdateError::Column { column: "spindle_speed" });
    }
    let mut found = RecordedCuts { cuts: Vec::new(), silent: 0, worn: 0 };
    for row in rows {
        let (spindle_speed, depth) = (speed(row), at("depth_of_cut", row));
        let immersion = diameter.map(|diameter| (at("width_of_cut", row) / diameter).min(1.0));
        let known = (heard[row] == 0.0 || heard[row] == 1.0) && spindle_speed > 0.0 && depth > 0.0;
        if !known || immersion.is_some_and(|share| share.is_nan() || share <= 0.0) {
            found.silent += 1;
            continue;
        }
        if at("flank_wear", row) > SHARP {
            found.worn += 1;
            continue;
        }
        let chatter = heard[row] == 1.0;
        let frequency = Some(at("chatter_frequency", row)).filter(|frequency| chatter && *frequency > 0.0);
        // Widths that differ by rounding alone are one immersion.
        let immersion = immersion.map(|share| (share * 1e6).round() / 1e6);
        found.cuts.push(ShopCut { spindle_speed, depth, immersion, chatter, frequency });
    }
    if found.cuts.is_empty() { Err(UpdateError::NoCuts) } else { Ok(found) }
}

/// Whether the header of a table is that of records, and not of a plain table of cuts.
fn is_records(text: &str) -> bool {
    text.lines().next().is_some_and(|header| header.contains("operation_id"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const CHART: &str = include_str!("../../../scenarios/chatter/endmill.toml");
    const RECORDS: &str = "operation_id,machine,tool_id,sequence,cutting_speed [m/min],feed_per_tooth [mm],\
        depth_of_cut [mm],width_of_cut [mm],cutting_time [min],flank_wear [mm],chatter,chatter_frequency [Hz]\n\
        1,M1,E1,1,160,0.05,2,3,1,0.02,1,910\n2,M1,E1,2,160,0.05,1.5,3,1,0.05,0,\n3,M1,E1,3,160,0.05,1.5,3,1,0.3,0,\n\
        4,M1,E1,4,160,0.05,2,3,1,0.06,,\n5,M2,E2,1,160,0.05,2,3,1,0.02,0,\n";

    fn found(machine: Option<&str>) -> Result<RecordedCuts, UpdateError> {
        let (records, _) = parse_csv("cuts.csv", RECORDS.as_bytes(), RecordKind::Milling).unwrap();
        let file = toolroom_lobes::parse("endmill.toml", CHART, &[]).unwrap().content;
        recorded_cuts(&records, &file, machine)
    }

    #[test]
    fn records_give_the_cuts_of_one_machine_with_sharp_edges() {
        let cuts = found(Some("M1")).unwrap();
        assert_eq!((cuts.cuts.len(), cuts.silent, cuts.worn), (2, 1, 1));
        let first = cuts.cuts[0];
        // 160 m/min at 12 mm, 3 of 12 mm wide.
        let rpm = first.spindle_speed * 60.0 / TAU;
        assert!((rpm - 4244.13).abs() < 0.01, "{rpm}");
        assert_eq!((first.immersion, first.chatter, first.frequency), (Some(0.25), true, Some(910.0)));
        assert!(cuts.words().unwrap().starts_with("2 cuts are used; 1 say nothing"));
        for (machine, word) in [(None, "M1, M2"), (Some("M3"), "M3")] {
            let message = found(machine).unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        }
        assert!(is_records(RECORDS) && !is_records("spindle_speed [rpm],depth_of_cut [mm],chatter\n"));
    }
}
