//! From records to answers, on records that a law made.

use nalgebra::DVector;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::fmt::Write as _;
use toolroom_calibrate::{
    Calibration, CalibrationError, Channel, DataError, Edge, IDLE_POWER, Law, Life, Measured, Method, Model, Parameter,
    Prior, Request, Scale, Stretch, Verdict, WearModel, sample,
};
use toolroom_records::{RecordKind, Records, parse_csv};
use toolroom_wear::{Cut, Pair};

const HEADER: &str = "operation_id,machine,tool_id,sequence,cutting_speed [m/min],feed_per_rev [mm],depth_of_cut [mm],\
                      cutting_time [min],flank_wear [mm],edge_end\n";

fn base() -> Pair {
    Pair::named("c45_t15k6").expect("shipped")
}

fn records(rows: &str) -> Records {
    parse_csv("wear.csv", format!("{HEADER}{rows}").as_bytes(), RecordKind::Turning).expect("records").0
}

/// Rows of edges at some speeds that wear by Taylor's law.
fn made(speeds: &[f64]) -> String {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let conditions: Vec<Cut> = speeds.iter().map(|speed| Cut::nominal(speed / 60.0, 0.3e-3, 1.5e-3)).collect();
    let mut rows = String::new();
    for (index, speed) in speeds.iter().enumerate() {
        let time = 4.0 * (220.0 / speed).powi(5);
        let edge = Edge {
            name: format!("E{index}"),
            stretches: vec![Stretch::read(index, time, 0.0); 8],
            life: None,
            begun: None,
        };
        let model = WearModel::new(Law::ExtendedTaylor, &base(), conditions.clone(), vec![edge], 0.3);
        let names: Vec<&str> = model.parameters().iter().map(|parameter| parameter.name.as_str()).collect();
        let truth = names.iter().zip(model.parameters()).map(|(name, parameter)| match *name {
            "extended_taylor.reference_life" => 60f64.ln(),
            "edge_scatter" => 0.15f64.ln(),
            "reading_noise" => 0.008f64.ln(),
            _ => parameter.prior.mean,
        });
        let truth = DVector::from_iterator(names.len(), truth);
        for (reading, wear) in model.replicate(truth.as_slice(), 0, &mut random).iter().enumerate() {
            let sequence = reading + 1;
            let _ = writeln!(rows, "O{index}{reading},L1,E{index},{sequence},{speed},0.3,1.5,{time},{wear:.4},");
        }
    }
    rows
}

fn request(laws: &[Law]) -> Request {
    Request {
        candidates: laws.iter().map(|law| (*law).into()).collect(),
        limit: 0.3,
        draws: 1000,
        seed: 3,
        ..Request::default()
    }
}

#[test]
fn edges_that_did_not_wear_out_are_censored_and_the_rest_is_said() {
    let rows = "1,L1,A,1,200,0.3,1.5,5,,\n2,L1,A,2,200,0.3,1.5,6,,worn\n\
                3,L1,B,1,200,0.3,1.5,4,,chipped\n\
                4,L1,C,2,200,0.3,1.5,4,0.10,\n5,L1,C,1,200,0.3,1.5,4,0.20,\n6,L1,C,3,200,0.3,1.5,4,0.05,\n";
    let measured = Measured::of(&records(rows), 0.3).expect("edges");
    assert_eq!(measured.edges[0].life, Some((0, Life::Exact(11.0))));
    assert_eq!(measured.edges[1].life, Some((0, Life::Censored(4.0))));
    let read: Vec<f64> = measured.edges[2].stretches.iter().filter_map(|stretch| stretch.wear).collect();
    assert!((read[0] - 0.20).abs() < 1e-12, "rows are in the order of their sequence: {read:?}");
    assert!(
        measured.notes.iter().any(|note| note.contains("wear falls from 0.200 to 0.100 mm")),
        "{:?}",
        measured.notes
    );
    assert!(measured.notes.iter().any(|note| note.starts_with("1 edges without edge_end")), "{:?}", measured.notes);
    assert!(measured.refusals.iter().any(|refusal| refusal.starts_with("one cutting speed (200 m/min)")));
    let wrong = Measured::of(&records("1,L1,A,1,200,0.3,1.5,5,0.1,blunt\n"), 0.3);
    assert!(matches!(wrong, Err(DataError::End { .. })), "{wrong:?}");
}

