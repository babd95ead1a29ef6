//! Structure files whose modes change with the spindle speed.

use super::{LobesCut, parse, read_structure};
use std::f64::consts::TAU;
use std::path::PathBuf;
use toolroom_chatter::Milling;

/// A folder of its own for one test.
fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("toolroom-lobes-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

const HEAD: &str = "schema = 1\nname = \"spindle\"\n[measurement]\nsource = \"taps while turning\"\n";

fn mode(frequency: f64, under: &str) -> String {
    format!(
        "[[{under}mode]]\nname = \"feed\"\ndirection = [1, 0]\nnatural_frequency = {{ value = \"{frequency} Hz\", sd = \"9 Hz\" }}\n\
         damping_ratio = {{ value = 0.02 }}\nstiffness = {{ value = \"12 N/um\" }}\n"
    )
}

fn speed(rpm: f64, frequency: f64) -> String {
    format!("[[speed]]\nspindle_speed = \"{rpm} rpm\"\n{}", mode(frequency, "speed."))
}

const CHART: &str = "schema = 1\nname = \"chart\"\nprocess = \"milling\"\nstructure = \"spindle.toml\"\n\
    [cutter]\nteeth = 4\ndiameter = \"12 mm\"\n[engagement]\nimmersion = 0.25\ndirection = \"down\"\n\
    [force]\ntangential = \"800 MPa\"\nradial = \"260 MPa\"\n\
    [chart]\nspindle_speed = [\"3000 rpm\", \"9000 rpm\"]\ndepth_of_cut = [\"0 mm\", \"6 mm\"]\n";

/// The cut of the chart with the structure file `text`.
fn cut(name: &str, text: &str) -> Milling {
    let folder = folder(name);
    std::fs::write(folder.join("spindle.toml"), text).unwrap();
    let file = folder.join("chart.toml");
    std::fs::write(&file, CHART).unwrap();
    let found = super::read(&file, &[]).unwrap_or_else(|error| panic!("{error:?}"));
    std::fs::remove_dir_all(folder).unwrap();
    let LobesCut::Milling(cut) = found.content.cut else { panic!("milling") };
    cut
}

#[test]
fn modes_by_speed_reach_every_limit_and_none_outside() {
    let drifting =
        cut("drift", &format!("{HEAD}{}{}{}", speed(3000.0, 1150.0), speed(6000.0, 1120.0), speed(9000.0, 1105.0)));
    let rpm = |speed: f64| speed / 60.0 * TAU;
    for (at, frequency) in [(3000.0, 1150.0), (4500.0, 1135.0), (6000.0, 1120.0), (8000.0, 1110.0)] {
        let fixed = cut("fixed", &format!("{HEAD}{}", mode(frequency, "")));
        let limit = |cut: &Milling| cut.at_speed(rpm(at)).unwrap().limit(20e-3).unwrap().depth;
        let (here, alone) = (limit(&drifting), limit(&fixed));
        // Between the speeds of the table the shape is linear, not the stiffness: a few millionths.
        assert!((here / alone - 1.0).abs() < 1e-5, "{at} rpm: {here} {alone}");
    }
    assert!(drifting.at_speed(rpm(2900.0)).is_err() && drifting.at_speed(rpm(9100.0)).is_err());
}

#[test]
fn the_scatter_and_the_compliance_above_the_range_are_those_of_all_speeds() {
    let folder = folder("scatter");
    let file = folder.join("spindle.toml");
    let residual = "[residual]\nupper_xx = \"0.002 um/N\"\n";
    std::fs::write(&file, format!("{HEAD}{}{}{residual}", speed(3000.0, 1000.0), speed(6000.0, 900.0))).unwrap();
    let structure = read_structure(&file, &[]).unwrap().content;
    std::fs::remove_dir_all(folder).unwrap();
    // 9 Hz of 900 Hz is more than of 1000 Hz.
    assert!((structure.scatter.unwrap().natural_frequency - 0.01).abs() < 1e-12);
    let table = structure.by_speed.unwrap();
    let (slow, fast) = (table.at(table.range().0).unwrap(), table.at(table.range().1).unwrap());
    assert_eq!((slow.len(), structure.modes.len()), (2, 2));
    assert_eq!(slow[1], fast[1]);
    assert!((slow[1].natural_frequency - 1000.0 / 0.3).abs() < 1e-9 && slow[0] != fast[0]);
}

#[test]
fn tables_that_are_none_are_refused_at_their_line() {
    let two = format!("{}{}", mode(900.0, "speed."), mode(1200.0, "speed.").replace("feed", "second"));
    let cases = [
        (format!("{HEAD}{}", speed(3000.0, 900.0)), "spindle speed"),
        (format!("{HEAD}{}{}", speed(6000.0, 900.0), speed(3000.0, 900.0)), "ascend"),
        (format!("{HEAD}{}[[speed]]\nspindle_speed = \"6000 rpm\"\n{two}", speed(3000.0, 900.0)), "same modes"),
        (format!("{HEAD}{}{}", mode(900.0, ""), speed(3000.0, 900.0)), "[[speed]]"),
        (HEAD.to_owned(), "vibration mode"),
    ];
    let folder = folder("faults");
    let file = folder.join("spindle.toml");
    for (text, word) in cases {
        std::fs::write(&file, &text).unwrap();
        let error = read_structure(&file, &[]).unwrap_err();
        assert!(format!("{error:?} {error}").contains(word), "{word}: {error} {error:?}");
    }
    std::fs::remove_dir_all(folder).unwrap();
    // A lobes file still takes its own modes.
    let own = CHART.replace("structure = \"spindle.toml\"\n", "");
    let mode = "[[mode]]\nname = \"feed\"\ndirection = [1, 0]\nnatural_frequency = \"900 Hz\"\ndamping_ratio = 0.02\nstiffness = \"12 N/um\"\n";
    assert!(parse("chart.toml", &format!("{own}{mode}"), &[]).is_ok());
}

#[test]
fn a_corner_radius_reaches_the_limit_and_what_it_cannot_have_is_refused() {
    let own = CHART.replace("structure = \"spindle.toml\"\n", "");
    let mode = "[[mode]]\nname = \"feed\"\ndirection = [1, 0]\nnatural_frequency = \"900 Hz\"\ndamping_ratio = 0.02\nstiffness = \"12 N/um\"\n";
    let text = |cutter: &str, force: &str| {
        let cut = own
            .replace("[engagement]", &format!("{cutter}\n[engagement]"))
            .replace("[chart]", &format!("{force}\n[chart]"));
        format!("{cut}{mode}")
    };
    let limit = |cutter: &str, force: &str| {
        let file = parse("chart.toml", &text(cutter, force), &[]).unwrap_or_else(|error| panic!("{error:?}")).content;
        let LobesCut::Milling(cut) = file.cut else { panic!("milling") };
        cut.at_speed(600.0).unwrap().limit(30e-3).unwrap().depth
    };
    let (cylinder, ball) = (limit("", ""), limit("corner_radius = \"6 mm\"", "axial = \"200 MPa\""));
    // The tip of a ball hardly reaches a wall at a quarter of the diameter: it may go deeper.
    assert!(ball > cylinder + 0.5e-3, "{cylinder} {ball}");
    // A taper turns the force: with the axial coefficient it cuts less deep, and wider above its tip.
    let cone = limit("taper_angle = \"45 deg\"", "axial = \"200 MPa\"");
    assert!((cone / cylinder - 1.0).abs() > 0.01, "{cylinder} {cone}");
    for (cutter, force, word) in [
        ("corner_radius = \"7 mm\"", "", "half the diameter"),
        ("taper_angle = \"10 deg\"\nrunout = \"5 um\"", "feed_per_tooth = \"0.1 mm\"", "tapered cutters"),
        ("taper_angle = \"10 deg\"\ncorner_radius = \"1 mm\"", "", "without a corner radius"),
        ("corner_radius = \"2 mm\"\nrunout = \"5 um\"", "feed_per_tooth = \"0.1 mm\"", "equal pitch"),
    ] {
        let error = parse("chart.toml", &text(cutter, force), &[]).unwrap_err();
        assert!(format!("{error:?}").contains(word), "{word}: {error:?}");
    }
}

#[test]
fn modes_along_a_path_reach_limits_and_what_does_not_fit_is_refused_at_its_line() {
    let station =
        |at: f64, frequency: f64| format!("[[station]]\nposition = \"{at} mm\"\n{}", mode(frequency, "station."));
    let wall = cut("wall", &format!("mass_loss = 0.1\n{HEAD}{}{}", station(0.0, 1150.0), station(60.0, 900.0)));
    let path = wall.along_path.as_ref().unwrap();
    assert_eq!(path.range(), (0.0, 0.06));
    // A tenth of the mass has gone at the end.
    assert!((path.at(0.06).unwrap()[0].natural_frequency - 900.0 / 0.9f64.sqrt()).abs() < 1e-9);
    let alone = cut("alone", &format!("{HEAD}{}", mode(1150.0, "")));
    let limit = |cut: &Milling| cut.at_speed(600.0).unwrap().limit(20e-3).unwrap().depth;
    assert!(limit(&wall) <= limit(&alone) * (1.0 + 1e-9));
    let speed = speed(3000.0, 900.0) + &speed(6000.0, 900.0);
    let cases = [
        (format!("{HEAD}{}", station(0.0, 900.0)), "second station"),
        (format!("{HEAD}{}{}", station(10.0, 900.0), station(0.0, 900.0)), "ascend"),
        (format!("{HEAD}{}{}{speed}", station(0.0, 900.0), station(5.0, 900.0)), "[[station]]"),
        (format!("mass_loss = 0.1\n{HEAD}{}", mode(900.0, "")), "[[station]]"),
        (format!("mass_loss = 0.95\n{HEAD}{}{}", station(0.0, 900.0), station(5.0, 900.0)), "mass_loss"),
    ];
    let folder = folder("stations");
    let file = folder.join("wall.toml");
    for (text, word) in cases {
        std::fs::write(&file, &text).unwrap();
        let error = read_structure(&file, &[]).unwrap_err();
        assert!(format!("{error:?} {error}").contains(word), "{word}: {error} {error:?}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// What a structure file must have is its modes: where they come from is nobody's duty to write.
#[test]
fn a_structure_written_by_hand_needs_no_measurement() {
    let residual = "[residual]\nupper_xx = \"0.0015 um/N\"\n";
    let by_hand = format!("schema = 1\nname = \"spindle\"\n{}{residual}", mode(1655.2, ""));
    let measured = format!("{HEAD}{}{residual}", mode(1655.2, ""));
    assert_eq!(cut("by-hand", &by_hand).modes, cut("measured", &measured).modes);
}
