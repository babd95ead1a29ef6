//! From tables of cells to records in SI.

use super::columns::{ColumnKind, RecordColumn};
use super::csv_table::{self, OtherTable, RawTable, name_and_unit, scale};
use super::error::RecordError;
use super::{ReadReport, RecordKind, Records};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Reads records from a file, or from the file of `kind` in a directory; `parquet` reads files of that
/// extension.
///
/// # Errors
/// [`RecordError`]: a file that cannot be read, a missing column, a unit that does not fit.
pub fn read(path: &Path, kind: RecordKind, parquet: OtherTable<'_>) -> Result<(Records, ReadReport), RecordError> {
    if path.is_dir() && find(path, kind).is_err() {
        let parts = folders(path, kind);
        if !parts.is_empty() {
            return joined(&parts, kind, parquet);
        }
    }
    let path = if path.is_dir() { find(path, kind)? } else { path.to_owned() };
    let file = path.display().to_string();
    let table = if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("parquet")) {
        parquet(&path)?
    } else {
        let bytes = std::fs::read(&path).map_err(|source| RecordError::Unreadable { path: path.clone(), source })?;
        cells(&file, &bytes)?
    };
    understand(&file, table, kind)
}

/// Reads records from delimited text; `file` is its name in messages.
///
/// # Errors
/// As [`read`].
///
/// ```
/// use toolroom_records::{RecordKind, parse_csv};
/// let csv = "operation_id;machine;tool_id;sequence;cutting_speed [m/min];feed_per_rev [mm];\
///     depth_of_cut [mm];cutting_time [min];cutting_force [kN]\n1;L1;T1;1;180;0,3;1,5;2;0,9\n";
/// let (records, report) = parse_csv("operations.csv", csv.as_bytes(), RecordKind::Turning).unwrap();
/// assert_eq!(records.numbers("cutting_force"), Some(&[900.0][..]));
/// assert_eq!(report.notes, ["numbers have a decimal comma"]);
/// ```
pub fn parse_csv(file: &str, bytes: &[u8], kind: RecordKind) -> Result<(Records, ReadReport), RecordError> {
    understand(file, cells(file, bytes)?, kind)
}

/// The cells of delimited text in any delimiter, encoding and decimal sign; `file` is its name in messages.
///
/// # Errors
/// [`RecordError::Quote`]: a quote that cannot be read.
pub fn cells(file: &str, bytes: &[u8]) -> Result<RawTable, RecordError> {
    csv_table::parse(bytes).map_err(|fault| RecordError::Quote { file: file.to_owned(), fault })
}

/// Kinds of which a directory holds a table, by itself or in its folders. Of tables that two kinds
/// share, `operations`, the first counts.
pub fn tables(dir: &Path) -> Vec<RecordKind> {
    let kinds = [RecordKind::Turning, RecordKind::Milling, RecordKind::Grinding, RecordKind::Shop, RecordKind::Program];
    kinds.into_iter().filter(|kind| has_table(dir, *kind)).collect()
}

/// Whether a directory holds a table of a kind, by itself or in its folders.
pub fn has_table(dir: &Path, kind: RecordKind) -> bool {
    find(dir, kind).is_ok() || !folders(dir, kind).is_empty()
}

/// Files of all tables that a directory holds, by itself or in its folders.
pub fn table_files(dir: &Path) -> Vec<PathBuf> {
    let of_kind = |kind: &RecordKind| {
        let nested = folders(dir, *kind);
        nested.iter().map(PathBuf::as_path).chain([dir]).filter_map(|own| find(own, *kind).ok()).collect::<Vec<_>>()
    };
    RecordKind::ALL.iter().flat_map(of_kind).collect()
}

/// Folders of a directory that hold a file of the kind, by name.
fn folders(dir: &Path, kind: RecordKind) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(dir).into_iter().flatten().filter_map(Result::ok);
    let mut list: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_dir()).collect();
    list.retain(|path| find(path, kind).is_ok());
    list.sort();
    list
}

/// The records of several folders, one after the other.
fn joined(parts: &[PathBuf], kind: RecordKind, parquet: OtherTable<'_>) -> Result<(Records, ReadReport), RecordError> {
    let (mut records, mut report) = read(&parts[0], kind, parquet)?;
    for part in &parts[1..] {
        let (more, read) = read(part, kind, parquet)?;
        records = records.followed_by(&more);
        report.file = format!("{}, {}", report.file, read.file);
        report.rows += read.rows;
        report
            .columns
            .extend(read.columns.into_iter().filter(|column| !report.columns.contains(column)).collect::<Vec<_>>());
        report.notes.extend(read.notes);
        report.dropped.extend(read.dropped);
        report.unknown_cuts.extend(read.unknown_cuts);
        report.unreadable.extend(read.unreadable);
    }
    // Lines of several files say nothing without the file.
    report.lines.clear();
    Ok((records, report))
}

