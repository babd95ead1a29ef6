//! Frequency responses in a table with units in its header.

use crate::coherence::CoherenceTable;
use crate::error::DynamicsError;
use crate::frf::{Direction, Frf, Measurement};
use crate::table::{Table, read_table, split_title};
use crate::unit::{self, Motion};
use nalgebra::Complex;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quantity {
    Frequency,
    Real,
    Imaginary,
    Magnitude,
    /// Magnitude in decibels.
    Level,
    Phase,
    Coherence,
}

/// A column with the directions of its function.
struct Column {
    title: String,
    function: [Direction; 2],
    quantity: Quantity,
    /// Factor of its values to SI.
    factor: f64,
    motion: Motion,
}

/// The columns of one function and their values.
#[derive(Default)]
struct Parts {
    values: Vec<(Quantity, f64, Motion, Vec<f64>)>,
}

/// Reads frequency responses from a table; `file` is its name in messages.
///
/// Columns stand in any order, with units in the header: `frequency [Hz]` and either `real [um/N]`, `imag [um/N]` or
/// `magnitude [um/N]`, `phase [deg]`, and `coherence` where it is known. Several functions have `xx.`, `xy.`, `yx.` or
/// `yy.` before the name: the direction of the response, then that of the force. Taps at two points of a blank have `11.`, `21.`,
/// `12.` or `22.` in their place, the point of the response and that of the force. Cells are separated by commas,
/// semicolons or tabs; lines that start with `#` are comments.
///
/// # Errors
/// [`DynamicsError`] with file, line and column of the first fault.
///
/// # Examples
/// ```
/// let text = "frequency [Hz],real [um/N],imag [um/N]\n100,0.5,-0.1\n102,0.6,-0.2\n";
/// let measured = toolroom_dynamics::read_csv("tap.csv", text).unwrap();
/// assert_eq!(measured.functions[0].name(), "xx");
/// assert!((measured.functions[0].receptance[1].im + 0.2e-6).abs() < 1e-18);
/// ```
pub fn read_csv(file: &str, text: &str) -> Result<Measurement, DynamicsError> {
    let table = read_table(file, text)?;
    if speed_column(&table).is_some() {
        return Err(DynamicsError::BySpeed { file: file.to_owned() });
    }
    from_table(file, table)
}

/// Reads frequency responses at several spindle speeds (rad/s), ascending: a table as that of [`read_csv`] with the column
/// `spindle_speed [rpm]`, whose rows of one speed are one measurement. None where the table has no such column.
///
/// # Errors
/// As [`read_csv`]; a speed that is not positive.
///
/// # Examples
/// ```
/// let text = "spindle_speed [rpm],frequency [Hz],real [um/N],imag [um/N]\n6000,100,0.5,-0.1\n3000,100,0.6,-0.2\n";
/// let measured = toolroom_dynamics::read_csv_by_speed("taps.csv", text).unwrap().unwrap();
/// assert_eq!(measured.len(), 2);
/// assert!((measured[0].0 - 314.159265).abs() < 1e-6 && measured[0].1.functions[0].receptance[0].re == 0.6e-6);
/// ```
pub fn read_csv_by_speed(file: &str, text: &str) -> Result<Option<Vec<(f64, Measurement)>>, DynamicsError> {
    let table = read_table(file, text)?;
    let Some(place) = speed_column(&table) else { return Ok(None) };
    let Table { line, mut titles, mut columns, mut decimals } = table;
    let title = titles.remove(place);
    decimals.remove(place);
    let told = columns.remove(place);
    let (_, unit) = split_title(&title);
    let unit = unit.filter(|unit| !unit.is_empty()).ok_or_else(|| DynamicsError::MissingUnit {
        file: file.to_owned(),
        line,
        column: title.clone(),
        example: "spindle_speed [rpm]",
    })?;
    let factor = unit::speed(unit).ok_or_else(|| DynamicsError::UnknownUnit {
        file: file.to_owned(),
        line,
        column: title.clone(),
        unit: unit.to_owned(),
        accepted: unit::SPEEDS,
    })?;
    let mut speeds = told.clone();
    speeds.sort_by(f64::total_cmp);
    speeds.dedup();
    if let Some(speed) = speeds.iter().find(|speed| **speed <= 0.0) {
        return Err(DynamicsError::Speed { file: file.to_owned(), value: *speed });
    }
    let at = |speed: &f64| {
        let rows = |column: &Vec<f64>| {
            column.iter().zip(&told).filter(|(_, told)| *told == speed).map(|(value, _)| *value).collect()
        };
        let table = Table {
            line,
            titles: titles.clone(),
            columns: columns.iter().map(rows).collect(),
            decimals: decimals.clone(),
        };
        let named = format!("{file} at {speed} {unit}");
        Ok((speed * factor, from_table(&named, table)?))
    };
    speeds.iter().map(at).collect::<Result<Vec<_>, _>>().map(Some)
}

