//! Turning operations and milling cuts. The log keeps what a pass ends with; means over the cut
//! follow from the process itself, driven over each pass between the wear that the log knows, and
//! brought to the end that the log knows.

use crate::{Run, edge_name};
use toolroom_kernel::{Entity, Purpose};
use toolroom_process::{Field, MachineProcess, watched};
use toolroom_records::{RecordKind, Records};
use toolroom_scenario::{Cut, Work, lot_name};
use toolroom_shop::Refusal;
use toolroom_shop::runlog::{ChangeReason, LogEvent, PassRow};

/// The start of a cut that means leave out, s.
const LEFT_OUT: f64 = 20.0;
/// Points of a mean.
const POINTS: usize = 8;
/// Events that a pass may go through on its way.
const EVENTS: usize = 4;
/// Temperature of 0 °C, K.
const ICE: f64 = 273.15;
/// Channels that are means over the cut.
const MEANS: [&str; 5] = ["cutting_force", "feed_force", "spindle_power", "temperature", "thermo_emf"];

/// Rows of turning or milling.
pub fn records(run: &Run<'_>, kind: RecordKind) -> Result<Records, Box<Refusal>> {
    let name = if kind == RecordKind::Milling { "milling" } else { "turning" };
    let mut rows: Vec<usize> = (0..run.log.passes.len()).filter(|at| run.process(*at).name() == name).collect();
    rows.retain(|at| run.log.passes[*at].cutting_time > 0.0 && programmed(run, &run.log.passes[*at]).is_some());
    rows.sort_by(|a, b| {
        let (a, b) = (&run.log.passes[*a], &run.log.passes[*b]);
        a.edge.cmp(&b.edge).then(a.start.total_cmp(&b.start))
    });
    let passes: Vec<&PassRow> = rows.iter().map(|at| &run.log.passes[*at]).collect();
    let mut records = Records::new(kind, passes.len());
    conditions(run, &passes, &mut records);
    let mut means: Vec<Vec<f64>> = vec![Vec::with_capacity(passes.len()); MEANS.len()];
    let mut start = 0;
    while start < passes.len() {
        let end = start + passes[start..].iter().take_while(|pass| pass.edge == passes[start].edge).count();
        for mean in of_edge(run, &passes[start..end], &rows[start..end])? {
            means.iter_mut().zip(mean).for_each(|(values, value)| values.push(value));
        }
        start = end;
    }
    for (channel, values) in MEANS.iter().zip(&means) {
        run.channel(&mut records, channel, values);
    }
    let positive = |value: f64| if value > 0.0 { value } else { f64::NAN };
    let of_passes = |value: &dyn Fn(&PassRow) -> f64| passes.iter().map(|pass| value(pass)).collect::<Vec<f64>>();
    run.channel(&mut records, "flank_wear", &of_passes(&|pass| pass.flank_wear_end));
    let root = std::f64::consts::SQRT_2;
    run.channel(&mut records, "vibration_rms", &of_passes(&|pass| positive(pass.vibration_amplitude / root)));
    run.channel(&mut records, "roughness_ra", &of_passes(&|pass| positive(pass.roughness)));
    times(run, &rows, &mut records);
    if passes.iter().any(|pass| !pass.stability_margin.is_nan()) {
        chatter(run, &passes, &mut records);
    }
    Ok(records)
}

