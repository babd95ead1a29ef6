//! Tables of numbers below one line of titles.

use crate::error::DynamicsError;

/// A table.
pub(crate) struct Table {
    /// Line of the titles, from 1.
    pub line: usize,
    /// The titles as they are written.
    pub titles: Vec<String>,
    /// The numbers of every column.
    pub columns: Vec<Vec<f64>>,
    /// Greatest number of decimals in a cell of every column that is written without a power of ten.
    pub decimals: Vec<usize>,
}

/// Reads a table: cells are separated by commas, semicolons or tabs, whichever the titles have most of; lines that start with
/// `#` are comments. Where commas do not separate, they are decimal signs, unless points are.
pub(crate) fn read_table(file: &str, text: &str) -> Result<Table, DynamicsError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    // Every other byte of plain text in UTF-16 is zero.
    if text.get(..64).unwrap_or(text).contains('\0') {
        return Err(DynamicsError::Encoding { file: file.to_owned() });
    }
    // Lines that end with carriage returns alone, as some spreadsheets write them.
    let returns = (!text.contains('\n')).then(|| text.replace('\r', "\n"));
    let mut lines = returns
        .as_deref()
        .unwrap_or(text)
        .lines()
        .enumerate()
        .map(|(i, line)| (i + 1, line))
        .filter(|(_, l)| !l.trim().is_empty() && !l.starts_with('#'));
    let (line, header) = lines.next().ok_or_else(|| DynamicsError::Nothing { file: file.to_owned() })?;
    let separator = [',', ';', '\t'].into_iter().max_by_key(|mark| header.matches(*mark).count()).unwrap_or(',');
    let cell = |text: &str| text.trim().trim_matches('"').trim().to_owned();
    let mut titles: Vec<String> = header.split(separator).map(cell).collect();
    let mut lines = lines.peekable();
    // Units in a row of their own below the names.
    if let Some(units) = lines.next_if(|(_, row)| below_titles(row, separator, &titles)) {
        for (title, unit) in titles.iter_mut().zip(units.1.split(separator).map(cell)) {
            if !unit.is_empty() {
                *title = format!("{title} [{}]", unit.trim_matches(['[', ']', '(', ')']));
            }
        }
    }
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); titles.len()];
    let mut decimals = vec![0; titles.len()];
    for (line, row) in lines {
        let texts: Vec<&str> = row.split(separator).map(|text| text.trim().trim_matches('"').trim()).collect();
        if texts.len() != titles.len() {
            let (cells, columns) = (texts.len(), titles.len());
            return Err(DynamicsError::UnevenRow { file: file.to_owned(), line, cells, columns });
        }
        for (i, text) in texts.iter().enumerate() {
            let plain =
                if separator == ',' || text.contains('.') { (*text).to_owned() } else { text.replace(',', ".") };
            let value = plain.parse::<f64>().ok().filter(|value| value.is_finite());
            columns[i].push(value.ok_or_else(|| DynamicsError::NotANumber {
                file: file.to_owned(),
                line,
                column: titles[i].clone(),
                text: (*text).to_owned(),
            })?);
            if !plain.contains(['e', 'E']) {
                let places = plain.split_once('.').map_or(0, |(_, places)| places.len());
                decimals[i] = decimals[i].max(places);
            }
        }
    }
    Ok(Table { line, titles, columns, decimals })
}

/// Whether a row holds the units of titles that have none: as many cells, one at least filled, and no number among them.
fn below_titles(row: &str, separator: char, titles: &[String]) -> bool {
    let cells: Vec<&str> = row.split(separator).map(|text| text.trim().trim_matches('"').trim()).collect();
    cells.len() == titles.len()
        && titles.iter().all(|title| split_title(title).1.is_none())
        && cells.iter().any(|text| !text.is_empty())
        && cells.iter().all(|text| text.replace(',', ".").parse::<f64>().is_err())
}

impl Table {
    /// The columns that `place` knows by their name and unit, each at its place and multiplied by its factor; the title of a
    /// column that it does not know, or that is there twice.
    pub fn sorted<const N: usize>(
        self,
        place: impl Fn(&str, Option<&str>) -> Option<(usize, f64)>,
    ) -> Result<[Option<Vec<f64>>; N], String> {
        let mut found = [const { None }; N];
        for (title, values) in self.titles.into_iter().zip(self.columns) {
            let (name, unit) = split_title(&title);
            let Some((index, factor)) = place(&name, unit) else { return Err(title) };
            if found[index].replace(values.into_iter().map(|value| value * factor).collect()).is_some() {
                return Err(title);
            }
        }
        Ok(found)
    }
}

/// Name and unit of a title such as `force [N]` or `force (N)`.
pub(crate) fn split_title(title: &str) -> (String, Option<&str>) {
    let square = title.split_once('[').map(|(name, rest)| (name, rest.trim().strip_suffix(']').map(str::trim)));
    let round = || {
        let (name, unit) = title.trim().strip_suffix(')')?.split_once('(')?;
        Some((name, Some(unit.trim())))
    };
    let (name, unit) = square.or_else(round).unwrap_or((title, None));
    (name.trim().to_lowercase(), unit)
}
