//! Failures, repairs and interrupted work.

use crate::statistics::Estimate;
use rand::RngExt;
use rand_distr::Exp1;
use std::collections::VecDeque;
use toolroom_kernel::{Calendar, Class, Entity, EventKey, Purpose, SimTime, Stream, Streams};

#[derive(Clone, Copy)]
enum Event {
    Fail,
    Repaired,
    Arrive,
    Finish,
}

struct Draws(Stream);

impl Draws {
    fn exponential(&mut self, mean: f64) -> f64 {
        mean * self.0.sample::<f64, _>(Exp1)
    }
}

fn draws(replication: u64) -> Draws {
    Draws(Streams::new(7, replication).open(Entity::named("machines"), Purpose::Failure))
}

fn schedule(calendar: &mut Calendar<Event>, delay: f64, class: Class, event: Event) -> EventKey {
    let time = calendar.now().after(delay).unwrap();
    calendar.schedule(time, class, event).unwrap()
}

/// Machines that fail and share repairmen; yields (time, machines down) after each event.
fn repair_shop(
    machines: usize,
    repairmen: usize,
    life: f64,
    repair: f64,
    draws: &mut Draws,
    mut visit: impl FnMut(f64, usize) -> bool,
) {
    let mut calendar = Calendar::new();
    let mut down = 0;
    for _ in 0..machines {
        schedule(&mut calendar, draws.exponential(life), Class::Finish, Event::Fail);
    }
    while let Some((now, event)) = calendar.pop() {
        match event {
            Event::Fail => {
                down += 1;
                if down <= repairmen {
                    schedule(&mut calendar, draws.exponential(repair), Class::Finish, Event::Repaired);
                }
            }
            _ => {
                down -= 1;
                schedule(&mut calendar, draws.exponential(life), Class::Finish, Event::Fail);
                if down >= repairmen {
                    schedule(&mut calendar, draws.exponential(repair), Class::Finish, Event::Repaired);
                }
            }
        }
        if !visit(now.seconds(), down) {
            return;
        }
    }
}

#[test]
fn shared_repairmen_limit_availability() {
    let cases = [(10, 1, 300.0, 30.0, 0.785_42), (5, 1, 10.0, 2.0, 0.715_13), (10, 2, 10.0, 2.0, 0.759_63)];
    for (machines, repairmen, life, repair, exact) in cases {
        let (batches, length) = (50, 1000.0 * life);
        let mut up_time = vec![0.0; batches];
        let (mut since, mut up) = (0.0, machines);
        repair_shop(machines, repairmen, life, repair, &mut draws(0), |now, down| {
            // A piece of constant state may cross batch ends.
            while since < now {
                let batch = (since / length) as usize;
                let Some(total) = up_time.get_mut(batch) else { return false };
                let end = now.min((batch + 1) as f64 * length);
                *total += (end - since) * up as f64;
                since = end;
            }
            up = machines - down;
            true
        });
        let availability: Vec<f64> = up_time.iter().map(|total| total / length / machines as f64).collect();
        let what = format!("{machines} machines, {repairmen} repairmen");
        Estimate::of_independent(&availability).assert_agrees(&what, exact, 0.005);
    }
}

/// Ten machines must run, three spares, mean life 100, one repairman, mean repair 1.
///
/// Source: S. M. Ross, "Simulation", section 7.7; the exact mean is that of the birth–death chain.
#[test]
fn spares_run_out_when_ross_says() {
    let (working, spares, life, repair) = (10, 3, 100.0, 1.0);
    let times: Vec<f64> = (0..400)
        .map(|replication| {
            let mut draws = draws(replication);
            let mut calendar = Calendar::new();
            let mut down = 0;
            let mut failure = schedule(&mut calendar, draws.exponential(life / 10.0), Class::Finish, Event::Fail);
            loop {
                let (now, event) = calendar.pop().unwrap();
                match event {
                    Event::Fail if down == spares => return now.seconds(),
                    Event::Fail => {
                        down += 1;
                        if down == 1 {
                            schedule(&mut calendar, draws.exponential(repair), Class::Finish, Event::Repaired);
                        }
                    }
                    _ => {
                        down -= 1;
                        if down > 0 {
                            schedule(&mut calendar, draws.exponential(repair), Class::Finish, Event::Repaired);
                        }
                        // Life has no memory: drawing the pending failure anew changes no probability.
                        calendar.cancel(failure);
                    }
                }
                failure =
                    schedule(&mut calendar, draws.exponential(life / f64::from(working)), Class::Finish, Event::Fail);
            }
        })
        .collect();
    Estimate::of_independent(&times).assert_agrees("time to crash", 12_340.0, 0.06);
}

/// Failures at rate 0.05 only while busy, repair rate 0.5, work resumes: mean completion time
/// 1.1, mean time in the system 3.58824 at arrival rate 0.6.
#[test]
fn work_resumes_after_repair() {
    let mut draws = draws(1);
    let mut calendar = Calendar::new();
    let mut queue: VecDeque<(SimTime, f64)> = VecDeque::new();
    // Finish, failure and start of the running piece of work.
    let mut running: Option<(EventKey, EventKey, SimTime)> = None;
    let mut up = true;
    let mut in_system = Vec::new();
    schedule(&mut calendar, draws.exponential(1.0 / 0.6), Class::Arrive, Event::Arrive);
    while in_system.len() < 500_000 {
        let (now, event) = calendar.pop().unwrap();
        match event {
            Event::Arrive => {
                queue.push_back((now, draws.exponential(1.0)));
                schedule(&mut calendar, draws.exponential(1.0 / 0.6), Class::Arrive, Event::Arrive);
            }
            Event::Finish => {
                let (_, failure, _) = running.take().unwrap();
                assert!(calendar.cancel(failure));
                let (arrived, _) = queue.pop_front().unwrap();
                in_system.push(now - arrived);
            }
            Event::Fail => {
                let (finish, _, started) = running.take().unwrap();
                assert!(calendar.cancel(finish));
                let remaining = &mut queue[0].1;
                *remaining = (*remaining - (now - started)).max(0.0);
                up = false;
                schedule(&mut calendar, draws.exponential(2.0), Class::Finish, Event::Repaired);
            }
            Event::Repaired => up = true,
        }
        if up
            && running.is_none()
            && let Some(&(_, remaining)) = queue.front()
        {
            let finish = schedule(&mut calendar, remaining, Class::Finish, Event::Finish);
            let failure = schedule(&mut calendar, draws.exponential(20.0), Class::Finish, Event::Fail);
            running = Some((finish, failure, now));
        }
    }
    Estimate::of_series(&in_system).assert_agrees("time in the system", 3.588_24, 0.03);
}