#[test]
fn a_calibration_finds_what_made_the_records_and_says_what_it_cannot_know() {
    let measured = Measured::of(&records(&made(&[180.0, 180.0, 220.0, 220.0, 300.0, 300.0])), 0.3).expect("edges");
    let calibration =
        Calibration::new(measured, &base(), request(&[Law::ExtendedTaylor, Law::Usui])).expect("a calibration");
    assert_eq!((calibration.choice.verdict, calibration.choice.carried.law), (Verdict::Chosen, Law::ExtendedTaylor));
    let json = calibration.json();
    let named = |name: &str| {
        let list = json["parameters"].as_array().expect("a list");
        list.iter().find(|parameter| parameter["name"] == name).expect("named").clone()
    };
    let life = named("extended_taylor.reference_life");
    let inside = |value: f64| (life["ci90"][0].as_f64() < Some(value)) && (Some(value) < life["ci90"][1].as_f64());
    assert!(inside(60.0), "{life}");
    assert_eq!(named("extended_taylor.feed_exponent")["determined"], false);
    assert!(calibration.undetermined());
    assert!(calibration.text().contains("vary feed_per_rev"), "{}", calibration.text());
    let set = calibration.set_file("ours", "c45_t15k6");
    assert!(set.contains("law = \"extended_taylor\"") && set.contains("[scatter]\ncommon_wear = "), "{set}");
    assert!(set.contains("life_noise = 0.0 # not fitted"), "{set}");
    let again = Measured::of(&records(&made(&[180.0, 180.0, 220.0, 220.0, 300.0, 300.0])), 0.3).expect("edges");
    let again = Calibration::new(again, &base(), request(&[Law::ExtendedTaylor, Law::Usui])).expect("a calibration");
    assert_eq!(json, again.json(), "the same seed gives the same answers");
}

#[test]
fn a_parameter_that_no_law_has_is_refused_by_name() {
    let measured = Measured::of(&records(&made(&[200.0, 250.0])), 0.3).expect("edges");
    let wrong = Request { fixed: vec![("stage_tlit".to_owned(), 0.0)], ..request(&[Law::ExtendedTaylor]) };
    let calibration = Calibration::new(measured, &base(), wrong);
    assert!(
        matches!(&calibration, Err(CalibrationError::Parameter { name, .. }) if name == "stage_tlit"),
        "{calibration:?}"
    );
}

#[test]
fn a_value_that_is_fixed_is_the_one_of_the_set_and_one_that_cannot_be_is_refused() {
    let fixed = |fixed: &[(&str, f64)]| {
        let measured = Measured::of(&records(&made(&[200.0, 250.0, 300.0])), 0.3).expect("edges");
        let fixed = fixed.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
        Calibration::new(measured, &base(), Request { fixed, ..request(&[Law::ExtendedTaylor]) })
    };
    let set = fixed(&[("stage_tilt", 0.2)]).expect("a calibration").set_file("ours", "c45_t15k6");
    assert!(set.contains("stage_tilt = { value = 0.2,"), "{set}");
    for (name, value, reason) in [
        ("stage_tilt", 0.9, "stage_tilt"),
        ("stage_contrast", 2.0, "stage_contrast"),
        ("reference_life", -5.0, "reference_life"),
        ("edge_scatter", 0.1, "--prior"),
    ] {
        let refused = fixed(&[(name, value)]).expect_err(name).to_string();
        assert!(refused.starts_with(&format!("--fix {name}={value}: ")) && refused.contains(reason), "{refused}");
    }
}

