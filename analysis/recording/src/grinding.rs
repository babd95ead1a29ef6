//! Plunge grinding trials: parts ground with one infeed, or with a rough and a finish one, and a spark-out. The log keeps the force at
//! the end of each phase; stock, rise and the other forces follow from the process, with the process
//! stiffness that this force tells.

use crate::{Run, edge_name};
use toolroom_infeed::{Infeed, Input, State};
use toolroom_process::{Process, watched};
use toolroom_records::{RecordKind, Records};
use toolroom_scenario::{GrindingPhase, ProcessModel, Work};
use toolroom_shop::Refusal;

/// Readings of a trial.
const CHANNELS: [&str; 5] =
    ["stock_removed", "normal_force", "tangential_force", "rise_revolutions", "force_after_spark_out"];

/// Share of the depth of the last revolution by which the mean radius lags behind the radius at the wheel: half of it,
/// since infeed does not stop within a turn.
const MEAN_LAG: f64 = 0.5;

/// A part in its dressing cycle.
struct Trial<'a> {
    visit: usize,
    wheel: &'a Infeed,
    work_rotation_speed: f64,
    infeed: GrindingPhase,
    /// The finish stage, where there is one.
    finish: Option<GrindingPhase>,
    spark_out: u32,
    /// Dressing cycle.
    edge: u32,
    start: f64,
    /// Age of the coolant, s, and whether it is another than at first.
    coolant: (f64, bool),
    /// Normal force at the end of the infeed, N.
    force: f64,
}

/// Rows of grinding.
pub fn trials(run: &Run<'_>) -> Result<Records, Box<Refusal>> {
    let mut trials: Vec<Trial<'_>> = (0..run.visits.list.len()).filter_map(|visit| trial(run, visit)).collect();
    trials.sort_by(|a, b| a.edge.cmp(&b.edge).then(a.start.total_cmp(&b.start)));
    let mut records = Records::new(RecordKind::Grinding, trials.len());
    let mut part = vec![0.0; trials.len()];
    let mut readings: Vec<Vec<f64>> = vec![Vec::with_capacity(trials.len()); CHANNELS.len()];
    let mut wheel = State::default();
    for (row, trial) in trials.iter().enumerate() {
        let same = row > 0 && trials[row - 1].edge == trial.edge;
        part[row] = if same { part[row - 1] + 1.0 } else { 1.0 };
        if !same {
            wheel = trial.wheel.initial();
        }
        let followed = watched(|| {
            let nominal = ground(trial, 1.0, &mut wheel.clone())[1];
            let factor = if nominal > 0.0 && trial.force > 0.0 { trial.force / nominal } else { 1.0 };
            ground(trial, factor, &mut wheel)
        });
        let first = &run.log.passes[run.visits.list[trial.visit].passes[0]];
        let followed = followed.map_err(|source| run.refusal(first, source))?;
        readings.iter_mut().zip(followed).for_each(|(all, reading)| all.push(reading));
    }
    let visit = |trial: &Trial<'_>| &run.visits.list[trial.visit];
    let machine = |trial: &Trial<'_>| run.log.edges[trial.edge as usize].machine;
    let text = |value: &dyn Fn(&Trial<'_>) -> String| trials.iter().map(value).collect::<Vec<String>>();
    let number = |value: &dyn Fn(&Trial<'_>) -> f64| trials.iter().map(value).collect::<Vec<f64>>();
    records.set_texts(
        "trial_id",
        text(&|trial| run.operation_id(visit(trial).job, visit(trial).part, visit(trial).operation)),
    );
    records.set_texts("machine", text(&|trial| run.machine(machine(trial))));
    records.set_texts("wheel_id", text(&|trial| format!("W-{}", run.machine(machine(trial)))));
    records.set_texts("dressing_cycle", text(&|trial| edge_name(trial.edge)));
    records.set_numbers("part_in_cycle", part);
    records.set_numbers("infeed_per_rev", number(&|trial| trial.infeed.infeed_per_rev));
    records.set_numbers("revolutions", number(&|trial| f64::from(trial.infeed.revolutions)));
    records.set_numbers("spark_out_revolutions", number(&|trial| f64::from(trial.spark_out)));
    if trials.iter().any(|trial| trial.finish.is_some()) {
        let of = |value: fn(&GrindingPhase) -> f64| number(&|trial| trial.finish.as_ref().map_or(0.0, value));
        records.set_numbers("finish_infeed_per_rev", of(|phase| phase.infeed_per_rev));
        records.set_numbers("finish_revolutions", of(|phase| f64::from(phase.revolutions)));
    }
    records.set_numbers("work_rotation_speed", number(&|trial| trial.work_rotation_speed));
    records.set_numbers("start_time", number(&|trial| trial.start));
    run.coolants(&mut records, &trials.iter().map(|trial| (machine(trial), trial.start)).collect::<Vec<_>>());
    for (channel, values) in CHANNELS.iter().zip(&readings) {
        run.channel(&mut records, channel, values);
    }
    Ok(records)
}

/// The trial that a visit is, if it has one or two infeeds before its spark-out and is ground by one dressing of the wheel.
fn trial<'a>(run: &Run<'a>, index: usize) -> Option<Trial<'a>> {
    let visit = &run.visits.list[index];
    let operation = &run.scenario.parts[visit.part as usize].operations[visit.operation as usize];
    let tool = &run.scenario.tools[operation.tool?];
    let (ProcessModel::Infeed(wheel), Work::Grinding { work_rotation_speed, phases }) =
        (&tool.process, &operation.work)
    else {
        return None;
    };
    let (moving, resting): (Vec<&GrindingPhase>, Vec<&GrindingPhase>) =
        phases.iter().partition(|phase| phase.infeed_per_rev > 0.0);
    let (infeed, finish) = match moving[..] {
        [infeed] => (infeed, None),
        [infeed, finish] => (infeed, Some(*finish)),
        _ => return None,
    };
    // Infeed that goes on behind a spark-out is no stage of a trial.
    if phases[..moving.len()].iter().any(|phase| phase.infeed_per_rev <= 0.0) {
        return None;
    }
    let first = &run.log.passes[*visit.passes.first()?];
    let whole =
        visit.passes.len() == phases.len() && visit.passes.iter().all(|pass| run.log.passes[*pass].edge == first.edge);
    whole.then(|| Trial {
        visit: index,
        wheel,
        work_rotation_speed: *work_rotation_speed,
        infeed: *infeed,
        finish,
        spark_out: resting.iter().map(|phase| phase.revolutions).sum(),
        edge: first.edge,
        start: first.start,
        coolant: run.coolant(first.machine, first.start),
        force: first.cutting_force,
    })
}

