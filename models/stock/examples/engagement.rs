//! How long the engagement of a program through its stock takes, by motion and by step:
//! `cargo run --release -p toolroom-stock --example engagement -- PROGRAM SETUP`. The time is that of the fastest of
//! three runs of one thread, with the reading of the program. A step has its bound and one to three samples; steps that are halved
//! have been looked at as well.
//! The sums of volume and angles are printed, which tell whether two versions of the program agree.

use std::io::Write;
use std::time::Instant;
use toolroom_program::{Control, Event, EventKind, Run};
use toolroom_stock::{Cut, Follower, Load, Setup};

/// What a run came to.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    motions: u32,
    steps: u32,
    removed: f64,
    angles: f64,
}

/// Takes the shares of a motion between which a stretch lies, its bound and its load.
type Trace<'t> = dyn FnMut(f64, f64, f64, Option<Load>) + 't;

/// Follows an event; what its motion does to the stock.
fn follow(
    event: Event,
    follower: &mut Follower<'_>,
    trace: Option<&mut Trace<'_>>,
) -> Result<Option<Cut>, Box<dyn std::error::Error>> {
    match event.kind {
        EventKind::ToolChange(tool) => follower.change(tool),
        EventKind::Spindle { speed, sense } => follower.spindle(speed, sense),
        EventKind::Motion(motion) => {
            return Ok(match trace {
                Some(trace) => follower.motion_traced(&motion, trace)?,
                None => follower.motion(&motion)?,
            });
        }
        EventKind::Block
        | EventKind::Dwell(_)
        | EventKind::Coolant(_)
        | EventKind::Stop(_)
        | EventKind::Home(_)
        | EventKind::Offset(_)
        | EventKind::ExactStop
        | EventKind::Auxiliary(..)
        | EventKind::Hole
        | EventKind::End => {}
    }
    Ok(None)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(program), Some(file)) = (arguments.next(), arguments.next()) else {
        return Err("give a program and its setup".into());
    };
    let text = std::fs::read_to_string(&program)?;
    let setup = Setup::parse(&file, &std::fs::read_to_string(&file)?, &[])?.content;
    let (mut control, mut sums) = (Control::default(), Sums::default());
    setup.tell(&mut control);
    let mut follower = Follower::new(&setup);
    for event in Run::new(&text, &control)? {
        let mut trace = |_: f64, _: f64, bound: f64, _: Option<Load>| sums.steps += u32::from(bound > 0.0);
        follow(event?, &mut follower, Some(&mut trace))?;
    }
    let mut least = f64::INFINITY;
    for _ in 0..3 {
        let start = Instant::now();
        (sums.motions, sums.removed, sums.angles) = (0, 0.0, 0.0);
        let mut follower = Follower::new(&setup);
        for event in Run::new(&text, &control)? {
            if let Some(cut) = follow(event?, &mut follower, None)? {
                sums.motions += 1;
                sums.angles += cut.bound + cut.sampled;
            }
        }
        sums.removed = follower.cutting().removed();
        least = least.min(start.elapsed().as_secs_f64());
    }
    let Sums { motions, steps, removed, angles } = sums;
    let micro = |count: u32| 1e6 * least / f64::from(count.max(1));
    writeln!(
        std::io::stdout(),
        "{least:.3} s: {motions} motions of {:.1} us, {steps} steps in material of {:.1} us; removed {:.6} cm3, angles {angles:.6} rad",
        micro(motions),
        micro(steps),
        1e6 * removed
    )?;
    Ok(())
}