#[test]
fn forces_are_fitted_against_the_wear_that_was_fitted() {
    let base = base();
    let mut rows = String::from(HEADER.trim_end());
    rows.push_str(",cutting_force [N]\n");
    let wear: Vec<String> = made(&[180.0, 180.0, 220.0, 220.0, 300.0, 300.0]).lines().map(str::to_owned).collect();
    for (index, row) in wear.iter().enumerate() {
        let cells: Vec<&str> = row.split(',').collect();
        let number = |place: usize| cells[place].parse::<f64>().expect("a number");
        let cut = Cut::nominal(number(4) / 60.0, 0.3e-3, 1.5e-3);
        // The stress on the land is a fifth above that of the set; readings are off by up to 2 %.
        let load = base.force.load(&cut);
        let error = 1.0 + [0.02, -0.01, 0.0, 0.01, -0.02][index % 5];
        let force = (load.sharp + 1.2 * load.shear_per_wear * number(8) * 1e-3) * error;
        let _ = writeln!(rows, "{row},{force:.1}");
    }
    let records = parse_csv("wear.csv", rows.as_bytes(), RecordKind::Turning).expect("records").0;
    let measured = Measured::of(&records, 0.3).expect("edges");
    let calibration = Calibration::new(measured, &base, request(&[Law::ExtendedTaylor])).expect("a calibration");
    let force = calibration.channels.first().expect("forces");
    let stress = 1.2 * base.force.flank_shear_stress * 1e-6;
    let place = force.model.parameters().iter().position(|parameter| parameter.name == "force.flank_shear_stress");
    let place = place.expect("named");
    let [low, high] = [0.05, 0.95].map(|share| force.posterior.quantile(place, share).exp());
    assert!(low < stress && stress < high, "{low} … {high} against {stress}");
    assert!(force.gain.0 > 2.0 * force.gain.1, "{:?}", force.gain);
    assert!(calibration.set_file("ours", "c45_t15k6").contains("[parameters.force]"));
    let columns = calibration.draw_columns();
    assert!(
        columns.contains(&"force.flank_shear_stress [MPa]".to_owned()) && !columns.contains(&"force_noise".to_owned())
    );
    assert!(calibration.draws().all(|draw| draw.len() == columns.len()));
}

/// Edges with a feed force and a spindle power: the ratio of the feed force is a tenth above that of the set, the pressure on the
/// land three tenths, the stress on it a fifth; the spindle idles with 0.8 kW.
fn loaded(base: &Pair, with_force: bool) -> Records {
    let mut rows = String::from(HEADER.trim_end());
    rows.push_str(",feed_force [N],spindle_power [kW]");
    rows.push_str(if with_force { ",cutting_force [N]\n" } else { "\n" });
    for (index, row) in made(&[180.0, 180.0, 220.0, 220.0, 300.0, 300.0]).lines().enumerate() {
        let cells: Vec<&str> = row.split(',').collect();
        let number = |place: usize| cells[place].parse::<f64>().expect("a number");
        let speed = number(4) / 60.0;
        let (load, wear) = (base.force.load(&Cut::nominal(speed, 0.3e-3, 1.5e-3)), number(8) * 1e-3);
        let error = |shift: usize| 1.0 + [0.02, -0.01, 0.0, 0.01, -0.02][(index + shift) % 5];
        let feed = (1.1 * load.feed_force_ratio * load.sharp + 1.3 * load.pressure_per_wear * wear) * error(0);
        let cutting = load.sharp + 1.2 * load.shear_per_wear * wear;
        let power = (cutting * speed * 1e-3 + 0.8) * error(2);
        let _ = write!(rows, "{row},{feed:.1},{power:.4}");
        let _ = if with_force { writeln!(rows, ",{:.1}", cutting * error(3)) } else { writeln!(rows) };
    }
    parse_csv("wear.csv", rows.as_bytes(), RecordKind::Turning).expect("records").0
}

