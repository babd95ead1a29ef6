//! Side milling: twelve end mills on two machines, five part types, three lots.
//!
//! Teeth are followed through the cut one by one: the chip of each is what the teeth before it left, its force a
//! power of the chip's thickness; a mill wears by rubbing and, faster when it is hot, by heat.

use crate::noise::{Chance, Reading};
use crate::{Case, Edges, Generator};
use std::f64::consts::{PI, TAU};
use std::fmt::Write;

/// Mills of a data set.
const TOOLS: usize = 12;
/// Cuts of a mill.
const CUTS: usize = 14;

/// A cut in the trade's units: m/min, mm, mm, mm; curvature of the path, 1/m; minutes.
#[derive(Clone, Copy, Debug)]
struct Cut {
    speed: f64,
    feed: f64,
    depth: f64,
    width: f64,
    curvature: f64,
    minutes: f64,
}

const PARTS: [Cut; 5] = [
    Cut { speed: 160.0, feed: 0.05, depth: 12.0, width: 3.0, curvature: 0.0, minutes: 5.0 },
    Cut { speed: 182.0, feed: 0.06, depth: 9.0, width: 2.0, curvature: 50.0, minutes: 4.0 },
    Cut { speed: 140.0, feed: 0.072, depth: 11.0, width: 2.4, curvature: 25.0, minutes: 6.0 },
    Cut { speed: 170.0, feed: 0.04, depth: 14.0, width: 3.6, curvature: 0.0, minutes: 3.5 },
    Cut { speed: 150.0, feed: 0.052, depth: 8.0, width: 4.6, curvature: 66.0, minutes: 4.5 },
];

/// The shop with two mills.
pub const GENERATOR: Generator = Generator { process: "milling", effects: &EFFECTS, outside: &OUTSIDE, records };

const EFFECTS: [(&str, f64); 16] = [
    ("wear_force", 0.20),
    ("wear_acceleration", 1.0),
    ("run_in", 1.5),
    ("lot_hardness", 0.08),
    ("built_up_edge", 0.6),
    ("force_drift", 0.012),
    ("force_bias", 30.0),
    ("spindle_loss", 0.15),
    ("runout", 8.0),
    ("stock_offset", 0.3),
    ("helix_form_error", 0.5),
    ("servo_lag", 0.5),
    ("crawl_wear", 1.5),
    ("chipping", 0.6),
    ("operator_delay", 25.0),
    ("tool_change_delay", 40.0),
];

const OUTSIDE: [&str; 6] =
    ["day_cycle", "chip_recutting", "machine_offset", "entry_shock", "fixture_drag", "soft_fixture"];

/// Diameter, mm, and teeth of the mills.
const DIAMETER: f64 = 12.0;
const TEETH: usize = 4;
/// Steps of the angle through the cut.
const ANGLES: usize = 40;
/// Steps of wear through a cut.
const STEPS: usize = 24;
/// Scatter of wear from mill to mill, standard deviation of the logarithm.
const SCATTER: f64 = 0.10;
/// Land at which the operator takes a mill out, mm.
const WORN_OUT: f64 = 0.33;

/// Constants of the work and the machines' structure.
struct World {
    /// Force of a chip 1 mm thick, N/mm, across its exponents: along and across the edge.
    along: (f64, f64),
    across: (f64, f64),
    /// Force of the land, N/mm².
    land: (f64, f64),
    /// N/um.
    stiffness: f64,
    /// Steepness of wear in heat.
    heat: f64,
}

impl World {
    fn new(stress: bool) -> Self {
        if stress {
            Self { along: (1650.0, 0.70), across: (620.0, 0.58), land: (300.0, 650.0), stiffness: 9.6, heat: 13.0 }
        } else {
            Self { along: (1500.0, 0.78), across: (476.0, 0.65), land: (250.0, 600.0), stiffness: 9.6, heat: 9.5 }
        }
    }

