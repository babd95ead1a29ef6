//! Tables as comma-separated text: the one writer of every CSV file, and the check of their quotes.
//!
//! What is written reads back in any reader that follows RFC 4180: cells with a comma, a quote or a line
//! break are quoted, rows are as long as the header, a number has all of its digits and no sign before
//! zero, and what is not defined (NaN, infinite) is an empty cell. A column is named with its unit in
//! brackets, `time [s]`, by whoever writes it.

mod lines;
mod quotes;

pub use lines::Lines;
pub use quotes::{BrokenQuote, broken_quote};

use serde::{Serialize, Serializer};
use std::io::Write;

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell<'a> {
    /// Nothing.
    Empty,
    /// A name or word.
    Text(&'a str),
    /// The same made for the cell.
    Own(String),
    /// A number as the shortest decimal that reads back to the same bits, without exponent.
    Number(f64),
    /// The same with an exponent where it is very large or small.
    Scientific(f64),
    /// A number with so many decimals.
    Fixed(f64, usize),
}

impl Cell<'_> {
    fn write<W: Write>(&self, to: &mut csv::Writer<W>) -> Result<(), csv::Error> {
        // 0.0 in place of -0.0, which some readers take for a text or print as it is.
        let plain = |value: f64| value.is_finite().then_some(value + 0.0);
        let number = match self {
            Self::Empty => None,
            Self::Text(text) => return to.write_field(text),
            Self::Own(text) => return to.write_field(text),
            Self::Number(value) => plain(*value).map(|value| value.to_string()),
            Self::Scientific(value) => plain(*value).map(|value| format!("{value:?}")),
            Self::Fixed(value, decimals) => plain(*value).map(|value| fixed(value, *decimals)),
        };
        to.write_field(number.unwrap_or_default())
    }
}

/// A number with so many decimals; one that rounds to zero has no sign.
fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let zero = text.bytes().all(|byte| matches!(byte, b'-' | b'0' | b'.'));
    if zero { text.trim_start_matches('-').to_owned() } else { text }
}

impl From<f64> for Cell<'_> {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl<'a> From<&'a str> for Cell<'a> {
    fn from(text: &'a str) -> Self {
        Self::Text(text)
    }
}

impl<'a> From<&'a String> for Cell<'a> {
    fn from(text: &'a String) -> Self {
        Self::Text(text)
    }
}

impl From<String> for Cell<'_> {
    fn from(text: String) -> Self {
        Self::Own(text)
    }
}

macro_rules! whole {
    ($($kind:ty),*) => {$(
        impl From<$kind> for Cell<'_> {
            fn from(value: $kind) -> Self {
                Self::Own(value.to_string())
            }
        }
    )*};
}
whole!(u32, u64, usize, bool);

impl<'a, T: Into<Cell<'a>>> From<Option<T>> for Cell<'a> {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Empty, Into::into)
    }
}

/// Cells with a `#` are quoted as well: a line that starts with one is a comment to our readers.
fn builder() -> csv::WriterBuilder {
    let mut builder = csv::WriterBuilder::new();
    builder.comment(Some(b'#'));
    builder
}

/// Writes a table row by row.
///
/// # Examples
/// ```
/// use toolroom_process::table::CsvWriter;
/// let mut table = CsvWriter::new(Vec::new(), ["policy", "life, mean [min]"])?;
/// table.row(["v0, \"slow\"".into(), (-0.0).into()])?;
/// assert_eq!(table.finish()?, b"policy,\"life, mean [min]\"\n\"v0, \"\"slow\"\"\",0\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct CsvWriter<W: Write> {
    inner: csv::Writer<W>,
}

impl<W: Write> CsvWriter<W> {
    /// Starts a table with its header.
    ///
    /// # Errors
    /// Those of `to`.
    pub fn new(to: W, header: impl IntoIterator<Item = impl AsRef<str>>) -> Result<Self, csv::Error> {
        let mut inner = builder().from_writer(to);
        inner.write_record(header.into_iter().map(|name| name.as_ref().to_owned()))?;
        Ok(Self { inner })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// Those of the sink, and a row of another length than the header.
    pub fn row<'a>(&mut self, cells: impl IntoIterator<Item = Cell<'a>>) -> Result<(), csv::Error> {
        cells.into_iter().try_for_each(|cell| cell.write(&mut self.inner))?;
        // The end of a record, whose length is compared with that of the header.
        self.inner.write_record(None::<&[u8]>)
    }

    /// Adds a row of another table as it stands there.
    ///
    /// # Errors
    /// As [`row`](Self::row).
    pub fn copy(&mut self, row: &csv::ByteRecord) -> Result<(), csv::Error> {
        self.inner.write_byte_record(row)
    }

    /// Hands on what is buffered.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn flush(&mut self) -> Result<(), csv::Error> {
        Ok(self.inner.flush()?)
    }

    /// Ends the table and gives the sink back.
    ///
    /// # Errors
    /// Those of the sink.
    pub fn finish(self) -> Result<W, csv::Error> {
        self.inner.into_inner().map_err(|error| csv::Error::from(error.into_error()))
    }
}

