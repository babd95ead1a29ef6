//! Whether enough was measured for any answer at all.

use super::Forward;
use std::collections::{BTreeMap, BTreeSet};

/// Fewest groups to fit, and fewest values that one channel has in them (assumptions). From one group
/// nothing is known of the scatter between groups, and the noise of a channel is read off its values.
const GROUPS: usize = 2;
const VALUES: usize = 8;

/// Why the parts of a process are too little for any answer; `None` where they suffice.
pub(super) fn too_little(parts: &[Box<dyn Forward>]) -> Option<String> {
    let mut groups: BTreeSet<&str> = BTreeSet::new();
    let mut values: BTreeMap<&str, usize> = BTreeMap::new();
    for part in parts {
        let measured = &part.frame().measured;
        for group in measured.fitted_groups() {
            groups.insert(&measured.groups[group]);
            for observation in &measured.observations[measured.spans[group].clone()] {
                *values.entry(measured.channels[observation.channel].name).or_default() += 1;
            }
        }
    }
    let most = values.iter().max_by_key(|(_, count)| **count);
    match most {
        None => Some("no row has a value that the model predicts".to_owned()),
        Some((channel, count)) if *count < VALUES => {
            Some(format!("{channel} has {count} values, no channel more; {VALUES} of one channel are needed"))
        }
        Some(_) if groups.len() < GROUPS => {
            Some(format!("{} group of rows was measured; {GROUPS} are needed", groups.len()))
        }
        Some(_) => None,
    }
}
