//! A shop of two lathes and two mills in two shifts: jobs turn first, then some are milled. Every
//! stay of a machine is an event; delays happen one by one.

use crate::noise::Chance;
use crate::{Case, Edges, Generator};
use std::fmt::Write;

/// Days that are recorded.
const DAYS: usize = 10;
/// The shop.
pub const GENERATOR: Generator = Generator { process: "shop", effects: &EFFECTS, outside: &OUTSIDE, records };

const EFFECTS: [(&str, f64); 8] = [
    ("feed_override", 0.08),
    ("feed_hold", 15.0),
    ("micro_stops", 1.5),
    ("operator_delay", 12.0),
    ("tool_change_delay", 15.0),
    ("tool_change_policy", 0.1),
    ("axis_acceleration", 2.0),
    ("breakdown_shape", 1.0),
];

const OUTSIDE: [&str; 5] = ["day_cycle", "chip_jam", "machine_offset", "learning", "sticky_fixture"];

const HOUR: f64 = 3600.0;
const DAY: f64 = 24.0 * HOUR;
/// Working time of a day, s.
const OPEN: (f64, f64) = (6.0 * HOUR, 22.0 * HOUR);
/// Start of the second shift, s.
const SECOND: f64 = 14.0 * HOUR;

/// A program: name, time as planned (s), life of an edge in it (s), passes, feed speed (m/s).
struct Program {
    name: &'static str,
    time: f64,
    life: f64,
    passes: f64,
    feed_speed: f64,
}

const PROGRAMS: [Program; 5] = [
    Program { name: "shaft/turn", time: 150.0, life: 2650.0, passes: 3.0, feed_speed: 0.006 },
    Program { name: "flange/turn", time: 360.0, life: 2650.0, passes: 6.0, feed_speed: 0.006 },
    Program { name: "ring/turn", time: 90.0, life: 2650.0, passes: 2.0, feed_speed: 0.006 },
    Program { name: "shaft/mill", time: 240.0, life: 3900.0, passes: 2.0, feed_speed: 0.014 },
    Program { name: "flange/mill", time: 480.0, life: 3900.0, passes: 4.0, feed_speed: 0.014 },
];
/// Jobs: programs in order, arrivals per hour of the whole day.
const JOBS: [(&[usize], f64); 3] = [(&[0, 3], 6.0), (&[1, 4], 2.7), (&[2], 6.0)];
const MACHINES: [&str; 4] = ["L1", "L2", "M1", "M2"];

/// What one machine goes through.
struct Machine {
    index: usize,
    now: f64,
    /// Factor on its times.
    gain: f64,
    edge: usize,
    /// Wear of the edge, mm, and the factor of this edge on its rate.
    wear: f64,
    rate: f64,
    /// Time in use until the next breakdown, s.
    good: f64,
    rows: Vec<(f64, String)>,
}

struct World<'a> {
    case: &'a Case,
    chance: Chance,
    /// True over planned time, by program.
    program: Vec<f64>,
    handling: f64,
    change: f64,
    scatter: f64,
    spread: f64,
    /// Whether overrides are logged.
    logged: bool,
}

impl World<'_> {
    fn strength(&self, id: &str) -> f64 {
        self.case.strength(id)
    }

    /// Time between two breakdowns, s: Weibull by inversion.
    fn good(&mut self) -> f64 {
        let shape = 1.0 + self.strength("breakdown_shape");
        // The mean by strata instead of the gamma function.
        let mean =
            (0..400).map(|i| (-(1.0 - (f64::from(i) + 0.5) / 400.0).ln()).powf(1.0 / shape)).sum::<f64>() / 400.0;
        8.0 * HOUR / mean * (-(1.0 - self.chance.uniform()).ln()).powf(1.0 / shape)
    }
}

fn closing(time: f64) -> f64 {
    (time / DAY).floor() * DAY + OPEN.1
}

fn second(time: f64) -> bool {
    time.rem_euclid(DAY) >= SECOND
}

impl Machine {
    fn log(&mut self, state: &str, job: &str, feed: f64, world: &World<'_>) {
        let feed = if world.logged { format!("{:.0}", 100.0 * feed) } else { String::new() };
        let tool = if job.is_empty() { String::new() } else { format!("{}-T{}", MACHINES[self.index], self.edge) };
        let job = if job.is_empty() { ",".to_owned() } else { job.to_owned() };
        let row = format!("{:.1},{},{state},{job},{tool},{feed}", self.now, MACHINES[self.index]);
        self.rows.push((self.now, row));
    }

