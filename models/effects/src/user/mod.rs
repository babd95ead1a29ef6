//! Effects that users define in files, beside those of the catalogue.
//!
//! ```text
//! [[effect]] ─expression─► tree ─dimension, neutral─► checked ─program─► stack program, over f64 and dual numbers
//! ```

mod change;
mod definition;
mod dimension;
mod expression;
mod file;
mod neutral;
mod program;
mod slots;

pub use definition::Definition;
pub use expression::FormulaError;
pub use file::{CODES, EFFECTS_FILE, USER_EFFECT, parse_definitions, read_definitions, read_effects_file};

use crate::{Context, Terms};
use change::Change;
use neutral::Point;
use program::SHAPES;
use slots::{Quantity, Term};
use toolroom_process::{AnyRecord, EffectValue, Field, Number};

/// An effect that a user has defined, with its strength and the numbers of its shape.
#[derive(Clone, Copy, Debug)]
pub struct UserEffect<N: Copy = f64> {
    pub(crate) size: N,
    shape: [N; SHAPES],
    definition: &'static Definition,
}

impl<N: Copy + PartialEq> PartialEq for UserEffect<N> {
    fn eq(&self, other: &Self) -> bool {
        self.definition == other.definition && self.size == other.size && self.shape == other.shape
    }
}

impl UserEffect {
    /// The effect at size zero, in the shape of its definition.
    pub fn new(definition: &'static Definition) -> Self {
        let shape = |i: usize| definition.fields.get(i + 1).map_or(0.0, |field| field.start);
        Self { size: 0.0, shape: std::array::from_fn(shape), definition }
    }
}

impl<N: Copy> UserEffect<N> {
    /// What the user has written.
    pub fn definition(&self) -> &'static Definition {
        self.definition
    }

    pub(crate) fn map<M: Copy>(&self, mut convert: impl FnMut(N) -> M) -> UserEffect<M> {
        UserEffect { size: convert(self.size), shape: self.shape.map(convert), definition: self.definition }
    }
}

impl<N: Number> UserEffect<N> {
    pub(crate) fn act(&self, context: &Context<N>, terms: &mut Terms<N>) {
        for change in &self.definition.changes {
            let value = change.program.value(self.size, &self.shape, context);
            let before = change.term.of(terms);
            let after = if change.term.is_factor() { before * value } else { before + value };
            *change.term.of_mut(terms) = after;
            let [least, greatest] = change.range;
            let within = |value: N| value.re() >= least && value.re() <= greatest;
            if !within(value) {
                self.refuse(change, value, context);
            } else if within(before) && !within(after) {
                // Effects that act on one term may leave its range together.
                self.refuse(change, after, context);
            }
        }
    }

    /// Refuses the value of a term. What follows from a context that holds no numbers is no fault of the effect.
    #[cold]
    fn refuse(&self, change: &Change, value: N, context: &Context<N>) {
        let (size, shape, context) = (self.size.re(), self.shape.map(|own| own.re()), context.map(|own| own.re()));
        let (point, fields) = (Point { size, shape, context }, self.definition.fields);
        if !point.is_finite(change, fields) {
            return;
        }
        toolroom_process::refuse(|| {
            let term = change.term.field();
            let [value, min, max] = [value.re(), term.min, term.max].map(|value| term.to_display(value));
            let context = point.words(change, fields);
            let effect = self.definition.entry().id;
            Box::new(EffectValue { effect, term: term.name, value, min, max, unit: term.display, context }).into()
        });
    }
}

impl AnyRecord for UserEffect {
    fn fields(&self) -> &'static [Field] {
        self.definition.fields
    }

    fn value(&self, i: usize) -> Option<f64> {
        match i {
            _ if i >= self.definition.fields.len() => None,
            0 => Some(self.size),
            i => Some(self.shape[i - 1]),
        }
    }

    fn set_value(&mut self, i: usize, value: f64) -> Option<()> {
        match i {
            _ if i >= self.definition.fields.len() => return None,
            0 => self.size = value,
            i => self.shape[i - 1] = value,
        }
        Some(())
    }
}

/// A quantity or a term that formulas may name, for people.
#[derive(Clone, Copy, Debug)]
pub struct Named {
    /// Name, unit and meaning.
    pub field: &'static Field,
    /// Processes that fill the quantity, or whose equations read the term.
    pub processes: [Option<&'static str>; 3],
    /// `None` of a quantity; whether the term is multiplied (true) or added to.
    pub factor: Option<bool>,
}

/// Quantities that formulas may read, then terms that they may change.
pub fn vocabulary() -> impl Iterator<Item = Named> {
    const ALL: [&str; 3] = ["turning", "milling", "infeed"];
    let quantity = |own: &Quantity| Named {
        field: own.field(),
        processes: ALL.map(|process| own.filled_by().contains(&process).then_some(process)),
        factor: None,
    };
    let term = |own: &Term| Named {
        field: own.field(),
        processes: ALL.map(|process| own.is_read_by(process).then_some(process)),
        factor: Some(own.is_factor()),
    };
    Quantity::ALL.iter().map(quantity).chain(Term::ALL.iter().map(term))
}