#[test]
fn feed_force_and_power_tell_of_the_land_as_the_cutting_force_does() {
    let base = base();
    let found = |with_force: bool| {
        let measured = Measured::of(&loaded(&base, with_force), 0.3).expect("edges");
        Calibration::new(measured, &base, request(&[Law::ExtendedTaylor])).expect("a calibration")
    };
    let held = |found: &Calibration, name: &str, truth: f64| {
        let mut places = found.channels.iter().flat_map(|fit| {
            let names = fit.model.parameters().iter().enumerate();
            names.filter(|(_, parameter)| parameter.name == name).map(move |(place, _)| (fit, place))
        });
        let (fit, place) = places.next().unwrap_or_else(|| panic!("{name}"));
        let [low, high] = [0.05, 0.95].map(|share| fit.posterior.quantile(place, share).exp());
        assert!(low < truth && truth < high, "{name}: {low} … {high} against {truth}");
        assert!(fit.gain.0 > 2.0 * fit.gain.1, "{name}: {:?}", fit.gain);
    };
    let channels = |found: &Calibration| found.channels.iter().map(|fit| fit.model.channel()).collect::<Vec<_>>();
    let without = found(false);
    assert_eq!(channels(&without), [Channel::SpindlePower, Channel::FeedForce]);
    held(&without, "force.flank_shear_stress", 1.2 * base.force.flank_shear_stress * 1e-6);
    held(&without, IDLE_POWER, 0.8);
    held(&without, "force.feed_force_ratio", 1.1 * base.force.feed_force_ratio);
    held(&without, "force.flank_pressure", 1.3 * base.force.flank_pressure * 1e-6);
    // The set and the draws hold what a set has a name for; the idle power is one of the machine.
    let set = without.set_file("ours", "c45_t15k6");
    assert_eq!(set.matches("[parameters.force]").count(), 1);
    assert!(set.contains("feed_force_ratio") && set.contains("flank_pressure") && !set.contains(IDLE_POWER), "{set}");
    let columns = without.draw_columns();
    assert!(columns.contains(&"force.flank_pressure [MPa]".to_owned()), "{columns:?}");
    assert!(without.draws().all(|draw| draw.len() == columns.len()));
    // Where the cutting force was read, power says nothing more of it.
    let with = found(true);
    assert_eq!(channels(&with), [Channel::CuttingForce, Channel::FeedForce]);
    assert!(
        with.measured.notes.iter().any(|note| note.contains("spindle_power is not used")),
        "{:?}",
        with.measured.notes
    );
}

/// A density with two narrow maxima beside a wide prior.
struct Twins {
    parameters: Vec<Parameter>,
}

impl Twins {
    fn ln_likelihood_at(u: f64) -> f64 {
        let one =
            |mean: f64, deviation: f64, share: f64| share / deviation * (-0.5 * ((u - mean) / deviation).powi(2)).exp();
        (one(-2.0, 0.3, 0.7) + one(1.5, 0.5, 0.3)).ln()
    }
}

impl Model for Twins {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn edges(&self) -> usize {
        1
    }

    fn ln_densities(&self, u: &[f64], edges: &[usize]) -> Vec<f64> {
        edges.iter().map(|_| Self::ln_likelihood_at(u[0])).collect()
    }

    fn readings(&self, _edge: usize) -> Vec<f64> {
        Vec::new()
    }

    fn replicate(&self, _u: &[f64], _edge: usize, _random: &mut ChaCha8Rng) -> Vec<f64> {
        Vec::new()
    }
}

#[test]
fn two_maxima_are_drawn_by_what_lies_around_each_without_an_ensemble() {
    let prior = Prior::new(0.0, 2.0);
    let model = Twins { parameters: vec![Parameter::new("u", "1", Scale::Plain, prior, "measure")] };
    let density = |u: f64| (Twins::ln_likelihood_at(u) + prior.ln_density(u)).exp();
    let sum = |from: i32, to: i32| (from..to).map(|place| density(0.001 * f64::from(place))).sum::<f64>();
    let above = sum(0, 8000) / sum(-8000, 8000);
    let found = sample(&model, &[0], 4000, 3).expect("a density");
    assert_eq!((found.modes.len(), found.method), (1, Method::ResampledLaplace));
    let drawn = found.draws.iter().filter(|draw| draw[0] > 0.0).count() as f64 / 4000.0;
    assert!((drawn - above).abs() < 0.02, "{drawn} against {above}");
}

