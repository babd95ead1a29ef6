//! What the rules of a queue look at.

use super::job::Jobs;
use super::layout::Layout;
use super::machine::Machine;
use super::readiness::Readiness;
use rand::RngExt;
use toolroom_kernel::{Purpose, Streams};
use toolroom_queues::{Facts, Keys, Measures, Moment, Plan, QueueEntry, QueueKind, keys};
use toolroom_scenario::{DispatchRule, KeyOptions, NextQueue, Scenario, SlackBy};

/// How the queue of rules has to be kept.
pub(super) fn queue_kind(rules: &[DispatchRule], options: &KeyOptions) -> QueueKind {
    if !rules.iter().all(|rule| options.are_usual_for(*rule)) {
        QueueKind::Scan
    } else if rules.iter().all(|rule| *rule == DispatchRule::Fifo) {
        QueueKind::Line
    } else if rules.iter().all(|rule| rule.stands()) {
        QueueKind::Heap
    } else {
        Plan::of(rules).map_or(QueueKind::Scan, QueueKind::Kinetic)
    }
}

/// Whether a rule looks at the time of this and all later operations.
pub(super) fn looks_at_work_left(rule: DispatchRule) -> bool {
    matches!(
        rule,
        DispatchRule::ShortestRemaining
            | DispatchRule::LongestRemaining
            | DispatchRule::Slack
            | DispatchRule::SlackPerOperation
            | DispatchRule::CriticalRatio
            | DispatchRule::ModifiedDueDate
            | DispatchRule::TimeNextQueueAndSlack
            | DispatchRule::Atc
            | DispatchRule::AtcWithSetups
            | DispatchRule::Covert
    )
}

/// Whether a rule looks at when this operation is due.
pub(super) fn looks_at_operation_due(rule: DispatchRule, options: &KeyOptions) -> bool {
    let costs = matches!(rule, DispatchRule::Atc | DispatchRule::AtcWithSetups | DispatchRule::Covert);
    matches!(rule, DispatchRule::EarliestOperationDue | DispatchRule::ModifiedOperationDue)
        || costs && options.slack_by == SlackBy::Operation
}

/// What the rules of a machine look at of a job that comes to its queue; what no rule looks at is not worked out.
pub(super) fn facts(
    scenario: &Scenario,
    layout: &Layout,
    streams: &Streams,
    (jobs, slot): (&Jobs, u32),
    (machine, rules): (usize, &[DispatchRule]),
) -> Facts {
    let job = jobs.at(slot);
    let (part, index) = (job.row.part as usize, job.operation as usize);
    let plans = &layout.operations[part];
    let time = |operation: usize| layout.time(jobs, slot, part, operation);
    let (count, release, due) = (plans.len(), job.row.arrival, job.row.due);
    let options = &scenario.control.keys;
    let work_left = rules.iter().any(|rule| looks_at_work_left(*rule));
    let own_due = rules.iter().any(|rule| looks_at_operation_due(*rule, options));
    // Sums over a routing cost more than all the rest: only where a rule looks at them.
    let operation_due = |total: f64| {
        let until: f64 = job.operations_until(index).map(time).sum();
        let share = if total > 0.0 { until / total } else { 1.0 };
        release + (due - release) * share
    };
    let setup = plans[index].setup_time.unwrap_or(layout.machine_plans[machine].setup_time);
    let rank = || streams.open(job.entity.part(index as u64), Purpose::Policy).random();
    let next_index = job.next_operation(count);
    let next = plans.get(next_index);
    Facts {
        release,
        priority: f64::from(job.priority),
        weight: job.weight,
        due,
        operation_due: if own_due { operation_due((0..count).map(time).sum()) } else { due },
        time: time(index),
        work_left: if work_left { job.operations_left(count).map(time).sum() } else { 0.0 },
        operations_left: job.places_left(count).len() as f64,
        next_time: next.map_or(0.0, |_| time(next_index)),
        next_station: next.map(|plan| plan.station),
        setup_group: plans[index].setup_group,
        setup_time: setup,
        rank: if rules.contains(&DispatchRule::Random) { rank() } else { 0.0 },
    }
}

/// What the rules of a machine look at.
pub(super) struct Look<'a> {
    pub scenario: &'a Scenario,
    pub layout: &'a Layout,
    pub jobs: &'a Jobs,
    pub waiting_work: &'a [(u32, f64)],
    /// What is left of the work in the machines of every station, s; empty where it does not count.
    pub started: Vec<f64>,
    /// The machine that chooses, and for what it stands ready; `None` where none does, and no setup counts.
    pub chooser: Option<(usize, Readiness)>,
    pub rules: &'a [DispatchRule],
    pub now: f64,
}

impl Look<'_> {
    fn setup(&self, facts: &Facts) -> f64 {
        let (group, usual) = (facts.setup_group, facts.setup_time);
        let needed =
            self.chooser.and_then(|(machine, ready)| self.layout.setup(self.scenario, machine, ready, group, usual));
        needed.unwrap_or(0.0)
    }

    /// What the means over the queue are taken of.
    pub(super) fn measures(&self, facts: &Facts) -> Measures {
        let with_setup = self.scenario.control.keys.setup;
        if !with_setup && !self.rules.contains(&DispatchRule::AtcWithSetups) {
            return Measures { time: facts.time, setup: 0.0 };
        }
        let setup = self.setup(facts);
        Measures { time: if with_setup { facts.time + setup } else { facts.time }, setup }
    }

    pub(super) fn keys(&self, waiting: &QueueEntry, facts: &Facts, mean: Measures) -> Keys {
        let work_at = |station: u32| {
            let together = &self.layout.overlapping[station as usize];
            let waiting = together.iter().map(|station| self.waiting_work[*station as usize].1).sum::<f64>();
            let started = |station: &u32| self.started.get(*station as usize).copied().unwrap_or(0.0);
            waiting + together.iter().map(started).sum::<f64>()
        };
        let moment = Moment {
            now: self.now,
            mean,
            next_work: facts.next_station.filter(|_| self.layout.looks_ahead).map_or(0.0, work_at),
            setup: self.setup(facts),
            options: &self.scenario.control.keys,
        };
        let mut own = *facts;
        if moment.options.setup {
            own.time += moment.setup;
            own.work_left += moment.setup;
        }
        keys(self.rules, waiting.since.seconds(), &own, &moment)
    }
}

/// What is left of the operations in work at every station, s: their time as rules see it, less the time since they began. Empty
/// where no rule counts it.
pub(super) fn started_work(
    scenario: &Scenario,
    layout: &Layout,
    (jobs, machines): (&Jobs, &[Machine]),
    now: f64,
) -> Vec<f64> {
    if !layout.looks_ahead || scenario.control.keys.next_queue == NextQueue::Waiting {
        return Vec::new();
    }
    let mut started = vec![0.0; layout.overlapping.len()];
    for task in machines.iter().filter_map(|machine| machine.task.as_ref()) {
        let job = jobs.at(task.slot);
        let (part, operation) = (job.row.part as usize, job.operation as usize);
        let whole = layout.time(jobs, task.slot, part, operation);
        started[layout.operations[part][operation].station as usize] += (task.begun.seconds() + whole - now).max(0.0);
    }
    started
}