    /// Waits for the shop to open.
    fn open(&mut self, world: &World<'_>) {
        let phase = self.now.rem_euclid(DAY);
        let start = (self.now / DAY).floor() * DAY + OPEN.0;
        if phase < OPEN.0 || phase >= OPEN.1 {
            self.log("off_shift", "", 1.0, world);
            self.now = if phase < OPEN.0 { start } else { start + DAY };
        }
    }

    /// Works in a state, through nights and breakdowns.
    fn work(&mut self, state: &str, job: &str, feed: f64, time: f64, world: &mut World<'_>) {
        let mut left = time;
        while left > 1e-9 {
            self.open(world);
            self.log(state, job, feed, world);
            let stretch = left.min(closing(self.now) - self.now).min(self.good);
            self.now += stretch;
            self.good -= stretch;
            left -= stretch;
            if self.good <= 1e-9 {
                self.log("down", job, feed, world);
                let repair = world.chance.delay(25.0 * 60.0).max(400.0);
                self.now += repair;
                self.good = world.good();
            }
        }
    }

    fn operate(&mut self, program: usize, number: usize, world: &mut World<'_>) {
        let plan = &PROGRAMS[program];
        let operation = plan.name.split_once('/').map_or(plan.name, |(_, operation)| operation);
        let job = format!("{},J{number}/{operation}", plan.name);
        self.open(world);
        let late = second(self.now);
        let day = self.now / DAY;
        let mut handling = world.handling * gamma_like(&mut world.chance, world.spread);
        if late && world.strength("operator_delay") > 0.0 {
            let mean = 12.0 * world.strength("operator_delay");
            handling += world.chance.delay(mean);
        }
        handling *= 1.0 + 0.2 * world.strength("learning") * (-day / 3.0).exp();
        if plan.name == "flange/turn" {
            handling += 12.0 * world.strength("sticky_fixture");
        }
        self.work("handling", &job, 1.0, 0.65 * handling, world);
        let limit = 0.4 + 0.1 * world.strength("tool_change_policy");
        if self.wear >= limit {
            self.edge += 1;
            self.wear = 0.0;
            self.rate = (world.scatter * world.chance.normal()).exp();
            let mut time = 90.0 * world.change * (1.0 + 0.02 * world.chance.normal());
            if world.strength("tool_change_delay") > 0.0 {
                time += world.chance.delay(15.0 * world.strength("tool_change_delay"));
            }
            self.work("tool_change", &job, 1.0, time, world);
        }
        let running = plan.time * world.program[program] * self.gain;
        self.wear += 0.4 / plan.life * running * self.rate * (1.0 + 0.1 * world.chance.normal()).max(0.1);
        let outlier = if world.chance.uniform() < 0.01 { 3.0 } else { 1.0 };
        let noise = 0.005 * world.case.scatter * if world.case.stress { 2.0 } else { 1.0 };
        let mut cut = running * (noise * outlier * world.chance.normal()).exp();
        cut += plan.passes * plan.feed_speed * 2.0 * world.strength("axis_acceleration");
        let hours = self.now.rem_euclid(DAY) / HOUR;
        cut *= 1.0 + 0.05 * world.strength("day_cycle") * ((hours - 9.0) / 24.0 * std::f64::consts::TAU).sin();
        if self.index == 1 {
            cut *= 1.0 + 0.15 * world.strength("machine_offset");
        }
        if plan.name == "flange/turn" && world.chance.uniform() < 0.08 * world.strength("chip_jam") {
            cut += world.chance.delay(60.0);
        }
        // Stops come one after the other while the program runs.
        let rate = 1.5 * world.strength("micro_stops") / HOUR;
        if rate > 0.0 {
            let mut time = -(1.0 - world.chance.uniform()).ln() / rate;
            let mut stopped = 0.0;
            while time < running {
                stopped += world.chance.delay(20.0);
                time -= (1.0 - world.chance.uniform()).ln() / rate;
            }
            cut += stopped;
        }
        let mut feed = 1.0;
        let slow = world.strength("feed_override");
        // Below zero somebody turns the knob up in the late shift, which no log says.
        if slow != 0.0 {
            if world.logged && slow > 0.0 {
                // Somebody turns the knob for some operations, whatever the shift.
                if world.chance.uniform() < 0.4 {
                    feed = (100.0 / (1.0 + slow * 0.2 * world.chance.uniform())).round() / 100.0;
                }
                cut /= feed;
            } else if late {
                cut *= 1.0 + 0.08 * slow;
            }
        }
        let held = world.chance.uniform() < 0.05 && world.strength("feed_hold") > 0.0;
        let share = if held { world.chance.uniform() } else { 1.0 };
        self.work("cutting", &job, feed, share * cut, world);
        if held {
            let time = world.chance.delay(15.0 * world.strength("feed_hold"));
            self.work("feed_hold", &job, feed, time, world);
            self.work("cutting", &job, feed, (1.0 - share) * cut, world);
        }
        self.work("handling", &job, 1.0, 0.35 * handling, world);
        self.log("idle", "", 1.0, world);
    }
}

