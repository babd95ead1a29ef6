//! Speed of planning.

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use toolroom_contour::{
    Contour, CutterSide, EdgeLife, Models, Objective, Parameters, Pass, PathError, Planner, Point, Trace,
};

/// A spiral of arcs, no two of one radius.
fn spiral(sections: u32) -> Contour {
    let mut trace = Trace::new(Point::default(), 0.0);
    for i in 0..sections {
        trace.arc(0.03 + 1e-5 * f64::from(i), 0.01).expect("an arc of positive radius");
    }
    trace.finish(CutterSide::Left, false).expect("a smooth open contour")
}

fn benches(c: &mut Criterion) {
    let (parameters, pass) = (Parameters::default(), Pass::default());
    let models = Models { path_error: PathError::Empirical, ..Models::default() };
    let mut group = c.benchmark_group("contour");
    group.sample_size(10);
    for sections in [18, 1000, 10_000] {
        let contour = spiral(sections);
        group.bench_function(format!("plan of {sections} sections"), |b| {
            b.iter(|| {
                let planner = Planner::new(black_box(&contour), &parameters, &pass, &models)?;
                planner.optimal(Objective::Cost)
            });
        });
    }
    let contour = spiral(180);
    let planner = Planner::new(&contour, &parameters, &pass, &models).expect("the reference pass is sound");
    group.bench_function("plan with ramps of 180 sections", |b| b.iter(|| planner.optimal_with_ramps(Objective::Time)));
    let edge = EdgeLife { remaining: 0.003, ..EdgeLife::default() };
    group.bench_function("plan with edge life of 180 sections", |b| {
        b.iter(|| planner.optimal_with_edge(Objective::Time, black_box(edge)));
    });
    let contour = spiral(18);
    let planner = Planner::new(&contour, &parameters, &pass, &models).expect("the reference pass is sound");
    let edge = EdgeLife { remaining: 0.0003, levels: 64 };
    group.bench_function("plan with ramps and edge life of 18 sections, 64 levels", |b| {
        b.iter(|| planner.optimal_with_ramps_and_edge(Objective::Cost, black_box(edge)));
    });
    group.finish();
}

criterion_group!(contour, benches);
criterion_main!(contour);