    /// Mean force of a turn, N: against the teeth, along the feed, off the wall.
    fn forces(&self, cut: &Cut, runout: f64, land: f64, hard: f64) -> [f64; 3] {
        let exit = (1.0 - 2.0 * cut.width / DIAMETER).max(-1.0).acos();
        let offset = |tooth: usize| runout * (TAU * (tooth as f64 + 0.5) / TEETH as f64).sin();
        let mut sums = [0.0; 3];
        for tooth in 0..TEETH {
            for step in 0..ANGLES {
                let angle = exit * (step as f64 + 0.5) / ANGLES as f64;
                // What the teeth before this one have left.
                let chip = (1..=TEETH)
                    .map(|back| {
                        let before = (tooth + TEETH - back) % TEETH;
                        back as f64 * cut.feed * angle.sin() + offset(tooth) - offset(before)
                    })
                    .fold(f64::INFINITY, f64::min);
                if chip <= 0.0 {
                    continue;
                }
                let along = hard * self.along.0 * chip.powf(self.along.1) + self.land.0 * land;
                let across = hard * self.across.0 * chip.powf(self.across.1) + self.land.1 * land.powf(0.97);
                sums[0] += along;
                // Climb milling.
                sums[1] += across * angle.sin() - along * angle.cos();
                sums[2] += across * angle.cos() + along * angle.sin();
            }
        }
        sums.map(|sum| sum * cut.depth * exit / (ANGLES as f64 * TAU))
    }

    /// Rate of wear, mm/min, of a land of `land` mm; `chip` is the thickest chip over the nominal one.
    fn wear_rate(&self, cut: &Cut, land: f64, chip: f64, hard: f64) -> f64 {
        let arc = (1.0 - 2.0 * cut.width / DIAMETER).max(-1.0).acos() / (PI / 3.0);
        let (speed, feed, depth) = (cut.speed / 167.4, cut.feed / 0.05 * chip, cut.depth / 12.0);
        let rubbing = 0.45 * hard * speed.powf(1.2) * feed.powf(0.25) * depth.powf(0.9) * arc.powf(1.1);
        let warmth = speed.powf(0.4) * feed.powf(0.05) * arc.powf(0.13);
        let hot = 0.55 * depth * (self.heat * (warmth - 1.0)).exp();
        let stage = 0.76 + 1.33 * (-land / 0.035).exp() + 1.24 * ((land - 0.32) / 0.05).exp();
        0.3 / 60.0 * (rubbing + hot) * stage
    }
}

/// What surrounds a cut.
struct Around<'a> {
    case: &'a Case,
    world: &'a World,
    cut: Cut,
    hard: f64,
    crawl: bool,
    factor: f64,
    chip: f64,
}

impl Around<'_> {
    /// A triangle of speeds in which material builds up.
    fn built_up(&self) -> f64 {
        (1.0 - (self.cut.speed - 146.0).abs() / 18.0).max(0.0) * self.case.strength("built_up_edge")
    }

    fn rate(&self, land: f64, minutes: f64) -> f64 {
        let case = self.case;
        let mut rate = self.world.wear_rate(&self.cut, land, self.chip, self.hard) * self.factor;
        rate *= 1.0 + case.strength("wear_acceleration") * ((land / 0.3).exp() - 1.0 - land / 0.3) / 0.718;
        rate *= 1.0 + 1.5 * case.strength("run_in") * (-minutes / 4.0).exp();
        rate *= 1.0 + 0.6 * self.built_up();
        // A form error of 2 % is a wear curve that is a quarter faster late in life.
        rate *= 1.0 + 12.5 * case.form * 0.5 * (1.0 + ((land - 0.2) / 0.03).tanh());
        if self.crawl {
            rate *= 1.0 + 1.5 * case.strength("crawl_wear");
        }
        rate
    }
}

