//! The three job shops of Fisher and Thompson (1963) under dispatching rules.
//!
//! Makespan and sum of flow times as in the reference results of jasima (Apache-2.0,
//! `testInstances/*.expected`; FT06 in the published numbering, optimum 55): all due dates are at
//! time zero, ties go to the earlier arrival at the machine, then to the lower job number.

use crate::instances::{FT06, FT10, FT20, Instance};
use toolroom_kernel::{Calendar, Class, SimTime};

#[derive(Debug, Clone, Copy)]
enum Rule {
    ShortestFirst,
    FirstComeFirstServed,
    LastComeFirstServed,
    LongestFirst,
    LeastSlack,
    EarliestDue,
    /// Least work in the next queue, the running operation included.
    WorkInNextQueue,
    /// Twice the processing time + work in next queue + next processing time (Holthaus and Rajendran 2000).
    Holthaus,
    /// Largest critical ratio first.
    InverseCriticalRatio,
}

#[derive(Clone, Copy)]
enum Event {
    Arrive(usize),
    Move(usize),
    Finish(usize),
}

#[derive(Clone, Default)]
struct Machine {
    /// Job and end of the running operation.
    running: Option<(usize, SimTime)>,
    queue: Vec<usize>,
}

struct Shop {
    rule: Rule,
    jobs: Instance,
    calendar: Calendar<Event>,
    machines: Vec<Machine>,
    step: Vec<usize>,
    queued_at: Vec<SimTime>,
}

impl Shop {
    /// Makespan and sum of flow times.
    fn run(jobs: Instance, rule: Rule) -> (f64, f64) {
        let mut shop = Self {
            rule,
            jobs,
            calendar: Calendar::new(),
            machines: vec![Machine::default(); jobs[0].len() / 2],
            step: vec![0; jobs.len()],
            queued_at: vec![SimTime::ZERO; jobs.len()],
        };
        // Scheduled backwards: the result must not depend on it.
        for job in (0..jobs.len()).rev() {
            shop.calendar.schedule(SimTime::ZERO, Class::Arrive, Event::Arrive(job)).unwrap();
        }
        let mut flow = 0.0;
        while let Some(now) = shop.calendar.peek_time() {
            while let Some(event) = shop.calendar.pop_before(now, Class::Observe) {
                flow += shop.settle(event, now);
            }
            (0..shop.machines.len()).for_each(|machine| shop.dispatch(machine, now));
        }
        (shop.calendar.now().seconds(), flow)
    }

    /// Machine and time of the operation `ahead` of the current one.
    fn operation(&self, job: usize, ahead: usize) -> Option<(usize, f64)> {
        let rest = self.jobs[job].get(2 * (self.step[job] + ahead)..)?;
        rest.first_chunk().map(|&[machine, time]| (machine as usize, f64::from(time)))
    }

    fn remaining(&self, job: usize) -> f64 {
        (0..).map_while(|ahead| self.operation(job, ahead)).map(|(_, time)| time).sum()
    }

    /// Returns the flow time of a job that leaves.
    fn settle(&mut self, event: Event, now: SimTime) -> f64 {
        match event {
            Event::Arrive(job) | Event::Move(job) => {
                let Some((machine, _)) = self.operation(job, 0) else { return now.seconds() };
                self.queued_at[job] = now;
                self.machines[machine].queue.push(job);
            }
            Event::Finish(machine) => {
                let (job, _) = self.machines[machine].running.take().unwrap();
                self.step[job] += 1;
                self.calendar.schedule(now, Class::Move, Event::Move(job)).unwrap();
            }
        }
        0.0
    }

    fn work_at(&self, machine: usize, now: SimTime) -> f64 {
        let Machine { running, queue } = &self.machines[machine];
        let waiting: f64 = queue.iter().filter_map(|&job| self.operation(job, 0)).map(|(_, time)| time).sum();
        waiting + running.map_or(0.0, |(_, end)| end - now)
    }

    /// The lowest goes first.
    fn priority(&self, job: usize, now: SimTime) -> f64 {
        let time = |ahead| self.operation(job, ahead).map_or(0.0, |(_, time)| time);
        let next_queue = || self.operation(job, 1).map_or(0.0, |(machine, _)| self.work_at(machine, now));
        match self.rule {
            Rule::ShortestFirst => time(0),
            Rule::FirstComeFirstServed => self.queued_at[job].seconds(),
            Rule::LastComeFirstServed => -self.queued_at[job].seconds(),
            Rule::LongestFirst => -time(0),
            Rule::LeastSlack => -now.seconds() - self.remaining(job),
            Rule::EarliestDue => 0.0,
            Rule::WorkInNextQueue => next_queue(),
            Rule::Holthaus => 2.0 * time(0) + next_queue() + time(1),
            Rule::InverseCriticalRatio => now.seconds() / self.remaining(job),
        }
    }

    fn dispatch(&mut self, machine: usize, now: SimTime) {
        if self.machines[machine].running.is_some() {
            return;
        }
        let key = |job: usize| (self.priority(job, now), self.queued_at[job], job);
        let chosen = self.machines[machine].queue.iter().copied().min_by(|&a, &b| key(a).partial_cmp(&key(b)).unwrap());
        let Some(job) = chosen else { return };
        let (_, time) = self.operation(job, 0).unwrap();
        let end = now.after(time).unwrap();
        let state = &mut self.machines[machine];
        state.queue.retain(|&waiting| waiting != job);
        state.running = Some((job, end));
        self.calendar.schedule(end, Class::Finish, Event::Finish(machine)).unwrap();
    }
}

const RULES: [Rule; 9] = [
    Rule::ShortestFirst,
    Rule::FirstComeFirstServed,
    Rule::LastComeFirstServed,
    Rule::LongestFirst,
    Rule::LeastSlack,
    Rule::EarliestDue,
    Rule::WorkInNextQueue,
    Rule::Holthaus,
    Rule::InverseCriticalRatio,
];

fn assert_matches(jobs: Instance, optimum: f64, expected: [(f64, f64); 9]) {
    for (rule, expected) in RULES.into_iter().zip(expected) {
        assert_eq!(Shop::run(jobs, rule), expected, "{rule:?}");
        assert!(expected.0 >= optimum);
    }
}

#[test]
fn six_by_six_matches_under_nine_rules() {
    let expected = [(88, 316), (65, 329), (68, 325), (67, 347), (61, 335), (65, 329), (88, 326), (88, 317), (61, 335)];
    assert_matches(FT06, 55.0, expected.map(|(makespan, flow)| (f64::from(makespan), f64::from(flow))));
}

#[test]
fn ten_by_ten_matches_under_nine_rules() {
    let expected = [
        (1074, 8343),
        (1184, 9782),
        (1393, 9978),
        (1295, 11034),
        (1108, 10105),
        (1184, 9782),
        (1344, 9743),
        (1181, 8135),
        (1122, 10252),
    ];
    assert_matches(FT10, 930.0, expected.map(|(makespan, flow)| (f64::from(makespan), f64::from(flow))));
}

#[test]
fn twenty_by_five_matches_under_nine_rules() {
    let expected = [
        (1267, 15705),
        (1645, 25542),
        (1365, 16314),
        (1631, 24430),
        (1501, 24258),
        (1645, 25542),
        (1513, 19510),
        (1335, 15088),
        (1526, 24763),
    ];
    assert_matches(FT20, 1165.0, expected.map(|(makespan, flow)| (f64::from(makespan), f64::from(flow))));
}