/// Place of the column of spindle speeds.
fn speed_column(table: &Table) -> Option<usize> {
    table.titles.iter().position(|title| split_title(title).0 == "spindle_speed")
}

fn from_table(file: &str, table: Table) -> Result<Measurement, DynamicsError> {
    let Table { line, titles, columns: cells, decimals } = table;
    let columns: Vec<Column> = titles.iter().map(|title| column(file, line, title)).collect::<Result<_, _>>()?;
    let coherence_digit = coherence_digit(&columns, &decimals);
    let missing = |column: String| DynamicsError::ColumnCount { file: file.to_owned(), line, column };
    let mut frequencies = None;
    let mut functions: BTreeMap<[Direction; 2], Parts> = BTreeMap::new();
    for (column, values) in columns.into_iter().zip(cells) {
        if column.quantity == Quantity::Frequency {
            if frequencies.replace(values.iter().map(|value| value * column.factor).collect::<Vec<f64>>()).is_some() {
                return Err(missing(column.title));
            }
            continue;
        }
        let parts = functions.entry(column.function).or_default();
        if parts.values.iter().any(|(quantity, ..)| *quantity == column.quantity) {
            return Err(missing(column.title));
        }
        parts.values.push((column.quantity, column.factor, column.motion, values));
    }
    let frequencies = frequencies.ok_or_else(|| missing("frequency [Hz]".to_owned()))?;
    let functions = functions.into_iter().map(|([response, force], parts)| {
        parts
            .function(response, force)
            .ok_or_else(|| missing(format!("{response}{force}.real, {response}{force}.imag")))
    });
    let notes = frequencies_in_radians(&frequencies).into_iter().collect();
    Measurement {
        source: file.to_owned(),
        frequencies,
        functions: functions.collect::<Result<_, _>>()?,
        averages: None,
        coherence_digit,
        window_decay: 0.0,
        notes,
    }
    .checked()
}

/// Half of the last digit of the coherence as it is written.
fn coherence_digit(columns: &[Column], decimals: &[usize]) -> f64 {
    let written = columns.iter().zip(decimals).filter(|(column, _)| column.quantity == Quantity::Coherence);
    let digit = |(column, decimals): (&Column, &usize)| {
        0.5 * column.factor * 10f64.powi(-i32::try_from(*decimals).unwrap_or(i32::MAX))
    };
    written.map(digit).reduce(f64::min).unwrap_or(0.5)
}

/// A note where lines called Hz are 2 pi times a round number apart, and not a round number: eighths of Hz, as analysers have them.
fn frequencies_in_radians(frequencies: &[f64]) -> Option<String> {
    let [first, second, .., last] = *frequencies else { return None };
    let step = (last - first) / (frequencies.len() - 1) as f64;
    let round = |step: f64| step > 0.0 && ((8.0 * step).round() - 8.0 * step).abs() < 1e-4 && 8.0 * step > 0.5;
    let suspicious = ((second - first) / step - 1.0).abs() < 1e-3 && round(step / TAU) && !round(step);
    suspicious.then(|| {
        format!("the lines are 2 pi times {:.3} Hz apart: are the frequencies in rad/s, and not in Hz?", step / TAU)
    })
}

