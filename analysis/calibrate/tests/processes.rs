//! Milling, groups of edges, shapes of wear curves, passes instead of minutes, edges held out, many readings.

use nalgebra::DVector;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::fmt::Write as _;
use toolroom_calibrate::{
    Base, Calibration, Candidate, Clock, Condition, DataError, Edge, Law, Measured, Method, Model, Process, Request,
    Shape, Stretch, Treatment, Verdict, WearModel, maximise, profiles, sample,
};
use toolroom_cutting::{Milling, MillingInput};
use toolroom_records::{RecordKind, Records, parse_csv};
use toolroom_wear::{Cut, Pair};

fn mill() -> Base {
    let Milling { life, cutter, chipping, .. } = Milling::named("c45_endmill_d12").expect("shipped");
    Base::Milling { life, diameter: cutter.diameter, chipping }
}

fn pair() -> Pair {
    Pair::named("c45_t15k6").expect("shipped")
}

fn shapes(law: Law) -> Vec<Candidate> {
    Shape::ALL.map(|shape| Candidate { law, shape }).to_vec()
}

/// Six cutters at two feeds and two widths, of which those in steel wear twice as fast; the wear curve has the set's stages.
fn cuts() -> Records {
    let mut rows = String::from(
        "operation_id,machine,tool_id,sequence,material,cutting_speed [m/min],feed_per_tooth [mm],depth_of_cut [mm],\
         width_of_cut [mm],cutting_time [min],flank_wear [mm],edge_end\n",
    );
    let (base, mut random) = (mill(), ChaCha8Rng::seed_from_u64(11));
    for (index, (speed, feed, width, steel)) in [
        (150.0, 0.05, 3.0, false),
        (150.0, 0.08, 3.0, true),
        (190.0, 0.05, 6.0, true),
        (190.0, 0.08, 6.0, false),
        (230.0, 0.05, 3.0, true),
        (230.0, 0.08, 6.0, false),
        (150.0, 0.08, 6.0, true),
        (230.0, 0.05, 6.0, false),
    ]
    .into_iter()
    .enumerate()
    {
        let cut = Cut::nominal(speed / 60.0, feed * 1e-3, 12e-3);
        let condition = Condition { width: Some(width * 1e-3), ..cut.into() };
        let blank = |time: f64| Edge {
            name: "one".to_owned(),
            stretches: vec![Stretch::read(0, time, 0.0); 8],
            life: None,
            begun: None,
        };
        let model = |time: f64| WearModel::new(Law::CutterLife, base.clone(), [condition], vec![blank(time)], 0.3);
        let truth = DVector::from_iterator(
            model(1.0).parameters().len(),
            model(1.0).parameters().iter().map(|parameter| match parameter.name.as_str() {
                "life.feed_exponent" => 0.36,
                "life.depth_exponent" => 0.98,
                "edge_scatter" => 0.10f64.ln(),
                "reading_noise" => 0.006f64.ln(),
                _ => parameter.prior.mean,
            }),
        );
        let factor = if steel { 2.0 } else { 1.0 };
        let life = model(1.0).life(truth.as_slice(), condition) / factor;
        for (reading, wear) in model(factor * life / 8.0).replicate(truth.as_slice(), 0, &mut random).iter().enumerate()
        {
            let material = if steel { "steel" } else { "iron" };
            let (number, time) = (reading + 1, life / 8.0);
            let end = if number == 8 { "worn" } else { "" };
            let _ = writeln!(
                rows,
                "O{index}-{number},M,E{index},{number},{material},{speed},{feed},12,{width},{time:.4},{wear:.4},{end}"
            );
        }
    }
    parse_csv("cuts.csv", rows.as_bytes(), RecordKind::Milling).expect("records").0
}

#[test]
fn lives_of_milling_are_those_of_the_process() {
    let base = mill();
    let cut = Cut::nominal(200.0 / 60.0, 0.07e-3, 8e-3);
    let condition = Condition { width: Some(5e-3), ..cut.into() };
    let model = WearModel::new(Law::CutterLife, base.clone(), [condition], Vec::new(), 0.3);
    let start = |name: &str, mean: f64| match (name, &base) {
        ("life.feed_exponent", Base::Milling { life, .. }) => life.feed_exponent,
        ("life.depth_exponent", Base::Milling { life, .. }) => life.depth_exponent,
        ("life.width_exponent", Base::Milling { life, .. }) => life.width_exponent,
        _ => mean,
    };
    let u: Vec<f64> = model.parameters().iter().map(|parameter| start(&parameter.name, parameter.prior.mean)).collect();
    let input = MillingInput {
        cutting_speed: 200.0 / 60.0,
        feed_per_tooth: 0.07e-3,
        depth_of_cut: 8e-3,
        width_of_cut: 5e-3,
        ..MillingInput::default()
    };
    let (life, _) = Milling::named("c45_endmill_d12").expect("shipped").life(&input).expect("a life");
    let found = model.life(&u, condition);
    assert!((found * 60.0 / life.cutting_time - 1.0).abs() < 1e-6, "{found} min against {} s", life.cutting_time);
}

