//! Frequency responses in universal files: data set 58 in ASCII and binary, units from data set 164.
//!
//! # Source
//! The data sets 58, 58b and 164 as documented by the Structural Dynamics Research Laboratory of the University of
//! Cincinnati. Numbers are read by column, since fixed-width numbers may touch, and by blanks where that fails. The bytes of a
//! binary block are counted by what its record promises, not by the count in its header, which some programs get wrong.

use crate::error::{DynamicsError, UniversalProblem};
use crate::frf::{Direction, Frf, Measurement};
use crate::unit::{self, Motion};
use nalgebra::Complex;

/// A function type of data set 58.
const RESPONSE: i64 = 4;
/// A function type of data set 58.
const COHERENCE: i64 = 6;

/// Factors of a data set 164: a value in SI is the value of the file over the factor.
#[derive(Clone, Copy)]
struct Units {
    length: f64,
    force: f64,
}

/// One data set 58.
struct Function {
    line: usize,
    kind: i64,
    response: i64,
    force: i64,
    /// Whether its values have double precision.
    double: bool,
    frequencies: Vec<f64>,
    values: Vec<Complex<f64>>,
    /// Types of ordinate numerator and denominator, and their unit labels.
    types: [i64; 2],
    labels: [String; 2],
}

/// The bytes of a file, read line by line.
struct Cursor<'a> {
    file: &'a str,
    bytes: &'a [u8],
    place: usize,
    line: usize,
}

impl Cursor<'_> {
    /// The next line without its end; bytes that are no ASCII become question marks.
    fn line(&mut self) -> Option<String> {
        let rest = self.bytes.get(self.place..).filter(|rest| !rest.is_empty())?;
        let length = rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len());
        self.place += (length + 1).min(rest.len());
        self.line += 1;
        let text = rest[..length].strip_suffix(b"\r").unwrap_or(&rest[..length]);
        Some(text.iter().map(|byte| if byte.is_ascii() { char::from(*byte) } else { '?' }).collect())
    }

    fn fault(&self, line: usize, problem: UniversalProblem) -> DynamicsError {
        DynamicsError::Universal { file: self.file.to_owned(), line, problem }
    }

    fn due(&mut self, start: usize) -> Result<String, DynamicsError> {
        self.line().ok_or_else(|| self.fault(start, UniversalProblem::BrokenOff))
    }

    /// A whole number in some columns of a line; nothing there is zero.
    fn whole(&self, text: &str, columns: std::ops::Range<usize>) -> Result<i64, DynamicsError> {
        let field = text.get(columns.start..columns.end.min(text.len())).unwrap_or("").trim();
        if field.is_empty() {
            return Ok(0);
        }
        field.parse().map_err(|_| self.fault(self.line, UniversalProblem::NotANumber(field.to_owned())))
    }

    fn real(&self, field: &str) -> Result<f64, DynamicsError> {
        number(field).ok_or_else(|| self.fault(self.line, UniversalProblem::NotANumber(field.trim().to_owned())))
    }
}

/// A number as Fortran writes it.
fn number(field: &str) -> Option<f64> {
    field.trim().replace(['D', 'd'], "E").parse::<f64>().ok().filter(|value| value.is_finite())
}

/// Numbers of a line by columns of these widths, in turn; by blanks, where a field by columns is no number.
fn numbers(text: &str, widths: &[usize]) -> Option<Vec<f64>> {
    let by_column = || {
        let (mut found, mut start) = (Vec::new(), 0);
        for width in widths.iter().cycle() {
            let field = text.get(start..(start + width).min(text.len())).filter(|field| !field.trim().is_empty());
            let Some(field) = field else { break };
            found.push(number(field)?);
            start += width;
        }
        text.get(start..).is_none_or(|rest| rest.trim().is_empty()).then_some(found)
    };
    by_column().or_else(|| text.split_whitespace().map(number).collect())
}