/// The coherence that a table holds of each function, over its frequencies (Hz).
pub(crate) fn read_coherence_csv(file: &str, text: &str) -> Result<CoherenceTable, DynamicsError> {
    let Table { line, titles, columns: cells, decimals } = read_table(file, text)?;
    let columns: Vec<Column> = titles.iter().map(|title| column(file, line, title)).collect::<Result<_, _>>()?;
    let digit = coherence_digit(&columns, &decimals);
    let missing = |column: &str| DynamicsError::ColumnCount { file: file.to_owned(), line, column: column.to_owned() };
    let (mut frequencies, mut functions) = (None, Vec::new());
    for (column, values) in columns.into_iter().zip(cells) {
        let values: Vec<f64> = values.into_iter().map(|value| value * column.factor).collect();
        match column.quantity {
            Quantity::Frequency if frequencies.is_none() => frequencies = Some(values),
            Quantity::Frequency => return Err(missing(&column.title)),
            Quantity::Coherence if functions.iter().any(|(function, _)| *function == column.function) => {
                return Err(missing(&column.title));
            }
            Quantity::Coherence => functions.push((column.function, values)),
            Quantity::Real | Quantity::Imaginary | Quantity::Magnitude | Quantity::Level | Quantity::Phase => {}
        }
    }
    let frequencies = frequencies.ok_or_else(|| missing("frequency [Hz]"))?;
    if functions.is_empty() {
        return Err(missing("coherence"));
    }
    Ok(CoherenceTable { source: file.to_owned(), frequencies, functions, digit })
}

/// What a title of the header means.
fn column(file: &str, line: usize, title: &str) -> Result<Column, DynamicsError> {
    let (name, unit) = split_title(title);
    let unknown = || DynamicsError::UnknownColumn { file: file.to_owned(), line, column: title.to_owned() };
    let (function, name) = match name.split_once('.') {
        None => ([Direction::X, Direction::X], name.as_str()),
        Some(("xx", name)) => ([Direction::X, Direction::X], name),
        Some(("xy", name)) => ([Direction::X, Direction::Y], name),
        Some(("yx", name)) => ([Direction::Y, Direction::X], name),
        Some(("yy", name)) => ([Direction::Y, Direction::Y], name),
        // Points of a blank in one direction: the first stands where x does, the second where y does.
        Some(("11", name)) => ([Direction::X, Direction::X], name),
        Some(("12", name)) => ([Direction::X, Direction::Y], name),
        Some(("21", name)) => ([Direction::Y, Direction::X], name),
        Some(("22", name)) => ([Direction::Y, Direction::Y], name),
        Some(_) => return Err(unknown()),
    };
    let (quantity, example, accepted) = match name {
        "frequency" => (Quantity::Frequency, "frequency [Hz]", "Hz, kHz, rad/s"),
        "real" => (Quantity::Real, "real [um/N]", unit::RESPONSES),
        "imag" | "imaginary" => (Quantity::Imaginary, "imag [um/N]", unit::RESPONSES),
        "magnitude" => (Quantity::Magnitude, "magnitude [um/N]", unit::RESPONSES),
        "phase" => (Quantity::Phase, "phase [deg]", "deg, rad"),
        "coherence" => (Quantity::Coherence, "coherence", "1, %"),
        _ => return Err(unknown()),
    };
    let title = title.to_owned();
    let found = |quantity, factor, motion| Ok(Column { title: title.clone(), function, quantity, factor, motion });
    if quantity == Quantity::Coherence {
        return match unit.unwrap_or_default() {
            "" | "1" | "-" => found(quantity, 1.0, Motion::Displacement),
            "%" => found(quantity, 0.01, Motion::Displacement),
            unit => Err(DynamicsError::UnknownUnit {
                file: file.to_owned(),
                line,
                column: title.clone(),
                unit: unit.to_owned(),
                accepted: "1, %",
            }),
        };
    }
    let column = || title.clone();
    let unit = unit.filter(|unit| !unit.is_empty()).ok_or_else(|| DynamicsError::MissingUnit {
        file: file.to_owned(),
        line,
        column: column(),
        example,
    })?;
    let refused = || DynamicsError::UnknownUnit {
        file: file.to_owned(),
        line,
        column: column(),
        unit: unit.to_owned(),
        accepted,
    };
    match quantity {
        Quantity::Frequency => found(quantity, unit::frequency(unit).ok_or_else(refused)?, Motion::Displacement),
        Quantity::Phase => found(quantity, unit::phase(unit).ok_or_else(refused)?, Motion::Displacement),
        Quantity::Real | Quantity::Imaginary | Quantity::Magnitude | Quantity::Level | Quantity::Coherence => {
            let (level, plain) = match unit.strip_prefix("dB re 1 ") {
                Some(plain) if quantity == Quantity::Magnitude => (true, plain),
                _ => (false, unit),
            };
            let (factor, motion) = unit::response(plain).ok_or_else(refused)?;
            found(if level { Quantity::Level } else { quantity }, factor, motion)
        }
    }
}