fn find(dir: &Path, kind: RecordKind) -> Result<PathBuf, RecordError> {
    let stem = kind.file_stem();
    let candidates = ["csv", "parquet"].map(|extension| dir.join(format!("{stem}.{extension}")));
    let found = candidates.into_iter().find(|path| path.is_file());
    found.ok_or(RecordError::NoFile { path: dir.to_owned(), stem })
}

/// A column of the file that is used.
struct UsedColumn {
    at: usize,
    name: String,
    column: Option<&'static RecordColumn>,
    /// Unit in which it is read; none for texts.
    unit: String,
    factor: f64,
    offset: f64,
}

/// The records that a table of cells holds. The table is taken, so that its cells, which take most of the memory, are gone before
/// the records are put into order.
fn understand(file: &str, table: RawTable, kind: RecordKind) -> Result<(Records, ReadReport), RecordError> {
    let mut report = ReadReport { file: file.to_owned(), notes: table.notes.clone(), ..ReadReport::default() };
    if table.header.is_empty() {
        return Err(RecordError::NoRows { file: file.to_owned(), rows: 0, first: None, wrong: false });
    }
    let used = header(file, &table, kind, &mut report)?;
    for column in kind.columns().iter().filter(|column| column.required) {
        if used.iter().all(|each| each.name != column.name) {
            let likeness = |title: &&String| strsim::jaro_winkler(column.name, &title.to_ascii_lowercase());
            let nearest = table.header.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
            let nearest = nearest.filter(|title| likeness(title) > 0.8).cloned();
            return Err(RecordError::MissingColumn {
                file: file.to_owned(),
                column: column.name,
                example: column.header(),
                nearest,
            });
        }
    }
    let (rows, wrong) = rows(&table, &used, kind, &mut report);
    if rows.is_empty() {
        let first = report.dropped.first().map(|(line, reason)| format!("line {line}, {reason}"));
        return Err(RecordError::NoRows { file: file.to_owned(), rows: table.rows.len(), first, wrong });
    }
    let mut records = Records::new(kind, rows.len());
    for (index, each) in used.iter().enumerate() {
        if each.column.is_some_and(|column| column.kind == ColumnKind::Text) {
            let texts = rows.iter().map(|row| table.rows[row.at].1.get(each.at).cloned().unwrap_or_default());
            records.set_texts(&each.name, texts.collect());
        } else {
            records.set_numbers(&each.name, rows.iter().map(|row| row.numbers[index]).collect());
        }
    }
    report.rows = records.len();
    report.lines = rows.iter().map(|row| table.rows[row.at].0).collect();
    drop((rows, table));
    Ok((ordered(records, &mut report), report))
}

fn header(
    file: &str,
    table: &RawTable,
    kind: RecordKind,
    report: &mut ReadReport,
) -> Result<Vec<UsedColumn>, RecordError> {
    let mut used: Vec<UsedColumn> = Vec::new();
    for (place, title) in table.header.iter().enumerate() {
        let (name, read) = name_and_unit(title);
        let name = name.to_ascii_lowercase().replace([' ', '-'], "_");
        let known = kind.column(&name);
        if used.iter().any(|each| each.name == name) {
            report.notes.push(format!("column `{title}` stands twice; the first is used"));
            continue;
        }
        let (unit, (factor, offset)) = match known {
            Some(column) if column.kind == ColumnKind::Text => (String::new(), (1.0, 0.0)),
            Some(column) => {
                let unit = if read.is_empty() { column.display } else { read };
                if read.is_empty() && column.display != "1" {
                    report.notes.push(format!("column `{name}` has no unit; taken as {}", column.display));
                }
                // A bare count or a ratio written as such.
                let unit = if column.unit == "1" && matches!(unit, "rev" | "-") { "1" } else { unit };
                let scale = scale(unit, column.unit).ok_or_else(|| RecordError::Unit {
                    file: file.to_owned(),
                    column: column.name,
                    read: read.to_owned(),
                    accepted: toolroom_process::unit::accepted(column.unit),
                })?;
                (unit.to_owned(), scale)
            }
            None => {
                report.unused.push(title.clone());
                continue;
            }
        };
        report.columns.push(title.clone());
        used.push(UsedColumn { at: place, name, column: known, unit, factor, offset });
    }
    Ok(used)
}

