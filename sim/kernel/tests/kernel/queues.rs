//! One station: waiting times against the formulas of queueing theory.

use crate::statistics::Estimate;
use rand::RngExt;
use rand_distr::Exp1;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use toolroom_kernel::{Calendar, Class, Entity, EventKey, Purpose, SimTime, Stream, Streams};

/// Service time distributions of mean one.
#[derive(Clone, Copy)]
enum Service {
    Constant,
    Erlang(u32),
    Exponential,
    /// Two exponential phases with balanced means.
    Hyperexponential {
        squared_cv: f64,
    },
}

impl Service {
    fn draw(self, stream: &mut Stream) -> f64 {
        let mut exponential = || stream.sample::<f64, _>(Exp1);
        match self {
            Self::Constant => 1.0,
            Self::Erlang(phases) => (0..phases).map(|_| exponential()).sum::<f64>() / f64::from(phases),
            Self::Exponential => exponential(),
            Self::Hyperexponential { squared_cv } => {
                let p = 0.5 * (1.0 + ((squared_cv - 1.0) / (squared_cv + 1.0)).sqrt());
                let unit = exponential();
                unit / (2.0 * if stream.random::<f64>() < p { p } else { 1.0 - p })
            }
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Discipline {
    FirstComeFirstServed,
    ShortestFirst,
    ClassFirst,
    ClassFirstPreemptiveResume,
}

#[derive(Clone, Copy)]
enum Event {
    Arrive(usize),
    Finish(usize),
}

#[derive(Clone, Copy)]
struct Job {
    number: usize,
    class: usize,
    arrived: SimTime,
    service: f64,
    remaining: f64,
}

struct Station {
    discipline: Discipline,
    service: Service,
    rates: Vec<f64>,
    calendar: Calendar<Event>,
    arrivals: Vec<Stream>,
    services: Vec<Stream>,
    queue: BinaryHeap<Reverse<(u64, usize)>>,
    jobs: Vec<Job>,
    servers: Vec<Option<(usize, EventKey, SimTime)>>,
    /// Per class, in order of completion: time in the system less service time.
    waits: Vec<Vec<f64>>,
}

impl Station {
    fn run(discipline: Discipline, service: Service, servers: usize, rates: &[f64], jobs: usize) -> Vec<Vec<f64>> {
        let streams = Streams::new(20_261_121, 0);
        let open =
            |purpose| (0..rates.len()).map(move |c| streams.open(Entity::named("class").part(c as u64), purpose));
        let mut station = Self {
            discipline,
            service,
            rates: rates.to_vec(),
            calendar: Calendar::new(),
            arrivals: open(Purpose::Arrival).collect(),
            services: open(Purpose::Processing).collect(),
            queue: BinaryHeap::new(),
            jobs: Vec::with_capacity(jobs + rates.len()),
            servers: vec![None; servers],
            waits: vec![Vec::new(); rates.len()],
        };
        (0..rates.len()).for_each(|class| station.next_arrival(class));
        while station.jobs.len() < jobs {
            let now = station.calendar.peek_time().unwrap();
            while let Some(event) = station.calendar.pop_before(now, Class::Observe) {
                station.settle(event, now);
            }
            station.dispatch(now);
        }
        // The first tenth is the warm-up.
        station.waits.into_iter().map(|waits| waits[waits.len() / 10..].to_vec()).collect()
    }

    fn next_arrival(&mut self, class: usize) {
        let gap = self.arrivals[class].sample::<f64, _>(Exp1) / self.rates[class];
        let time = self.calendar.now().after(gap).unwrap();
        self.calendar.schedule(time, Class::Arrive, Event::Arrive(class)).unwrap();
    }

    fn settle(&mut self, event: Event, now: SimTime) {
        match event {
            Event::Arrive(class) => {
                let service = self.service.draw(&mut self.services[class]);
                let number = self.jobs.len();
                self.jobs.push(Job { number, class, arrived: now, service, remaining: service });
                self.enqueue(number);
                self.next_arrival(class);
                if self.discipline == Discipline::ClassFirstPreemptiveResume {
                    self.preempt(class, now);
                }
            }
            Event::Finish(server) => {
                let (number, _, _) = self.servers[server].take().unwrap();
                let job = self.jobs[number];
                self.waits[job.class].push(now - job.arrived - job.service);
            }
        }
    }

    fn enqueue(&mut self, number: usize) {
        let Job { class, service, .. } = self.jobs[number];
        let rank = match self.discipline {
            Discipline::FirstComeFirstServed => 0,
            Discipline::ShortestFirst => service.to_bits(),
            Discipline::ClassFirst | Discipline::ClassFirstPreemptiveResume => class as u64,
        };
        self.queue.push(Reverse((rank, number)));
    }

    fn preempt(&mut self, class: usize, now: SimTime) {
        let less_urgent = |&(number, _, _): &(usize, EventKey, SimTime)| self.jobs[number].class > class;
        let Some((number, finish, started)) = self.servers[0].take_if(|busy| less_urgent(busy)) else { return };
        assert!(self.calendar.cancel(finish));
        self.jobs[number].remaining -= now - started;
        self.enqueue(number);
    }

    fn dispatch(&mut self, now: SimTime) {
        for server in 0..self.servers.len() {
            if self.servers[server].is_none()
                && let Some(Reverse((_, number))) = self.queue.pop()
            {
                let end = now.after(self.jobs[number].remaining.max(0.0)).unwrap();
                let finish = self.calendar.schedule(end, Class::Finish, Event::Finish(server)).unwrap();
                self.servers[server] = Some((self.jobs[number].number, finish, now));
            }
        }
    }
}

fn mean_wait(discipline: Discipline, service: Service, servers: usize, rate: f64) -> Estimate {
    Estimate::of_series(&Station::run(discipline, service, servers, &[rate], 500_000)[0])
}

/// Erlang C: `wait = C(c, a) / (c - a)` with mean service one.
#[test]
fn waiting_with_several_servers_follows_erlang_c() {
    for (servers, load, exact) in [(1, 0.8, 4.0), (2, 1.6, 1.777_778), (4, 3.2, 0.745_541), (3, 2.7, 2.723_537)] {
        let wait = mean_wait(Discipline::FirstComeFirstServed, Service::Exponential, servers, load);
        wait.assert_agrees(&format!("M/M/{servers} at {load}"), exact, 0.05);
    }
}

/// Pollaczek–Khinchine: `wait = load (1 + squared_cv) / (2 (1 - load))`.
#[test]
fn waiting_with_general_service_follows_pollaczek_khinchine() {
    let squared_cv_4 = Service::Hyperexponential { squared_cv: 4.0 };
    let cases = [(Service::Constant, 2.0), (Service::Erlang(4), 2.5), (Service::Erlang(2), 3.0), (squared_cv_4, 10.0)];
    for (service, exact) in cases {
        let wait = mean_wait(Discipline::FirstComeFirstServed, service, 1, 0.8);
        wait.assert_agrees(&format!("M/G/1 with wait {exact}"), exact, 0.05);
    }
}

/// Shortest processing time first, not interrupted: integral over Cobham's formula.
#[test]
fn shortest_first_shortens_waiting_as_computed() {
    for (load, exact) in [(0.8, 1.882_22), (0.85, 2.363_77)] {
        let wait = mean_wait(Discipline::ShortestFirst, Service::Exponential, 1, load);
        wait.assert_agrees(&format!("SPT at {load}"), exact, 0.05);
    }
}

/// Cobham: `wait = residual / ((1 - load_before) (1 - load_up_to))`.
#[test]
fn urgent_jobs_pass_the_others() {
    let waits = Station::run(Discipline::ClassFirst, Service::Exponential, 1, &[0.3, 0.5], 500_000);
    for (class, exact) in [1.142_86, 5.714_29].into_iter().enumerate() {
        Estimate::of_series(&waits[class]).assert_agrees(&format!("class {class}"), exact, 0.05);
    }
}

/// Times in the system 1.42857 and 7.14286, less the service of mean one.
#[test]
fn urgent_jobs_interrupt_the_others() {
    let waits = Station::run(Discipline::ClassFirstPreemptiveResume, Service::Exponential, 1, &[0.3, 0.5], 500_000);
    for (class, exact) in [0.428_57, 6.142_86].into_iter().enumerate() {
        Estimate::of_series(&waits[class]).assert_agrees(&format!("class {class}"), exact, 0.05);
    }
}
