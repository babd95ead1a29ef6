//! Keys of waiting jobs under the rules of queues: the least goes first.

use super::entry::{Facts, Keys};
use toolroom_scenario::{DispatchRule, KeyOptions, MOST_RULES, SlackBy};

/// Options where none are given.
static USUAL: KeyOptions = KeyOptions {
    atc_k: KeyOptions::ATC_K,
    atcs_k: KeyOptions::ATCS_K,
    covert_kb: KeyOptions::COVERT_KB,
    time: toolroom_scenario::KeyTime::Drawn,
    setup: false,
    slack_by: SlackBy::Job,
    next_queue: toolroom_scenario::NextQueue::Waiting,
};

/// What changes while jobs wait.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Time, s.
    pub now: f64,
    /// Means of what waits in the queue.
    pub mean: Measures,
    /// Time of the operations that wait at the next station, s.
    pub next_work: f64,
    /// Setup that the machine would need, s.
    pub setup: f64,
    /// What keys are made of.
    pub options: &'a KeyOptions,
}

impl Default for Moment<'_> {
    fn default() -> Self {
        Self { now: 0.0, mean: Measures::default(), next_work: 0.0, setup: 0.0, options: &USUAL }
    }
}

/// Times of an operation at a machine, or their means over a queue.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measures {
    /// Of the operation, s.
    pub time: f64,
    /// Of the setup that the machine would need, s; 0 where no rule looks at its mean.
    pub setup: f64,
}

/// Key of a job under a rule: the job with the least key goes first.
pub fn key(rule: DispatchRule, since: f64, facts: &Facts, moment: &Moment<'_>) -> f64 {
    let &Facts { time, work_left, operations_left, due, .. } = facts;
    let (options, mean) = (moment.options, moment.mean);
    let slack = due - moment.now - work_left;
    // Slack as the rules of tardiness costs see it, and the work that it is compared with.
    let (own_slack, own_work) = match options.slack_by {
        SlackBy::Job => (slack, work_left),
        SlackBy::Operation => (facts.operation_due - moment.now - time, time),
    };
    let late_in = |look_ahead: f64| own_slack.max(0.0) / look_ahead.max(f64::MIN_POSITIVE);
    let key = match rule {
        DispatchRule::Fifo => since,
        DispatchRule::Lifo => -since,
        DispatchRule::Random => facts.rank,
        DispatchRule::FirstReleased => facts.release,
        DispatchRule::Priority => facts.priority,
        DispatchRule::ShortestProcessingTime => time,
        DispatchRule::WeightedShortestTime => time / facts.weight,
        DispatchRule::LongestProcessingTime => -time,
        DispatchRule::ShortestRemaining => work_left,
        DispatchRule::LongestRemaining => -work_left,
        DispatchRule::EarliestDueDate => due,
        DispatchRule::EarliestOperationDue => facts.operation_due,
        DispatchRule::Slack => due - work_left,
        DispatchRule::FewestOperations => operations_left,
        DispatchRule::MostOperations => -operations_left,
        DispatchRule::SlackPerOperation => slack / operations_left,
        DispatchRule::CriticalRatio => (due - moment.now) / work_left.max(f64::MIN_POSITIVE),
        DispatchRule::ModifiedDueDate => (moment.now + work_left).max(due),
        DispatchRule::ModifiedOperationDue => (moment.now + time).max(facts.operation_due),
        DispatchRule::WorkInNextQueue => moment.next_work,
        DispatchRule::TimeAndNextQueue => time + moment.next_work,
        DispatchRule::TimesAndNextQueue => 2.0 * time + moment.next_work + facts.next_time,
        DispatchRule::TimeNextQueueAndSlack => time + moment.next_work + slack.min(0.0),
        DispatchRule::Atc => -facts.weight * (-late_in(options.atc_k * mean.time)).exp() / time.max(f64::MIN_POSITIVE),
        DispatchRule::AtcWithSetups => {
            let [by_slack, by_setup] = options.atcs_k;
            let setups = moment.setup / (by_setup * mean.setup).max(f64::MIN_POSITIVE);
            -facts.weight * (-late_in(by_slack * mean.time)).exp() * (-setups).exp() / time.max(f64::MIN_POSITIVE)
        }
        DispatchRule::Covert => {
            let [wait, look_ahead] = options.covert_kb;
            let cost = 1.0 - late_in(look_ahead * wait * own_work);
            -facts.weight * cost.max(0.0) / time.max(f64::MIN_POSITIVE)
        }
        DispatchRule::LeastSetup => moment.setup,
    };
    key + 0.0 // one zero for both signs: keys are compared with them
}

/// Keys of a job under several rules.
pub fn keys(rules: &[DispatchRule], since: f64, facts: &Facts, moment: &Moment<'_>) -> Keys {
    let mut keys = [0.0; MOST_RULES];
    keys.iter_mut().zip(rules).for_each(|(each, rule)| *each = key(*rule, since, facts, moment));
    keys
}
