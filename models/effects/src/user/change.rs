//! One change of one term by an effect that a user has written.

use super::program::Program;
use super::slots::Term;

/// One change of one term.
#[derive(Debug)]
pub(crate) struct Change {
    pub term: Term,
    pub program: Program,
    /// Least and greatest value of the term, SI.
    pub range: [f64; 2],
    pub(super) slots: Vec<usize>,
}

impl Change {
    /// Places of the quantities that it names, among size, shape and context.
    pub fn slots(&self) -> &[usize] {
        &self.slots
    }
}