#[test]
fn one_edge_is_fitted_and_neither_a_law_nor_the_scatter_of_edges_is_claimed() {
    let measured = Measured::of(&records(&made(&[220.0])), 0.3).expect("an edge");
    let calibration =
        Calibration::new(measured, &base(), request(&[Law::ExtendedTaylor, Law::Usui])).expect("a calibration");
    assert_eq!(calibration.choice.verdict, Verdict::CannotTell);
    let text = calibration.text();
    assert!(text.contains("1 edge(s): the scatter of edges is the prior; measure three or more"), "{text}");
    assert!(calibration.undetermined());
}

#[test]
fn readings_in_another_unit_are_refused_with_the_unit_that_they_look_like() {
    let thousand = made(&[180.0, 220.0]).lines().fold(String::new(), |mut rows, line| {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if let Ok(wear) = cells[8].parse::<f64>() {
            cells[8] = format!("{}", 1000.0 * wear);
        }
        let _ = writeln!(rows, "{}", cells.join(","));
        rows
    });
    let error = Measured::of(&records(&thousand), 0.3).expect_err("no flank wear");
    assert!(error.to_string().contains("write flank_wear [um]"), "{error}");
}

#[test]
fn values_far_from_what_was_expected_are_told_as_a_unit_that_may_be_wrong() {
    // Minutes that are read as seconds.
    let seconds = HEADER.replace("[min]", "[s]") + &made(&[180.0, 220.0, 260.0]);
    let short = parse_csv("wear.csv", seconds.as_bytes(), RecordKind::Turning).expect("records").0;
    let told = |records: &Records| {
        let measured = Measured::of(records, 0.3).expect("edges");
        let calibration = Calibration::new(measured, &base(), request(&[Law::ExtendedTaylor])).expect("a calibration");
        calibration.warnings().into_iter().filter(|warning| warning.contains("that were expected")).collect::<Vec<_>>()
    };
    let warnings = told(&short);
    assert!(warnings.iter().any(|warning| warning.contains("reference_life is")), "{warnings:?}");
    assert_eq!(told(&records(&made(&[180.0, 220.0, 260.0]))), Vec::<String>::new());
}

#[test]
fn records_without_wear_need_edges_that_wore_out_and_words_of_ends_count_on_last_rows() {
    let unread = |end: &str| {
        made(&[180.0, 220.0]).lines().fold(String::new(), |mut rows, line| {
            let cells: Vec<&str> = line.split(',').collect();
            let last = cells[3] == "8";
            let _ = writeln!(rows, "{},,{}", cells[..8].join(","), if last { end } else { "" });
            rows
        })
    };
    let error = Measured::of(&records(&unread("stopped")), 0.3).expect_err("nothing tells of wear");
    assert_eq!(error, DataError::NoWear);
    let worn = Measured::of(&records(&unread("worn")), 0.3).expect("lives");
    assert!(worn.notes.iter().any(|note| note.contains("no flank_wear")), "{:?}", worn.notes);
    let early = made(&[180.0, 220.0]).replacen(",\n", ",worn\n", 1);
    let measured = Measured::of(&records(&early), 0.3).expect("edges");
    assert!(measured.notes.iter().any(|note| note.contains("`worn` in row 1")), "{:?}", measured.notes);
}

#[test]
fn an_exponent_of_what_never_changed_is_not_called_determined() {
    let measured = Measured::of(&records(&made(&[220.0, 220.0, 220.0, 220.0])), 0.3).expect("edges");
    let calibration = Calibration::new(measured, &base(), request(&[Law::ExtendedTaylor])).expect("a calibration");
    let json = calibration.json();
    for name in ["speed_exponent", "feed_exponent", "depth_exponent"] {
        let listed = json["parameters"].as_array().expect("a list");
        let own = listed.iter().find(|own| own["name"] == format!("extended_taylor.{name}")).expect("a parameter");
        assert_eq!(own["determined"], false, "{own}");
    }
}

