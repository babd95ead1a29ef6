//! Data sets of universal files, as they stand there: 58 in ASCII and binary, units from 164.

use crate::error::{DynamicsError, UniversalProblem};
use nalgebra::Complex;

/// Factors of a data set 164: a value in SI is the value of the file over the factor.
#[derive(Clone, Copy)]
pub(super) struct Units {
    pub length: f64,
    pub force: f64,
}

/// One data set 58.
#[derive(Clone)]
pub(super) struct Function {
    pub line: usize,
    pub kind: i64,
    pub response: i64,
    pub force: i64,
    /// Whether its values have double precision.
    pub double: bool,
    pub frequencies: Vec<f64>,
    pub values: Vec<Complex<f64>>,
    /// Types of ordinate numerator and denominator, and their unit labels.
    pub types: [i64; 2],
    pub labels: [String; 2],
}

/// What a universal file holds.
pub(super) struct Sets {
    /// Its name in messages.
    pub file: String,
    /// Units of all functions; none without a data set 164.
    pub units: Option<Units>,
    /// The functions, in the order of the file.
    pub functions: Vec<Function>,
}

impl Sets {
    /// Reads the data sets 58 and 164 and skips the others.
    ///
    /// # Errors
    /// [`DynamicsError::Universal`] with the line of the data set that cannot be read.
    pub fn read(file: &str, bytes: &[u8]) -> Result<Self, DynamicsError> {
        let mut cursor = Cursor { file, bytes, place: 0, line: 0 };
        let (mut units, mut functions) = (None, Vec::new());
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
        Ok(Self { file: file.to_owned(), units, functions })
    }

    /// A fault of the data set that begins at `line`.
    pub fn fault(&self, line: usize, problem: UniversalProblem) -> DynamicsError {
        DynamicsError::Universal { file: self.file.clone(), line, problem }
    }
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
    let points = cursor.whole(&abscissa, 10..20)?;
    let promised = usize::try_from(points).map_err(|_| cursor.fault(start, UniversalProblem::Points(points)))?;
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
        binary_values(cursor, header, start, &Layout { count, parts, even, double, short: true })?
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
    if flat.len() > count || !is_at_the_end(cursor) {
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
    count: usize,
    parts: usize,
    even: bool,
    double: bool,
    /// Whether an uneven abscissa is of single precision before doubles.
    short: bool,
}

/// Whether nothing but the end of the set follows.
fn is_at_the_end(cursor: &Cursor<'_>) -> bool {
    let rest = &cursor.bytes[cursor.place..];
    let first = rest.iter().position(|byte| !byte.is_ascii_whitespace() && *byte != 0);
    first.is_none_or(|first| rest[first..].starts_with(b"-1"))
}

/// The values of a binary block. Writers disagree whether the abscissa of an uneven function is of single precision before
/// doubles: the block itself shows it, by where it ends.
fn binary_values(
    cursor: &mut Cursor<'_>,
    header: &str,
    start: usize,
    layout: &Layout,
) -> Result<Vec<f64>, DynamicsError> {
    let (order, format) = (cursor.whole(header, 7..13)?, cursor.whole(header, 13..19)?);
    if !matches!(order, 1 | 2) || format != 2 {
        return Err(cursor.fault(start, UniversalProblem::Binary(order, format)));
    }
    let (place, reversed) = (cursor.place, order == 2);
    let read = bytes(cursor, start, reversed, layout);
    if layout.even || !layout.double || (read.is_ok() && is_at_the_end(cursor)) {
        return read;
    }
    let end = std::mem::replace(&mut cursor.place, place);
    let long = bytes(cursor, start, reversed, &Layout { short: false, ..*layout });
    if long.is_ok() && is_at_the_end(cursor) {
        return long;
    }
    cursor.place = end;
    read
}

/// The values of a binary block of one layout, whose bytes may stand in reversed order.
fn bytes(cursor: &mut Cursor<'_>, start: usize, reversed: bool, layout: &Layout) -> Result<Vec<f64>, DynamicsError> {
    let mut values = Vec::with_capacity(layout.count);
    for i in 0..layout.count {
        let short = !layout.double || (layout.short && !layout.even && i % layout.parts == 0);
        let size = if short { 4 } else { 8 };
        let raw = cursor.bytes.get(cursor.place..cursor.place + size);
        let mut raw = raw.ok_or_else(|| cursor.fault(start, UniversalProblem::BrokenOff))?.to_vec();
        cursor.place += size;
        if reversed {
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
