//! Whether people are there when their machines are.

use crate::warning::Warning;
use toolroom_scenario::{Attendance, Operation, Scenario, ShiftCalendar};

/// Operations that no machine can ever do, because nobody with a skill that they need works while it does, until the
/// horizon.
pub(crate) fn absent(scenario: &Scenario) -> Vec<Warning> {
    let calendar = |index: Option<usize>| index.map(|index| &scenario.calendars[index]);
    let mut warnings = Vec::new();
    for part in &scenario.parts {
        for operation in &part.operations {
            let attendance = operation.attendance;
            let needed = [(attendance.setup, "setup"), (attendance.load, "load"), (attendance.run, "run")];
            for (skill, step) in needed.into_iter().filter_map(|(skill, step)| Some((skill?, step))) {
                let people = || scenario.operators.iter().filter(|operator| operator.skills.contains(&skill));
                let together = operation.machines.iter().any(|&machine| {
                    let machine = calendar(scenario.machines[machine].calendar);
                    people().any(|operator| meet(machine, calendar(operator.calendar), scenario.horizon))
                });
                if !together && people().next().is_some() {
                    let message = format!(
                        "operation \"{}\" of part \"{}\" is never done: nobody with the skill \"{}\" ({step}) works while one of its \
                         machines does",
                        operation.name, part.name, scenario.skills[skill]
                    );
                    warnings.push(Warning { code: "never-there", message });
                }
            }
        }
    }
    warnings
}

/// Machines and people that both have a rate: what a machine costs is often that of its operator, too.
pub(crate) fn paid_twice(scenario: &Scenario) -> Option<Warning> {
    let person = scenario.operators.iter().find(|person| person.rate > 0.0)?;
    let needs = |operation: &Operation, machine: usize| {
        let Attendance { setup, load, run, .. } = operation.attendance;
        operation.machines.contains(&machine) && (setup.is_some() || load.is_some() || run.is_some())
    };
    let attended =
        |machine: usize| scenario.parts.iter().flat_map(|part| &part.operations).any(|own| needs(own, machine));
    let (_, machine) = scenario.machines.iter().enumerate().find(|(index, own)| own.rate > 0.0 && attended(*index))?;
    let message = format!(
        "operators have a rate (\"{}\"), and so has machine \"{}\": its rate is then that of the machine alone, without its \
         operator",
        person.name, machine.name
    );
    Some(Warning { code: "rate-counted-twice", message })
}

/// Whether two calendars have working time in common before `horizon`; who has none always works.
fn meet(a: Option<&ShiftCalendar>, b: Option<&ShiftCalendar>, horizon: f64) -> bool {
    let (Some(a), Some(b)) = (a, b) else { return true };
    let mut now = 0.0;
    while now < horizon {
        if a.works_at(now) && b.works_at(now) {
            return true;
        }
        let next = [a, b].into_iter().filter_map(|calendar| calendar.next_boundary(now));
        now = next.map(|boundary| boundary.time).fold(f64::INFINITY, f64::min);
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_scenario_file::parse;

    #[test]
    fn people_who_come_when_their_machines_rest_are_told() {
        let shop = |hours: &str| {
            let text = format!(
                "schema = 1\n[shop]\nname = \"x\"\nstart = \"2026-03-30 00:00\"\nhorizon = \"1 week\"\n\
                 [[calendar]]\nname = \"early\"\nweek = {{ mon-fri = [\"06:00-14:00\"] }}\n\
                 [[calendar]]\nname = \"late\"\nweek = {{ mon-fri = [\"{hours}\"] }}\n\
                 [[operator]]\nname = \"setter\"\nskills = [\"setup\"]\ncalendar = \"late\"\n\
                 [[machine]]\nname = \"A\"\nprocess = \"plain\"\ncalendar = \"early\"\n\
                 [[part]]\nname = \"bar\"\noperation = [{{ name = \"saw\", machines = \"A\", work = \"5 min\", \
                 operator = {{ setup = \"setup\" }} }}]\n[[order]]\nid = \"1\"\npart = \"bar\"\n"
            );
            absent(&parse("x.toml", &text, &[]).unwrap_or_else(|error| panic!("{error}")).scenario)
        };
        let told = shop("14:00-22:00");
        assert_eq!((told.len(), told[0].code), (1, "never-there"));
        assert!(told[0].message.starts_with("operation \"saw\" of part \"bar\" is never done"), "{told:?}");
        assert!(shop("13:59-22:00").is_empty());
        assert!(shop("22:00-07:00").is_empty());
    }
}
