//! The text of the scenario, with the cell of every value.

use crate::fault::CellRef;
use std::fmt::Write as _;

/// A scenario that is being written.
pub(crate) struct Draft {
    pub text: String,
    /// Where what a cell gives begins; up to the next one.
    marks: Vec<(usize, CellRef)>,
}

impl Draft {
    /// The base; everything behind it comes from tables.
    pub fn new(base: &str, map: &str) -> Self {
        let mut text = base.trim_end().to_owned();
        text += &format!(
            "\n\n# ---- From here on made by `toolroom import shop --map {}`: what is changed below is lost by the next import.\n",
            map.replace(char::is_control, " ")
        );
        Self { text, marks: Vec::new() }
    }

    /// `[[order]]` of a row.
    pub fn section(&mut self, title: &str, origin: CellRef) {
        self.text.push('\n');
        self.mark(origin);
        let _ = writeln!(self.text, "[[{title}]]");
    }

    /// `key = value` of a cell.
    pub fn value(&mut self, key: &str, value: &str, origin: CellRef) {
        self.mark(origin);
        let _ = writeln!(self.text, "{key} = {value}");
    }

    /// A piece of a value that comes from several cells.
    pub fn piece(&mut self, piece: &str, origin: CellRef) {
        self.mark(origin);
        self.text += piece;
    }

    fn mark(&mut self, origin: CellRef) {
        if self.marks.last().is_none_or(|(_, last)| *last != origin) {
            self.marks.push((self.text.len(), origin));
        }
    }

    /// The cell that the text at a byte comes from; `None` in the base.
    pub fn origin(&self, byte: usize) -> Option<CellRef> {
        let behind = self.marks.partition_point(|(start, _)| *start <= byte);
        self.marks[..behind].last().map(|(_, origin)| *origin)
    }
}
