//! Plunge grinding: fifty-six trials over eight dressings of two machines.
//!
//! The work is followed by the angle: at each of ninety places of its circumference the wheel takes what it left
//! there one turn ago and what the infeed, which never stops within a turn, has brought since. Force grows with a
//! power of the depth that is not quite one.

use crate::noise::{Chance, Reading};
use crate::{Case, Edges, Generator};
use std::fmt::Write;

/// Dressings of a data set.
const DRESSINGS: usize = 8;
/// Trials after each dressing.
const TRIALS: usize = 7;

/// The shop with two grinders.
pub const GENERATOR: Generator = Generator { process: "grinding", effects: &EFFECTS, outside: &OUTSIDE, records };

const EFFECTS: [(&str, f64); 7] = [
    ("wheel_dulling", 0.3),
    ("wheel_wear", 0.01),
    ("threshold_force", 12.0),
    ("thermal_growth", 7e-4),
    ("start_offset", 3.0),
    ("stiffness_drift", 0.03),
    ("coolant_change", 0.08),
];

const OUTSIDE: [&str; 6] =
    ["size_effect", "day_cycle", "machine_offset", "loaded_wheel", "speed_force", "operator_touch"];

/// Scatter of force from dressing to dressing, standard deviation of the logarithm.
const SCATTER: f64 = 0.03;
/// Places on the circumference of the work.
const PLACES: usize = 90;
/// Depth to which force coefficients refer, um.
const DEPTH: f64 = 4.4;
/// Work diameter, wheel diameter, mm.
const WORK: f64 = 50.0;
const WHEEL: f64 = 400.0;
/// Share of what stands in the way to which a depth is worked out.
const CLOSE: f64 = 1e-12;
/// Removed volume at which dulling counts, mm³/mm.
const DULL: f64 = 1500.0;

/// Wheel, work and machine as they are in one trial: N, um.
struct Contact {
    stiffness: f64,
    /// Force at the reference depth over that depth.
    force: f64,
    exponent: f64,
    threshold: f64,
    /// Growth of the machine's stiffness with load.
    stiffening: f64,
    /// Wheel radius worn per depth.
    wear: f64,
}

impl Contact {
    fn force_of(&self, depth: f64) -> f64 {
        // Grains that rub begin to do so at once, those that cut take their share.
        let rubbing = if self.threshold > 0.0 { self.threshold * -(-depth / 0.08).exp_m1() } else { 0.0 };
        rubbing + self.force * DEPTH * (depth / DEPTH).powf(self.exponent)
    }

    fn deflection(&self, force: f64) -> f64 {
        force / self.stiffness * (force.max(1.0) / 170.0).powf(-self.stiffening)
    }

    /// Depth at which force and deflection use up what stands in the way, by false position; of an end that stays
    /// in place half the weight is taken (Illinois).
    fn depth(&self, standing: f64) -> f64 {
        if standing <= 0.0 {
            return 0.0;
        }
        let beyond = |depth: f64| depth * (1.0 + self.wear) + self.deflection(self.force_of(depth)) - standing;
        let [mut low, mut high] = [(0.0, -standing), (standing, beyond(standing))];
        let mut stayed = 0;
        while high.0 - low.0 > CLOSE * standing {
            let depth = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let left = beyond(depth);
            if left.abs() <= CLOSE * standing {
                return depth;
            }
            if left < 0.0 {
                low = (depth, left);
                high.1 *= if stayed > 0 { 0.5 } else { 1.0 };
                stayed = 1;
            } else {
                high = (depth, left);
                low.1 *= if stayed < 0 { 0.5 } else { 1.0 };
                stayed = -1;
            }
        }
        0.5 * (low.0 + high.0)
    }
}

/// What a plunge leaves.
struct Plunge {
    stock: f64,
    steady: f64,
    depth: f64,
    rise: f64,
    at_retraction: f64,
    /// Sum of force over revolutions, N.
    work: f64,
    worn: f64,
}