/// A whole table as text.
///
/// # Errors
/// A row of another length than the header.
pub fn csv_text<'a, R: IntoIterator<Item = Cell<'a>>>(
    header: impl IntoIterator<Item = impl AsRef<str>>,
    rows: impl IntoIterator<Item = R>,
) -> Result<String, csv::Error> {
    let mut table = CsvWriter::new(Vec::new(), header)?;
    rows.into_iter().try_for_each(|row| table.row(row))?;
    text(table.finish()?)
}

/// Structures as a table as text, a row each, named like their fields. Their numbers go through
/// [`defined`].
///
/// # Errors
/// What serde or the csv crate says of structures that are no rows.
pub fn csv_of(rows: &[impl Serialize]) -> Result<String, csv::Error> {
    let mut table = builder().from_writer(Vec::new());
    rows.iter().try_for_each(|row| table.serialize(row))?;
    text(table.into_inner().map_err(|error| csv::Error::from(error.into_error()))?)
}

fn text(bytes: Vec<u8>) -> Result<String, csv::Error> {
    String::from_utf8(bytes).map_err(|error| csv::Error::from(std::io::Error::other(error)))
}

/// For `serialize_with` of a number in a row of [`csv_of`]: no sign before zero, nothing where it is not
/// finite.
///
/// # Errors
/// Those of the serializer.
pub fn defined<S: Serializer>(value: &Option<f64>, to: S) -> Result<S::Ok, S::Error> {
    value.filter(|value| value.is_finite()).map(|value| value + 0.0).serialize(to)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(text: &str) -> Vec<Vec<String>> {
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
        reader.records().map(|row| row.expect("a row").iter().map(str::to_owned).collect()).collect()
    }

    #[test]
    fn zero_has_no_sign_and_what_is_not_defined_is_empty() {
        let cells = [
            Cell::Number(-0.0),
            Cell::Fixed(-1e-9, 3),
            Cell::Fixed(-0.5, 3),
            Cell::Scientific(-0.0),
            f64::NAN.into(),
            Cell::Fixed(f64::INFINITY, 2),
            Cell::Scientific(f64::NEG_INFINITY),
            None::<f64>.into(),
        ];
        let text = csv_text(["a", "b", "c", "d", "e", "f", "g", "h"], [cells]).expect("a table");
        assert_eq!(text, "a,b,c,d,e,f,g,h\n0,0.000,-0.500,0.0,,,,\n");
    }

    #[test]
    fn a_comma_in_a_header_and_a_hash_before_a_row_are_letters() {
        let text = csv_text(["rate, 2 min change [m/min]", "B10 [min]"], [[1.5.into(), true.into()]]).expect("a table");
        assert_eq!(csv_text(["a", "b"], [["#1".into(), 2u32.into()]]).expect("a table"), "a,b\n\"#1\",2\n");
        assert_eq!(read(&text), [["rate, 2 min change [m/min]", "B10 [min]"], ["1.5", "true"]]);
    }

    #[test]
    fn a_row_of_another_length_is_refused() {
        assert!(csv_text(["a", "b"], [[Cell::Empty]]).is_err());
        assert!(csv_text(["a"], [[1.0.into(), 2.0.into()]]).is_err());
    }

    #[test]
    fn structures_are_written_like_rows() {
        #[derive(Serialize)]
        struct Row {
            name: &'static str,
            #[serde(serialize_with = "defined")]
            size: Option<f64>,
        }
        let rows = [
            Row { name: "a,b", size: Some(-0.0) },
            Row { name: "c", size: Some(f64::NAN) },
            Row { name: "d", size: None },
        ];
        assert_eq!(csv_of(&rows).expect("a table"), "name,size\n\"a,b\",0.0\nc,\nd,\n");
    }

    proptest! {
        #[test]
        fn whatever_is_written_reads_back_the_same(
            header in prop::collection::vec("[a-z].*", 2..5),
            rows in prop::collection::vec((".*", any::<f64>()), 0..20),
        ) {
            let cells = |(text, number): &(String, f64)| -> Vec<Cell<'_>> {
                let more = (2..header.len()).map(|_| Cell::Scientific(*number));
                [Cell::Own(text.clone()), Cell::Number(*number)].into_iter().chain(more).collect()
            };
            let text = csv_text(&header, rows.iter().map(cells)).expect("a table");
            prop_assert_eq!(broken_quote(&text, b','), None);
            let back = read(&text);
            prop_assert_eq!(&back[0], &header);
            prop_assert_eq!(back.len(), rows.len() + 1);
            for (row, (text, number)) in back[1..].iter().zip(&rows) {
                prop_assert_eq!(&row[0], text);
                for cell in &row[1..] {
                    if number.is_finite() {
                        prop_assert_eq!((cell.parse::<f64>().expect("a number") + 0.0).to_bits(), (number + 0.0).to_bits());
                    } else {
                        prop_assert_eq!(cell, "");
                    }
                }
            }
        }
    }
}
