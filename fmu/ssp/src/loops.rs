//! Algebraic loops: signals that determine each other at one instant.
//!
//! Only a unit knows which of its outputs follow which inputs at once; its description tells (`dependencies` of
//! `ModelStructure`), and where it does not, an output may follow them all.

use crate::structure::SystemStructure;
use std::collections::VecDeque;
use toolroom_fmu_import::ModelDescription;

/// A loop of signals.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Loop {
    /// The way round, from connector to connector.
    pub signals: String,
    /// Units on the way that do not tell what their outputs depend on: without them it may be none.
    pub undeclared: Vec<String>,
}

impl std::fmt::Display for Loop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "an algebraic loop, settled before the first step and a step late after it: {}", self.signals)?;
        if self.undeclared.is_empty() {
            return Ok(());
        }
        write!(f, " ({}: what an output depends on is not declared, so it may be none)", self.undeclared.join(", "))
    }
}

/// Whether the output `output` of a unit may follow its input `input` at once.
fn follows(unit: &ModelDescription, output: &str, input: &str) -> bool {
    let place = |name: &str| unit.variables.iter().position(|variable| variable.name == name);
    let Some(from) = place(output) else { return false };
    let dependencies = dependencies(unit, from);
    dependencies.is_none_or(|knowns| place(input).is_some_and(|input| knowns.contains(&input)))
}

/// What an output is said to depend on; `None` where nothing is said.
fn dependencies(unit: &ModelDescription, output: usize) -> Option<&[usize]> {
    unit.structure.outputs.iter().find(|unknown| unknown.variable == output)?.dependencies.as_deref()
}

/// The shortest loop of each group of signals that hang together.
pub(crate) fn loops(structure: &SystemStructure, units: &[&ModelDescription]) -> Vec<Loop> {
    let signals = &structure.connections;
    let leads = |one: usize, other: usize| {
        let (to, from) = (&signals[one].to, &signals[other].from);
        to.component == from.component && follows(units[to.component], &from.connector, &to.connector)
    };
    let after: Vec<Vec<usize>> =
        (0..signals.len()).map(|one| (0..signals.len()).filter(|other| leads(one, *other)).collect()).collect();
    // From one signal to every one that it leads to, with the one before it on a shortest way.
    let reached = |first: usize| {
        let mut before: Vec<Option<usize>> = vec![None; signals.len()];
        let mut open = VecDeque::from([first]);
        while let Some(at) = open.pop_front() {
            for &next in &after[at] {
                if before[next].is_none() {
                    before[next] = Some(at);
                    open.push_back(next);
                }
            }
        }
        before
    };
    let all: Vec<Vec<Option<usize>>> = (0..signals.len()).map(reached).collect();
    let mut told = vec![false; signals.len()];
    let mut found = Vec::new();
    for first in 0..signals.len() {
        if told[first] || all[first][first].is_none() {
            continue;
        }
        // Signals that lead to each other make one group.
        (0..signals.len()).filter(|other| all[first][*other].is_some()).for_each(|other| {
            told[other] |= all[other][first].is_some();
        });
        let mut way = vec![first];
        while let Some(before) = all[first][way[way.len() - 1]] {
            way.push(before);
            if before == first {
                break;
            }
        }
        way.reverse();
        let named = |signal: &usize| {
            let signal = &signals[*signal];
            format!("{} -> {}", structure.named(&signal.from), structure.named(&signal.to))
        };
        let silent = way.windows(2).filter_map(|pair| {
            let from = &signals[pair[1]].from;
            let unit = units[from.component];
            let output = unit.variables.iter().position(|variable| variable.name == from.connector)?;
            dependencies(unit, output).is_none().then(|| structure.components[from.component].name.clone())
        });
        let mut undeclared: Vec<String> = silent.collect();
        undeclared.dedup();
        found.push(Loop { signals: way[..way.len() - 1].iter().map(named).collect::<Vec<_>>().join(", "), undeclared });
    }
    found
}