#[test]
fn falls_of_many_edges_are_told_at_once_and_wear_far_below_zero_is_refused() {
    let fallen = |wear: &str| {
        made(&[180.0, 180.0, 220.0]).lines().fold(String::new(), |mut rows, line| {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            if cells[3] == "5" {
                cells[8] = wear.to_owned();
            }
            let _ = writeln!(rows, "{}", cells.join(","));
            rows
        })
    };
    let measured = Measured::of(&records(&fallen("0.01")), 0.3).expect("edges");
    let falls: Vec<&String> = measured.notes.iter().filter(|note| note.contains("wear falls")).collect();
    assert!(matches!(falls.as_slice(), [note] if note.starts_with("3 edges, E0 first")), "{falls:?}");
    let error = Measured::of(&records(&fallen("-0.2")), 0.3).expect_err("no wear");
    assert!(error.to_string().contains("leave the cell empty"), "{error}");
}

/// Rows of six edges with the temperature and the thermo-EMF of a set, each off by up to 1.5 %.
fn heated(truth: &Pair, columns: [bool; 2]) -> Records {
    let mut rows = String::from(HEADER.trim_end());
    rows.push_str(if columns[0] { ",temperature [degC]" } else { "" });
    rows.push_str(if columns[1] { ",thermo_emf [mV]\n" } else { "\n" });
    for (index, row) in made(&[180.0, 180.0, 220.0, 220.0, 300.0, 300.0]).lines().enumerate() {
        let cells: Vec<&str> = row.split(',').collect();
        let number = |place: usize| cells[place].parse::<f64>().expect("a number");
        let point = truth.point(&Cut::nominal(number(4) / 60.0, 0.3e-3, 1.5e-3), number(8).max(0.0) * 1e-3);
        let error = |shift: usize| 1.0 + [0.015, -0.01, 0.0, 0.008, -0.013][(index + shift) % 5];
        let temperature = format!(",{:.1}", point.temperature * error(0) - 273.15);
        let emf = format!(",{:.3}", point.thermo_emf * 1e3 * error(2));
        let of = |there: bool, cell: String| if there { cell } else { String::new() };
        let _ = writeln!(rows, "{row}{}{}", of(columns[0], temperature), of(columns[1], emf));
    }
    parse_csv("wear.csv", rows.as_bytes(), RecordKind::Turning).expect("records").0
}

#[test]
fn temperature_and_thermo_emf_tell_how_the_contact_heats() {
    let (base, mut truth) = (base(), base());
    truth.temperature.chip_heating *= 1.06;
    truth.temperature.flank_heating *= 1.5;
    truth.emf.sensitivity *= 1.2;
    let found = |columns: [bool; 2]| {
        let measured = Measured::of(&heated(&truth, columns), 0.3).expect("edges");
        Calibration::new(measured, &base, request(&[Law::EnergyBalance])).expect("a calibration")
    };
    let rise = |pair: &Pair, speed: f64, wear: f64| {
        let point = pair.point(&Cut::nominal(speed / 60.0, 0.3e-3, 1.5e-3), wear);
        point.temperature - pair.temperature.ambient_temperature
    };
    for (columns, channels) in
        [([true, false], vec![Channel::Temperature]), ([true, true], vec![Channel::Temperature, Channel::ThermoEmf])]
    {
        let found = found(columns);
        assert_eq!(found.channels.iter().map(|fit| fit.model.channel()).collect::<Vec<_>>(), channels);
        let heat = &found.channels[0];
        let told = heat.model.at(heat.posterior.map.u.as_slice());
        for (speed, wear) in [(180.0, 0.02e-3), (180.0, 0.25e-3), (300.0, 0.02e-3), (300.0, 0.25e-3)] {
            let (told, true_rise) = (rise(&told, speed, wear), rise(&truth, speed, wear));
            assert!((told / true_rise - 1.0).abs() < 0.015, "{speed} {wear}: {told} against {true_rise}");
        }
        assert!(heat.gain.0 > 2.0 * heat.gain.1, "{:?}", heat.gain);
        if let Some(emf) = found.channels.get(1) {
            // The sensitivity is told under the temperatures that were fitted: rise and sensitivity together are what was measured.
            let sensitivity = emf.model.at(emf.posterior.map.u.as_slice()).emf.sensitivity;
            let product = sensitivity * rise(&told, 220.0, 0.1e-3);
            let due = truth.emf.sensitivity * rise(&truth, 220.0, 0.1e-3);
            assert!((product / due - 1.0).abs() < 0.01, "{product} V for {due} V");
        }
        // The wear was fitted under these temperatures, so that the set has both.
        let set = found.set_file("ours", "c45_t15k6");
        assert!(
            set.contains("[parameters.temperature]\nchip_heating") && set.contains("reference_temperature"),
            "{set}"
        );
        assert!(set.contains("\"temperature.chip_heating\" = { factor"), "{set}");
        assert!(found.draw_columns().iter().all(|column| !column.starts_with("temperature")));
        assert!(found.text().contains("under the temperatures that were measured"), "{}", found.text());
    }
    let by_emf = found([false, true]);
    let heat = &by_emf.channels[0];
    let told = heat.model.at(heat.posterior.map.u.as_slice());
    // A characteristic a fifth steeper than that of the set is taken for a contact that is so much hotter.
    assert!(rise(&told, 220.0, 0.1e-3) > 1.1 * rise(&truth, 220.0, 0.1e-3));
    assert!(by_emf.text().contains("whose characteristic (emf) is that of the set"), "{}", by_emf.text());
    let without = found([false, false]);
    assert!(without.text().contains("which these data do not measure"), "{}", without.text());
}

