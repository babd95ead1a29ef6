//! What a run costs after the simulation: key figures and Parquet tables of one log of the demo
//! shop, and the simulation itself for comparison.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::path::Path;
use toolroom_study::kpi::evaluate;
use toolroom_study::logs::{Format, LogWriter};

fn results(criterion: &mut Criterion) {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/demo.toml"));
    let scenario = toolroom_scenario_file::read(path, &[]).expect("a shipped scenario").scenario;
    let log = toolroom_shop::run(&scenario, 0, 0).expect("a run");
    let rows = log.passes.len() + log.edges.len() + log.jobs.len() + log.states.len() + log.events.len();

    let mut group = criterion.benchmark_group("demo shop, one run");
    group.bench_function("simulation", |bench| {
        bench.iter(|| toolroom_shop::run(black_box(&scenario), 0, 0).expect("a run"));
    });
    group.throughput(Throughput::Elements(rows as u64));
    group.bench_function("key figures", |bench| bench.iter(|| evaluate(black_box(&scenario), black_box(&log))));

    let directory = std::env::temp_dir().join(format!("toolroom-bench-{}", std::process::id()));
    std::fs::create_dir_all(&directory).expect("a folder");
    for format in [Format::Parquet, Format::Csv] {
        group.bench_function(format!("log tables, {}", format.extension()), |bench| {
            bench.iter(|| {
                let mut writer = LogWriter::create(&directory, &scenario, format).expect("files");
                writer.write(0, 0, black_box(&log)).expect("rows");
                writer.finish().expect("a footer");
            });
        });
    }
    group.finish();
    std::fs::remove_dir_all(&directory).expect("a folder to remove");
}

criterion_group!(benches, results);
criterion_main!(benches);
