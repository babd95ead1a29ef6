//! Measured lives and wear readings from CSV files.

use super::measured_error::{GREATEST, LEAST};
use super::sample::Observation;
use std::collections::BTreeMap;
use toolroom_process::table::{Lines, broken_quote};

pub use super::measured_error::MeasuredError;

/// One edge as measured.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredLife {
    /// Name of the edge; empty where lives have none.
    pub edge: String,
    /// Group, empty where the file has none.
    pub group: String,
    /// What is known of its life.
    pub life: Observation,
    /// The covariates requested, in their order.
    pub covariates: Vec<f64>,
}

/// A file of measured lives.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Lives in the order of the file.
    pub lives: Vec<MeasuredLife>,
    /// Unit of the lives as the header says it, empty where it does not.
    pub unit: String,
    /// What the reader did on its own account.
    pub notes: Vec<String>,
}

/// How lives stand in a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Layout {
    /// One life a line: columns `life`, and where they are there `censored`, `inspected`, `group`.
    Lives,
    /// Wear readings, several lines an edge: the life is the age at which wear reaches a limit.
    Readings {
        /// Columns that name the edge.
        edge: Vec<String>,
        /// Column of the age.
        age: String,
        /// Column of the wear; rows without it are skipped.
        wear: String,
        /// Wear at which an edge is spent, in the unit of the column.
        limit: f64,
        /// Column of the group.
        group: Option<String>,
        /// Whether the crossing is interpolated between readings; otherwise it lies between them.
        interpolate: bool,
    },
}

/// Reads measured lives. `covariates` are columns of numbers; one written `ln(NAME)` is taken as
/// its logarithm, one written `NAME=VALUE` is 1 where the column has that value and 0 elsewhere.
///
/// # Errors
/// [`MeasuredError`] with file, line and what was read.
///
/// # Examples
/// ```
/// use toolroom_life::measured::{Layout, read};
/// use toolroom_life::sample::Observation::Censored;
/// let csv = "life [min],censored\n12.5,0\n30,1\n";
/// let measured = read("lives.csv", csv.as_bytes(), &Layout::Lives, &[])?;
/// assert_eq!((measured.lives[1].life, measured.unit.as_str()), (Censored(30.0), "min"));
/// # Ok::<(), toolroom_life::measured::MeasuredError>(())
/// ```
pub fn read(file: &str, bytes: &[u8], layout: &Layout, covariates: &[String]) -> Result<Measured, MeasuredError> {
    let table = Table::read(file, bytes)?;
    let mut notes = Vec::new();
    if table.decimal_comma {
        notes.push("numbers have a decimal comma".to_owned());
    }
    let columns: Vec<Covariate> = covariates.iter().map(|text| table.covariate(text)).collect::<Result<_, _>>()?;
    match layout {
        Layout::Lives => {
            let life = table.column("life")?;
            let [censored, inspected, group] = ["censored", "inspected", "group"].map(|name| table.find(name));
            let of_row = |row: &Row| {
                let age = table.life(row, life)?;
                let observed = match (censored, inspected) {
                    (Some(column), _) if table.flag(row, column)? => Observation::Censored(age),
                    (_, Some(column)) if !row.cells[column].is_empty() => {
                        let before = table.number(row, column)?;
                        if !(before >= 0.0 && before < age) {
                            return Err(table.refuse(row, column, "an inspection before the end of the life"));
                        }
                        Observation::Between(before, age)
                    }
                    _ => Observation::Failed(age),
                };
                let covariates =
                    columns.iter().map(|column| table.covariate_of(row, column)).collect::<Result<_, _>>()?;
                let group = group.map_or(String::new(), |column| row.cells[column].clone());
                Ok(MeasuredLife { edge: String::new(), group, life: observed, covariates })
            };
            let lives = table.every(of_row)?;
            Ok(Measured { lives, unit: table.units[life].clone(), notes })
        }
        Layout::Readings { edge, age, wear, limit, group, interpolate } => {
            let names: Vec<usize> = edge.iter().map(|name| table.column(name)).collect::<Result<_, _>>()?;
            let (age, wear) = (table.column(age)?, table.column(wear)?);
            let group = group.as_ref().map(|name| table.column(name)).transpose()?;
            let mut order: Vec<String> = Vec::new();
            let mut edges: BTreeMap<String, Vec<Reading<'_>>> = BTreeMap::new();
            table.every(|row| {
                let name = names.iter().map(|column| row.cells[*column].as_str()).collect::<Vec<_>>().join(" ");
                let age_read = table.number(row, age)?;
                let worn = if row.cells[wear].is_empty() { None } else { Some(table.number(row, wear)?) };
                let readings = edges.entry(name.clone()).or_insert_with(|| {
                    order.push(name.clone());
                    Vec::new()
                });
                if let Some((_, before, _)) = readings.last().filter(|last| last.1 > age_read) {
                    let (file, line, before) = (file.to_owned(), row.line, *before);
                    return Err(MeasuredError::Backwards { file, line, edge: name, age: age_read, before });
                }
                readings.push((row, age_read, worn));
                Ok(())
            })?;
            let mut lives = Vec::new();
            for name in order {
                let readings = &edges[&name];
                let known: Vec<(f64, f64)> =
                    readings.iter().filter_map(|(_, at, worn)| Some((*at, (*worn)?))).collect();
                let Some(life) = crossing(&known, *limit, *interpolate) else {
                    notes.push(format!("edge {name} has no reading after age 0 and is left out"));
                    continue;
                };
                let row = readings[0].0;
                if !(LEAST..=GREATEST).contains(&life.age()) {
                    let column = format!("{}` of edge `{name}", table.names[age]);
                    return Err(table.no_life(row, column, life.age().to_string()));
                }
                let covariates =
                    columns.iter().map(|column| table.covariate_of(row, column)).collect::<Result<_, _>>()?;
                let group = group.map_or(String::new(), |column| row.cells[column].clone());
                lives.push(MeasuredLife { edge: name, group, life, covariates });
            }
            Ok(Measured { lives, unit: table.units[age].clone(), notes })
        }
    }
}

