//! TOML texts as trees, with what is wrong in them.

use crate::fault::{Fault, Problem};
use std::collections::BTreeSet;
use toml::Spanned;
use toml::de::DeTable;

/// Longest text of which every slip is told, bytes; of a longer one the first (assumption). The reader of TOML notes a message for
/// nearly every sign that is out of place, which takes a hundred times the memory of the text.
const TOLD_WHOLE: usize = 4 << 20;

/// Most lines whose slips are told (assumption): nobody mends more before the next look.
const MOST_LINES: usize = 1000;

/// What can be understood of a text, and what breaks the rules of TOML in it.
pub(crate) fn tree(text: &str) -> (Spanned<DeTable<'_>>, Vec<Problem>) {
    let (root, errors) = if text.len() <= TOLD_WHOLE {
        DeTable::parse_recoverable(text)
    } else {
        match DeTable::parse(text) {
            Ok(root) => (root, Vec::new()),
            Err(error) => (Spanned::new(0..0, DeTable::new()), vec![error]),
        }
    };
    if errors.is_empty() {
        return (root, Vec::new());
    }
    let ends: Vec<usize> = text.match_indices('\n').map(|(end, _)| end).collect();
    let mut lines = BTreeSet::new();
    let mut problems = Vec::new();
    for error in errors {
        let span = error.span().unwrap_or(0..0);
        // One slip often gives several messages about its line; the first says what it is.
        if lines.len() < MOST_LINES && lines.insert(ends.partition_point(|end| *end < span.start)) {
            problems.push(Problem { fault: Fault::Syntax { message: error.message().to_owned() }, span });
        }
    }
    (root, problems)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_that_is_wrong_is_told_once() {
        let (_, problems) = tree("a = [,,,,]\nb = 1\nc = = 2\n");
        let starts: Vec<usize> = problems.iter().map(|problem| problem.span.start).collect();
        assert_eq!(starts, [5, 21]);
    }

    #[test]
    fn a_text_of_nothing_but_slips_is_answered_by_its_first_lines() {
        let (_, problems) = tree(&"= 1\n".repeat(2 * MOST_LINES));
        assert_eq!(problems.len(), MOST_LINES);
        let (_, problems) = tree(&format!("a = [{}", ",".repeat(TOLD_WHOLE)));
        assert_eq!(problems.iter().map(|problem| problem.span.start).collect::<Vec<_>>(), [5]);
    }
}
