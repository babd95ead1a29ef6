//! Square tables of times from one thing to another: between setup groups, between places.

use super::fault::ScenarioFault;
use super::keys::quantity::DECADE;
use super::random::bare;
use toolroom_form::{Fault, Section, Value, Walk, nearest};
use toolroom_process::table::Lines;
use toolroom_process::unit::quantity;

/// A table of times; its form is not looked at where it is given by lists.
pub(super) struct Matrix {
    /// Names of rows and columns.
    pub names: Vec<String>,
    /// Rows of times, s: from the row to the column.
    pub times: Vec<Vec<f64>>,
}

/// The matrix of a section, by the list `names` and by `times`, or by `file`. A row in front of those of the names belongs to
/// no name, where `first` says that there may be one: in a file its name is empty. `None` after a fault.
pub(super) fn matrix(walk: &mut Walk, section: &Section<'_>, names: &'static str, first: bool) -> Option<Matrix> {
    let Some(file) = section.text("file") else {
        for key in [names, "times"].into_iter().filter(|key| section.got(key).is_none()) {
            let list = if key == "times" { "[[\"1.5 min\"]]" } else { "[\"…\"]" };
            let example = format!("{list}` or `file = \"times.csv\"");
            walk.fault(
                section.span.clone(),
                Fault::MissingKey { section: section.form.title.to_owned(), key, example },
            );
        }
        section.got(names).and(section.got("times"))?;
        return Some(Matrix { names: section.texts(names), times: section.list("times").iter().map(row).collect() });
    };
    if section.given("times") {
        let (case, applicable) = ("a table from a `file`, which has them".to_owned(), format!("{names}, file"));
        walk.fault(section.span_of("times"), Fault::NotApplicable { key: "times", case, applicable });
    }
    let text = walk.file(section, "file", file)?;
    let read = of_file(walk, section, (file, &text), first)?;
    if section.given(names) { arranged(walk, section, names, file, read) } else { Some(read) }
}

/// The matrix of a file in the order of the names that the section lists.
fn arranged(walk: &mut Walk, section: &Section<'_>, key: &str, file: &str, read: Matrix) -> Option<Matrix> {
    let names = section.texts(key);
    let places: Option<Vec<usize>> =
        names.iter().map(|name| read.names.iter().position(|known| known == name)).collect();
    let Some(places) = places.filter(|_| names.len() == read.names.len()) else {
        let reason =
            format!("`{key}` are {}, but the columns of {file} are {}", names.join(", "), read.names.join(", "));
        let fix = format!("take out `{key}`, or list the columns of the file, in any order");
        walk.fault(section.span_of(key), ScenarioFault::Arrangement { reason, fix });
        return None;
    };
    let before = read.times.len() - read.names.len(); // a row in front that belongs to no name
    let rows = (0..before).chain(places.iter().map(|place| place + before));
    let times = rows.map(|row| places.iter().map(|column| read.times[row][*column]).collect()).collect();
    Some(Matrix { names, times })
}

/// A row of a list.
pub(super) fn row(got: &toolroom_form::SectionValue<'_>) -> Vec<f64> {
    let Value::List(cells) = &got.value else { return Vec::new() };
    cells.iter().map(|cell| if let Value::Si(time) = cell.value { time } else { f64::NAN }).collect()
}

/// The table of a file: the first line names the columns, the first cell of every other line its row.
fn of_file(walk: &mut Walk, section: &Section<'_>, (file, text): (&str, &str), first: bool) -> Option<Matrix> {
    let (place, noted) = (section.span_of("file"), walk.problems.len());
    let mut fault = |line: u64, reason: String, fix: Option<String>| {
        let fault = ScenarioFault::TableCell { file: file.to_owned(), line, reason, fix };
        walk.fault(place.clone(), fault);
    };
    let first_line = text.lines().find(|line| !line.starts_with('#')).unwrap_or_default();
    let delimiter = if first_line.contains(';') && !first_line.contains(',') { b';' } else { b',' };
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .flexible(true)
        .from_reader(text.as_bytes());
    let header: Vec<String> = match reader.headers() {
        Ok(header) => header.iter().map(str::to_owned).collect(),
        Err(error) => {
            fault(1, error.to_string(), None);
            return None;
        }
    };
    let (corner, names) = header.split_first()?;
    let unit = bare(corner).1;
    for (i, name) in names.iter().enumerate() {
        if name.is_empty() || names[..i].contains(name) {
            let fix = "the first line names the columns after its first cell, each once: from,small,large".to_owned();
            fault(1, format!("column {} is called \"{name}\"", i + 2), Some(fix));
        }
    }
    let mut rows: Vec<Option<Vec<f64>>> = vec![None; names.len() + 1];
    let mut lines = Lines::new(text);
    for record in reader.records() {
        let record = match record {
            Ok(record) => record,
            Err(error) => {
                fault(error.position().map_or(0, csv::Position::line), error.to_string(), None);
                continue;
            }
        };
        let line = record.position().map_or(0, |position| lines.at(position.byte()) as u64);
        let name = record.get(0).unwrap_or_default();
        let index = match names.iter().position(|known| known == name) {
            Some(found) => found + 1,
            None if name.is_empty() && first => 0,
            None => {
                let near = nearest(name, names.iter().map(String::as_str));
                let near = near.map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
                let fix = format!("{near}rows have the names of the columns: {}", names.join(", "));
                fault(line, format!("there is no column \"{name}\" for this row"), Some(fix));
                continue;
            }
        };
        if rows[index].is_some() {
            fault(line, format!("there are two rows \"{name}\""), None);
        }
        if record.len() != header.len() {
            let reason = format!("row \"{name}\" has {} cells, and the first line {}", record.len(), header.len());
            fault(line, reason, Some("give a time to every column".to_owned()));
        }
        let mut times = Vec::with_capacity(names.len());
        for (cell, column) in record.iter().skip(1).zip(names) {
            let read = match unit.filter(|_| cell.parse::<f64>().is_ok()) {
                Some(unit) => quantity(&format!("{cell} {unit}"), "s"),
                None => quantity(cell, "s"),
            };
            match read {
                Ok(time) if (0.0..=DECADE).contains(&time) => times.push(time),
                Ok(_) => {
                    let fix = "a time is 0 or longer, and shorter than ten years".to_owned();
                    fault(line, format!("\"{cell}\", to \"{column}\", is outside 0 to 87600 h"), Some(fix));
                }
                Err(reason) => {
                    let fix = "write 4.2 min, or give the unit of all in the first cell: from [min]".to_owned();
                    fault(line, format!("to \"{column}\": {reason}"), Some(fix));
                }
            }
        }
        rows[index] = Some(times);
    }
    for (name, _) in names.iter().zip(&rows[1..]).filter(|(_, row)| row.is_none()) {
        fault(1, format!("the row \"{name}\" is missing"), Some("give a row for every column".to_owned()));
    }
    if walk.problems.len() > noted {
        return None;
    }
    Some(Matrix { names: names.to_vec(), times: rows.into_iter().flatten().collect() })
}