/// What was heard of chatter: 1 where it set in, 0 in a stable cut; nothing is known of a cut that was unstable for too short a
/// time to be heard, and of tools without a structure. Beside that how fast the spindle turned, and where along the work
/// the pass began.
fn chatter(run: &Run<'_>, passes: &[&PassRow], records: &mut Records) {
    let onsets: Vec<(u32, f64)> = run
        .log
        .events
        .iter()
        .filter(|event| event.event == LogEvent::ChatterOnset)
        .filter_map(|event| Some((event.machine?, event.time)))
        .collect();
    let set_in = |pass: &PassRow| {
        let within = |(machine, time): &(u32, f64)| *machine == pass.machine && (pass.start..=pass.end).contains(time);
        onsets.iter().any(within)
    };
    let heard = |pass: &&PassRow| {
        if pass.stability_margin.is_nan() {
            f64::NAN
        } else if set_in(pass) {
            1.0
        } else if pass.chatter_time > 0.0 {
            f64::NAN
        } else {
            0.0
        }
    };
    let heard: Vec<f64> = passes.iter().map(heard).collect();
    let known = |(pass, heard): (&&PassRow, &f64)| {
        if *heard == 1.0 && pass.chatter_frequency > 0.0 { pass.chatter_frequency } else { f64::NAN }
    };
    let frequencies: Vec<f64> = passes.iter().zip(&heard).map(known).collect();
    if frequencies.iter().any(|frequency| frequency.is_finite()) {
        let readings = run.readings(records.kind, "chatter_frequency", &frequencies);
        records.set_numbers("chatter_frequency", readings);
    }
    records.set_numbers("chatter", heard);
    let work = |pass: &PassRow| programmed(run, pass).unwrap_or_default();
    if records.kind == RecordKind::Turning {
        let speeds = records.numbers("cutting_speed").map_or_else(Vec::new, <[f64]>::to_vec);
        let turned = |(pass, speed): (&&PassRow, f64)| {
            let diameter = work(pass).diameter;
            if diameter > 0.0 { 2.0 * speed / diameter } else { f64::NAN }
        };
        records.set_numbers("spindle_speed", passes.iter().zip(speeds).map(turned).collect());
        let places: Vec<f64> = passes.iter().map(|pass| work(pass).position).collect();
        if places.iter().any(|place| *place > 0.0) {
            let place = |place: f64| if place > 0.0 { place } else { f64::NAN };
            records.set_numbers("position", places.into_iter().map(place).collect());
        }
    }
}

/// What was commanded, and where.
fn conditions(run: &Run<'_>, passes: &[&PassRow], records: &mut Records) {
    let milling = records.kind == RecordKind::Milling;
    let mut sequence = vec![0.0; passes.len()];
    for row in 1..passes.len() {
        sequence[row] = if passes[row].edge == passes[row - 1].edge { sequence[row - 1] + 1.0 } else { 0.0 };
    }
    let id = |row: usize| {
        let pass = passes[row];
        let operation = run.operation_id(pass.job, pass.part, pass.operation);
        let work = &run.scenario.parts[pass.part as usize].operations[pass.operation as usize].work;
        if work.passes() > 1 { format!("{operation}/{}", pass.pass + 1) } else { operation }
    };
    let rows = 0..passes.len();
    let text = |value: &dyn Fn(usize) -> String| rows.clone().map(value).collect::<Vec<String>>();
    let number = |value: &dyn Fn(usize) -> f64| rows.clone().map(value).collect::<Vec<f64>>();
    records.set_texts("operation_id", text(&id));
    records.set_texts("machine", text(&|row| run.machine(passes[row].machine)));
    records.set_texts("tool_id", text(&|row| edge_name(passes[row].edge)));
    records.set_numbers("sequence", sequence.iter().map(|at| at + 1.0).collect());
    records.set_numbers("start_time", number(&|row| passes[row].start));
    records.set_texts("part_type", text(&|row| run.scenario.parts[passes[row].part as usize].name.clone()));
    // Lots are written down where somebody cares for them.
    if run.scenario.parts.iter().any(|part| part.deviating_lot.is_some()) {
        let part = |row: usize| &run.scenario.parts[passes[row].part as usize].name;
        records.set_texts("lot", text(&|row| lot_name(part(row), run.log.jobs[passes[row].job as usize].lot)));
    }
    run.coolants(records, &passes.iter().map(|pass| (pass.machine, pass.start)).collect::<Vec<_>>());
    let shifts = text(&|row| run.shift(passes[row].machine as usize, passes[row].start));
    if shifts.iter().any(|shift| !shift.is_empty()) {
        records.set_texts("shift", shifts);
    }
    let speed = |pass: &PassRow| if pass.path > 0.0 { pass.path / pass.cutting_time } else { pass.speed_start };
    let mean = |pass: &PassRow| if milling { pass.speed_start } else { speed(pass) };
    records.set_numbers("cutting_speed", number(&|row| mean(passes[row])));
    let feed = if milling { "feed_per_tooth" } else { "feed_per_rev" };
    records.set_numbers(feed, number(&|row| passes[row].feed));
    records.set_numbers("depth_of_cut", number(&|row| passes[row].depth_of_cut));
    if milling {
        records.set_numbers(
            "width_of_cut",
            number(&|row| programmed(run, passes[row]).map_or(f64::NAN, |cut| cut.width_of_cut)),
        );
        records.set_numbers("path_length", number(&|row| passes[row].path));
    }
    records.set_numbers("cutting_time", number(&|row| passes[row].cutting_time));
    records.set_numbers("feed_override", vec![1.0; passes.len()]);
    let last = |row: usize| passes.get(row + 1).is_none_or(|next| next.edge != passes[row].edge);
    let end = |row: usize| if last(row) { edge_end(run.log.edges[passes[row].edge as usize].reason) } else { "" };
    records.set_texts("edge_end", text(&|row| end(row).to_owned()));
}

