//! Speed of planning.

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use toolroom_contour::{
    Contour, CutterSide, EdgeLife, Models, Objective, Parameters, Pass, PathError, Planner, Point, Trace,
};

/// A hole of three lobes in `sections` sections, no two neighbours of one radius.
fn hole(sections: u32) -> Contour {
    let mut trace = Trace::new(Point::default(), 0.0);
    trace.lobed(1.0, 0.035, 3, sections).expect("radii stay positive");
    trace.finish(CutterSide::Left, true).expect("a lobed profile closes")
}

fn benches(c: &mut Criterion) {
    let (parameters, pass) = (Parameters::default(), Pass::default());
    let models = Models { path_error: PathError::Empirical, ..Models::default() };
    let mut group = c.benchmark_group("contour");
    group.sample_size(10);
    for sections in [18, 1000, 10_000] {
        let contour = hole(sections);
        group.bench_function(format!("plan of {sections} sections"), |b| {
            b.iter(|| {
                let planner = Planner::new(black_box(&contour), &parameters, &pass, &models)?;
                planner.optimal(Objective::Cost)
            });
        });
    }
    let contour = hole(180);
    let planner = Planner::new(&contour, &parameters, &pass, &models).expect("the reference pass is sound");
    group.bench_function("plan with ramps of 180 sections", |b| b.iter(|| planner.optimal_with_ramps(Objective::Time)));
    let edge = EdgeLife { remaining: 0.003, ..EdgeLife::default() };
    group.bench_function("plan with edge life of 180 sections", |b| {
        b.iter(|| planner.optimal_with_edge(Objective::Time, black_box(edge)));
    });
    group.finish();
}

criterion_group!(contour, benches);
criterion_main!(contour);
