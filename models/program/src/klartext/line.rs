//! Lines of Klartext as statements.

use std::ops::ControlFlow;
use toolroom_pages::Reader;

/// A block in words.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Statement {
    pub line: usize,
    pub file: usize,
    pub skip: bool,
    /// The block in capitals, without number, comment and continuation.
    pub text: String,
    /// Words with the column of the first line of the block.
    pub words: Vec<(String, usize)>,
}

impl Statement {
    /// The label that it sets; LBL 0 is none.
    pub fn label(&self) -> Option<&str> {
        let rest = self.text.strip_prefix("LBL ")?;
        let label = rest.split_whitespace().next().unwrap_or_default().trim_matches('"');
        (label != "0").then_some(label)
    }
}

/// Makes statements of lines.
#[derive(Clone)]
pub(super) struct LineReader {
    file: usize,
    /// Whether the last line goes on in the next.
    continued: bool,
}

impl LineReader {
    pub fn new(file: usize) -> Self {
        Self { file, continued: false }
    }
}

impl Reader for LineReader {
    type Item = Statement;

    fn line(&mut self, number: usize, line: &str, list: &mut Vec<Statement>) -> ControlFlow<()> {
        let line = line.trim_start_matches('\u{feff}').replace('\0', " ").to_ascii_uppercase();
        let uncommented = comment(&line);
        let mut body = uncommented.trim_end();
        let goes_on = body.ends_with('~') || line.trim_end().ends_with('~');
        body = body.trim_end_matches('~');
        let mut start = body.len() - body.trim_start().len();
        let mut skip = false;
        if !self.continued {
            let digits = body[start..].bytes().take_while(u8::is_ascii_digit).count();
            start += digits;
            start += body[start..].len() - body[start..].trim_start().len();
            if body[start..].starts_with('/') {
                skip = true;
                start += 1;
            }
            // A line of structure holds words for people.
            if body[start..].trim_start().starts_with('*') {
                return ControlFlow::Continue(());
            }
        }
        let words = split(body, start);
        match list.last_mut().filter(|_| self.continued) {
            Some(last) => {
                last.text.push(' ');
                last.text.push_str(body[start..].trim());
                last.words.extend(words);
            }
            None if words.is_empty() => {}
            None => {
                let text = body[start..].trim().to_owned();
                list.push(Statement { line: number, file: self.file, skip, text, words });
            }
        }
        self.continued = goes_on;
        ControlFlow::Continue(())
    }

    fn goes_on(&self) -> bool {
        self.continued
    }

    fn stays(_: &Statement) -> bool {
        false
    }
}

/// A line without its comment.
fn comment(line: &str) -> String {
    let mut quoted = false;
    for (start, letter) in line.char_indices() {
        match letter {
            '"' => quoted = !quoted,
            ';' if !quoted => return line[..start].to_owned(),
            _ => {}
        }
    }
    line.to_owned()
}

/// Words of a line from `start`, with their columns; a text in quotes is one.
fn split(line: &str, start: usize) -> Vec<(String, usize)> {
    let mut words: Vec<(String, usize)> = Vec::new();
    let (mut word, mut column, mut quoted) = (String::new(), 0, false);
    for (index, letter) in line.char_indices().skip_while(|(index, _)| *index < start) {
        if letter.is_whitespace() && !quoted {
            if !word.is_empty() {
                words.push((std::mem::take(&mut word), column));
            }
            continue;
        }
        if word.is_empty() {
            column = index + 1;
        }
        quoted ^= letter == '"';
        word.push(letter);
    }
    if !word.is_empty() {
        words.push((word, column));
    }
    words
}