/// How an edge ended, in the words of records. An edge that collapsed did not wear out.
fn edge_end(reason: ChangeReason) -> &'static str {
    match reason {
        ChangeReason::WearLimit => "worn",
        ChangeReason::Chipping => "chipped",
        ChangeReason::ThermalCollapse => "broken",
        ChangeReason::Rule | ChangeReason::Dressing => "changed",
        ChangeReason::EndOfRun => "stopped",
    }
}

/// Cycle and stops of operations with one pass.
fn times(run: &Run<'_>, rows: &[usize], records: &mut Records) {
    let mut cycle = vec![f64::NAN; rows.len()];
    let (mut stops, mut stopped) = (cycle.clone(), cycle.clone());
    for (row, pass_index) in rows.iter().enumerate() {
        let visit = &run.visits.list[run.visits.of_pass[*pass_index]];
        if visit.passes.len() == 1 && visit.whole {
            cycle[row] = visit.handling + visit.machining;
            stops[row] = f64::from(visit.stops);
            stopped[row] = visit.stop_time;
        }
    }
    run.channel(records, "cycle_time", &cycle);
    // Counted and clocked by the control.
    if stops.iter().any(|count| *count > 0.0) {
        records.set_numbers("stop_count", stops);
        records.set_numbers("stop_time", stopped);
    }
}

/// The programmed cut of a pass; `None` around a contour and in a part program, where conditions change all the way.
fn programmed(run: &Run<'_>, pass: &PassRow) -> Option<Cut> {
    match &run.scenario.parts[pass.part as usize].operations[pass.operation as usize].work {
        Work::Cutting(cuts) => cuts.get(pass.pass as usize).copied(),
        Work::Plain(_) | Work::Contour(_) | Work::Program(_) | Work::Grinding { .. } | Work::Cycle(_) => None,
    }
}

/// Element of a field by name.
fn place(fields: &[Field], name: &str) -> Option<usize> {
    let mut index = 0;
    for field in fields {
        if field.name == name {
            return Some(index);
        }
        index += field.len;
    }
    None
}