#[test]
fn milling_is_calibrated_with_groups_of_edges_and_says_how_much_faster_each_wears() {
    let by = |word: Option<&str>| Treatment {
        by: Some(("material".to_owned(), word.map(str::to_owned))),
        ..Treatment::from_base(&mill())
    };
    let measured = Measured::treated(&cuts(), 0.3, &by(None)).expect("edges");
    assert_eq!((measured.groups.join(","), measured.process), ("iron,steel".to_owned(), Process::Milling));
    let request = Request {
        candidates: shapes(Law::CutterLife),
        by: Some("material".to_owned()),
        draws: 1000,
        ..Request::default()
    };
    let calibration = Calibration::new(measured, mill(), request.clone()).expect("a calibration");
    // The curve of the truth is neither straight nor tilted.
    assert_eq!(calibration.choice.carried.shape, Shape::Curved, "{:?}", calibration.choice.scores);
    let json = calibration.json();
    let named = |name: &str| {
        let list = json["parameters"].as_array().expect("a list");
        list.iter().find(|parameter| parameter["name"] == name).expect("named").clone()
    };
    let holds = |name: &str, value: f64| {
        let ends = &named(name)["ci90"];
        assert!(ends[0].as_f64() < Some(value) && Some(value) < ends[1].as_f64(), "{name}: {value} in {ends}");
    };
    holds("material=steel", 2.0);
    holds("life.feed_exponent", 0.36);
    holds("life.width_exponent", 0.65);
    assert_eq!(named("life.depth_exponent")["determined"], false);
    let set = calibration.set_file("ours", "c45_endmill_d12");
    assert!(set.contains("process = \"milling\"") && set.contains("[parameters.life]"), "{set}");
    let folder = std::env::temp_dir().join(format!("toolroom-calibrate-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    std::fs::write(folder.join("ours.toml"), set).expect("a file");
    let read = Milling::load("./ours.toml", &folder).expect("the set is accepted");
    let life = calibration.lives.iter().find(|life| (life.condition.cut.cutting_speed * 60.0 - 190.0).abs() < 1e-6);
    let life = life.expect("a tested speed");
    let input = MillingInput {
        cutting_speed: life.condition.cut.cutting_speed,
        feed_per_tooth: life.condition.cut.feed_per_rev,
        depth_of_cut: life.condition.cut.depth_of_cut,
        width_of_cut: life.condition.width.expect("a width"),
        ..MillingInput::default()
    };
    let (of_set, _) = read.life(&input).expect("a life");
    assert!((of_set.cutting_time / 60.0 / life.median - 1.0).abs() < 0.1, "{} against {life:?}", of_set.cutting_time);
    // With steel first the set carries steel: half the life.
    let steel = Measured::treated(&cuts(), 0.3, &by(Some("steel"))).expect("edges");
    let request = Request { candidates: vec![Law::CutterLife.into()], ..request };
    let other = Calibration::new(steel, mill(), request).expect("a calibration");
    let ratio = other.lives[0].median / calibration.lives[0].median;
    assert!((0.4..0.6).contains(&ratio), "{ratio}");
    let wrong = |word| Measured::treated(&cuts(), 0.3, &by(Some(word)));
    assert!(matches!(wrong("brass"), Err(DataError::Groups { .. })));
    std::fs::remove_dir_all(folder).expect("the folder goes");
}

#[test]
fn passes_instead_of_minutes_give_shapes_and_no_exponent_of_taylors_law() {
    let mut rows = String::from("operation_id,tool_id,sequence,cutting_speed [m/min],flank_wear [mm]\n");
    for (edge, (speed, level)) in [(55.0, 1.0), (55.0, 1.1), (80.0, 1.15), (80.0, 0.95)].into_iter().enumerate() {
        for pass in 1..=6_u32 {
            let wear = 0.05 * level * f64::from(pass) + [0.003, -0.004, 0.001][(edge + pass as usize) % 3];
            let _ = writeln!(rows, "{edge}-{pass},T{edge},{pass},{speed},{wear:.4}");
        }
    }
    let records = parse_csv("passes.csv", rows.as_bytes(), RecordKind::Empirical).expect("records").0;
    let measured = Measured::treated(&records, 0.3, &Treatment::from_base(&Base::from(&pair()))).expect("edges");
    assert_eq!(measured.clock, Clock::Operations);
    assert!(measured.notes.iter().any(|note| note.contains("no feed_per_rev, depth_of_cut")), "{:?}", measured.notes);
    let taylor = measured.refusals.iter().find(|refusal| refusal.contains("lives count operations"));
    assert!(taylor.is_some(), "{:?}", measured.refusals);
    let request = Request { candidates: shapes(Law::ExtendedTaylor), draws: 1000, ..Request::default() };
    let calibration = Calibration::new(measured, &pair(), request).expect("a calibration");
    assert_eq!(calibration.choice.carried.shape, Shape::Straight, "{:?}", calibration.choice.scores);
    let life = &calibration.lives[0];
    assert!((5.0..7.0).contains(&life.median), "{life:?}");
    assert!(calibration.text().contains("life in operations"), "{}", calibration.text());
}

/// Edges of Taylor's law of turning, read `readings` times each, over a life at three speeds.
fn edges(readings: usize, count: usize) -> (Vec<Cut>, Vec<Edge>) {
    let conditions: Vec<Cut> = [180.0, 220.0, 280.0].map(|speed| Cut::nominal(speed / 60.0, 0.3e-3, 1.5e-3)).to_vec();
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let made = (0..count)
        .map(|index| {
            let condition = index % 3;
            let speed = conditions[condition].cutting_speed * 60.0;
            let time = 60.0 * (222.0_f64 / speed).powi(5) / readings as f64;
            let stretches = vec![Stretch::read(condition, time, 0.0); readings];
            let edge = Edge { name: format!("E{index}"), stretches, life: None, begun: None };
            let model = WearModel::new(Law::ExtendedTaylor, &pair(), conditions.clone(), vec![edge.clone()], 0.3);
            let truth: Vec<f64> = model
                .parameters()
                .iter()
                .map(|parameter| match parameter.name.as_str() {
                    "extended_taylor.reference_life" => 60f64.ln(),
                    "edge_scatter" => 0.15f64.ln(),
                    "reading_noise" => 0.008f64.ln(),
                    _ => parameter.prior.mean,
                })
                .collect();
            let read = model.replicate(&truth, 0, &mut random);
            let stretches =
                edge.stretches.iter().zip(read).map(|(stretch, wear)| Stretch { wear: Some(wear), ..*stretch });
            Edge { stretches: stretches.collect(), ..edge }
        })
        .collect();
    (conditions, made)
}

/// The same edges as records.
fn recorded(edges: &[Edge], conditions: &[Cut]) -> Records {
    let mut rows = String::from(
        "operation_id,machine,tool_id,sequence,cutting_speed [m/min],feed_per_rev [mm],depth_of_cut [mm],\
         cutting_time [min],flank_wear [mm],edge_end\n",
    );
    for edge in edges {
        for (index, stretch) in edge.stretches.iter().enumerate() {
            let speed = conditions[stretch.condition].cutting_speed * 60.0;
            let (name, wear) = (&edge.name, stretch.wear.unwrap_or(f64::NAN));
            let end = if index + 1 == edge.stretches.len() { "worn" } else { "" };
            let _ =
                writeln!(rows, "{name}-{index},L,{name},{index},{speed},0.3,1.5,{:.9},{wear:.9},{end}", stretch.time);
        }
    }
    parse_csv("wear.csv", rows.as_bytes(), RecordKind::Turning).expect("records").0
}

fn prior_means(model: &WearModel) -> DVector<f64> {
    let means = model.parameters().iter().map(|parameter| parameter.prior.mean);
    DVector::from_iterator(model.parameters().len(), means)
}

#[test]
fn blocks_of_readings_say_what_the_readings_say() {
    let (conditions, edges) = edges(300, 6);
    let packed = Measured::of(&recorded(&edges, &conditions), 0.3).expect("edges");
    assert_eq!(packed.readings(), 1800);
    assert!(packed.edges.iter().all(|edge| (60..=120).contains(&edge.readings())), "{}", packed.edges[0].readings());
    for law in [Law::ExtendedTaylor, Law::Usui] {
        let whole = WearModel::new(law, &pair(), conditions.clone(), edges.clone(), 0.3);
        let blocks = WearModel::new(law, &pair(), packed.conditions.clone(), packed.edges.clone(), 0.3);
        let every: Vec<usize> = (0..edges.len()).collect();
        let best = maximise(&whole, &every, &prior_means(&whole), None).expect("a maximum");
        let other = maximise(&blocks, &every, &best.u, Some(&best.covariance)).expect("a maximum");
        for index in 0..best.u.len() {
            let deviation = best.covariance[(index, index)].sqrt();
            let off = (best.u[index] - other.u[index]) / deviation;
            let name = &whole.parameters()[index].name;
            assert!(off.abs() < 0.05, "{}, {name}: {off} deviations", law.group());
            let ratio = other.covariance[(index, index)].sqrt() / deviation;
            assert!((ratio - 1.0).abs() < 0.05, "{}, {name}: {ratio} of the deviation", law.group());
        }
    }
}

#[test]
fn densities_near_a_place_are_those_that_are_found_from_anywhere() {
    let (conditions, edges) = edges(40, 6);
    let every: Vec<usize> = (0..edges.len()).collect();
    for law in [Law::ExtendedTaylor, Law::EnergyBalance] {
        let model = WearModel::new(law, &pair(), conditions.clone(), edges.clone(), 0.3);
        let best = maximise(&model, &every, &prior_means(&model), None).expect("a maximum");
        let near = model.near(best.u.as_slice()).expect("edges with many readings");
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let root = best.covariance.clone().cholesky().expect("positive").l();
        let mut compared = 0;
        for _ in 0..20 {
            let normal = DVector::from_fn(best.u.len(), |_, _| StandardNormal.sample(&mut random));
            let there = &best.u + 2.0 * &root * normal;
            let (approximate, other) =
                (near.ln_posterior(there.as_slice(), &every), model.ln_posterior(there.as_slice(), &every));
            if approximate == other {
                // An exponent below zero has no density.
                continue;
            }
            compared += 1;
            assert!((approximate - other).abs() < 1e-5, "{}: {approximate} against {other}", law.group());
        }
        assert!(compared > 5, "{}: {compared}", law.group());
    }
}

#[test]
fn edges_held_out_are_predicted_and_profiles_agree_with_the_draws() {
    let (conditions, edges) = edges(8, 8);
    let records = recorded(&edges, &conditions);
    let request = Request {
        candidates: vec![Law::ExtendedTaylor.into()],
        held_out: vec!["E3".to_owned(), "E7".to_owned()],
        profile: true,
        draws: 1000,
        ..Request::default()
    };
    let found = Calibration::new(Measured::of(&records, 0.3).expect("edges"), &pair(), request).expect("a calibration");
    assert_eq!(found.measured.edges.len(), 6);
    let held = found.held_out.as_ref().expect("edges held out");
    assert_eq!((held.names.join(","), held.coverage.readings), ("E3,E7".to_owned(), 16));
    assert!(held.coverage.inside90 > 0.6, "{:?}", held.coverage);
    assert!(found.text().contains("held out: E3, E7"), "{}", found.text());
    let profile = found.profiles.as_ref().expect("profiles");
    let parameters = found.carried().model.parameters();
    let life = parameters.iter().position(|parameter| parameter.name == "extended_taylor.reference_life");
    let (place, deviation) = (life.expect("named"), |index| found.posterior.deviation(index));
    let ends = [0.05, 0.95].map(|share| found.posterior.quantile(place, share));
    for (end, of_draws) in profile[place].iter().zip(ends) {
        assert!((end - of_draws).abs() < 0.5 * deviation(place), "{profile:?} against {ends:?}");
    }
    // No edge chipped, and the records say so: a bound, and the set keeps its own rate.
    let chipping = found.chipping.expect("ends are told");
    assert!(chipping.chips == 0 && chipping.ci90[1] > 0.0);
    assert!(!found.set_file("ours", "c45_t15k6").contains("[parameters.chipping]"));
    let wrong = Request { held_out: vec!["E9".to_owned()], ..found.request.clone() };
    let calibration = Calibration::new(Measured::of(&records, 0.3).expect("edges"), &pair(), wrong);
    assert!(calibration.is_err_and(|error| error.to_string().contains("no edge `E9`")));
    assert_eq!(found.choice.verdict, Verdict::Given);
    let model = &found.carried().model;
    let every: Vec<usize> = (0..6).collect();
    assert_eq!(profiles(model, &every, &found.posterior.map), *profile);
}

#[test]
fn noise_within_lives_leaves_a_density_that_draws_can_be_taken_of() {
    let (conditions, edges) = edges(10, 12);
    let every: Vec<usize> = (0..edges.len()).collect();
    for law in [Law::ExtendedTaylor, Law::Usui] {
        let model = WearModel::new(law, &pair(), conditions.clone(), edges.clone(), 0.3).with_life_noise(5.0);
        let found = sample(&model, &every, 1000, 1).expect("a posterior");
        assert_ne!(found.method, Method::Ensemble, "{}: {} modes", law.group(), found.modes.len());
    }
}
