//! Speed of a unit through its C interface (FMI 3.0 Co-Simulation).

#[path = "../tests/importer/mod.rs"]
mod importer;

use criterion::{Criterion, criterion_group, criterion_main};
use importer::{fmi3FreeInstance, fmi3GetFMUState, fmi3GetFloat64, fmi3SetFMUState, ready3, reference, step3, token};
use std::hint::black_box;
use std::ptr::null_mut;
use toolroom_cutting::{Turning, TurningInput};
use toolroom_process::Process;

fn steps(criterion: &mut Criterion) {
    for (model, length) in [("turning", 0.01), ("turning", 0.1), ("turning", 1.0), ("milling", 0.1), ("infeed", 0.01)] {
        let unit = ready3(&token(model));
        let mut state = null_mut();
        // SAFETY: the arguments are what the standard asks for.
        unsafe { assert_eq!(fmi3GetFMUState(unit, &mut state), 0) };
        let mut count = 0u32;
        criterion.bench_function(&format!("{model}/do_step {length} s"), |bencher| {
            bencher.iter(|| {
                assert_eq!(step3(unit, f64::from(count) * length, length).0, 0);
                count += 1;
                if count == 2000 {
                    // Back to the start, so that every step is one of a young edge.
                    // SAFETY: the arguments are what the standard asks for.
                    unsafe { assert_eq!(fmi3SetFMUState(unit, state), 0) };
                    count = 0;
                }
            });
        });
        // SAFETY: the arguments are what the standard asks for.
        unsafe { fmi3FreeInstance(unit) };
    }
}

/// What the process itself takes for a step of 0.1 s: the rest is the unit's.
fn process(criterion: &mut Criterion) {
    let (turning, input) = (Turning::named("ni_vk6om").expect("a shipped set"), TurningInput::default());
    let mut state = turning.initial();
    criterion.bench_function("turning/process alone 0.1 s", |bencher| {
        bencher.iter(|| {
            turning.advance(&mut state, &input, 0.1).expect("a step");
            if state.cutting_time > 200.0 {
                state = turning.initial();
            }
        });
    });
}

fn values(criterion: &mut Criterion) {
    let token = token("turning");
    let unit = ready3(&token);
    let one = [reference("turning", "process.flank_wear")];
    let names = ["tool.flank_wear", "tool.cutting_path", "process.cutting_speed", "process.cutting_force"];
    let eight: Vec<u32> = names.iter().cycle().take(8).map(|name| reference("turning", name)).collect();
    let mut into = [0.0; 8];
    assert_eq!(step3(unit, 0.0, 1.0).0, 0);
    for (name, references) in [("get 1", &one[..]), ("get 8", &eight[..])] {
        criterion.bench_function(&format!("turning/{name}"), |bencher| {
            bencher.iter(|| {
                // SAFETY: the arguments are what the standard asks for.
                let status = unsafe {
                    fmi3GetFloat64(unit, references.as_ptr(), references.len(), into.as_mut_ptr(), references.len())
                };
                black_box(status);
            });
        });
    }
    let mut state = null_mut();
    // SAFETY: the arguments are what the standard asks for.
    unsafe { fmi3GetFMUState(unit, &mut state) };
    criterion.bench_function("turning/save state", |bencher| {
        // SAFETY: the arguments are what the standard asks for.
        bencher.iter(|| unsafe { fmi3GetFMUState(unit, &mut state) });
    });
    criterion.bench_function("turning/restore state", |bencher| {
        // SAFETY: the arguments are what the standard asks for.
        bencher.iter(|| unsafe { fmi3SetFMUState(unit, state) });
    });
    criterion.bench_function("turning/instantiate, initialise, free", |bencher| {
        // SAFETY: the arguments are what the standard asks for.
        bencher.iter(|| unsafe { fmi3FreeInstance(ready3(&token)) });
    });
}

criterion_group!(benches, steps, process, values);
criterion_main!(benches);
