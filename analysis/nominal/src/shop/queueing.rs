//! Which machines take ready jobs one by one, in the order in which they came.

use toolroom_scenario::{
    ArrivalPattern, Assignment, DispatchRule, Distribution, Operation, Preemption, ReleaseRule, Scenario,
};

/// Why waits before a machine are not replicated from the times at which jobs were ready; `None` where they are.
pub fn queueing(scenario: &Scenario, machine: usize) -> Option<&'static str> {
    let kind = &scenario.machines[machine];
    let rules = kind.rules.as_ref().unwrap_or(&scenario.dispatch);
    let at_machine = |own: &&Operation| own.machines.contains(&machine);
    let operations: Vec<&Operation> =
        scenario.parts.iter().flat_map(|part| &part.operations).filter(at_machine).collect();
    let several = |quantity: &Distribution| !matches!(quantity, Distribution::Constant(pieces) if *pieces <= 1.0);
    let fixed = |part: usize, operation: usize| {
        scenario
            .shared
            .fixtures
            .iter()
            .flat_map(|fixture| &fixture.holds)
            .any(|hold| hold.part == part && (hold.from..=hold.until).contains(&operation))
    };
    let needs_fixture = scenario.parts.iter().enumerate().any(|(part, own)| {
        own.operations.iter().enumerate().any(|(index, own)| own.machines.contains(&machine) && fixed(part, index))
    });
    let needs_people =
        |own: &&Operation| [own.attendance.setup, own.attendance.load, own.attendance.run].iter().any(Option::is_some);
    let needs_crib = |own: &&Operation| own.tool.is_some_and(|tool| scenario.shared.crib_of(tool).is_some());
    let moved =
        !scenario.transports.is_empty() || !matches!(scenario.move_time, Distribution::Constant(time) if time <= 0.0);
    let held_back = !scenario.control.loops.is_empty()
        || scenario.control.release != ReleaseRule::Immediate
        || scenario.arrivals.iter().any(|own| matches!(own.pattern, ArrivalPattern::ConstantWork { .. }));
    let reasons = [
        (rules.first() != Some(&DispatchRule::Fifo), "it does not take the first that came"),
        (scenario.preemption != Preemption::None, "urgent jobs interrupt others"),
        (scenario.control.assign == Assignment::AtArrival, "jobs join its queue before it is free"),
        (kind.batch.is_some(), "it takes several jobs at a time"),
        (!scenario.buffers.is_empty(), "places are limited"),
        (moved, "jobs are on their way to it"),
        (operations.iter().any(needs_people), "it waits for people"),
        (needs_fixture, "it waits for fixtures"),
        (operations.iter().any(needs_crib), "it waits for tools"),
        (operations.iter().any(|own| own.assembles), "it waits for components"),
        (held_back, "jobs come when others have left"),
        (
            scenario.arrivals.iter().any(|own| several(&own.quantity))
                || scenario.orders.iter().any(|own| own.quantity > 1),
            "jobs have several pieces",
        ),
        (
            operations.windows(2).any(|pair| sorted(&pair[0].machines) != sorted(&pair[1].machines)),
            "its jobs may go to different machines",
        ),
        (operations.iter().any(|own| !own.time_on.is_empty()), "its times differ from those of other machines"),
    ];
    reasons.into_iter().find(|(holds, _)| *holds).map(|(_, reason)| reason)
}

fn sorted(machines: &[usize]) -> Vec<usize> {
    let mut machines = machines.to_vec();
    machines.sort_unstable();
    machines
}
