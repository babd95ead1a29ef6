//! Speed of the kernel: events per second.
//!
//! Each calendar line has a bare `BinaryHeap` of (time, sequence) beside it: what the data
//! structure alone costs, without slots, cancellation and checks.

#![allow(missing_docs)] // criterion's macros generate public functions

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use rand::RngExt;
use rand_distr::Exp1;
use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};
use std::hint::black_box;
use stochastic_shop::{Rule, Shop};
use toolroom_kernel::{Calendar, Class, Entity, Purpose, SimTime, Streams};

#[path = "../tests/kernel/stochastic_shop.rs"]
mod stochastic_shop;

const HOLDS: usize = 100_000;

/// Exponential delays drawn beforehand: the random numbers are not part of the measurement.
fn delays() -> Vec<f64> {
    let mut stream = Streams::new(1, 0).open(Entity::named("hold"), Purpose::Processing);
    (0..HOLDS).map(|_| stream.sample(Exp1)).collect()
}

/// Pop one event, schedule the next one, with a constant number pending.
fn hold(criterion: &mut Criterion) {
    let delays = delays();
    let mut group = criterion.benchmark_group("hold");
    group.throughput(Throughput::Elements(HOLDS as u64));
    for pending in [10, 100, 1_000] {
        let mut calendar = Calendar::new();
        for &delay in &delays[..pending] {
            calendar.schedule(SimTime::ZERO.after(delay).unwrap(), Class::Finish, 0u64).unwrap();
        }
        group.bench_function(BenchmarkId::new("calendar", pending), |bencher| {
            bencher.iter(|| {
                for &delay in &delays {
                    let (now, event) = calendar.pop().unwrap();
                    calendar.schedule(now.after(delay).unwrap(), Class::Finish, event + 1).unwrap();
                }
            });
        });

        let mut heap: BinaryHeap<Reverse<(u64, u64)>> =
            delays[..pending].iter().zip(0..).map(|(delay, i)| Reverse((delay.to_bits(), i))).collect();
        let mut sequence = pending as u64;
        group.bench_function(BenchmarkId::new("bare heap", pending), |bencher| {
            bencher.iter(|| {
                for &delay in &delays {
                    let Reverse((bits, _)) = heap.pop().unwrap();
                    heap.push(Reverse(((f64::from_bits(bits) + delay).to_bits(), sequence)));
                    sequence += 1;
                }
            });
        });
    }
    group.finish();
}

/// Two of three planned events are cancelled and planned anew before one happens.
fn replan(criterion: &mut Criterion) {
    let delays = delays();
    let mut group = criterion.benchmark_group("replan");
    group.throughput(Throughput::Elements(HOLDS as u64));
    group.bench_function("100 pending", |bencher| {
        let mut calendar = Calendar::new();
        let plan = |calendar: &mut Calendar<usize>, delay: f64, entity| {
            let time = calendar.now().after(delay).unwrap();
            calendar.schedule(time, Class::Finish, entity).unwrap()
        };
        let mut keys: Vec<_> = (0..100).map(|entity| plan(&mut calendar, delays[entity], entity)).collect();
        bencher.iter(|| {
            for (i, &delay) in delays.iter().enumerate() {
                let entity = if i % 3 == 0 {
                    calendar.pop().unwrap().1
                } else {
                    calendar.cancel(keys[i % 100]);
                    i % 100
                };
                keys[entity] = plan(&mut calendar, delay, entity);
            }
        });
    });
    group.finish();
}

/// Mean wait of an M/M/1 queue at load 0.8, random numbers included.
fn mm1(customers: usize) -> f64 {
    #[derive(Clone, Copy)]
    enum Event {
        Arrive,
        Finish,
    }
    let streams = Streams::new(1, 0);
    let mut arrivals = streams.open(Entity::named("queue"), Purpose::Arrival);
    let mut services = streams.open(Entity::named("queue"), Purpose::Processing);
    let mut calendar = Calendar::new();
    let mut queue = VecDeque::new();
    let (mut busy, mut served, mut waited) = (false, 0, 0.0);
    calendar.schedule(SimTime::ZERO, Class::Arrive, Event::Arrive).unwrap();
    while served < customers {
        let (now, event) = calendar.pop().unwrap();
        match event {
            Event::Arrive => {
                queue.push_back(now);
                let gap = arrivals.sample::<f64, _>(Exp1) / 0.8;
                calendar.schedule(now.after(gap).unwrap(), Class::Arrive, Event::Arrive).unwrap();
            }
            Event::Finish => {
                busy = false;
                served += 1;
            }
        }
        if !busy && let Some(arrived) = queue.pop_front() {
            busy = true;
            waited += now - arrived;
            let end = now.after(services.sample(Exp1)).unwrap();
            calendar.schedule(end, Class::Finish, Event::Finish).unwrap();
        }
    }
    waited / served as f64
}

fn models(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("models");
    let customers = 100_000;
    group.throughput(Throughput::Elements(2 * customers as u64));
    group.bench_function("M/M/1", |bencher| bencher.iter(|| mm1(black_box(customers))));

    for rule in [Rule::FirstComeFirstServed, Rule::ShortestFirst] {
        let run = || {
            let mut shop = Shop::new(rule, 85);
            shop.run_until(black_box(20_000));
            shop.events
        };
        group.throughput(Throughput::Elements(run()));
        group.bench_function(BenchmarkId::new("job shop", format!("{rule:?}")), |bencher| bencher.iter(run));
    }
    group.finish();
}

fn streams(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("streams");
    let (streams, tool) = (Streams::new(1, 0), Entity::named("tool"));
    let mut index = 0;
    group.bench_function("open and draw once", |bencher| {
        bencher.iter(|| {
            index += 1;
            streams.at(tool, Purpose::Tool, index).sample::<f64, _>(Exp1)
        });
    });
    let mut stream = streams.open(tool, Purpose::Tool);
    group.bench_function("draw", |bencher| bencher.iter(|| stream.sample::<f64, _>(Exp1)));
    group.finish();
}

criterion_group!(benches, hold, replan, models, streams);
criterion_main!(benches);
