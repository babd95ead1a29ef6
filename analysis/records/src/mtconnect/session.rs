//! Stretches of a log in which time runs forward.

use super::keys::{Role, roles};
use super::shdr::{Entry, Lines};
use std::collections::BTreeMap;

/// Disorder of time stamps that threads of one adapter cause, s (assumption); more than that is
/// another connection of the adapter.
const JITTER: f64 = 1.0;

/// What one connection of an adapter sent, in the order of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    /// Machine.
    pub machine: String,
    /// First line of the log.
    pub line: usize,
    /// Values in the order of time.
    pub entries: Vec<Entry>,
    /// Which key each role is read from.
    pub keys: BTreeMap<Role, String>,
    /// Entries that were put into order.
    pub disordered: usize,
}

impl Session {
    /// First and last time, s.
    pub fn span(&self) -> (f64, f64) {
        let time = |entry: Option<&Entry>| entry.map_or(f64::NAN, |entry| entry.time);
        (time(self.entries.first()), time(self.entries.last()))
    }

    /// Keys that have no role here.
    pub fn unused(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self.entries.iter().map(|entry| entry.key.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        names.retain(|name| self.keys.values().all(|key| key != name));
        names
    }
}

/// Cuts a log where time goes back and where the adapter connects anew: it sends only what changes,
/// so that the same availability again, after a while, begins what it sends first. `chosen` says which key a role is read from where the usual
/// names do not.
pub fn sessions(machine: &str, lines: &Lines, chosen: &[(Role, String)]) -> Vec<Session> {
    let mut parts: Vec<Vec<Entry>> = Vec::new();
    let mut latest = f64::NEG_INFINITY;
    let mut available: Option<&Entry> = None;
    for entry in &lines.entries {
        let tells = roles(&entry.key).any(|(role, _)| role == Role::Availability);
        let same = available.is_some_and(|before| before.key == entry.key && before.value == entry.value);
        let anew = tells && same && entry.time > latest + JITTER;
        if tells {
            available = Some(entry);
        }
        match parts.last_mut() {
            Some(part) if entry.time >= latest - JITTER && !anew => part.push(entry.clone()),
            _ => {
                parts.push(vec![entry.clone()]);
                latest = entry.time;
            }
        }
        latest = latest.max(entry.time);
    }
    parts.into_iter().map(|entries| session(machine, entries, chosen)).collect()
}

fn session(machine: &str, mut entries: Vec<Entry>, chosen: &[(Role, String)]) -> Session {
    let line = entries.first().map_or(1, |entry| entry.line);
    let disordered = entries.windows(2).filter(|pair| pair[1].time < pair[0].time).count();
    entries.sort_by(|a, b| a.time.total_cmp(&b.time));
    let mut ranks: BTreeMap<Role, (usize, &str)> = BTreeMap::new();
    for entry in &entries {
        for (role, rank) in roles(&entry.key) {
            let best = ranks.entry(role).or_insert((rank, &entry.key));
            if (rank, entry.key.as_str()) < *best {
                *best = (rank, &entry.key);
            }
        }
    }
    let mut keys: BTreeMap<Role, String> = ranks.into_iter().map(|(role, (_, key))| (role, key.to_owned())).collect();
    keys.extend(chosen.iter().cloned());
    Session { machine: machine.to_owned(), line, entries, keys, disordered }
}

#[cfg(test)]
mod tests {
    use super::super::parse_shdr;
    use super::*;

    #[test]
    fn time_that_goes_back_begins_another_session() {
        let lines = parse_shdr("10|exec|READY\n11|a|1\n10.5|a|2\n12|exec|ACTIVE\n3|exec|READY\n4|exec|ACTIVE\n");
        let sessions = sessions("m", &lines, &[]);
        assert_eq!(sessions.iter().map(Session::span).collect::<Vec<_>>(), [(10.0, 12.0), (3.0, 4.0)]);
        assert_eq!((sessions[0].disordered, sessions[1].line), (1, 5));
        assert_eq!(sessions[0].unused(), ["a"]);
    }

    #[test]
    fn an_adapter_that_connects_anew_begins_another_session() {
        let lines = parse_shdr("1|avail|AVAILABLE|a|1\n2|a|2\n900|avail|AVAILABLE|a|3\n901|avail|UNAVAILABLE\n");
        assert_eq!(
            sessions("m", &lines, &[]).iter().map(Session::span).collect::<Vec<_>>(),
            [(1.0, 2.0), (900.0, 901.0)]
        );
    }

    #[test]
    fn a_role_may_be_read_from_a_chosen_key() {
        let lines = parse_shdr("1|exec|READY|MyTool|7\n");
        let found = sessions("m", &lines, &[(Role::Tool, "MyTool".to_owned())]);
        assert_eq!(found[0].keys[&Role::Tool], "MyTool");
    }
}