/// A plunge of `turns` at `infeed` um per turn with `sparks` turns without, contact being late by `late` um.
fn plunge(contact: &Contact, infeed: f64, turns: f64, sparks: f64, late: f64) -> Plunge {
    let step = 1.0 / PLACES as f64;
    let mut surface = vec![0.0_f64; PLACES];
    let (mut worn, mut work) = (0.0, 0.0);
    let mut forces: Vec<f64> = Vec::new();
    let mut depths: Vec<f64> = Vec::new();
    let total = ((turns + sparks) / step).round() as usize;
    let fed = (turns / step).round() as usize;
    for i in 0..total {
        let commanded = infeed * ((i + 1).min(fed) as f64 * step) - late;
        let place = i % PLACES;
        let depth = contact.depth(commanded - worn - surface[place]);
        surface[place] += depth;
        worn += contact.wear * depth * step;
        let pressed = contact.threshold > 0.0 && depth == 0.0;
        let force = if pressed {
            // The wheel leans on the work without cutting.
            ((commanded - worn - surface[place]).max(0.0) * contact.stiffness).min(contact.threshold)
        } else {
            contact.force_of(depth)
        };
        work += force * step;
        forces.push(force);
        depths.push(depth);
    }
    let last = |values: &[f64]| {
        let from = fed.saturating_sub(PLACES);
        values[from..fed].iter().sum::<f64>() / (fed - from) as f64
    };
    let steady = last(&forces);
    let crossing = forces[..fed].iter().position(|force| *force >= 0.95 * steady).unwrap_or(fed);
    Plunge {
        stock: surface.iter().sum::<f64>() / PLACES as f64,
        steady,
        depth: last(&depths),
        rise: (crossing + 1) as f64 * step,
        at_retraction: forces.last().copied().unwrap_or(0.0),
        work,
        worn,
    }
}