/// Columns that tell one record from another.
const IDENTITY: [&str; 7] =
    ["operation_id", "trial_id", "tool_id", "wheel_id", "dressing_cycle", "sequence", "part_in_cycle"];

/// A row that is used: its place in the table and its numbers, SI.
struct UsedRow {
    at: usize,
    numbers: Vec<f64>,
}

/// Rows that are used, and whether some are not for what they hold.
fn rows(table: &RawTable, used: &[UsedColumn], kind: RecordKind, report: &mut ReadReport) -> (Vec<UsedRow>, bool) {
    let mut wrong = false;
    let mut kept = Vec::with_capacity(table.rows.len());
    let mut first_of: BTreeMap<Vec<&str>, usize> = BTreeMap::new();
    // Ids may start anew with each edge: a record is the same only on the same edge.
    let identity: Vec<usize> = match kind {
        RecordKind::Shop | RecordKind::Orders => Vec::new(),
        RecordKind::Turning
        | RecordKind::Milling
        | RecordKind::Grinding
        | RecordKind::Program
        | RecordKind::Empirical => {
            used.iter().filter(|each| IDENTITY.contains(&each.name.as_str())).map(|each| each.at).collect()
        }
    };
    let mut beyond: BTreeMap<usize, (Vec<usize>, usize, String)> = BTreeMap::new();
    'rows: for (row, (line, cells)) in table.rows.iter().enumerate() {
        if let Some(reason) = table.surplus(cells) {
            wrong = true;
            report.dropped.push((*line, reason));
            continue;
        }
        let mut numbers = Vec::with_capacity(used.len());
        for used_column in used {
            let read = cells.get(used_column.at).map_or("", String::as_str);
            let missing = is_missing(read);
            let column = used_column.column;
            let must = column.is_some_and(|column| column.required);
            if column.is_some_and(|column| column.kind == ColumnKind::Text) {
                if must && missing {
                    report.dropped.push((*line, format!("{} is empty", used_column.name)));
                    continue 'rows;
                }
                numbers.push(f64::NAN);
                continue;
            }
            let number = number(read);
            if let (Some(value), Some(column)) = (number, column)
                && (value * used_column.factor + used_column.offset).abs() > column.greatest * column.scale()
            {
                let UsedColumn { name, unit, .. } = used_column;
                let (greatest, display) = (column.greatest, column.display);
                // Counts, and marks such as `censored`, have no unit that could be wrong.
                let reason = if display == "1" && unit == "1" {
                    format!("{name} is {read}, and {greatest} is the greatest that it can be")
                } else {
                    format!("{name} is {read} {unit}, beyond {greatest} {display}: check its unit")
                };
                if must {
                    wrong = true;
                    report.dropped.push((*line, reason));
                    continue 'rows;
                }
                beyond.entry(numbers.len()).or_insert_with(|| (Vec::new(), *line, reason)).0.push(row);
            }
            // One such row would spoil the whole life of its edge, or be the greatest of all outliers.
            if must && column.zip(number).is_some_and(|(column, value)| value < column.least) {
                let (name, unit) = (&used_column.name, &used_column.unit);
                let reason =
                    format!("{name} is {read} {unit}, at which nothing is cut: correct it, or leave the row out");
                wrong = true;
                report.unknown_cuts.push((*line, format!("a {name} of {read} {unit}")));
                report.dropped.push((*line, reason));
                continue 'rows;
            }
            if number.is_none() && !missing {
                report.unreadable.push((*line, used_column.name.clone(), read.to_owned()));
            }
            if must && number.is_none() {
                wrong |= !missing;
                let name = &used_column.name;
                // The order of rows says nothing of what was cut.
                if name != kind.sequence().1 {
                    let what = if missing { format!("an empty {name}") } else { format!("a {name} of `{read}`") };
                    report.unknown_cuts.push((*line, what));
                }
                report
                    .dropped
                    .push((*line, format!("{} is {}", used_column.name, if missing { "empty" } else { read })));
                continue 'rows;
            }
            numbers.push(number.map_or(f64::NAN, |number| number * used_column.factor + used_column.offset));
        }
        let cell = |column: usize| cells.get(column).map_or("", String::as_str);
        let key: Vec<&str> = identity.iter().map(|column| cell(*column)).collect();
        if !key.is_empty() {
            if let Some(first) = first_of.get(&key) {
                report.dropped.push((*line, format!("`{}` stands in line {first} already", key.join(" "))));
                continue;
            }
            first_of.insert(key, *line);
        }
        kept.push(UsedRow { at: row, numbers });
    }
    report.notes.extend(ids_told_apart(kind, table, used, &kept));
    for (column, (places, line, reason)) in beyond {
        // A few slips are no values; a whole channel in another unit is for the diagnosis to say.
        let few = 2 * places.len() < kept.len();
        let what = if few { format!("; {} such values are taken as missing", places.len()) } else { String::new() };
        report.notes.push(format!("line {line}: {reason}{what}"));
        for row in kept.iter_mut().filter(|row| few && places.binary_search(&row.at).is_ok()) {
            row.numbers[column] = f64::NAN;
        }
    }
    (kept, wrong)
}

