//! Six machines, every job visits each once in random order, exponential times, load 0.85.
//!
//! First come, first served: a Kelly network with mean flow time 6 / (1 - 0.85) = 40.

use rand::RngExt;
use rand_distr::Exp1;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use toolroom_kernel::{Calendar, Class, Digest, Entity, Purpose, SimTime, Stream, Streams};

const MACHINES: usize = 6;
const ARRIVAL_RATE: f64 = 0.85;

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Rule {
    FirstComeFirstServed,
    ShortestFirst,
}

#[derive(Debug, Clone, Copy)]
enum Event {
    Arrive,
    Finish { machine: u8, job: u32 },
}

#[derive(Debug, Clone, Copy)]
struct Job {
    arrived: SimTime,
    route: [u8; MACHINES],
    times: [f64; MACHINES],
    step: u8,
}

#[derive(Debug, Clone, Default)]
struct Machine {
    busy: bool,
    queue: BinaryHeap<Reverse<(u64, u64, u32)>>,
}

/// A clone is a snapshot of the whole run.
#[derive(Debug, Clone)]
pub struct Shop {
    pub rule: Rule,
    calendar: Calendar<Event>,
    arrivals: Stream,
    work: Stream,
    machines: [Machine; MACHINES],
    jobs: Vec<Job>,
    free: Vec<u32>,
    queued: u64,
    pub flow_times: Vec<f64>,
    pub events: u64,
    pub digest: Digest,
}

impl Shop {
    pub fn new(rule: Rule, seed: u64) -> Self {
        let streams = Streams::new(seed, 0);
        let jobs = Entity::named("jobs");
        let mut shop = Self {
            rule,
            calendar: Calendar::new(),
            arrivals: streams.open(jobs, Purpose::Arrival),
            work: streams.open(jobs, Purpose::Processing),
            machines: Default::default(),
            jobs: Vec::new(),
            free: Vec::new(),
            queued: 0,
            flow_times: Vec::new(),
            events: 0,
            digest: Digest::new(),
        };
        shop.next_arrival();
        shop
    }

    /// Runs until `jobs` jobs have left the shop.
    pub fn run_until(&mut self, jobs: usize) {
        while self.flow_times.len() < jobs {
            let now = self.calendar.peek_time().unwrap();
            while let Some(event) = self.calendar.pop_before(now, Class::Observe) {
                self.events += 1;
                self.settle(event, now);
            }
            (0..MACHINES).for_each(|machine| self.dispatch(machine, now));
        }
    }

    fn next_arrival(&mut self) {
        let time = self.calendar.now().after(self.arrivals.sample::<f64, _>(Exp1) / ARRIVAL_RATE).unwrap();
        self.calendar.schedule(time, Class::Arrive, Event::Arrive).unwrap();
    }

    fn settle(&mut self, event: Event, now: SimTime) {
        match event {
            Event::Arrive => {
                let mut route = [0, 1, 2, 3, 4, 5];
                (1..MACHINES).for_each(|i| route.swap(i, self.work.random_range(0..=i)));
                let times = std::array::from_fn(|_| self.work.sample(Exp1));
                let job = Job { arrived: now, route, times, step: 0 };
                let id = match self.free.pop() {
                    Some(id) => {
                        self.jobs[id as usize] = job;
                        id
                    }
                    None => {
                        self.jobs.push(job);
                        (self.jobs.len() - 1) as u32
                    }
                };
                self.digest.record(now, &[0, u64::from(id)]);
                self.enqueue(id);
                self.next_arrival();
            }
            Event::Finish { machine, job } => {
                self.digest.record(now, &[1, u64::from(machine), u64::from(job)]);
                self.machines[machine as usize].busy = false;
                let state = &mut self.jobs[job as usize];
                state.step += 1;
                if state.step as usize == MACHINES {
                    self.flow_times.push(now - state.arrived);
                    self.free.push(job);
                } else {
                    self.enqueue(job);
                }
            }
        }
    }

    fn enqueue(&mut self, id: u32) {
        let job = &self.jobs[id as usize];
        let step = job.step as usize;
        let rank = if self.rule == Rule::ShortestFirst { job.times[step].to_bits() } else { 0 };
        self.machines[job.route[step] as usize].queue.push(Reverse((rank, self.queued, id)));
        self.queued += 1;
    }

    fn dispatch(&mut self, index: usize, now: SimTime) {
        let machine = &mut self.machines[index];
        if !machine.busy
            && let Some(Reverse((_, _, id))) = machine.queue.pop()
        {
            machine.busy = true;
            let job = &self.jobs[id as usize];
            let end = now.after(job.times[job.step as usize]).unwrap();
            let finish = Event::Finish { machine: index as u8, job: id };
            self.calendar.schedule(end, Class::Finish, finish).unwrap();
        }
    }
}