/// The records of a case, as CSV.
fn records(case: &Case) -> String {
    let mut text = String::from(
        "operation_id,machine,tool_id,sequence,start_time [s],lot,part_type,operator,shift,cutting_speed [m/min],\
         feed_per_tooth [mm],depth_of_cut [mm],width_of_cut [mm],cutting_time [min],spindle_speed [rpm],\
         path_length [mm],path_curvature [1/m],helical_deviation [um],feed_override [%],flank_wear [mm],\
         cutting_force [N],feed_force [N],spindle_power [kW],form_error [um],roughness_ra [um],cycle_time [s],\
         stop_count\n",
    );
    // What a shop is does not change with its mills.
    let mut shop = Chance::new(case.seed, 20);
    let level = |chance: &mut Chance, deviation: f64| (deviation * chance.normal()).exp();
    let (force_level, across_level) = (level(&mut shop, 0.05), level(&mut shop, 0.04));
    let (wear_level, stiffness_level) = (level(&mut shop, 0.10), level(&mut shop, 0.05));
    let rough_level = level(&mut shop, 0.15);
    let handling = 70.0 + 20.0 * shop.uniform();
    let gains = [level(&mut shop, 0.01), level(&mut shop, 0.01)];
    let mut chance = Chance::new(case.seed, 20 + case.stream());
    let mut world = World::new(case.stress);
    world.across.0 *= across_level;
    let mut clock = [0.0_f64; 2];
    // A closure that is to be believed needs more mills than a diagnosis.
    let (first, tools) = match case.edges {
        Edges::Diagnosed => (1, TOOLS),
        Edges::New => (TOOLS + 1, 4 * TOOLS),
    };
    for tool in 0..tools {
        if tool % TOOLS == 0 {
            clock = [0.0; 2];
        }
        let machine = tool % 2;
        let factor = wear_level * level(&mut chance, SCATTER * case.scatter);
        let own_force = force_level * level(&mut chance, 0.015);
        let (mut land, mut minutes) = (0.0_f64, 0.0_f64);
        let mut readings = [0.02, 0.03, 0.02, 0.012, 0.05].map(Reading::new);
        let mut wear_reading = Reading::new(0.005);
        let bears = chance.delay(1.0);
        let mut hazard = 0.0;
        for operation in 0..CUTS {
            let part = chance.below(PARTS.len());
            let mut cut = PARTS[part];
            cut.minutes *= 0.9 + 0.2 * chance.uniform();
            // Programmes of one part differ.
            cut.speed *= [0.88, 1.0, 1.0, 1.1][chance.below(4)];
            cut.feed *= [0.9, 1.0, 1.15][chance.below(3)];
            let planned = cut;
            cut.width += 0.3 * case.strength("stock_offset");
            let hours = clock[machine] / 3600.0;
            let crawl = chance.uniform() < 0.06;
            let lot = ((hours / 2.5) as usize + machine) % 3;
            let hard = if lot == 1 { 1.0 + 0.08 * case.strength("lot_hardness") } else { 1.0 };
            let runout = 8e-3 * case.strength("runout");
            let thickest = cut.feed * (1.0 - 2.0 * cut.width / DIAMETER).max(0.0).acos().sin();
            let heavier = (2.0 * runout * (PI / TEETH as f64).sin()).min(3.0 * thickest);
            let day = (hours / 24.0 * 7.0 * TAU).sin() * case.strength("day_cycle");
            let around = Around {
                case,
                world: &world,
                cut,
                hard,
                crawl,
                factor: factor * (1.0 + 0.15 * day),
                chip: 1.0 + heavier / thickest,
            };
            let mut mean = [0.0; 3];
            let dt = cut.minutes / STEPS as f64;
            for _ in 0..STEPS {
                let k1 = around.rate(land, minutes);
                let k2 = around.rate(land + 0.5 * dt * k1, minutes + 0.5 * dt);
                let k3 = around.rate(land + 0.5 * dt * k2, minutes + 0.5 * dt);
                let k4 = around.rate(land + dt * k3, minutes + dt);
                land = (land + dt * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0).min(1.0);
                minutes += dt;
                let forces = world.forces(&cut, runout, land, hard);
                let worn = 1.0 + 0.20 * case.strength("wear_force") * (land / 0.3).powf(1.1);
                let change = worn * (1.0 - 0.18 * around.built_up()) * own_force / STEPS as f64;
                mean.iter_mut().zip(forces).for_each(|(mean, force)| *mean += force * change);
            }
            land += 0.004 * case.strength("entry_shock") * cut.depth / 12.0;
            let [mut against, along, off_wall] = mean;
            if chance.uniform() < 0.4 && cut.width > 2.8 {
                against *= 1.0 + 0.12 * case.strength("chip_recutting") * chance.delay(1.0);
            }
            if machine == 1 {
                against *= 1.0 + 0.05 * case.strength("machine_offset");
            }
            let mut power = against * gains[machine] * cut.speed / 60.0 / 1000.0;
            power += 0.15 * case.strength("spindle_loss") * (cut.speed / 200.0).powf(2.2);
            if part == 3 {
                power += 0.20 * case.strength("fixture_drag");
            }
            let drift = 1.0 + 0.12 * case.strength("force_drift") * -(-hours / 10.0).exp_m1();
            let read_force = against * drift + 30.0 * case.strength("force_bias");
            let read_feed = along * drift;
            let turns = cut.speed * 1000.0 / (PI * DIAMETER);
            let feed_rate = turns * TEETH as f64 * cut.feed;
            // Where along the axis the wall is gauged, and how far its wave stands off the mean there.
            let height = [0.1, 0.3, 0.5, 0.7, 0.9][chance.below(5)];
            let wave = 9.0 * (cut.width / 3.0).powf(0.5) * ((TAU * height).cos() * 0.6 + 0.5 - height);
            let slack = 14.0 * if part == 4 { case.strength("soft_fixture") } else { 0.0 };
            let metres = feed_rate / 60.0 / 1000.0;
            let corner = 0.5 * case.strength("servo_lag") * metres * metres * cut.curvature / (2.0 * 30.0 * 30.0) * 1e6;
            let bent = off_wall / (world.stiffness * stiffness_level);
            let form = bent + slack + 0.5 * case.strength("helix_form_error") * wave + corner * (1.0 - 0.1 * height);
            let scallop = |feed: f64| feed * feed / (4.0 * DIAMETER);
            let marks = (scallop(cut.feed) + 2.0 * runout).min(scallop(cut.feed * TEETH as f64));
            let mut cycle = handling + cut.minutes * 60.0 + 2.0 * chance.normal();
            let night = (hours / 1.5) as usize % 2 == 1;
            if night {
                cycle += chance.delay(25.0) * case.strength("operator_delay");
            }
            if operation == 0 {
                cycle += chance.delay(40.0) * case.strength("tool_change_delay");
            }
            // A mill that chips is changed at once.
            let kilometres = cut.speed * cut.minutes / 1000.0 * 0.17;
            hazard += (0.6 * case.strength("chipping") * kilometres).powf(1.0) * (0.5 + land / 0.2);
            let chipped = case.strength("chipping") > 0.0 && hazard > bears;
            let noisy = |value: f64, reading: &mut Reading, chance: &mut Chance| value * reading.next(chance).exp();
            let wear_read = ((land + wear_reading.next(&mut chance)).max(0.0) * 100.0).round() / 100.0;
            let form_read = noisy(form, &mut readings[3], &mut chance) + 0.5 * chance.normal();
            let _ = writeln!(
                text,
                "{id},M{machine},E{name:02},{sequence},{start:.0},{lot},P{part},{operator},{shift},{speed:.1},{feed:.4},\
                 {depth},{width},{minutes:.4},{turns:.0},{path:.0},{curvature},{wave:.2},{overridden},{wear_read:.2},\
                 {f:.2},{ff:.2},{p:.5},{form_read:.2},{ra:.5},{cycle:.1},{stops}",
                id = tool * CUTS + operation + 1,
                machine = machine + 1,
                name = tool + first,
                sequence = operation + 1,
                start = clock[machine],
                lot = ["A", "B", "C"][lot],
                operator = if night { "Y" } else { "X" },
                shift = if night { "night" } else { "day" },
                speed = planned.speed,
                feed = planned.feed,
                depth = planned.depth,
                width = planned.width,
                minutes = planned.minutes,
                path = feed_rate * cut.minutes,
                curvature = cut.curvature,
                overridden = if crawl { 20 } else { 100 },
                f = noisy(read_force, &mut readings[0], &mut chance),
                ff = noisy(read_feed, &mut readings[1], &mut chance),
                p = noisy(power, &mut readings[2], &mut chance),
                ra = noisy(marks / 4.0 * 1000.0 * rough_level, &mut readings[4], &mut chance),
                stops = usize::from(chipped),
            );
            if land > WORN_OUT || chipped {
                break;
            }
            clock[machine] += cycle + 30.0 * chance.uniform();
        }
    }
    text
}