/// One look at an edge: its row, its age and its wear where it was read.
type Reading<'a> = (&'a Row, f64, Option<f64>);

/// The numbers of one column of a table.
///
/// # Errors
/// As [`read`].
pub fn numbers(file: &str, bytes: &[u8], column: &str) -> Result<Vec<f64>, MeasuredError> {
    let table = Table::read(file, bytes)?;
    let column = table.column(column)?;
    table.every(|row| table.finite(row, column))
}

/// The age at which readings (age, wear) first reach a limit. Before the first reading an edge is
/// taken as new at age 0.
fn crossing(readings: &[(f64, f64)], limit: f64, interpolate: bool) -> Option<Observation> {
    let last = readings.last()?.0;
    let Some(first) = readings.iter().position(|(_, wear)| *wear >= limit) else {
        return (last > 0.0).then_some(Observation::Censored(last));
    };
    let (age, wear) = readings[first];
    let before = if first == 0 { None } else { Some(readings[first - 1]) };
    match before {
        Some((from, low)) if interpolate && wear > low => {
            Some(Observation::Failed(from + (age - from) * (limit - low) / (wear - low)))
        }
        Some((from, _)) if from < age => Some(Observation::Between(from, age)),
        _ => (age > 0.0).then_some(Observation::Between(0.0, age)),
    }
}

struct Row {
    line: usize,
    cells: Vec<String>,
}

enum Covariate {
    Number { column: usize, logarithm: bool },
    Is { column: usize, value: String },
}

struct Table {
    file: String,
    names: Vec<String>,
    units: Vec<String>,
    rows: Vec<Row>,
    /// Rows of another length than the header.
    uneven: Vec<MeasuredError>,
    decimal_comma: bool,
}

impl Table {
    fn read(file: &str, bytes: &[u8]) -> Result<Self, MeasuredError> {
        let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
        let text = std::str::from_utf8(bytes)
            .map_err(|error| MeasuredError::Encoding { file: file.to_owned(), byte: error.valid_up_to() })?;
        let first = text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or_default();
        let delimiter = [b';', b'\t', b','].into_iter().find(|c| first.as_bytes().contains(c)).unwrap_or(b',');
        if let Some(fault) = broken_quote(text, delimiter) {
            return Err(MeasuredError::Quote { file: file.to_owned(), fault });
        }
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .has_headers(false)
            .flexible(true)
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let mut header: Option<Vec<String>> = None;
        let (mut rows, mut uneven) = (Vec::new(), Vec::new());
        let mut lines = Lines::new(text);
        for record in reader.records().filter_map(Result::ok) {
            let line = record.position().map_or(0, |position| lines.at(position.byte()));
            let cells: Vec<String> = record.iter().map(str::to_owned).collect();
            match &header {
                _ if cells.iter().all(String::is_empty) => {}
                None => header = Some(cells),
                Some(header) if header.len() != cells.len() => {
                    let (file, found, expected) = (file.to_owned(), cells.len(), header.len());
                    uneven.push(MeasuredError::CellCount { file, line, found, expected });
                }
                Some(_) => rows.push(Row { line, cells }),
            }
        }
        if rows.is_empty() {
            MeasuredError::of(std::mem::take(&mut uneven))?;
        }
        let header = header.filter(|_| !rows.is_empty());
        let header = header.ok_or_else(|| MeasuredError::NoRows { file: file.to_owned() })?;
        let split = |cell: &String| match cell.split_once('[') {
            Some((name, unit)) => (name.trim().to_owned(), unit.trim_end_matches(']').trim().to_owned()),
            None => (cell.clone(), String::new()),
        };
        let (names, units) = header.iter().map(split).unzip();
        let decimal_comma = decimal_comma(file, &rows, delimiter)?;
        Ok(Self { file: file.to_owned(), names, units, rows, uneven, decimal_comma })
    }

