//! A turning cell: twelve edges, two machines, five part types, three lots.

use crate::form::FormError;
use crate::noise::{Chance, Reading};
use crate::steel::{Cut, ROOM, World};
use crate::{Case, Edges, Generator};
use std::fmt::Write;

/// Edges of a data set.
pub const TOOLS: usize = 12;
/// Operations of an edge.
pub const OPERATIONS: usize = 14;

/// Part types: speed m/min, feed mm, depth mm, time min.
const PARTS: [(Cut, f64); 5] = [
    (Cut { speed: 165.0, feed: 0.25, depth: 1.5 }, 3.0),
    (Cut { speed: 190.0, feed: 0.30, depth: 1.2 }, 2.2),
    (Cut { speed: 210.0, feed: 0.20, depth: 2.0 }, 1.6),
    (Cut { speed: 225.0, feed: 0.30, depth: 1.5 }, 2.6),
    (Cut { speed: 180.0, feed: 0.38, depth: 1.0 }, 4.0),
];

/// The cell.
pub const GENERATOR: Generator = Generator { process: "turning", effects: &EFFECTS, outside: &OUTSIDE, records };

const EFFECTS: [(&str, f64); 20] = [
    ("wear_force", 0.20),
    ("wear_temperature", 0.10),
    ("wear_acceleration", 1.0),
    ("run_in", 1.5),
    ("thermal_heredity", 1.0),
    ("lot_hardness", 0.08),
    ("built_up_edge", 0.6),
    ("thermal_softening", 0.12),
    ("coolant_ageing", 0.0006),
    ("force_drift", 0.009),
    ("force_bias", 40.0),
    ("temperature_lag", 60.0),
    ("spindle_loss", 0.25),
    ("crawl_wear", 1.5),
    ("runout", 30.0),
    ("chuck_stiffness", 0.15),
    ("process_damping", 3e5),
    ("chipping", 0.12),
    ("operator_delay", 25.0),
    ("tool_change_delay", 40.0),
];

const OUTSIDE: [&str; 5] = ["day_cycle", "chip_jam", "machine_offset", "interrupted_cut", "fixture_drag"];

/// Scatter of wear from edge to edge, standard deviation of the logarithm.
const SCATTER: f64 = 0.10;
/// Land at which the operator takes an edge out, mm.
const WORN_OUT: f64 = 0.45;
/// Land of an edge that has broken, mm.
const BROKEN: f64 = 1.0;
/// Rise at which steel melts away under the edge, K.
const MOLTEN: f64 = 1150.0;
/// Nose radius, mm.
const NOSE: f64 = 0.8;

/// State of an edge.
#[derive(Clone, Copy, Default)]
struct Edge {
    wear: f64,
    minutes: f64,
    damage: f64,
}

/// What surrounds an operation.
struct Around<'a> {
    case: &'a Case,
    world: World,
    cut: Cut,
    lot: usize,
    coolant_hours: f64,
    hours: f64,
    crawl: bool,
    factor: f64,
    form: &'a FormError,
}

impl Around<'_> {
    fn rise(&self, edge: &Edge) -> f64 {
        let case = self.case;
        let plain = self.world.rise(self.cut, edge.wear) * self.form.temperature(self.cut, edge.wear);
        // The land heats, faster at first than in proportion.
        let land = 1.0 + 0.10 * case.strength("wear_temperature") * (edge.wear / 0.3).powf(0.9);
        // Oil and dirt gather towards a limit.
        let old = 1.0 + 0.09 * case.strength("coolant_ageing") * -(-self.coolant_hours / 120.0).exp_m1();
        let day = 1.0 + 0.025 * case.strength("day_cycle") * (self.hours / 24.0 * std::f64::consts::TAU).sin();
        (plain * land * old * day).min(MOLTEN)
    }

    /// Root mean square of the vibration, um, and roughness, um, at a cutting force, N.
    fn surface(&self, force: f64, wear: f64) -> (f64, f64) {
        let case = self.case;
        let turns = self.cut.speed / 0.17;
        let shaken = 0.004 * force * (1.0 + 0.3 * case.strength("runout") / self.cut.depth);
        let near = (-((turns - 1150.0) / 90.0).powi(2)).exp();
        let lobed = 1.0 + 1.2 * case.strength("chuck_stiffness") * near;
        let rubbed = 1.0 + 0.35 * case.strength("process_damping") * (wear + 0.05) * 200.0 / self.cut.speed;
        let marks = 1000.0 * self.cut.feed.powf(1.93) * 0.32_f64.powf(0.07) / (32.0 * NOSE) + 0.15 + 0.5 * wear;
        (shaken * lobed / rubbed, marks)
    }

    fn lot_factor(&self) -> f64 {
        if self.lot == 1 { 1.0 + 0.08 * self.case.strength("lot_hardness") } else { 1.0 }
    }

    /// A triangle of speeds in which material builds up.
    fn built_up(&self) -> f64 {
        (1.0 - (self.cut.speed - 172.0).abs() / 22.0).max(0.0) * self.case.strength("built_up_edge")
    }

    /// mm/min, and change of the memory of heat per minute.
    fn rates(&self, edge: &Edge) -> (f64, f64) {
        let case = self.case;
        let rise = self.rise(edge);
        let (abrasion, diffusion) = self.world.wear_rates(self.cut, edge.wear, rise);
        let heredity = 1.0 + case.strength("thermal_heredity") * edge.damage;
        let mut rate = abrasion * self.lot_factor() * heredity + diffusion;
        rate *= 1.0 + case.strength("wear_acceleration") * ((edge.wear / 0.3).exp() - 1.0 - edge.wear / 0.3) / 0.718;
        rate *= 1.0 + 1.5 * case.strength("run_in") * (-edge.minutes / 4.0).exp();
        rate *= 1.0 + 0.6 * self.built_up();
        if self.crawl {
            rate *= 1.0 + 1.5 * case.strength("crawl_wear");
        }
        let hot = ((rise - 850.0) / 60.0).exp();
        if self.case.strength("runout") > 0.0 {
            // A blank that runs out knocks on the edge once a turn.
            rate *= 1.0 + 0.03 * self.case.strength("runout") * 1.5 / self.cut.depth;
        }
        rate *= self.form.wear_rate(self.cut, edge.wear);
        (rate * self.factor, 0.5 * hot * (1.0 - edge.damage) - edge.damage * rate / 0.03)
    }
}

