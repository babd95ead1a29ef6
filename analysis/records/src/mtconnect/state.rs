//! What a machine does at each instant of a session.

use super::keys::Role;
use super::session::Session;

/// Word for a machine of which nothing is known.
pub const UNAVAILABLE: &str = "UNAVAILABLE";

/// A machine from one instant to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineState {
    /// When it became so, s.
    pub time: f64,
    /// Execution state as the adapter words it, [`UNAVAILABLE`] where it is not known.
    pub execution: String,
    /// Program; empty where not known.
    pub program: String,
    /// Tool in the spindle; empty where none is known.
    pub tool: String,
    /// Block of the program.
    pub block: f64,
    /// Feed override, 1 as programmed.
    pub feed_override: f64,
    /// Rapid override, 1 as programmed.
    pub rapid_override: f64,
    /// Spindle override, 1 as programmed.
    pub spindle_override: f64,
    /// Parts made.
    pub part_count: f64,
}

impl MachineState {
    fn unknown(time: f64) -> Self {
        Self {
            time,
            execution: UNAVAILABLE.to_owned(),
            program: String::new(),
            tool: String::new(),
            block: f64::NAN,
            feed_override: f64::NAN,
            rapid_override: f64::NAN,
            spindle_override: f64::NAN,
            part_count: f64::NAN,
        }
    }
}

/// States of a session, one whenever anything with a role changes. After the last entry nothing
/// is known: the last state is [`UNAVAILABLE`].
pub fn states(session: &Session) -> Vec<MachineState> {
    let role_of = |key: &str| session.keys.iter().find(|(_, name)| *name == key).map(|(role, _)| *role);
    let (start, end) = session.span();
    let mut now = MachineState::unknown(start);
    let mut execution: Option<String> = None;
    let mut available = true;
    let mut list: Vec<MachineState> = Vec::new();
    for entry in &session.entries {
        let Some(role) = role_of(&entry.key) else { continue };
        let value = entry.value.as_deref();
        let number = value.and_then(|value| value.parse::<f64>().ok()).filter(|number| number.is_finite());
        let number = number.unwrap_or(f64::NAN);
        let before = now.clone();
        match role {
            Role::Availability => available = value.is_some_and(|value| value.eq_ignore_ascii_case("available")),
            Role::Execution => execution = value.filter(|value| !value.is_empty()).map(str::to_ascii_uppercase),
            Role::Program => now.program = value.unwrap_or_default().to_owned(),
            // Controllers name no tool while the changer moves: the last one is still counted.
            Role::Tool => now.tool = tool(value.unwrap_or_default()).unwrap_or(now.tool),
            Role::Block => now.block = number,
            Role::FeedOverride => now.feed_override = number / 100.0,
            Role::RapidOverride => now.rapid_override = number / 100.0,
            Role::SpindleOverride => now.spindle_override = number / 100.0,
            Role::PartCount => now.part_count = number,
            // The feed changes all the time: runs keep it beside their states.
            Role::Feed => continue,
        }
        now.execution = execution.clone().filter(|_| available).unwrap_or_else(|| UNAVAILABLE.to_owned());
        now.time = entry.time;
        if !same(&before, &now) || list.is_empty() {
            match list.last_mut() {
                Some(last) if last.time == now.time => *last = now.clone(),
                _ => list.push(now.clone()),
            }
        }
    }
    if !list.is_empty() {
        list.push(MachineState { time: end, ..MachineState::unknown(end) });
    }
    list
}

/// A tool as a name: `3.000000` is tool 3; 0 and nothing are no tool.
fn tool(value: &str) -> Option<String> {
    match value.parse::<f64>() {
        Ok(0.0) => None,
        Ok(number) if number.fract() == 0.0 && number.abs() < 1e15 => Some(format!("{number:.0}")),
        _ => (!value.is_empty()).then(|| value.to_owned()),
    }
}

/// Whether nothing but the time differs.
fn same(a: &MachineState, b: &MachineState) -> bool {
    let numbers = |s: &MachineState| {
        [s.block, s.feed_override, s.rapid_override, s.spindle_override, s.part_count].map(f64::to_bits)
    };
    (&a.execution, &a.program, &a.tool) == (&b.execution, &b.program, &b.tool) && numbers(a) == numbers(b)
}

#[cfg(test)]
mod tests {
    use super::super::{parse_shdr, sessions};
    use super::*;

    fn of(text: &str) -> Vec<MachineState> {
        states(&sessions("m", &parse_shdr(text), &[])[0])
    }

    #[test]
    fn what_is_not_known_is_a_state_of_its_own() {
        let list =
            of("1|exec|READY|tool|0\n2|exec|ACTIVE|tool|3.0\n3|avail|UNAVAILABLE\n4|avail|AVAILABLE|tool|0\n5|x|1\n");
        let words: Vec<(f64, &str, &str)> =
            list.iter().map(|state| (state.time, state.execution.as_str(), state.tool.as_str())).collect();
        let expected = [
            (1.0, "READY", ""),
            (2.0, "ACTIVE", "3"),
            (3.0, UNAVAILABLE, "3"),
            (4.0, "ACTIVE", "3"),
            (5.0, UNAVAILABLE, ""),
        ];
        assert_eq!(words, expected);
    }

    #[test]
    fn overrides_are_shares_and_unreadable_ones_missing() {
        let list = of("1|exec|ACTIVE|Fovr|80\n2|Fovr|high\n");
        assert_eq!(list[0].feed_override, 0.8);
        assert!(list[1].feed_override.is_nan());
    }
}