/// Reads frequency responses from a universal file; `file` is its name in messages.
///
/// Functions of type 4 (response) and 6 (coherence) are taken; others are left out, which the notes say. Directions 1 and 2
/// are x and y, a negative one turns the sign.
///
/// # Errors
/// [`DynamicsError`] with file and line of the data set that cannot be read.
pub fn read_uff(file: &str, bytes: &[u8]) -> Result<Measurement, DynamicsError> {
    let mut cursor = Cursor { file, bytes, place: 0, line: 0 };
    let (mut units, mut functions, mut notes) = (None, Vec::new(), Vec::new());
    while let Some(line) = cursor.line() {
        if line.trim() != "-1" {
            continue;
        }
        // Delimiters without a data set between them are one.
        let Some(header) = std::iter::from_fn(|| cursor.line()).find(|header| header.trim() != "-1") else { break };
        let start = cursor.line;
        match header.get(..6).unwrap_or(&header).trim() {
            "58" => functions.push(function(&mut cursor, &header, start)?),
            "164" => units = Some(units_of(&mut cursor, start)?),
            _ => {}
        }
        end_of_set(&mut cursor);
    }
    let mut found: Vec<(Function, Frf)> = Vec::new();
    let (mut coherence, mut coherence_digit) = (Vec::new(), 0.0f64);
    for function in functions {
        match function.kind {
            RESPONSE => {
                let Some(frf) = response(&cursor, &function, units)? else {
                    notes.push(format!("line {}: a response out of the plane of x and y is left out", function.line));
                    continue;
                };
                found.push((function, frf));
            }
            COHERENCE => {
                coherence_digit = coherence_digit.max(if function.double { DOUBLE_DIGIT } else { DIGIT });
                coherence.push(function);
            }
            kind => notes.push(format!(
                "line {}: a function of type {kind} is left out; 4 (frequency response) and 6 (coherence) are read",
                function.line
            )),
        }
    }
    let Some(frequencies) = found.first().map(|(function, _)| function.frequencies.clone()) else {
        let file = file.to_owned();
        return Err(if notes.is_empty() {
            DynamicsError::Empty { file }
        } else {
            DynamicsError::LeftOut { file, notes: notes.join("; ") }
        });
    };
    for function in coherence {
        let same = |other: &&mut (Function, Frf)| {
            other.0.response.abs() == function.response.abs() && other.0.force.abs() == function.force.abs()
        };
        if let Some((_, frf)) = found.iter_mut().find(same) {
            if function.frequencies != frequencies {
                let function = format!("the coherence of {}", frf.name());
                return Err(DynamicsError::OtherFrequencies { file: file.to_owned(), function });
            }
            // What is more than rounding beyond the range is refused with the rest.
            let rounded = |value: f64| {
                let near = value.clamp(0.0, 1.0);
                if (value - near).abs() <= ROUNDING { near } else { value }
            };
            frf.coherence = Some(function.values.iter().map(|value| rounded(value.re)).collect());
        }
    }
    for (function, frf) in &found {
        if function.frequencies != frequencies {
            return Err(DynamicsError::OtherFrequencies { file: file.to_owned(), function: frf.name() });
        }
    }
    Measurement {
        source: file.to_owned(),
        frequencies,
        functions: found.into_iter().map(|(_, frf)| frf).collect(),
        averages: None,
        coherence_digit,
        window_decay: 0.0,
        notes,
    }
    .checked()
}

/// How far rounding can put a coherence beyond 0 … 1: one and a half of the last digit in the shortest format.
const ROUNDING: f64 = 1.5e-5;
/// Half of the last digit of a coherence in the shortest format of data set 58, `E13.5`.
const DIGIT: f64 = 0.5e-5;
/// The same in the format of double precision, `E20.12`.
const DOUBLE_DIGIT: f64 = 0.5e-11;

/// Skips to the end of a data set.
fn end_of_set(cursor: &mut Cursor<'_>) {
    while let Some(line) = cursor.line() {
        if line.trim() == "-1" {
            return;
        }
    }
}

fn units_of(cursor: &mut Cursor<'_>, start: usize) -> Result<Units, DynamicsError> {
    cursor.due(start)?;
    let factors = cursor.due(start)?;
    let values = numbers(&factors, &[25]).unwrap_or_default();
    match values[..] {
        [length, force, ..] if length > 0.0 && force > 0.0 => Ok(Units { length, force }),
        _ => Err(cursor.fault(start, UniversalProblem::NotANumber(factors.trim().to_owned()))),
    }
}