/// Says where one id stands for several records of one edge, which only their sequence tells apart. Two edges may share a pass;
/// an operation has several events, and a program several stretches.
fn ids_told_apart(kind: RecordKind, table: &RawTable, used: &[UsedColumn], kept: &[UsedRow]) -> Option<String> {
    match kind {
        RecordKind::Turning | RecordKind::Milling | RecordKind::Empirical => {}
        RecordKind::Grinding | RecordKind::Program | RecordKind::Shop | RecordKind::Orders => return None,
    }
    let [id, edge] = ["operation_id", "tool_id"].map(|name| used.iter().find(|each| each.name == name));
    let (id, edge) = id.zip(edge)?;
    let mut first_of: BTreeMap<[&str; 2], usize> = BTreeMap::new();
    let mut repeated: Vec<(&str, usize, usize)> = Vec::new();
    for row in kept {
        let (line, cells) = &table.rows[row.at];
        let key = [id, edge].map(|column| cells.get(column.at).map_or("", String::as_str));
        match first_of.get(&key) {
            Some(first) if !key[0].is_empty() => repeated.push((key[0], *first, *line)),
            Some(_) => {}
            None => {
                first_of.insert(key, *line);
            }
        }
    }
    let (id, first, line) = repeated.first()?;
    Some(format!(
        "{} rows have the operation_id of an earlier one of their edge, first `{id}` in lines {first} and {line}: their sequence tells \
         them apart, and predictions cannot be joined by the id alone",
        repeated.len()
    ))
}

/// A finite number.
pub(super) fn number(read: &str) -> Option<f64> {
    read.parse::<f64>().ok().filter(|number| number.is_finite())
}

/// What stands for nothing in real files.
pub(super) fn is_missing(read: &str) -> bool {
    matches!(read.to_ascii_lowercase().as_str(), "" | "nan" | "na" | "n/a" | "null" | "none" | "-" | "unavailable")
}

/// Rows in the order of their edge and sequence, so that files may come in any order. Dressings
/// that are not named follow from the order of the file, which is then kept.
fn ordered(records: Records, report: &mut ReadReport) -> Records {
    let (group, order) = records.kind.sequence();
    let groups: &[&str] = match records.kind {
        RecordKind::Grinding if records.texts(group).is_none() => return records,
        RecordKind::Grinding => &["machine", "wheel_id", "dressing_cycle"],
        RecordKind::Turning
        | RecordKind::Milling
        | RecordKind::Shop
        | RecordKind::Orders
        | RecordKind::Program
        | RecordKind::Empirical => &[group],
    };
    let Some(sequence) = records.numbers(order) else { return records };
    let mut rows: Vec<usize> = (0..records.len()).collect();
    let texts: Vec<&[String]> = groups.iter().filter_map(|group| records.texts(group)).collect();
    let keys: Vec<Vec<(&str, u64)>> =
        rows.iter().map(|row| texts.iter().map(|texts| numbered(&texts[*row])).collect()).collect();
    rows.sort_by(|a, b| keys[*a].cmp(&keys[*b]).then(sequence[*a].total_cmp(&sequence[*b])));
    if rows.windows(2).any(|pair| pair[0] > pair[1]) {
        report.notes.push(format!("rows put into the order of {} and {order}", groups.join(", ")));
    } else {
        return records;
    }
    if !report.lines.is_empty() {
        report.lines = rows.iter().map(|row| report.lines[*row]).collect();
    }
    records.select(&rows)
}

/// A name and the number that it ends in: T2 comes before T10.
fn numbered(text: &str) -> (&str, u64) {
    let name = text.trim_end_matches(|c: char| c.is_ascii_digit());
    (name, text[name.len()..].parse().unwrap_or(0))
}