/// Means over each pass of an edge, in order.
fn of_edge(run: &Run<'_>, passes: &[&PassRow], rows: &[usize]) -> Result<Vec<[f64; MEANS.len()]>, Box<Refusal>> {
    let process = run.process(rows[0]).machine_process();
    let (inputs, outputs) = (process.inputs(), process.outputs());
    let land = place(process.states(), "flank_wear");
    let edge = &run.log.edges[passes[0].edge as usize];
    // The stresses of the pair are those of the run: the log does not name them, its random numbers do.
    let tool = &run.scenario.tools[edge.tool as usize];
    let pair = tool.scatter.sample_pair(&mut run.streams.open(Entity::named(&tool.name), Purpose::Tool));
    let mut x = process.initial();
    let mut clock = f64::NAN;
    let mut of_pass = |pass: &PassRow, pass_index: &usize| {
        let model = run.process(*pass_index);
        let process = model.machine_process();
        let cut = programmed(run, pass).unwrap_or_default();
        let mut u: Vec<f64> = inputs.iter().flat_map(|field| std::iter::repeat_n(field.start, field.len)).collect();
        let mut set = |name: &str, value: f64| {
            if let Some(index) = place(inputs, name) {
                u[index] = value;
            }
        };
        set("cutting_speed", pass.speed_start);
        set("cutting_acceleration", (pass.speed_end - pass.speed_start) / pass.cutting_time);
        set("feed_per_rev", pass.feed);
        set("feed_per_tooth", pass.feed);
        set("depth_of_cut", pass.depth_of_cut);
        set("width_of_cut", cut.width_of_cut);
        set("coolant_age", run.coolant(pass.machine, pass.start).0);
        set("sensor_time", pass.start);
        set("pass_time", pass.cutting_time);
        let lot = run.log.jobs[pass.job as usize].lot;
        let part = &run.scenario.parts[pass.part as usize];
        set("lot_deviation", if run.hardened(*pass_index) { 1.0 } else { part.lot_deviation(lot) });
        set("mechanical_wear_factor", edge.mechanical_wear_factor);
        set("thermal_wear_factor", edge.thermal_wear_factor);
        set("flank_shear_factor", pair.flank_shear_factor);
        set("flank_pressure_factor", pair.flank_pressure_factor);
        if cut.diameter > 0.0 {
            set("workpiece_diameter", cut.diameter);
        }
        if pass.start > clock
            && let Some(engaged) = place(inputs, "engaged")
        {
            // Between passes the edge only cools; a process that refuses keeps its state.
            let mut idle = u.clone();
            idle[engaged] = 0.0;
            let _ = process.advance(&mut x, &mut idle, pass.start - clock);
        }
        let wear = |share: f64| pass.flank_wear_start + share * (pass.flank_wear_end - pass.flank_wear_start);
        let first = if pass.cutting_time > LEFT_OUT { LEFT_OUT } else { 0.0 };
        let step = (pass.cutting_time - first) / POINTS as f64;
        let mut y = vec![0.0; outputs.iter().map(|field| field.len).sum()];
        let mut sums = [0.0; MEANS.len()];
        let mut reached = 0.0;
        let mut go = |x: &mut Vec<f64>, u: &mut Vec<f64>, to: f64| {
            let share = reached / pass.cutting_time;
            if let Some(land) = land {
                x[land] = wear(share);
            }
            let mut left: f64 = to - reached;
            for _ in 0..EVENTS {
                match process.advance(x, u, left) {
                    Ok(advance) if advance.elapsed < left => left -= advance.elapsed,
                    _ => break,
                }
            }
            reached = to;
            if let Some(land) = land {
                x[land] = wear(to / pass.cutting_time);
            }
        };
        for point in 0..POINTS {
            go(&mut x, &mut u, first + (point as f64 + 0.5) * step);
            process.output(&x, &u, &mut y);
            for (sum, name) in sums.iter_mut().zip(MEANS) {
                *sum += place(outputs, name).map_or(f64::NAN, |index| y[index]) / POINTS as f64;
            }
        }
        go(&mut x, &mut u, pass.cutting_time);
        process.output(&x, &u, &mut y);
        // Hardness of the work and whatever else the log does not name are in its end values. Of the feed force the log
        // knows nothing: the hardness that explains the cutting force changes it by less, since it does not press harder
        // on the land.
        let feed = harder(process, &x, &u, &y, pass.cutting_force);
        let end = |name: &str, logged: f64| {
            place(outputs, name)
                .map(|index| logged / y[index])
                .filter(|ratio| ratio.is_finite() && *ratio > 0.0)
                .unwrap_or(1.0)
        };
        let force = end("cutting_force", pass.cutting_force);
        let power = end("spindle_power", pass.spindle_power);
        let heat = end("temperature", pass.temperature);
        // The junction is as hot as the cut: its voltage follows the temperature in °C.
        let junction = place(outputs, "temperature").map_or(1.0, |index| {
            let ratio = (heat * y[index] - ICE) / (y[index] - ICE);
            if ratio.is_finite() && ratio > 0.0 { ratio } else { 1.0 }
        });
        let factors = [force, feed.unwrap_or(force), power, heat, junction];
        clock = pass.end;
        let mut mean = [f64::NAN; MEANS.len()];
        mean.iter_mut().zip(sums).zip(factors).for_each(|((mean, sum), factor)| *mean = sum * factor);
        mean
    };
    let mean = |(pass, index): (&&PassRow, &usize)| {
        watched(|| of_pass(pass, index)).map_err(|source| run.refusal(pass, source))
    };
    passes.iter().zip(rows).map(mean).collect()
}