/// The records of a case, as CSV.
fn records(case: &Case) -> String {
    let mut text = String::from(
        "trial_id,machine,wheel_id,dressing_cycle,part_in_cycle,infeed_per_rev [um],revolutions,spark_out_revolutions,\
         work_rotation_speed [rpm],width [mm],coolant_id,wait_time [s],start_time [s],stock_removed [um],\
         normal_force [N],tangential_force [N],rise_revolutions,force_after_spark_out [N]\n",
    );
    // What a shop is does not change with its dressings.
    let mut shop = Chance::new(case.seed, 10);
    let level = |chance: &mut Chance, deviation: f64| (deviation * chance.normal()).exp();
    let (force_level, stiffness_level) = (level(&mut shop, 0.05), level(&mut shop, 0.06));
    let friction = 0.47 * level(&mut shop, 0.04);
    let machines = [level(&mut shop, 0.015), level(&mut shop, 0.015)];
    let exponent = if case.stress { 0.93 } else { 0.975 + 0.012 * shop.normal() };
    let stiffening = if case.stress { 0.06 } else { 0.01 };
    // Machines position by command since the dressing: what the wheel has worn is missing from the infeed.
    let ratio = 0.01 * case.strength("wheel_wear");
    let mut chance = Chance::new(case.seed, 10 + case.stream());
    let mut clock = [0.0_f64; 2];
    // A closure that is to be believed needs more dressings than a diagnosis.
    let (first, dressings) = match case.edges {
        Edges::Diagnosed => (1, case.times * DRESSINGS),
        Edges::New => (case.times * DRESSINGS + 1, 4 * DRESSINGS),
    };
    for dressing in 0..dressings {
        if dressing % DRESSINGS == 0 {
            clock = [0.0; 2];
        }
        let machine = dressing % 2;
        let wheel_level = level(&mut chance, SCATTER * case.scatter);
        let (mut volume, mut worn, mut part) = (0.0, 0.0, 0);
        let mut readings = [0.02, 0.02, 0.02].map(Reading::new);
        let mut stock_reading = Reading::new(0.5);
        for trial in 0..TRIALS {
            let infeed = [1.5, 2.2, 3.0, 4.43, 5.5, 7.0][chance.below(6)];
            let turns = (8 + chance.below(17)) as f64;
            let sparks = [0, 1, 2, 3, 4, 6][chance.below(6)] as f64;
            let speed = [180.0, 240.0, 292.0, 360.0][chance.below(4)];
            let wait = [5.0, 20.0, 60.0, 180.0, 600.0][chance.below(5)];
            let other_coolant = chance.uniform() < 0.4;
            let between = 1 + chance.below(5);
            part += between + 1;
            // Ordinary parts in between.
            volume += std::f64::consts::PI * WORK * 0.062 * between as f64;
            worn += ratio * WORK / WHEEL * 62.0 * between as f64;
            clock[machine] += between as f64 * 95.0 + 40.0 * chance.uniform();
            let hours = clock[machine] / 3600.0;
            let touch = if dressing % 4 < 2 { 4.0 } else { -1.0 } * case.strength("operator_touch");
            let mut force = 38.4 * force_level * wheel_level;
            force *= 1.0 + 0.33 * case.strength("wheel_dulling") * -(-volume / (1.5 * DULL)).exp_m1() * 1.5;
            if other_coolant {
                force *= 1.0 - 0.08 * case.strength("coolant_change");
            }
            force *= 1.0 + 0.10 * case.strength("day_cycle") * (hours / 3.0 * std::f64::consts::TAU).sin();
            force *= (speed / 270.0_f64).powf(-0.25 * case.strength("speed_force"));
            if chance.uniform() < 0.3 {
                force *= 1.0 + 0.10 * case.strength("loaded_wheel") * chance.delay(1.0);
            }
            let mut stiffness = 31.0 * stiffness_level * machines[machine];
            // Warm bearings give way towards a limit.
            stiffness *= 1.0 - 0.03 * case.strength("stiffness_drift") * 12.0 * -(-hours / 12.0).exp_m1();
            if machine == 1 {
                stiffness *= 1.0 - 0.20 * case.strength("machine_offset");
            }
            let contact = Contact {
                stiffness,
                force,
                exponent: exponent - 0.15 * case.strength("size_effect"),
                threshold: 12.0 * case.strength("threshold_force"),
                stiffening,
                wear: ratio * WORK / WHEEL,
            };
            let late = 3.0 * case.strength("start_offset") + touch + worn;
            let left = plunge(&contact, infeed, turns, sparks, late);
            volume += std::f64::consts::PI * WORK * left.stock / 1000.0;
            worn += left.worn;
            let cooling = 0.7 * (-wait / 45.0_f64).exp() + 0.3 * (-wait / 120.0_f64).exp();
            let warm = 7e-4 * case.strength("thermal_growth") * left.work * cooling;
            let stock = left.stock - warm + stock_reading.next(&mut chance);
            let noisy = |value: f64, reading: &mut Reading, chance: &mut Chance| value * reading.next(chance).exp();
            let normal = noisy(left.steady, &mut readings[0], &mut chance);
            let along = friction * left.steady * (left.depth.max(0.1) / DEPTH).powf(-0.015);
            let tangential = noisy(along, &mut readings[1], &mut chance);
            let rise = left.rise + 0.1 * chance.normal();
            let end = noisy(left.at_retraction, &mut readings[2], &mut chance) + chance.normal();
            let end = if sparks > 0.0 { format!("{:.1}", end.max(0.0)) } else { String::new() };
            let _ = writeln!(
                text,
                "{id},G{machine},W{machine},{name},{part},{infeed},{turns},{sparks},{speed},20,{coolant},{wait},\
                 {start:.0},{stock:.1},{normal:.1},{tangential:.1},{rise:.2},{end}",
                id = dressing * TRIALS + trial + 1,
                machine = machine + 1,
                name = dressing + first,
                coolant = if other_coolant { "B" } else { "A" },
                start = clock[machine],
            );
            clock[machine] += (turns + sparks) / speed * 60.0 + wait + 45.0;
        }
        clock[machine] += 180.0;
    }
    text
}