    /// What every row is, or everything that is wrong with the rows.
    fn every<'a, T>(
        &'a self,
        mut of: impl FnMut(&'a Row) -> Result<T, MeasuredError>,
    ) -> Result<Vec<T>, MeasuredError> {
        let mut faults = self.uneven.clone();
        let mut good = Vec::with_capacity(self.rows.len());
        for row in &self.rows {
            match of(row) {
                Ok(value) => good.push(value),
                Err(fault) => faults.push(fault),
            }
        }
        MeasuredError::of(faults)?;
        Ok(good)
    }

    fn find(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|each| each.eq_ignore_ascii_case(name))
    }

    fn column(&self, name: &str) -> Result<usize, MeasuredError> {
        self.find(name).ok_or_else(|| MeasuredError::MissingColumn {
            file: self.file.clone(),
            column: name.to_owned(),
            known: self.names.join(", "),
        })
    }

    fn covariate(&self, text: &str) -> Result<Covariate, MeasuredError> {
        if let Some((name, value)) = text.split_once('=') {
            return Ok(Covariate::Is { column: self.column(name.trim())?, value: value.trim().to_owned() });
        }
        let inner = text.trim().strip_prefix("ln(").and_then(|rest| rest.strip_suffix(')'));
        Ok(Covariate::Number { column: self.column(inner.unwrap_or(text).trim())?, logarithm: inner.is_some() })
    }

    fn covariate_of(&self, row: &Row, covariate: &Covariate) -> Result<f64, MeasuredError> {
        match covariate {
            Covariate::Is { column, value } => Ok(f64::from(u8::from(row.cells[*column] == *value))),
            Covariate::Number { column, logarithm: false } => self.number(row, *column),
            Covariate::Number { column, logarithm: true } => match self.number(row, *column)? {
                value if value > 0.0 => Ok(value.ln()),
                _ => Err(self.refuse(row, *column, "a positive number")),
            },
        }
    }

    fn finite(&self, row: &Row, column: usize) -> Result<f64, MeasuredError> {
        let cell = &row.cells[column];
        let text = if self.decimal_comma { cell.replace(',', ".") } else { cell.clone() };
        match text.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(self.refuse(row, column, "a finite number")),
        }
    }

    /// A number of which squares and sums can be taken.
    fn number(&self, row: &Row, column: usize) -> Result<f64, MeasuredError> {
        let value = self.finite(row, column)?;
        if value.abs() <= GREATEST { Ok(value) } else { Err(self.refuse(row, column, "a number up to 1e12")) }
    }

    /// A number that can be a life.
    fn life(&self, row: &Row, column: usize) -> Result<f64, MeasuredError> {
        let value = self.finite(row, column)?;
        if (LEAST..=GREATEST).contains(&value) {
            return Ok(value);
        }
        Err(self.no_life(row, self.names[column].clone(), row.cells[column].clone()))
    }

    fn no_life(&self, row: &Row, column: String, read: String) -> MeasuredError {
        MeasuredError::Age { file: self.file.clone(), line: row.line, column, read }
    }

    fn flag(&self, row: &Row, column: usize) -> Result<bool, MeasuredError> {
        match row.cells[column].to_lowercase().as_str() {
            "1" | "true" | "yes" => Ok(true),
            "" | "0" | "false" | "no" => Ok(false),
            _ => Err(self.refuse(row, column, "1 or 0, true or false, yes or no")),
        }
    }

    fn refuse(&self, row: &Row, column: usize, expected: &'static str) -> MeasuredError {
        MeasuredError::Cell {
            file: self.file.clone(),
            line: row.line,
            column: self.names[column].clone(),
            read: row.cells[column].clone(),
            expected,
        }
    }
}

