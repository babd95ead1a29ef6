use std::f64::consts::TAU;
use std::fmt::Write;
use std::time::Instant;
use toolroom_chatter::*;
#[test]
fn times() {
    let mut out = String::new();
    let std = |n: usize, a: f64| Milling {
        modes: [[1.0, 0.0], [0.0, 1.0]]
            .into_iter()
            .take(n)
            .map(|d| Mode::from_mass(d, 922.0, 0.011, 0.03993))
            .collect(),
        cutter: Cutter::straight(2, 0.02),
        engagement: Engagement::new(a, Direction::Down).unwrap(),
        force: MillingForce::new(6e8, 2e8),
        feed_per_tooth: 0.1e-3,
    };
    for n in [1, 2] {
        for waves in [60.0, 100.0, 200.0, 390.0] {
            let cut = std(n, 1.0);
            let speed = 922.0 * TAU / 2.0 / waves;
            let t = Instant::now();
            let l = cut.at_speed(speed).unwrap().limit(1e-3);
            writeln!(out, "{n} modes {waves} waves {:.2} rpm: {:?} {l:?}", speed * 60.0 / TAU, t.elapsed()).unwrap();
        }
    }
    let rpm = TAU / 60.0;
    for rpm_ in [1.0, 5.0] {
        let cut = std(2, 1.0);
        let t = Instant::now();
        let l = cut.at_speed(rpm_ * rpm).unwrap().stable_intervals(1e-3).unwrap();
        writeln!(out, "milling {rpm_} rpm {:?} {:?}", t.elapsed(), l).unwrap();
    }
    let mode =
        |x: f64, y: f64, f, z, k| Mode { direction: [x, y], natural_frequency: f, damping_ratio: z, stiffness: k };
    let t2 = Turning {
        force_angle: 20.1f64.to_radians(),
        process_damping: 1.066e5,
        ..Turning::orthogonal(
            vec![
                mode(0.9677, -0.2521, 158.4, 0.0235, 8.643e6),
                mode(0.99668, -0.08139, 331.6, 0.0272, 1.803e7),
                mode(0.98168, 0.19054, 126.3, 0.0121, 1.587e7),
                mode(0.99503, -0.09959, 124.8, 0.0363, 5.803e6),
            ],
            1735e6,
            0.04,
        )
    };
    for s in [4897.17, 1000.0, 100.0, 5.0, 1.0] {
        let t = Instant::now();
        for _ in 0..10 {
            std::hint::black_box(t2.limit(s * rpm).ok());
        }
        let a = t.elapsed() / 10;
        let t = Instant::now();
        for _ in 0..10 {
            std::hint::black_box(t2.stable_intervals(s * rpm, 3e-3).ok());
        }
        let b = t.elapsed() / 10;
        let t = Instant::now();
        std::hint::black_box(t2.verdict(s * rpm, 0.5e-3).ok());
        writeln!(out, "turning {s} rpm: limit {a:?} intervals {b:?} verdict {:?}", t.elapsed()).unwrap();
    }
    for a in [0.05, 1.0] {
        let cut = std(1, a);
        let speed = Axis { start: 5000.0 * rpm, end: 25000.0 * rpm, points: 400 };
        let depth = Axis { start: 0.0, end: 10e-3, points: 200 };
        let t = Instant::now();
        let b = cut.boundary(&speed, 10e-3).unwrap();
        let e = t.elapsed();
        let t = Instant::now();
        let c = cut.lobes(&speed.values("s").unwrap(), &depth.values("d").unwrap()).unwrap();
        let g = t.elapsed();
        let mut wrong = 0;
        for col in &b.columns {
            if let Some(i) = c.speed.iter().position(|s| *s == col.speed) {
                for (j, d) in c.depth.iter().enumerate() {
                    let below = col.crossings.iter().filter(|x| x.limit.depth < *d).count();
                    let v = c.at(i, j).unwrap();
                    if v.stable != (below % 2 == 0) && (v.spectral_radius - 1.0).abs() > 1e-3 {
                        wrong += 1;
                    }
                }
            }
        }
        writeln!(
            out,
            "a/D {a}: boundary {e:?} ({} columns), grid {g:?}, {wrong} points of the grid contradict",
            b.columns.len()
        )
        .unwrap();
    }
    panic!("{out}");
}