impl Parts {
    /// The function, if its columns make one.
    fn function(self, response: Direction, force: Direction) -> Option<Frf> {
        let find = |wanted: Quantity| self.values.iter().find(|(quantity, ..)| *quantity == wanted);
        let complex = |a: &[f64], b: &[f64], of: &dyn Fn(f64, f64) -> Complex<f64>| -> Vec<Complex<f64>> {
            a.iter().zip(b).map(|(a, b)| of(*a, *b)).collect()
        };
        let (motion, receptance) = match (find(Quantity::Real), find(Quantity::Imaginary)) {
            (Some((_, re, motion, a)), Some((_, im, other, b))) if motion == other => {
                (*motion, complex(a, b, &|a, b| Complex::new(a * re, b * im)))
            }
            _ => {
                let (quantity, scale, motion, a) = find(Quantity::Magnitude).or_else(|| find(Quantity::Level))?;
                let (_, radians, _, b) = find(Quantity::Phase)?;
                let level = *quantity == Quantity::Level;
                let size = |a: f64| if level { 10f64.powf(a / 20.0) } else { a } * scale;
                (*motion, complex(a, b, &|a, b| Complex::from_polar(size(a), b * radians)))
            }
        };
        let coherence = find(Quantity::Coherence);
        let coherence = coherence.map(|(_, factor, _, values)| values.iter().map(|value| value * factor).collect());
        Some(Frf { response, force, motion, receptance, coherence, noise: None })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn columns_stand_in_any_order_and_unit() {
        let one = read_csv("a", "imag [m/N];frequency [kHz];real [m/N]\n-2e-7;0.1;3e-7\n-1e-7;0.2;1e-7\n").unwrap();
        let text = "frequency [Hz],magnitude [dB re 1 m/N],phase [rad],coherence\n100,-128.860566,-0.5880026,0.99\n200,-136.9897,-0.78539816,1.000\n";
        let two = read_csv("b", text).unwrap();
        for (a, b) in one.functions[0].receptance.iter().zip(&two.functions[0].receptance) {
            assert!((a - b).norm() < 1e-6 * a.norm(), "{a} {b}");
        }
        assert_eq!(two.coherence_digit, 0.0005);
    }

    #[test]
    fn decimal_commas_are_read_where_they_do_not_separate() {
        let read = |text: &str| read_csv("a.csv", text);
        let point =
            read("frequency [Hz],real [um/N],imag [um/N],coherence\n100.5,0.25,-0.5,0.99\n101,0.3,-1e-2,1\n").unwrap();
        let comma =
            read("frequency [Hz];real [um/N];imag [um/N];coherence\n100,5;0,25;-0,5;0,99\n101;0,3;-1e-2;1\n").unwrap();
        assert_eq!(Measurement { source: "a.csv".to_owned(), ..comma }, point);
        let fault = |text: &str| read(text).unwrap_err().to_string();
        assert!(fault("frequency [Hz];real [um/N];imag [um/N]\n1.000,5;1;1\n").contains("`1.000,5`"));
        let wide: String = "frequency [Hz],real".chars().flat_map(|letter| [letter, '\0']).collect();
        assert!(fault(&wide).contains("UTF-16"));
    }

    #[test]
    fn units_stand_in_brackets_of_both_kinds_or_in_a_row_of_their_own() {
        let read = |text: &str| read_csv("a.csv", text).unwrap();
        let rows = "100,0.5,-0.1,0.98\n102,0.6,-0.2,0.99\n";
        let usual = read(&format!("frequency [Hz],real [um/N],imag [um/N],coherence\n{rows}"));
        let round = read(&format!("Frequency (Hz),Real (um/N),Imaginary (um/N),Coherence\n{rows}"));
        let below = read(&format!("\"Frequency\",\"Real\",\"Imag\",Coherence\nHz,um/N,um/N,\n{rows}"));
        let returns = read(&format!("frequency [Hz],real [um/N],imag [um/N],coherence\n{rows}").replace('\n', "\r"));
        assert_eq!([&round, &below, &returns], [&usual; 3]);
        let share = read("frequency [Hz],real [um/N],imag [um/N],coherence [%]\n100,0.5,-0.1,98\n102,0.6,-0.2,99\n");
        for (found, told) in share.functions[0].coherence.iter().flatten().zip([0.98, 0.99]) {
            assert!((found - told).abs() < 1e-15);
        }
        assert_eq!((share.coherence_digit, usual.coherence_digit), (0.005, 0.005));
    }

    #[test]
    fn frequencies_in_rad_per_second_that_are_called_hz_are_told() {
        let read = |step: f64| {
            let rows: String = (1..40).fold(String::new(), |rows, i| format!("{rows}{},{i},1\n", step * f64::from(i)));
            read_csv("a.csv", &format!("frequency [Hz],real [um/N],imag [um/N]\n{rows}")).unwrap().notes
        };
        assert!(read(2.0 * TAU)[0].contains("rad/s"));
        for step in [2.0, 0.5, 1.25, 1.220_703_125, 12.5, 0.1] {
            assert_eq!(read(step), Vec::<String>::new(), "{step}");
        }
    }

    #[test]
    fn a_response_that_is_the_same_everywhere_is_refused() {
        let rows: String = (1..30).fold(String::new(), |rows, line| format!("{rows}{line},1,0\n"));
        let refused = |unit: &str| {
            let text = format!("frequency [Hz],real [{unit}],imag [{unit}]\n{rows}");
            read_csv("a.csv", &text).unwrap_err().to_string()
        };
        assert!(refused("um/N").contains("xx is 1e-6 on every line"), "{}", refused("um/N"));
        assert!(refused("m/s2/N").contains("xx is 1e0 on every line"), "{}", refused("m/s2/N"));
    }

    #[test]
    fn acceleration_becomes_displacement() {
        let found = read_csv("a", "frequency [Hz],real [g/N],imag [g/N]\n100,-1,0\n").unwrap();
        let expected = 9.80665 / (628.318_530_717_958_6f64).powi(2);
        assert!((found.functions[0].receptance[0].re / expected - 1.0).abs() < 1e-12);
    }

    #[test]
    fn faults_name_file_line_and_column() {
        let fault = |text: &str| read_csv("tap.csv", text).unwrap_err().to_string();
        assert!(fault("frequency [Hz],real,imag [um/N]\n").starts_with("tap.csv:1: the column `real` has no unit"));
        assert!(fault("frequency [Hz],real [V/N],imag [um/N]\n").contains("the unit `V/N` of the column"));
        assert!(fault("frequency [Hz],real [um/N],imag [um/N]\n1,2,x\n").starts_with("tap.csv:2: `x` in the column"));
        assert!(fault("frequency [Hz],real [um/N],imag [um/N]\n1,2\n").contains("the row has 2 cells, the header 3"));
        assert!(fault("frequency [Hz],real [um/N]\n1,2\n").contains("must be there once"));
        assert!(fault("frequency [Hz],real [um/N],imag [um/N]\n2,1,1\n1,1,1\n").contains("1 Hz follows 2 Hz"));
        assert!(fault("frequency [Hz],real [um/N],imag [um/N],coherence\n2,1,1,1.2\n").contains("coherence at 2 Hz"));
        assert!(fault("").contains("the file is empty"));
        assert!(fault("frequency [Hz],real [um/N],imag [um/N]\n").contains("no frequency response"));
    }

    #[test]
    fn responses_at_several_speeds_are_told_apart() {
        let text =
            "frequency [Hz],spindle_speed [1/min],real [um/N],imag [um/N]\n100,3000,1,0\n100,6000,3,0\n110,3000,2,0\n";
        let found = read_csv_by_speed("a", text).unwrap().unwrap();
        assert_eq!(found.iter().map(|(_, measured)| measured.frequencies.len()).collect::<Vec<_>>(), [2, 1]);
        assert!(read_csv("a", text).unwrap_err().to_string().contains("several spindle speeds"));
        let fault =
            |header: &str, row: &str| read_csv_by_speed("a", &format!("{header}\n{row}\n")).unwrap_err().to_string();
        let rest = "frequency [Hz],real [um/N],imag [um/N]";
        assert!(fault(&format!("spindle_speed,{rest}"), "1,1,1,1").contains("has no unit"));
        assert!(fault(&format!("spindle_speed [m/min],{rest}"), "1,1,1,1").contains("rpm"));
        assert!(fault(&format!("spindle_speed [rpm],{rest}"), "0,1,1,1").contains("0"));
        assert_eq!(read_csv_by_speed("a", "frequency [Hz],real [um/N],imag [um/N]\n1,1,1\n"), Ok(None));
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in "(frequency \\[Hz\\]|[a-z.]{1,6}|\\[um/N\\]|[0-9.,;\\-\n ]|real|imag){0,40}") {
            let _ = read_csv("a", &text);
        }
    }
}