/// Whether numbers have a decimal comma; refused where some have a point.
fn decimal_comma(file: &str, rows: &[Row], delimiter: u8) -> Result<bool, MeasuredError> {
    if delimiter == b',' {
        return Ok(false);
    }
    let number = |cell: &str, sign: char| {
        cell.matches(sign).count() == 1 && cell.chars().all(|c| c.is_ascii_digit() || c == sign || c == '-')
    };
    let cells = || rows.iter().flat_map(|row| row.cells.iter().map(move |cell| (row.line, cell)));
    let comma = cells().find(|(_, cell)| number(cell, ','));
    match comma {
        Some((line, read)) if cells().any(|(_, cell)| number(cell, '.')) => {
            Err(MeasuredError::DecimalSign { file: file.to_owned(), line, read: read.clone() })
        }
        found => Ok(found.is_some()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Observation::{Between, Censored, Failed};

    fn lives(text: &str) -> Result<Vec<Observation>, MeasuredError> {
        read("f.csv", text.as_bytes(), &Layout::Lives, &[]).map(|m| m.lives.iter().map(|life| life.life).collect())
    }

    #[test]
    fn every_kind_of_observation_is_read() {
        let text = "\u{FEFF}group;Life [h];censored;inspected\nA;1,5;;\nA;2,0;yes;\nB;3,25;no;2,75\n\n";
        assert_eq!(lives(text).unwrap(), [Failed(1.5), Censored(2.0), Between(2.75, 3.25)]);
        let measured = read("f.csv", text.as_bytes(), &Layout::Lives, &["group=B".to_owned()]).unwrap();
        assert_eq!((measured.unit.as_str(), measured.notes.len()), ("h", 1));
        assert_eq!((measured.lives[2].group.as_str(), measured.lives[2].covariates[0]), ("B", 1.0));
    }

    #[test]
    fn readings_become_lives() {
        let text = "tool,t,VB\n1,0,0\n1,2,0.2\n1,4,0.4\n2,1,0.1\n2,3,\n2,5,0.2\n3,2,0.5\n4,0,0.1\n";
        let layout = |interpolate| Layout::Readings {
            edge: vec!["tool".to_owned()],
            age: "t".to_owned(),
            wear: "VB".to_owned(),
            limit: 0.3,
            group: None,
            interpolate,
        };
        let lives_by = |interpolate| read("f.csv", text.as_bytes(), &layout(interpolate), &[]).unwrap();
        let kinds = |m: &Measured| m.lives.iter().map(|life| life.life).collect::<Vec<_>>();
        assert_eq!(kinds(&lives_by(true)), [Failed(3.0), Censored(5.0), Between(0.0, 2.0)]);
        assert_eq!(kinds(&lives_by(false)), [Between(2.0, 4.0), Censored(5.0), Between(0.0, 2.0)]);
        assert!(lives_by(true).notes[0].contains("edge 4"));
        let twice = "tool,t,VB\n1,4,0.1\n1,2,0.2\n1,5,x\n";
        let error = read("f.csv", twice.as_bytes(), &layout(true), &[]).unwrap_err();
        assert!(matches!(&error, MeasuredError::Several { faults } if faults.len() == 2), "{error}");
        let back = "tool,t,VB\n1,4,0.1\n1,2,0.2\n";
        let error = read("f.csv", back.as_bytes(), &layout(true), &[]).unwrap_err();
        assert!(matches!(error, MeasuredError::Backwards { line: 3, .. }), "{error}");
    }

    #[test]
    fn faults_name_line_and_value() {
        let said = |text: &str| lives(text).unwrap_err().to_string();
        assert_eq!(
            said("life\n"),
            "f.csv: no rows; expected a header such as `life [min],censored,group` and one life a line"
        );
        assert!(said("lives\n3\n").contains("no column `life`; there are lives"));
        assert!(said("life\n3\nabc\n").starts_with("f.csv:3: `life` is `abc`"));
        assert!(said("life\nNaN\n").contains("a finite number is due"));
        assert!(said("life,censored\n3,maybe\n").contains("yes or no"));
        assert!(said("life,censored\n3\n").contains("1 cells where the header has 2"));
        let every = "life,censored\n3,maybe\n4\n5,0\n-1,0\nx,1\n";
        assert_eq!(
            said(every),
            "4 rows cannot be read:\n  f.csv:2: `censored` is `maybe`, but 1 or 0, true or false, yes or no is due\n  \
             f.csv:3: 1 cells where the header has 2\n  f.csv:5: `life` is -1, but a life from 1e-9 to 1e12 is due; take the \
             row out, or check its unit\n  f.csv:6: `life` is `x`, but a finite number is due"
        );
        let many = format!("life\n{}", "x\n".repeat(60));
        assert!(said(&many).starts_with("60 rows") && said(&many).ends_with("and 10 more"), "{}", said(&many));
        assert!(said("life;a\n3,5;1\n2.5;1\n").contains("decimal comma"));
        assert!(read("f.csv", b"life\n\xFF\n", &Layout::Lives, &[]).unwrap_err().to_string().contains("UTF-8"));
    }
}
