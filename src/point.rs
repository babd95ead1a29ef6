//! `toolroom point PROCESS`: every output of a process at one operating point.

use crate::args::PointArgs;
use crate::effects::defined;
use crate::failure::Failure;
use crate::speak::Voice;
use toolroom_planning::point::{Point, PointError, PointOptions};

pub fn run(args: &PointArgs, voice: &Voice) -> Result<(), Failure> {
    let options = PointOptions {
        tool: args.tool.clone(),
        changes: args.set.clone(),
        effects: args.effect.clone(),
        defined: defined(&args.effects)?,
        advance: args.advance.clone(),
        life_model: args.life_model.into(),
    };
    let point = Point::new(args.process.into(), &options).map_err(refused)?;
    if voice.json { voice.json(&point.json()) } else { voice.data(point.text()) }
}

/// An effect that gives no value at a point is work that failed; the rest is input.
fn refused(error: PointError) -> Failure {
    if let PointError::Value(refusal) = &error {
        return Failure::work_error(refusal);
    }
    let fix = error.fix();
    Failure::located(error, fix)
}