/// Rounds in which a hardness is sought.
const ROUNDS: usize = 30;
/// Share of the cutting force to which it is found.
const FOUND: f64 = 1e-12;

/// Factor on the feed force `y` of the state `x` under `u` where the work is as hard as the cutting force (N) says; `None`
/// where no hardness explains that.
fn harder(process: &dyn MachineProcess, x: &[f64], u: &[f64], y: &[f64], cutting_force: f64) -> Option<f64> {
    let port = place(process.inputs(), "hardness_ratio")?;
    let [cutting, feed] = ["cutting_force", "feed_force"].map(|name| place(process.outputs(), name));
    let (cutting, feed) = (cutting?, feed?);
    let (mut u, mut out) = (u.to_vec(), y.to_vec());
    let mut power_at = |hardness: f64| {
        u[port] = hardness;
        process.output(x, &u, &mut out);
        (out[cutting], out[feed])
    };
    // Forces are nearly powers of the hardness: secants of the logarithms.
    let (mut before, mut now) = (1.0_f64, cutting_force / y[cutting]);
    let mut missing = (cutting_force / y[cutting]).ln();
    for _ in 0..ROUNDS {
        if !(now.is_finite() && now > 0.0) {
            return None;
        }
        let (force, found) = power_at(now);
        let left = (cutting_force / force).ln();
        if left.abs() < FOUND {
            return Some(found / y[feed]).filter(|ratio| ratio.is_finite() && *ratio > 0.0);
        }
        let slope = (missing - left) / (now / before).ln();
        if !(slope.is_finite() && slope != 0.0) {
            return None;
        }
        (before, missing) = (now, left);
        now *= (left / slope).exp();
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_feed_force_follows_the_hardness_that_the_cutting_force_tells() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/gap/turning.toml");
        let scenario = toolroom_scenario_file::read(&path, &[]).expect("the shipped scenario").scenario;
        let process = scenario.tools[0].process.machine_process();
        let mut u: Vec<f64> = process.inputs().iter().flat_map(|own| std::iter::repeat_n(own.start, own.len)).collect();
        let mut set = |name: &str, value: f64| u[place(process.inputs(), name).expect("an input")] = value;
        for (name, value) in [("cutting_speed", 220.0 / 60.0), ("feed_per_rev", 0.3e-3), ("depth_of_cut", 1.5e-3)] {
            set(name, value);
        }
        let mut x = process.initial();
        x[place(process.states(), "flank_wear").expect("a land")] = 0.15e-3;
        let forces = |hardness: f64| -> Vec<f64> {
            let mut u = u.clone();
            u[place(process.inputs(), "hardness_ratio").expect("a hardness")] = hardness;
            let mut y = vec![0.0; process.outputs().iter().map(|own| own.len).sum()];
            process.output(&x, &u, &mut y);
            y
        };
        let [cutting, feed] =
            ["cutting_force", "feed_force"].map(|name| place(process.outputs(), name).expect("a force"));
        let (plain, plain_forces) = (forces(1.0)[feed], forces(1.0));
        for hardness in [0.9, 0.98, 1.0, 1.02, 1.15] {
            let hard = forces(hardness);
            let factor = harder(process, &x, &u, &plain_forces, hard[cutting]).expect("a hardness");
            assert!((factor * plain / hard[feed] - 1.0).abs() < 1e-9, "{hardness}: {factor}");
        }
        // The land is pressed as before: 2 % of hardness raise the cutting force by 1.36 % and the feed force by 1.01 %.
        let ratio = harder(process, &x, &u, &plain_forces, forces(1.02)[cutting]).expect("a hardness");
        assert!((ratio - 1.0101).abs() < 2e-4, "{ratio}");
        assert!(harder(process, &x, &u, &plain_forces, f64::NAN).is_none());
    }
}