/// A positive factor of mean 1 with a coefficient of variation: sums of delays.
fn gamma_like(chance: &mut Chance, spread: f64) -> f64 {
    // `delay` has cv 0.5; the mean of n of them 0.5/√n.
    let count = (0.5 / spread).powi(2).round().max(1.0) as usize;
    (0..count).map(|_| chance.delay(1.0)).sum::<f64>() / count as f64
}

/// Events of the shop as CSV.
fn records(case: &Case) -> String {
    let mut chance = Chance::new(case.seed, 10 + case.stream());
    let mut shop = Chance::new(case.seed, 0);
    let unsure = if case.stress { 1.5 } else { 1.0 };
    let mut world = World {
        program: PROGRAMS.iter().map(|_| (0.03 * unsure * shop.normal()).exp()).collect(),
        handling: 60.0 * (0.05 * unsure * shop.normal()).exp(),
        change: (0.03 * unsure * shop.normal()).exp(),
        scatter: 0.10 * case.scatter,
        spread: 0.2 * case.scatter,
        logged: case.seed.is_multiple_of(2),
        chance: Chance::new(case.seed, 20 + case.stream()),
        case,
    };
    let machine = |index: usize, gain: f64| Machine {
        index,
        now: 0.0,
        gain,
        edge: 1,
        wear: 0.0,
        rate: 1.0,
        good: 0.0,
        rows: Vec::new(),
    };
    let mut machines: Vec<Machine> =
        (0..MACHINES.len()).map(|index| machine(index, (0.015 * shop.normal()).exp())).collect();
    for machine in &mut machines {
        machine.good = world.good();
        machine.log("off_shift", "", 1.0, &world);
    }
    // A closure that is to be believed needs more days than a diagnosis.
    let days = if case.edges == Edges::New { 3 * DAYS } else { case.times * DAYS };
    let end = days as f64 * DAY;
    let mut arrivals: Vec<(f64, &[usize])> = Vec::new();
    for (programs, rate) in JOBS {
        let mut time = 0.0;
        loop {
            time -= (1.0 - chance.uniform()).ln() * HOUR / rate;
            if time > end {
                break;
            }
            arrivals.push((time, programs));
        }
    }
    arrivals.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut waiting: Vec<(f64, usize, &[usize])> =
        arrivals.iter().enumerate().map(|(number, (time, programs))| (*time, number, *programs)).collect();
    for stage in 0..2 {
        let (first, second) = machines.split_at_mut(2);
        let pair = if stage == 0 { first } else { second };
        let mut done = Vec::new();
        for (ready, number, programs) in waiting {
            let Some(program) = programs.get(stage) else { continue };
            let free = usize::from(pair[1].now < pair[0].now);
            let machine = &mut pair[free];
            machine.now = machine.now.max(ready);
            machine.operate(*program, number, &mut world);
            done.push((machine.now, number, programs));
        }
        done.sort_by(|a, b| a.0.total_cmp(&b.0));
        waiting = done;
    }
    let mut rows: Vec<(f64, String)> = machines.into_iter().flat_map(|machine| machine.rows).collect();
    rows.retain(|(time, _)| *time < end);
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut csv = String::from("time [s],machine,state,program,operation_id,tool_id,feed_override [%]\n");
    for (_, row) in rows {
        let _ = writeln!(csv, "{row}");
    }
    csv
}
