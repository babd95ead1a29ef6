//! Cuts of the shop that chattered or did not.

use crate::error::DynamicsError;
use crate::table::read_table;
use crate::unit::{self, Motion};
use std::f64::consts::TAU;
use toolroom_location::{Located, Location};

/// Why a table of cuts cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ShopCutError {
    /// The table cannot be read.
    #[error(transparent)]
    Table(#[from] DynamicsError),
    /// A column of no known meaning or unit, or one that is there twice.
    #[error(
        "{file}:{line}: the column `{column}` is none of `spindle_speed [rpm]`, `depth_of_cut [mm]`, `immersion`, `chatter` \
         (0 or 1) and `chatter_frequency [Hz]` (0 where it was not observed), each once and with its unit"
    )]
    Column {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The column as it is written.
        column: String,
    },
    /// A column that is needed.
    #[error("{file}:{line}: the column `{column}` is missing")]
    Missing {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The column.
        column: &'static str,
    },
    /// A value that no cut has.
    #[error("{file}: cut {row} has {value} in the column `{column}`; {due} is due")]
    Value {
        /// The file.
        file: String,
        /// Number of the cut, from 1.
        row: usize,
        /// The column.
        column: &'static str,
        /// What stands there.
        value: f64,
        /// What may stand there.
        due: &'static str,
    },
}

impl Located for ShopCutError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::Table(error) => error.location(),
            Self::Column { file, line, .. } | Self::Missing { file, line, .. } => Some(Location::line(file, *line)),
            Self::Value { file, .. } => Some(Location::of(file)),
        }
    }
}

/// A cut with whether it chattered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShopCut {
    /// Spindle speed (rad/s).
    pub spindle_speed: f64,
    /// Depth of cut (m).
    pub depth: f64,
    /// Radial width of cut over diameter, where it differs from that of the lobes file.
    pub immersion: Option<f64>,
    /// Whether it chattered.
    pub chatter: bool,
    /// Chatter frequency (Hz), where it was observed.
    pub frequency: Option<f64>,
}

/// Reads cuts from a table: `spindle_speed [rpm]`, `depth_of_cut [mm]`, `chatter` (0 or 1), and where they are known
/// `immersion` and `chatter_frequency [Hz]`, zero where it was not observed; `file` is its name in messages.
///
/// # Errors
/// [`ShopCutError`] with the place of the fault.
///
/// # Examples
/// ```
/// let text = "spindle_speed [rpm],depth_of_cut [mm],chatter\n5600,0.75,1\n7000,0.45,0\n";
/// let cuts = toolroom_dynamics::read_shop_cuts("cuts.csv", text).unwrap();
/// assert!(cuts.len() == 2 && cuts[0].chatter && (cuts[1].depth - 0.45e-3).abs() < 1e-12);
/// ```
pub fn read_shop_cuts(file: &str, text: &str) -> Result<Vec<ShopCut>, ShopCutError> {
    let table = read_table(file, text)?;
    let line = table.line;
    const NAMES: [&str; 5] = ["spindle_speed", "depth_of_cut", "immersion", "chatter", "chatter_frequency"];
    let sorted = table.sorted(|name, unit| {
        let place = NAMES.iter().position(|known| *known == name)?;
        let factor = match (place, unit) {
            (0, Some("rpm")) => Some(TAU / 60.0),
            (0, Some("rad/s")) => Some(1.0),
            (1, Some(unit)) => {
                unit::motion(unit).filter(|(_, motion)| *motion == Motion::Displacement).map(|(factor, _)| factor)
            }
            (2 | 3, None | Some("1")) => Some(1.0),
            (4, Some(unit)) => unit::frequency(unit),
            (_, _) => None,
        };
        Some((place, factor?))
    });
    let refused = |column| ShopCutError::Column { file: file.to_owned(), line, column };
    let missing = |column| ShopCutError::Missing { file: file.to_owned(), line, column };
    let [speeds, depths, immersions, chatter, frequencies] = sorted.map_err(refused)?;
    let speeds = speeds.ok_or_else(|| missing("spindle_speed [rpm]"))?;
    let depths = depths.ok_or_else(|| missing("depth_of_cut [mm]"))?;
    let chatter = chatter.ok_or_else(|| missing("chatter"))?;
    let mut cuts = Vec::with_capacity(speeds.len());
    for (i, ((speed, depth), chatter)) in speeds.iter().zip(&depths).zip(&chatter).enumerate() {
        let wrong = |column, value, due| ShopCutError::Value { file: file.to_owned(), row: i + 1, column, value, due };
        if *speed <= 0.0 {
            return Err(wrong("spindle_speed", *speed * 60.0 / TAU, "a positive speed"));
        }
        if *depth <= 0.0 {
            return Err(wrong("depth_of_cut", *depth * 1e3, "a positive depth"));
        }
        let chatter = match *chatter {
            0.0 => false,
            1.0 => true,
            other => return Err(wrong("chatter", other, "0 or 1")),
        };
        let immersion = immersions.as_ref().map(|values| values[i]);
        if let Some(immersion) = immersion.filter(|immersion| !(*immersion > 0.0 && *immersion <= 1.0)) {
            return Err(wrong("immersion", immersion, "a share above 0 and up to 1"));
        }
        let frequency = frequencies.as_ref().map(|values| values[i]).filter(|frequency| *frequency != 0.0);
        if let Some(frequency) = frequency.filter(|frequency| *frequency < 0.0 || !chatter) {
            return Err(wrong("chatter_frequency", frequency, "a frequency of a cut with chatter, else 0"));
        }
        cuts.push(ShopCut { spindle_speed: *speed, depth: *depth, immersion, chatter, frequency });
    }
    Ok(cuts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_of_a_table_of_cuts_are_told_with_their_place() {
        let good = "spindle_speed [rpm],depth_of_cut [mm],immersion,chatter,chatter_frequency [Hz]\n";
        let read = |rows: &str| read_shop_cuts("cuts.csv", &format!("{good}{rows}"));
        let cuts = read("6000,1.5,0.5,1,910\n7000,1,0.5,0,0\n").unwrap();
        assert_eq!((cuts[0].frequency, cuts[1].frequency, cuts[0].immersion), (Some(910.0), None, Some(0.5)));
        for (rows, word) in [
            ("0,1,0.5,1,910\n", "positive speed"),
            ("6000,-1,0.5,1,910\n", "positive depth"),
            ("6000,1,1.5,1,910\n", "share above 0"),
            ("6000,1,0.5,2,910\n", "0 or 1"),
            ("6000,1,0.5,0,910\n", "with chatter"),
            ("6000,1,0.5,one,910\n", "no number"),
        ] {
            let message = read(rows).unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        }
        for (header, word) in [
            ("spindle_speed,depth_of_cut [mm],chatter\n1,1,1\n", "spindle_speed"),
            ("spindle_speed [rpm],chatter\n1,1\n", "depth_of_cut"),
            ("spindle_speed [rpm],depth_of_cut [mm],chatter,tool\n1,1,1,1\n", "tool"),
        ] {
            let message = read_shop_cuts("cuts.csv", header).unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        }
    }
}
