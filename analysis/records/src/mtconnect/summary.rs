//! What was read of a log, in words.

use super::keys::Role;
use super::session::Session;
use super::shdr::{Lines, Passed};
use std::collections::BTreeMap;

/// What was read of the log `name`, and what was passed over and why, for people.
pub fn summary(name: &str, lines: &Lines, sessions: &[Session]) -> String {
    let mut text =
        format!("{name}: {} lines, {} values, {} sessions", lines.count, lines.entries.len(), sessions.len());
    let mut passed: BTreeMap<Passed, (usize, usize)> = BTreeMap::new();
    for (line, why) in &lines.finished_lines {
        passed.entry(*why).or_insert((0, *line)).0 += 1;
    }
    for (why, (count, first)) in passed {
        text += &format!("\n  {count} lines: {} (first: line {first})", why.reason());
    }
    let mut keys: BTreeMap<Role, &str> = BTreeMap::new();
    let mut unused: Vec<&str> = Vec::new();
    for session in sessions {
        keys.extend(session.keys.iter().map(|(role, key)| (*role, key.as_str())));
        unused.extend(session.unused());
        let (start, end) = session.span();
        let order = if session.disordered > 0 {
            format!(", {} values put into order", session.disordered)
        } else {
            String::new()
        };
        text += &format!(
            "\n  session from line {}: {:.1} s, {} values{order}",
            session.line,
            end - start,
            session.entries.len()
        );
    }
    let word = |role: &Role| Role::ALL.iter().find(|(each, _)| each == role).map_or("", |(_, name)| name);
    let pairs: Vec<String> = keys.iter().map(|(role, key)| format!("{} = {key}", word(role))).collect();
    text += &format!("\n  {}", pairs.join(", "));
    unused.sort_unstable();
    unused.dedup();
    if !unused.is_empty() {
        text += &format!("\n  not used: {}", unused.join(", "));
    }
    text
}