/// One data set 58 after its header.
fn function(cursor: &mut Cursor<'_>, header: &str, start: usize) -> Result<Function, DynamicsError> {
    let binary = header.as_bytes().get(6).is_some_and(|mark| mark.eq_ignore_ascii_case(&b'b'));
    for _ in 0..5 {
        cursor.due(start)?;
    }
    let names = cursor.due(start)?;
    let kind = cursor.whole(&names, 0..5)?;
    let (response, force) = (cursor.whole(&names, 51..55)?, cursor.whole(&names, 76..80)?);
    let abscissa = cursor.due(start)?;
    let data_type = cursor.whole(&abscissa, 0..10)?;
    let promised = usize::try_from(cursor.whole(&abscissa, 10..20)?).unwrap_or(usize::MAX);
    let even = cursor.whole(&abscissa, 20..30)? == 1;
    let field =
        |columns: std::ops::Range<usize>| abscissa.get(columns.start..columns.end.min(abscissa.len())).unwrap_or("");
    let (first, step) = if even { (cursor.real(field(30..43))?, cursor.real(field(43..56))?) } else { (0.0, 0.0) };
    cursor.due(start)?;
    let (numerator, denominator) = (cursor.due(start)?, cursor.due(start)?);
    cursor.due(start)?;
    let types = [cursor.whole(&numerator, 0..10)?, cursor.whole(&denominator, 0..10)?];
    let label = |text: &str| text.get(47..).unwrap_or("").trim().to_owned();
    let labels = [label(&numerator), label(&denominator)];
    let (complex, double) = match data_type {
        2 => (false, false),
        4 => (false, true),
        5 => (true, false),
        6 => (true, true),
        other => return Err(cursor.fault(start, UniversalProblem::DataType(other))),
    };
    // What stands for one value: where it is uneven, the abscissa first.
    let parts = usize::from(!even) + 1 + usize::from(complex);
    let values = promised.checked_mul(parts).filter(|count| *count <= cursor.bytes.len());
    let count = values.ok_or_else(|| cursor.fault(start, UniversalProblem::TooMany(promised)))?;
    let flat = if binary {
        bytes(cursor, header, start, count, &Layout { parts, even, double })?
    } else {
        let width = if double { 20 } else { 13 };
        let mut widths = vec![width; parts];
        if !even {
            widths[0] = 13;
        }
        let mut flat = Vec::with_capacity(count);
        while flat.len() < count {
            let line = cursor.due(start)?;
            let read = numbers(&line, &widths).filter(|read| !read.is_empty() && line.trim() != "-1");
            flat.extend(read.ok_or_else(|| cursor.fault(cursor.line, UniversalProblem::NotANumber(line)))?);
        }
        flat
    };
    let rest = cursor.bytes[cursor.place..].iter().position(|byte| !byte.is_ascii_whitespace() && *byte != 0);
    if flat.len() > count || rest.is_some_and(|first| !cursor.bytes[cursor.place + first..].starts_with(b"-1")) {
        return Err(cursor.fault(start, UniversalProblem::MoreThanPromised(promised)));
    }
    let of_value = usize::from(!even);
    let rows = || flat.chunks_exact(parts).take(promised);
    let frequencies = if even {
        (0..promised).map(|i| first + step * i as f64).collect()
    } else {
        rows().map(|row| row[0]).collect()
    };
    let values = rows().map(|row| Complex::new(row[of_value], if complex { row[of_value + 1] } else { 0.0 })).collect();
    Ok(Function { line: start, kind, response, force, double, frequencies, values, types, labels })
}

/// How the values of a binary block follow each other.
struct Layout {
    parts: usize,
    even: bool,
    double: bool,
}

/// The values of a binary block.
fn bytes(
    cursor: &mut Cursor<'_>,
    header: &str,
    start: usize,
    count: usize,
    layout: &Layout,
) -> Result<Vec<f64>, DynamicsError> {
    let (order, format) = (cursor.whole(header, 7..13)?, cursor.whole(header, 13..19)?);
    if !matches!(order, 1 | 2) || format != 2 {
        return Err(cursor.fault(start, UniversalProblem::Binary(order, format)));
    }
    let mut values = Vec::with_capacity(count);
    for i in 0..count {
        // The abscissa of an uneven function is of single precision even before doubles.
        let short = !layout.double || (!layout.even && i % layout.parts == 0);
        let size = if short { 4 } else { 8 };
        let raw = cursor.bytes.get(cursor.place..cursor.place + size);
        let mut raw = raw.ok_or_else(|| cursor.fault(start, UniversalProblem::BrokenOff))?.to_vec();
        cursor.place += size;
        if order == 2 {
            raw.reverse();
        }
        let value = match (<[u8; 4]>::try_from(&raw[..]), <[u8; 8]>::try_from(&raw[..])) {
            (Ok(short), _) => f64::from(f32::from_le_bytes(short)),
            (_, Ok(long)) => f64::from_le_bytes(long),
            _ => f64::NAN,
        };
        if !value.is_finite() {
            return Err(cursor.fault(start, UniversalProblem::NotANumber(value.to_string())));
        }
        values.push(value);
    }
    Ok(values)
}

