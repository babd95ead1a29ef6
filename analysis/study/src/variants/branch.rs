//! A shop that is changed while it runs: the shop as it is until an instant, and a variant of it from then on.

use toolroom_scenario::{
    Blocking, Branch, Hours, Interruption, Joined, Order, Paces, Scenario, ShiftCalendar, Urgency, WorkingTime, date,
};

/// Why a shop cannot be changed into another one while it runs.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub struct NoBranch {
    reason: String,
}

/// What a running shop can take.
pub const POSSIBLE: &str = "a shop that runs can take other rules (`dispatch.rule`, `dispatch.machine_choice`, `rule` of a machine), more \
     machines and people (`count`), other calendars, other priorities, weights and due dates of orders, and orders that are \
     released later";

/// The shop `previous` that becomes the shop `changed` at `at`, s. `changes` are what made one of the other.
///
/// # Errors
/// [`NoBranch`], in words: what a running shop cannot take.
pub fn branched(previous: &Scenario, changed: &Scenario, at: f64, changes: &[String]) -> Result<Scenario, NoBranch> {
    let refuse = |reason: String| Err(NoBranch { reason });
    let wrong: Vec<_> =
        changes.iter().filter(|change| !is_possible(change)).map(|change| format!("`{change}`")).collect();
    if !wrong.is_empty() {
        return refuse(format!("{} cannot change while the shop runs", wrong.join(", ")));
    }
    if previous.dispatch != changed.dispatch && previous.control.loops.iter().any(|own| own.rules.is_empty()) {
        return refuse(
            "`dispatch.rule` cannot change where backlogs of [[loop]] go by it; give them a `rule`".to_owned(),
        );
    }
    let mut world = changed.clone();
    let (mut rules, mut calendars) = (Vec::new(), changed.calendars.clone());
    for (index, machine) in changed.machines.iter().enumerate() {
        let place = previous.machines.iter().position(|own| own.name == machine.name);
        if place.is_none() && changed.blocking == Blocking::BeforeService {
            return refuse(format!("machine \"{}\" cannot come with blocking before service", machine.name));
        }
        rules.push(place.map_or_else(|| changed.rules(index), |place| previous.rules(place)).to_vec());
        let earlier = match place {
            None => (Hours::Never, Paces::default()),
            Some(place) => hours(previous, previous.machines[place].calendar),
        };
        world.machines[index].calendar = join(&mut calendars, changed, machine.calendar, (at, earlier));
    }
    for (index, operator) in changed.operators.iter().enumerate() {
        let place = previous.operators.iter().position(|own| own.name == operator.name);
        let never = (Hours::Never, Paces::default());
        let earlier = place.map_or(never, |place| hours(previous, previous.operators[place].calendar));
        world.operators[index].calendar = join(&mut calendars, changed, operator.calendar, (at, earlier));
    }
    let gone = previous
        .machines
        .iter()
        .map(|own| &own.name)
        .find(|name| changed.machines.iter().all(|own| own.name != **name));
    let left = || {
        previous
            .operators
            .iter()
            .map(|own| &own.name)
            .find(|name| changed.operators.iter().all(|own| own.name != **name))
    };
    if let Some(name) = gone.or_else(left) {
        let several = format!("{name}1");
        let names =
            || changed.machines.iter().map(|own| &own.name).chain(changed.operators.iter().map(|own| &own.name));
        if names().any(|own| *own == several) {
            return refuse(format!(
                "\"{name}\" has no `count` and cannot become several while the shop runs; write count = 1 for it, which calls it \
                 \"{several}\" from the start"
            ));
        }
        return refuse(format!("\"{name}\" cannot go while the shop runs; give it a calendar that ends"));
    }
    world.calendars = calendars;
    let orders = urgencies(previous, changed, at).map_err(|reason| NoBranch { reason })?;
    world.branch = Some(Branch { at, rules, machine_choice: previous.machine_choice, orders });
    Ok(world)
}

/// Whether a running shop can take a change, `path=value`.
fn is_possible(change: &str) -> bool {
    let path = change.split('=').next().unwrap_or_default().trim();
    let (head, key) = (path.split('.').next().unwrap_or_default(), path.rsplit('.').next().unwrap_or_default());
    match head {
        "dispatch" => ["rule", "machine_choice"].contains(&key),
        "machine" => ["count", "calendar", "rule"].contains(&key),
        "operator" => ["count", "calendar"].contains(&key),
        "order" | "calendar" | "tables" => true,
        _ => false,
    }
}

