//! Speed of the gap diagnosis.

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::Duration;
use toolroom_analysis::gap::{NominalModel, diagnose};
use toolroom_analysis::records::{RecordKind, Records, parse_csv};
use toolroom_truth::Case;

const MODEL: &str = include_str!("../../scenarios/gap/turning.toml");

/// Records of `sets` data sets of the same kind of shop, each on edges of its own.
fn recorded(sets: u64) -> Records {
    let of = |seed: u64| {
        let text = Case::one("turning", "wear_force", 1.0, 1).records().replace(",T", &format!(",T{seed}-"));
        parse_csv("bench", text.as_bytes(), RecordKind::Turning).expect("records of the contract").0
    };
    (1..sets).fold(of(0), |all, seed| all.followed_by(&of(seed)))
}

fn gap(c: &mut Criterion) {
    let model = NominalModel::parse("turning.toml", MODEL, &[]).expect("the shipped nominal model");
    let mut group = c.benchmark_group("gap");
    group.sample_size(10).measurement_time(Duration::from_secs(10));
    for (name, sets) in [("168 operations, whole catalogue", 1), ("10 080 operations, whole catalogue", 60)] {
        let records = recorded(sets);
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                let (forward, _) = model.over(black_box(&records), None, |_, _| false);
                diagnose(forward.as_ref(), 1).diagnosis
            });
        });
    }
    group.finish();
}

criterion_group!(benches, gap);
criterion_main!(benches);