/// The response of a data set in SI; none where it leaves the plane.
fn response(cursor: &Cursor<'_>, function: &Function, units: Option<Units>) -> Result<Option<Frf>, DynamicsError> {
    let [numerator, denominator] = function.types;
    let fault = |problem| cursor.fault(function.line, problem);
    let motion = match (numerator, denominator) {
        (8, 13) => Motion::Displacement,
        (11, 13) => Motion::Velocity,
        (12, 13) => Motion::Acceleration,
        (other, over) => return Err(fault(UniversalProblem::Ordinate(other, over))),
    };
    let [label, _] = &function.labels;
    let labelled = unit::motion(label).filter(|(_, other)| *other == motion);
    let factor = match (units, labelled) {
        // Accelerations in multiples of gravity are written beside any units.
        (_, Some((factor, _))) if label == "g" => factor,
        (Some(units), _) => units.force / units.length,
        (None, Some((factor, _))) => factor,
        (None, None) => return Err(fault(UniversalProblem::Units(label.clone()))),
    };
    let direction = |code: i64| match code.abs() {
        1 => Some(Direction::X),
        2 => Some(Direction::Y),
        _ => None,
    };
    let (Some(response), Some(force)) = (direction(function.response), direction(function.force)) else {
        return Ok(None);
    };
    let sign = (function.response.signum() * function.force.signum()) as f64;
    let receptance = function.values.iter().map(|value| value * (factor * sign)).collect();
    Ok(Some(Frf { response, force, motion, receptance, coherence: None, noise: None }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn records(kind: i64, directions: [i64; 2], data_type: i64, spacing: i64) -> String {
        format!(
            "tap test\nNONE\n22-Nov-26\nNONE\nNONE\n{kind:5}{:10}{:5}{:10} {:<10}{:10}{:4} {:<10}{:10}{:4}\n\
             {data_type:10}{:10}{spacing:10}{:13.5E}{:13.5E}{:13.5E}\n{:10}    0    0    0 Frequency            Hz\n\
             {:10}    0    0    0 Response             m/s^2\n{:10}    0    0    0 Excitation           N\n\
             {:10}    0    0    0 NONE                 NONE\n",
            1, 1, 0, "TIP", 1, directions[0], "TIP", 1, directions[1], 3, 100.0, 2.0, 0.0, 18, 12, 13, 0
        )
    }

    const UNITS: &str = "    -1\n   164\n         1SI: Meter (newton)           2\n  1.0000000000000000D+00  \
                         1.0000000000000000D+00  1.0000000000000000D+00\n  2.7314999999999998D+02\n    -1\n";
    const VALUES: [[f64; 2]; 3] = [[-1.0, 0.5], [-2.0, 0.25], [-3.0, 0.125]];

    fn accelerance(found: &Measurement) -> Vec<Complex<f64>> {
        let w = |frequency: f64| std::f64::consts::TAU * frequency;
        let pairs = found.functions[0].receptance.iter().zip(&found.frequencies);
        pairs.map(|(value, frequency)| -value * w(*frequency).powi(2)).collect()
    }

    fn same(found: &Measurement, sign: f64) {
        assert_eq!(found.frequencies, [100.0, 102.0, 104.0]);
        for (value, [re, im]) in accelerance(found).iter().zip(VALUES) {
            assert!((value - Complex::new(re, im) * sign).norm() < 1e-5, "{value}");
        }
    }

    #[test]
    fn ascii_numbers_may_touch_and_lines_end_as_they_like() {
        let values = " -1.00000E+00  5.00000E-01 -2.00000E+00  2.50000E-01\n -3.00000E+00  1.25000E-01\n";
        let touching = "-1.000000E+00  5.00000E-01-2.000000E+00  2.50000E-01\n-3.000000E+00  1.25000E-01\n";
        for values in [values, touching] {
            let text = format!("{UNITS}    -1\n    58\n{}{values}    -1\n", records(4, [1, 1], 5, 1));
            same(&read_uff("a", text.as_bytes()).unwrap(), 1.0);
            same(&read_uff("a", text.replace('\n', "\r\n").as_bytes()).unwrap(), 1.0);
            let turned = text.replace(&format!("{:4}\n", 1), &format!("{:4}\n", -1));
            same(&read_uff("a", turned.as_bytes()).unwrap(), -1.0);
        }
    }

    #[test]
    fn binary_blocks_of_both_orders_are_read_whatever_count_they_promise() {
        for order in [1, 2] {
            for (data_type, spacing) in [(5, 1), (6, 1), (5, 0), (6, 0)] {
                let header = format!("    58b{order:6}{:6}{:12}{:12}", 2, 11, 12);
                let mut bytes =
                    format!("{UNITS}    -1\n{header}\n{}", records(4, [2, 2], data_type, spacing)).into_bytes();
                let mut put = |value: f64, double: bool| {
                    let mut raw =
                        if double { value.to_le_bytes().to_vec() } else { (value as f32).to_le_bytes().to_vec() };
                    if order == 2 {
                        raw.reverse();
                    }
                    bytes.extend(raw);
                };
                for (i, pair) in VALUES.iter().enumerate() {
                    if spacing == 0 {
                        put(100.0 + 2.0 * i as f64, false);
                    }
                    pair.iter().for_each(|value| put(*value, data_type == 6));
                }
                bytes.extend(b"\n    -1\n");
                let found = read_uff("a", &bytes).unwrap();
                same(&found, 1.0);
                assert_eq!(found.functions[0].name(), "yy");
                bytes.truncate(bytes.len() - 12);
                assert!(matches!(read_uff("a", &bytes), Err(DynamicsError::Universal { .. })));
            }
        }
    }

    #[test]
    fn what_a_file_promises_and_what_it_holds_must_agree() {
        let values = " -1.00000E+00  5.00000E-01 -2.00000E+00  2.50000E-01\n -3.00000E+00  1.25000E-01\n";
        let response = format!("{UNITS}    -1\n    58\n{}{values}    -1\n", records(4, [1, 1], 5, 1));
        let fault = |text: &str| read_uff("a.uff", text.as_bytes()).unwrap_err().to_string();
        let fewer = response.replacen("         3         1", "         1         1", 1);
        assert!(fault(&fewer).contains("promises 1 values and goes on after them"), "{}", fault(&fewer));
        let more = response.replacen("         3         1", "         4         1", 1);
        assert!(fault(&more).starts_with("a.uff:"), "{}", fault(&more));
        let set = |records: &str, values: &str| format!("{response}    -1\n    58\n{records}{values}\n    -1\n");
        let coherence = records(6, [1, 1], 2, 1);
        let read = |values: &str| read_uff("a.uff", set(&coherence, values).as_bytes());
        let good = read("  1.00000E+00  9.00000E-01  1.00001E+00").unwrap();
        assert_eq!(good.functions[0].coherence.as_deref(), Some(&[1.0, 0.9, 1.0][..]));
        let beyond = read("  1.00000E+00  9.00000E-01  1.50000E+00").unwrap_err().to_string();
        assert!(beyond.contains("coherence at 104 Hz is 1.5"), "{beyond}");
        let elsewhere = coherence.replacen("1.00000E2", "2.00000E2", 1);
        let refused = fault(&set(&elsewhere, "  1.00000E+00  9.00000E-01  1.00000E+00"));
        assert!(refused.contains("the coherence of xx has other frequencies"), "{refused}");
        let upright = response.replace(&format!("{:4}\n", 1), &format!("{:4}\n", 3));
        assert!(fault(&upright).contains("out of the plane of x and y"), "{}", fault(&upright));
    }

    #[test]
    fn a_file_without_units_is_refused() {
        let values = " -1.00000E+00  5.00000E-01 -2.00000E+00  2.50000E-01\n -3.00000E+00  1.25000E-01\n";
        let text = format!("    -1\n    58\n{}{values}    -1\n", records(4, [1, 1], 5, 1)).replace("m/s^2", "V");
        let refused = read_uff("a.uff", text.as_bytes()).unwrap_err().to_string();
        assert!(refused.starts_with("a.uff:2: no data set 164"), "{refused}");
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_or_refused(noise in prop::collection::vec(any::<u8>(), 0..200), cut in 0usize..900, kind in 0i64..8) {
            let mut bytes = format!("{UNITS}    -1\n    58b     1     2\n{}", records(kind, [1, 2], 5, 1)).into_bytes();
            bytes.truncate(cut);
            bytes.extend(noise);
            let _ = read_uff("a", &bytes);
        }
    }
}
