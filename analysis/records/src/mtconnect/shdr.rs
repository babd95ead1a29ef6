//! Lines of SHDR, the text that adapters send to an MTConnect agent.

use super::time::seconds;

/// A value at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Seconds since 1970, or of a relative adapter.
    pub time: f64,
    /// Line of the file, from 1.
    pub line: usize,
    /// Key of the data item.
    pub key: String,
    /// Its value; `None` for UNAVAILABLE.
    pub value: Option<String>,
}

/// Why a line gave nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Passed {
    /// No time stamp could be read.
    NoTime,
    /// A time stamp without key and value.
    NoValue,
    /// A key at the end of a line has no value: the pairs before it were read.
    OddKey,
    /// Asset documents and their removal.
    Asset,
    /// A condition: kept as a value, its native code and text are not.
    Condition,
    /// A command of the adapter (`* shdrVersion: 2`).
    Command,
    /// Nothing on the line.
    Empty,
}

impl Passed {
    /// In words.
    pub fn reason(self) -> &'static str {
        match self {
            Self::NoTime => "no time stamp",
            Self::NoValue => "time without value",
            Self::OddKey => "a key without value at the end",
            Self::Asset => "asset document",
            Self::Condition => "condition: its level is kept, code and text are not",
            Self::Command => "command of the adapter",
            Self::Empty => "empty line",
        }
    }
}

/// Entries in the order of the file, and lines that gave less than they held.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lines {
    /// Values.
    pub entries: Vec<Entry>,
    /// Number of lines of the file.
    pub count: usize,
    /// Line and what of it was passed over.
    pub finished_lines: Vec<(usize, Passed)>,
}

/// Levels of a condition.
const LEVELS: [&str; 4] = ["normal", "warning", "fault", "unavailable"];

/// Reads `time|key|value|key|value…`, conditions (`time|key|level|code|severity|qualifier|text`),
/// and passes over assets and commands.
///
/// ```
/// let lines = toolroom_records::mtconnect::parse_shdr("2017-02-07T19:38:30.9Z|execution|ACTIVE|Fovr|80\n");
/// assert_eq!(lines.entries[1].value.as_deref(), Some("80"));
/// ```
pub fn parse_shdr(text: &str) -> Lines {
    let mut lines = Lines::default();
    // A document of several lines ends with the mark that opened it.
    let mut document: Option<String> = None;
    for (index, line) in text.lines().enumerate() {
        lines.count = index + 1;
        let line = line.trim_end_matches('\r').trim_start_matches('\u{feff}');
        let line_number = index + 1;
        if let Some(mark) = &document {
            lines.finished_lines.push((line_number, Passed::Asset));
            if line.trim() == mark {
                document = None;
            }
            continue;
        }
        if line.trim().is_empty() {
            lines.finished_lines.push((line_number, Passed::Empty));
        } else if line.starts_with('*') {
            lines.finished_lines.push((line_number, Passed::Command));
        } else {
            document = read_line(line, line_number, &mut lines);
        }
    }
    lines
}

/// Reads one line; the answer is the end mark of a document that it opens.
fn read_line(line: &str, line_number: usize, lines: &mut Lines) -> Option<String> {
    let mut fields = line.split('|');
    let Some(time) = fields.next().and_then(seconds) else {
        lines.finished_lines.push((line_number, Passed::NoTime));
        return None;
    };
    let fields: Vec<&str> = fields.map(str::trim).collect();
    if fields.is_empty() || fields[0].is_empty() {
        lines.finished_lines.push((line_number, Passed::NoValue));
        return None;
    }
    if fields[0].starts_with('@') {
        lines.finished_lines.push((line_number, Passed::Asset));
        return fields.last().filter(|field| field.starts_with("--multiline--")).map(|mark| (*mark).to_owned());
    }
    let entry = |key: &str, value: &str| {
        let value = (!value.eq_ignore_ascii_case("unavailable")).then(|| value.to_owned());
        Entry { time, line: line_number, key: key.to_owned(), value }
    };
    if is_condition(&fields) {
        lines.entries.push(entry(fields[0], fields[1]));
        lines.finished_lines.push((line_number, Passed::Condition));
        return None;
    }
    let pairs = fields.chunks_exact(2);
    if let [key] = pairs.remainder()
        && !key.is_empty()
    {
        lines.finished_lines.push((line_number, Passed::OddKey));
    }
    lines.entries.extend(pairs.filter(|pair| !pair[0].is_empty()).map(|pair| entry(pair[0], pair[1])));
    None
}

/// A condition stands alone on its line with six fields. UNAVAILABLE is also a value: there the
/// empty fields after it tell.
fn is_condition(fields: &[&str]) -> bool {
    let [_, level, code, severity, ..] = fields else { return false };
    let known = LEVELS.iter().any(|name| level.eq_ignore_ascii_case(name));
    known
        && fields.len() == 6
        && (!level.eq_ignore_ascii_case("unavailable") || (code.is_empty() && severity.is_empty()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn values(text: &str) -> Vec<(String, Option<String>)> {
        parse_shdr(text).entries.into_iter().map(|entry| (entry.key, entry.value)).collect()
    }

    #[test]
    fn pairs_conditions_assets_and_gaps_are_told_apart() {
        let text = "* shdrVersion: 2\n\
            2022-08-08T13:51:34.7Z|a|1|b||c|UNAVAILABLE\n\
            2022-08-08T13:51:34.8Z|coolant_cond|NORMAL||||\n\
            2022-08-08T13:51:34.8Z|coolant_cond|UNAVAILABLE||||\n\
            2022-08-08T10:33:04.9Z|@ASSET@|123.20|CuttingTool|--multiline--ABCD\n<CuttingTool>|x|1</CuttingTool>\n--multiline--ABCD\n\
            2022-08-08T13:51:35Z|d|4|e\n\n2017\n";
        let some = |key: &str, value: &str| (key.to_owned(), Some(value.to_owned()));
        let none = |key: &str| (key.to_owned(), None);
        let expected = [
            some("a", "1"),
            some("b", ""),
            none("c"),
            some("coolant_cond", "NORMAL"),
            none("coolant_cond"),
            some("d", "4"),
        ];
        assert_eq!(values(text), expected);
        let passed: Vec<Passed> = parse_shdr(text).finished_lines.into_iter().map(|(_, why)| why).collect();
        use Passed::*;
        assert_eq!(passed, [Command, Condition, Condition, Asset, Asset, Asset, OddKey, Empty, NoValue]);
    }

    proptest! {
        #[test]
        fn any_text_is_answered_without_panic(text in "([-0-9TZ:.+@|*a-dé \\n]|UNAVAILABLE|NORMAL|@ASSET@|--multiline--A){0,80}") {
            let lines = parse_shdr(&text);
            prop_assert!(lines.entries.iter().all(|entry| entry.time.is_finite() && !entry.key.is_empty()));
        }

        #[test]
        fn any_bytes_are_answered_without_panic(text in any::<String>()) {
            parse_shdr(&text);
        }
    }
}
