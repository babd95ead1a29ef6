//! The table of program runs derived from the logs of the NIST smart manufacturing test bed.

use crate::{RecordKind, Records};
use std::collections::BTreeMap;
use toolroom_process::table::{BrokenQuote, broken_quote};

/// Columns of the table: machine, day, hour, program, mode, time active, time active at 100 % override
/// (the integral of the recorded override: it says what the override was, no more), time held, tool
/// changes, holds.
const COLUMNS: [&str; 10] = ["machine", "day", "hour", "prog", "mode", "act", "nom", "hold", "tc", "nhold"];

/// Why the table was not read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunTableError {
    /// Not delimited text.
    #[error(transparent)]
    Csv(#[from] csv::Error),
    /// A quote that cannot be read.
    #[error(transparent)]
    Quote(#[from] BrokenQuote),
    /// A column is missing.
    #[error("the column `{column}` is missing; the table has {}", COLUMNS.join(", "))]
    MissingColumn {
        /// Its name.
        column: &'static str,
    },
    /// No run is left.
    #[error("no run of `{program}` in automatic mode")]
    NoRuns {
        /// Program requested, or all.
        program: String,
    },
}

/// Runs in automatic mode of `program` on `machine` (all, if none), one row a run; those of one day
/// are a section. The time of a run is the time active.
///
/// # Errors
/// [`RunTableError`].
///
/// ```
/// let table = "machine,day,hour,prog,mode,act,nom,hold,tc,nhold\nM1,2017-05-02,9,103,AUTOMATIC,40,20,0,1,0\n";
/// let (records, passed) = toolroom_records::mtconnect::run_table(table.as_bytes(), None, None).unwrap();
/// assert_eq!(records.numbers("feed_override"), Some(&[0.5][..]));
/// assert_eq!(passed, 0);
/// ```
pub fn run_table(
    bytes: &[u8],
    machine: Option<&str>,
    program: Option<&str>,
) -> Result<(Records, usize), RunTableError> {
    if let Some(fault) = broken_quote(&String::from_utf8_lossy(bytes), b',') {
        return Err(fault.into());
    }
    let mut reader = csv::ReaderBuilder::new().flexible(true).trim(csv::Trim::All).from_reader(bytes);
    let header = reader.headers()?.clone();
    let mut places = [0; COLUMNS.len()];
    for (place, column) in places.iter_mut().zip(COLUMNS) {
        let position = header.iter().position(|name| name.trim_start_matches('\u{feff}') == column);
        *place = position.ok_or(RunTableError::MissingColumn { column })?;
    }
    let mut runs: Vec<(Vec<String>, [f64; 5])> = Vec::new();
    let mut passed = 0;
    for record in reader.records() {
        let record = record?;
        let cell = |column: usize| record.get(places[column]).unwrap_or_default();
        let number =
            |column: usize| cell(column).parse::<f64>().ok().filter(|value| value.is_finite() && *value >= 0.0);
        let numbers = [5, 6, 7, 8, 9].map(number);
        let wanted = machine.is_none_or(|name| name == cell(0)) && program.is_none_or(|name| name == cell(3));
        let of_use =
            cell(4) == "AUTOMATIC" && cell(3) != super::UNAVAILABLE && numbers[0].is_some_and(|time| time > 0.0);
        match numbers {
            [Some(active), Some(nominal), Some(hold), Some(changes), Some(holds)] if wanted && of_use => {
                let texts = [0, 1, 3].map(|column| cell(column).to_owned()).to_vec();
                runs.push((texts, [active, nominal, hold, changes, holds]));
            }
            _ if wanted => passed += 1,
            _ => {}
        }
    }
    if runs.is_empty() {
        return Err(RunTableError::NoRuns { program: program.unwrap_or("any program").to_owned() });
    }
    let mut records = Records::new(RecordKind::Program, runs.len());
    let texts = |of: &dyn Fn(&[String]) -> String| runs.iter().map(|(texts, _)| of(texts)).collect::<Vec<String>>();
    let numbers = |of: &dyn Fn(&[f64; 5]) -> f64| runs.iter().map(|(_, numbers)| of(numbers)).collect::<Vec<f64>>();
    let sections = texts(&|texts| format!("{} {} {}", texts[0], texts[2], texts[1]));
    let mut counts: BTreeMap<&str, u32> = BTreeMap::new();
    let order: Vec<u32> = sections
        .iter()
        .map(|section| {
            let count = counts.entry(section).or_insert(0);
            *count += 1;
            *count
        })
        .collect();
    let names = sections.iter().zip(&order).map(|(section, count)| format!("{section} run {count}")).collect();
    records.set_texts("operation_id", names);
    records.set_texts("machine", texts(&|texts| texts[0].clone()));
    records.set_texts("program", texts(&|texts| format!("{} {}", texts[0], texts[2])));
    records.set_numbers("sequence", order.iter().map(|count| f64::from(*count)).collect());
    records.set_texts("section", sections);
    records.set_numbers("feed_override", numbers(&|[active, nominal, ..]| nominal / active));
    records.set_numbers("tool_changes", numbers(&|numbers| numbers[3]));
    records.set_numbers("cycle_time", numbers(&|numbers| numbers[0]));
    Ok((records, passed))
}