#[test]
fn a_reference_temperature_moves_with_measured_ones_and_the_lives_stay_what_was_measured() {
    let (base, mut truth) = (base(), base());
    truth.temperature.chip_heating *= 1.12;
    let life = |columns: [bool; 2]| {
        let measured = Measured::of(&heated(&truth, columns), 0.3).expect("edges");
        let calibration = Calibration::new(measured, &base, request(&[Law::TakeyamaMurata])).expect("a calibration");
        assert!(
            calibration.warnings().iter().all(|warning| !warning.contains("that were expected")),
            "{:?}",
            calibration.warnings()
        );
        calibration
            .lives
            .iter()
            .find(|life| (life.condition.cut.cutting_speed * 60.0 - 220.0).abs() < 0.1)
            .expect("a speed")
            .median
    };
    let (with, without) = (life([true, false]), life([false, false]));
    assert!((with / without - 1.0).abs() < 0.1, "{with} against {without} min");
}

#[test]
fn rows_that_cut_for_no_time_and_times_that_run_on_are_told() {
    let changed = |with: &dyn Fn(usize, f64) -> f64| {
        made(&[180.0, 220.0, 300.0]).lines().fold(String::new(), |mut rows, line| {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            let time = with(cells[3].parse().expect("a number"), cells[7].parse().expect("a number"));
            cells[7] = time.to_string();
            let _ = writeln!(rows, "{}", cells.join(","));
            rows
        })
    };
    let of = |with: &dyn Fn(usize, f64) -> f64| Measured::of(&records(&changed(with)), 0.3);
    let plain = of(&|_, time| time).expect("edges");
    assert!(plain.notes.iter().all(|note| !note.contains("no cutting time")), "{:?}", plain.notes);
    assert!(plain.refusals.iter().all(|refusal| !refusal.contains("counted from the beginning")));
    // The first reading is that of the new edge.
    let new = of(&|row, time| if row == 1 { 0.0 } else { time });
    let idle = of(&|row, time| if row == 6 { 0.0 } else { time }).expect("edges");
    let told = |measured: &Measured| measured.notes.iter().find(|note| note.contains("no cutting time")).cloned();
    let note = told(&idle).expect("a note");
    assert!(note.starts_with("3 rows") && note.contains("though wear rises"), "{note}");
    assert!(new.is_ok());
    let error = of(&|_, _| 0.0).expect_err("no time");
    assert!(error.to_string().contains("every cutting_time is 0"), "{error}");
    let running = of(&|row, time| row as f64 * time).expect("edges");
    assert!(running.refusals.iter().any(|refusal| refusal.contains("running = true")), "{:?}", running.refusals);
}