/// When somebody works by a calendar, and how fast work goes.
fn hours(scenario: &Scenario, calendar: Option<usize>) -> (Hours, Paces) {
    let of = |calendar: usize| &scenario.calendars[calendar];
    calendar.map_or((Hours::Always, Paces::default()), |calendar| {
        (Hours::Shifts(of(calendar).time.clone()), of(calendar).paces.clone())
    })
}

/// The calendar that is the one of `changed` from `at` on and `earlier` before, by index; it is added where that makes a
/// difference.
fn join(
    calendars: &mut Vec<ShiftCalendar>,
    changed: &Scenario,
    calendar: Option<usize>,
    (at, earlier): (f64, (Hours, Paces)),
) -> Option<usize> {
    let later = hours(changed, calendar);
    if earlier == later {
        return calendar;
    }
    let ((before, before_pace), (later, later_pace)) = (earlier, later);
    let usual = calendar.map(|calendar| &changed.calendars[calendar]);
    let name = format!("{} from {at} s", usual.map_or("always", |calendar| calendar.name.as_str()));
    calendars.push(ShiftCalendar {
        name,
        time: WorkingTime::Joined(Box::new(Joined { junction: at, before, after: later })),
        at_end: usual.map_or(Interruption::Resume, |calendar| calendar.at_end),
        finish_within: usual.map_or(0.0, |calendar| calendar.finish_within),
        start_only_if_fits: usual.is_some_and(|calendar| calendar.start_only_if_fits),
        paces: before_pace.joined(at, &later_pace),
    });
    Some(calendars.len() - 1)
}

