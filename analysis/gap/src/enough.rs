//! Whether enough was measured for any answer at all.

use super::constants::{FEWEST_FITTED, FEWEST_VALUES};
use super::{ChannelId, Forward};
use std::collections::{BTreeMap, BTreeSet};

/// Why the parts of a process are too little for any answer; `None` where they suffice.
pub(super) fn too_little(parts: &[Box<dyn Forward>]) -> Option<String> {
    let mut groups: BTreeSet<&str> = BTreeSet::new();
    let mut values: BTreeMap<ChannelId, usize> = BTreeMap::new();
    for part in parts {
        let measured = &part.frame().measured;
        for group in measured.fitted_groups() {
            groups.insert(&measured.groups[group]);
            for observation in &measured.observations[measured.spans[group].clone()] {
                *values.entry(measured.channels[observation.channel].id).or_default() += 1;
            }
        }
    }
    let most = values.iter().max_by_key(|(_, count)| **count);
    match most {
        None => Some("no row has a value that the model predicts".to_owned()),
        Some((channel, count)) if *count < FEWEST_VALUES => {
            Some(format!("{channel} has {count} values, no channel more; {FEWEST_VALUES} of one channel are needed"))
        }
        Some(_) if groups.len() < FEWEST_FITTED => {
            Some(format!("{} group of rows was measured; {FEWEST_FITTED} are needed", groups.len()))
        }
        Some(_) => None,
    }
}