/// Grinds the part; the wheel stays changed.
fn ground(trial: &Trial<'_>, stiffness: f64, wheel: &mut State) -> [f64; CHANNELS.len()] {
    let u = Input {
        infeed_per_rev: trial.infeed.infeed_per_rev,
        work_rotation_speed: trial.work_rotation_speed,
        process_stiffness_factor: stiffness,
        coolant_age: trial.coolant.0,
        coolant_changed: f64::from(u8::from(trial.coolant.1)),
        machine_time: trial.start,
        ..Input::default()
    };
    let mut part = trial.wheel.new_part(wheel);
    part.commanded_infeed = part.wheel_wear;
    let turn = |part: &mut State, infeed: f64, revolutions: u32| {
        for _ in 0..revolutions {
            part.commanded_infeed += infeed;
            *part = trial.wheel.revolution(part, &u);
        }
    };
    turn(&mut part, u.infeed_per_rev, trial.infeed.revolutions);
    let steady = trial.wheel.output(&part, &u);
    if let Some(finish) = trial.finish {
        turn(&mut part, finish.infeed_per_rev, finish.revolutions);
    }
    // Heat comes in under infeed and stays until the part is gauged.
    let infeed_per_rev = trial.finish.map_or(u.infeed_per_rev, |finish| finish.infeed_per_rev);
    let warm = part.stock_removed - trial.wheel.output(&part, &Input { infeed_per_rev, ..u }).stock_removed;
    turn(&mut part, 0.0, trial.spark_out);
    let end = trial.wheel.output(&part, &Input { infeed_per_rev: 0.0, ..u });
    *wheel = part;
    // The last revolution leaves a spiral, and a gauge reads the mean radius.
    let stock_removed = part.stock_removed - warm - MEAN_LAG * part.depth_of_cut;
    [stock_removed, steady.normal_force, steady.tangential_force, steady.rise_revolutions, end.normal_force]
}