/// Orders as they were before; what is in the shop stays what it is.
fn urgencies(previous: &Scenario, changed: &Scenario, at: f64) -> Result<Vec<Urgency>, String> {
    let when =
        |time: f64| changed.start.map_or_else(|| format!("{} h", time / 3600.0), |start| date::show(start + time));
    let known = |order: &Order| previous.orders.iter().find(|own| own.id == order.id);
    let fixed = |order: &Order| Order { priority: 0, weight: 0.0, due: 0.0, customer: String::new(), ..order.clone() };
    for order in &changed.orders {
        match known(order) {
            Some(own) if own.release <= at && fixed(own) != fixed(order) => {
                return Err(format!(
                    "order \"{}\" is in the shop since {} and cannot change",
                    order.id,
                    when(own.release)
                ));
            }
            Some(_) => {}
            None if order.release < at => {
                let (release, branch_time) = (when(order.release), when(at));
                return Err(format!("order \"{}\" is new, but released at {release}, before {branch_time}", order.id));
            }
            None => {}
        }
        if known(order).is_some_and(|own| own.release > at) && order.release < at {
            return Err(format!("order \"{}\" cannot be released before the change", order.id));
        }
    }
    let missing =
        previous.orders.iter().find(|own| own.release <= at && changed.orders.iter().all(|order| order.id != own.id));
    if let Some(order) = missing {
        return Err(format!("order \"{}\" is in the shop since {} and cannot go", order.id, when(order.release)));
    }
    Ok(changed.orders.iter().map(|order| known(order).unwrap_or(order).urgency()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use toolroom_scenario_file::{parse, read};
    use toolroom_shop::runlog::RunLog;

    /// One machine with four orders of 40, 30, 20 and 10 minutes, all there from the start, and one that comes.
    const SHOP: &str = r#"
schema = 1
[shop]
name = "branch"
horizon = "10 h"
[[calendar]]
name = "short"
shift = [{ start = "0 h", end = "1 h" }]
[[machine]]
name = "A"
count = 1
process = "plain"
[[part]]
name = "plate"
operation = [{ name = "saw", machines = "A", work = "1 min" }]
"#;

    fn shop(changes: &[&str]) -> Scenario {
        let order = |(id, pieces): (&str, u32)| {
            format!("[[order]]\nid = \"{id}\"\npart = \"plate\"\nquantity = {pieces}\ndue = \"8 h\"\npriority = 5\n")
        };
        let orders: String = [("a", 40), ("b", 30), ("c", 20), ("d", 10)].map(order).concat();
        let text = format!("{SHOP}{orders}");
        let changes: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        parse("shop.toml", &text, &changes).unwrap_or_else(|error| panic!("{error}")).scenario
    }

    fn changed(at: f64, changes: &[&str]) -> Result<Scenario, NoBranch> {
        let all: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
        branched(&shop(&[]), &shop(changes), at * 60.0, &all)
    }

    /// When every order is finished, min.
    fn finishes(scenario: &Scenario) -> Vec<f64> {
        let log = toolroom_shop::run(scenario, 0, 0).expect("it runs");
        log.jobs.iter().map(|job| job.finish / 60.0).collect()
    }

    #[test]
    fn a_running_shop_takes_rules_machines_hours_and_urgencies() {
        assert_eq!(finishes(&shop(&[])), [40.0, 70.0, 90.0, 100.0]);
        assert_eq!(finishes(&shop(&["dispatch.rule=spt"])), [100.0, 60.0, 30.0, 10.0]);
        let at = |at: f64, changes: &[&str]| finishes(&changed(at, changes).expect("it can"));
        // The first order is in work: the shortest of the others goes next.
        assert_eq!(at(15.0, &["dispatch.rule=spt"]), [40.0, 100.0, 70.0, 50.0]);
        // What ends in the instant of the change is followed by the old rule.
        assert_eq!(at(40.0, &["dispatch.rule=spt"]), [40.0, 70.0, 100.0, 80.0]);
        assert_eq!(at(15.0, &["machine.A.count=2"]), [40.0, 45.0, 60.0, 55.0]);
        // The machine stops after the first hour of every day: nothing after 60 min is done.
        let rest = at(15.0, &["machine.A.calendar=short"]);
        assert_eq!((rest[0], rest[1]), (40.0, 70.0), "by `shift`, what is in the machine is finished");
        assert!(rest[2].is_nan() && rest[3].is_nan());
        let urgent = ["dispatch.rule=priority", "order.3.priority=1"];
        assert_eq!(at(15.0, &urgent), [40.0, 90.0, 60.0, 100.0]);
    }

    #[test]
    fn the_past_is_that_of_the_shop_as_it_is() {
        let before = |log: &RunLog, at: f64| -> String {
            let rows: Vec<_> = log.operations.iter().filter(|row| row.end <= at).collect();
            let events: Vec<_> =
                log.events.iter().filter(|row| row.time < at).map(|row| (row.time.to_bits(), row.event)).collect();
            format!("{rows:?}{events:?}")
        };
        for (file, at, changes) in [
            ("orders.toml", "34 h", vec!["dispatch.rule=edd", "machine.T1.rule=spt"]),
            ("operators.toml", "12 min", vec!["operator.setter.count=2"]),
            ("ft06.toml", "20 min", vec!["dispatch.rule=spt"]),
        ] {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/shop").join(file);
            let all: Vec<String> = changes.iter().map(|&change| change.to_owned()).collect();
            let at = toolroom_process::unit::quantity(at, "s").expect("a time");
            let (base, after) = (read(&path, &[]).unwrap().scenario, read(&path, &all).unwrap().scenario);
            let (same, other) = (branched(&base, &base, at, &[]).unwrap(), branched(&base, &after, at, &all).unwrap());
            let run = |scenario: &Scenario| toolroom_shop::run(scenario, 0, 0).expect("it runs");
            let (whole, again, changed) = (run(&base), run(&same), run(&other));
            assert_eq!(format!("{whole:?}"), format!("{again:?}"), "{file}: a branch without change is the same run");
            assert_eq!(before(&whole, at), before(&changed, at), "{file}");
        }
    }

    #[test]
    fn what_a_running_shop_cannot_take_is_told() {
        let told = |changes: &[&str]| changed(15.0, changes).expect_err("it cannot").to_string();
        assert!(told(&["part.plate.operation.saw.work=\"2 min\""]).contains("part.plate.operation.saw.work"));
        assert!(told(&["order.2.quantity=31"]).contains("order \"b\" is in the shop since 0 h"));
        let two = branched(&shop(&["machine.A.count=2"]), &shop(&[]), 900.0, &["machine.A.count=1".to_owned()]);
        assert!(two.expect_err("it cannot").to_string().contains("\"A2\" cannot go"));
    }
}