/// The records of a case, as CSV.
fn records(case: &Case) -> String {
    let mut text = String::from(
        "operation_id,machine,tool_id,sequence,start_time [s],lot,part_type,operator,shift,coolant_age [h],\
         cutting_speed [m/min],feed_per_rev [mm],depth_of_cut [mm],cutting_time [min],feed_override [%],\
         flank_wear [mm],cutting_force [N],feed_force [N],spindle_power [kW],temperature [K],vibration_rms [um],\
         roughness_ra [um],cycle_time [s],stop_count\n",
    );
    // What a shop is does not change with its edges.
    let mut shop = Chance::new(case.seed, 0);
    let level = |chance: &mut Chance, deviation: f64| (deviation * chance.normal()).exp();
    let (force_level, feed_level) = (level(&mut shop, 0.05), level(&mut shop, 0.05));
    let (wear_level, warm_level) = (level(&mut shop, 0.10), level(&mut shop, 0.02));
    let handling = 60.0 + 20.0 * shop.uniform();
    let gains = [level(&mut shop, 0.01), level(&mut shop, 0.01)];
    let (rough_level, shaken_level) = (level(&mut shop, 0.12), level(&mut shop, 0.2));
    let mut chance = Chance::new(case.seed, case.stream());
    let world = World::new(case.stress);
    let form = FormError::new(case);
    let mut clock = [0.0_f64; 2];
    // A closure that is to be believed needs more edges than a diagnosis.
    let (first, tools) = match case.edges {
        Edges::Diagnosed => (1, case.times * TOOLS),
        Edges::New => (case.times * TOOLS + 1, 2 * TOOLS),
    };
    for tool in 0..tools {
        if tool % TOOLS == 0 {
            clock = [0.0; 2];
        }
        let machine = tool % 2;
        let factor = wear_level * level(&mut chance, SCATTER * case.scatter);
        let own_force = force_level * level(&mut chance, 0.015);
        let mut edge = Edge::default();
        let mut readings = [0.02, 0.03, 0.02, 0.015, 0.08, 0.05].map(Reading::new);
        let mut wear_reading = Reading::new(0.005);
        let (bears, mut hazard) = (chance.delay(1.0), 0.0);
        for operation in 0..OPERATIONS {
            let part = chance.below(PARTS.len());
            let (cut, nominal_minutes) = PARTS[part];
            let minutes = nominal_minutes * (0.9 + 0.2 * chance.uniform());
            let hours = clock[machine] / 3600.0;
            let crawl = chance.uniform() < 0.06;
            let around = Around {
                case,
                world,
                cut,
                lot: ((hours / 2.5) as usize + machine) % 3,
                coolant_hours: (hours * 20.0) % 160.0,
                hours: hours * 7.0,
                crawl,
                factor,
                form: &form,
            };
            let (mut force, mut feed, mut warm) = (0.0, 0.0, 0.0);
            const STEPS: usize = 24;
            let dt = minutes / STEPS as f64;
            for _ in 0..STEPS {
                let slope = |edge: &Edge| around.rates(edge);
                let shifted = |rates: (f64, f64), dt: f64| Edge {
                    wear: (edge.wear + rates.0 * dt).min(BROKEN),
                    minutes: edge.minutes + dt,
                    damage: (edge.damage + rates.1 * dt).clamp(0.0, 1.0),
                };
                let k1 = slope(&edge);
                let k2 = slope(&shifted(k1, 0.5 * dt));
                let k3 = slope(&shifted(k2, 0.5 * dt));
                let k4 = slope(&shifted(k3, dt));
                let mean = |a: f64, b: f64, c: f64, d: f64| (a + 2.0 * b + 2.0 * c + d) / 6.0;
                edge = shifted((mean(k1.0, k2.0, k3.0, k4.0), mean(k1.1, k2.1, k3.1, k4.1)), dt);
                let (main, along) = world.forces(cut, edge.wear);
                let [main, along] = form.forces(cut, edge.wear, [main, along]);
                let rise = around.rise(&edge);
                let soft = 1.0 - 0.12 * case.strength("thermal_softening") * ((rise - 700.0) / 500.0).tanh();
                let worn = 1.0 + 0.20 * case.strength("wear_force") * (edge.wear / 0.3).powf(1.1);
                let sticking = 1.0 - 0.18 * around.built_up();
                let change = soft * worn * sticking * around.lot_factor();
                force += main * change / STEPS as f64;
                feed += along * change / STEPS as f64;
                warm += rise / STEPS as f64;
            }
            if case.strength("interrupted_cut") > 0.0 {
                // Each entry costs a little of the edge.
                edge.wear += 0.004 * case.strength("interrupted_cut") * cut.depth;
            }
            let mut true_force = force * own_force;
            let true_feed = feed * own_force * feed_level / force_level;
            if case.strength("chip_jam") > 0.0 && cut.feed < 0.28 && chance.uniform() < 0.5 {
                true_force *= 1.0 + 0.12 * case.strength("chip_jam") * chance.delay(1.0);
            }
            if machine == 1 {
                true_force *= 1.0 + 0.045 * case.strength("machine_offset");
            }
            let mut power = true_force * gains[machine] * cut.speed / 60.0 / 1000.0;
            power += 0.25 * case.strength("spindle_loss") * (cut.speed / 200.0).powf(2.2);
            if part == 3 {
                power += 0.35 * case.strength("fixture_drag");
            }
            let drift = 1.0 + 0.10 * case.strength("force_drift") * -(-hours / 8.0).exp_m1();
            let read_force = true_force * drift + 40.0 * case.strength("force_bias");
            let read_feed = true_feed * drift;
            let lag = 60.0 * case.strength("temperature_lag") * (-minutes * 60.0 / 80.0).exp();
            let read_warm = ROOM + warm * warm_level - lag;
            let mut cycle = handling + minutes * 60.0 + 2.0 * chance.normal();
            let night = (hours / 1.5) as usize % 2 == 1;
            if night {
                cycle += chance.delay(25.0) * case.strength("operator_delay");
            }
            if operation == 0 {
                cycle += chance.delay(40.0) * case.strength("tool_change_delay");
            }
            let (shaken, marks) = around.surface(true_force, edge.wear);
            // An edge that chips is changed at once.
            hazard += 0.12 * case.strength("chipping") * cut.speed * minutes / 1000.0 * (0.5 + edge.wear / 0.2);
            let chipped = case.strength("chipping") > 0.0 && hazard > bears;
            let noisy = |value: f64, reading: &mut Reading, chance: &mut Chance| value * reading.next(chance).exp();
            let wear_read = ((edge.wear + wear_reading.next(&mut chance)).max(0.0) * 100.0).round() / 100.0;
            let _ = writeln!(
                text,
                "{id},L{machine},T{name:02},{sequence},{start:.0},{lot},P{part},{operator},{shift},{age:.2},{speed},{feed_set},{depth},{minutes:.4},{overridden},{wear_read:.2},{f:.2},{ff:.2},{p:.5},{t:.2},{rms:.3},{ra:.3},{cycle:.1},{stops}",
                id = tool * OPERATIONS + operation + 1,
                machine = machine + 1,
                name = tool + first,
                sequence = operation + 1,
                start = clock[machine],
                lot = ["A", "B", "C"][around.lot],
                operator = if night { "Y" } else { "X" },
                shift = if night { "night" } else { "day" },
                age = around.coolant_hours,
                speed = cut.speed,
                feed_set = cut.feed,
                depth = cut.depth,
                overridden = if crawl { 20 } else { 100 },
                f = noisy(read_force, &mut readings[0], &mut chance),
                ff = noisy(read_feed, &mut readings[1], &mut chance),
                p = noisy(power, &mut readings[2], &mut chance),
                t = noisy(read_warm, &mut readings[3], &mut chance),
                rms = noisy(shaken * shaken_level, &mut readings[4], &mut chance),
                ra = noisy(marks * rough_level, &mut readings[5], &mut chance),
                stops = usize::from(chipped),
            );
            if edge.wear > WORN_OUT || chipped {
                break;
            }
            edge.damage *= 0.9;
            clock[machine] += cycle + 30.0 * chance.uniform();
        }
    }
    text
}
