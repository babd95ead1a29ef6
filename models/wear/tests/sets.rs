//! Parameter sets as files: what they say, where it comes from, and what is refused.

use proptest::prelude::*;
use std::path::{Path, PathBuf};
use toolroom_wear::{Cut, Origin, PARAMETER_SETS, Pair, ParameterSet, Spread, TURNING_SETS, WearLaw};

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("toolroom-sets-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn read(body: &str) -> Result<ParameterSet, String> {
    let text = format!("schema = 1\nname = \"own\"\ntitle = \"own\"\nbased_on = \"c45_t15k6\"\n{body}");
    ParameterSet::parse("own.toml", &text, &TURNING_SETS).map_err(|error| error.to_string())
}

fn refused(body: &str) -> String {
    read(body).expect_err(body)
}

fn value(set: &ParameterSet, key: &str) -> (f64, Origin) {
    let (group, name) = key.split_once('.').unwrap();
    let value = set.value(group, name).unwrap();
    (value.field.to_display(value.value), value.origin.clone())
}

const TAYLOR: &str = "[handbook]\ntaylor = { form = \"v = C / (T^m ap^x f^y)\", C = \"420 m/min\", m = 0.2, x = 0.15, \
                      y = 0.2, wear_limit = \"0.3 mm\", source = \"table\" }\n";

#[test]
fn handbook_constants_become_a_law_about_the_reference_cut() {
    let set = read(TAYLOR).unwrap();
    assert_eq!(set.law, Some("extended_taylor"));
    let pair = Pair::of_set(&set).unwrap();
    let WearLaw::ExtendedTaylor(law) = pair.law else { panic!("another law") };
    let cut = Cut::nominal(222.0 / 60.0, 0.3e-3, 1.5e-3);
    assert!((law.tool_life(&cut) / 60.0 - 59.60626).abs() < 1e-5);
    // The edge is spent where the handbook's lives end.
    assert!((pair.life(&cut).cutting_time / 60.0 - 59.60626).abs() < 1e-4);
    assert_eq!(value(&set, "extended_taylor.speed_exponent"), (5.0, Origin::Handbook));
    assert_eq!(value(&set, "temperature.chip_heating"), (92.0, Origin::Based("c45_t15k6".to_owned())));
    assert_eq!(value(&set, "extended_taylor.stage_contrast").1, Origin::Assumed);
}

#[test]
fn lives_of_a_handbook_are_not_cut_short_by_the_heat_of_another_tool() {
    let set = read(TAYLOR).unwrap();
    assert_eq!(value(&set, "temperature.collapse_temperature"), (5000.0, Origin::Assumed));
    let pair = Pair::of_set(&set).unwrap();
    let WearLaw::ExtendedTaylor(law) = &pair.law else { panic!("another law") };
    // The tool of the set that it is based on collapses at this speed.
    let cut = Cut::nominal(400.0 / 60.0, 0.3e-3, 1.5e-3);
    assert!((pair.life(&cut).cutting_time / law.tool_life(&cut) - 1.0).abs() < 1e-4);
    // What the file states stays, and so does what the law of the base needs.
    let stated = format!(
        "{TAYLOR}[parameters.temperature]\ncollapse_temperature = {{ value = \"1500 K\", source = \"ours\" }}\n"
    );
    assert_eq!(value(&read(&stated).unwrap(), "temperature.collapse_temperature"), (1500.0, Origin::Given));
    assert_eq!(value(&read("").unwrap(), "temperature.collapse_temperature").0, 1400.0);
}

#[test]
fn what_is_stated_goes_before_the_handbook_and_both_before_the_base() {
    let body = format!(
        "{TAYLOR}[parameters.extended_taylor]\nspeed_exponent = {{ value = 3.5, source = \"ours\" }}\n\
         [handbook.kienzle]\nkc11 = \"1500 N/mm2\"\nmc = 0.22\ncutting_edge_angle = \"45 deg\"\nsource = \"table\"\n"
    )
    .replace("[handbook]\ntaylor", "[handbook]\ntaylor");
    let set = read(&body).unwrap();
    assert_eq!(value(&set, "extended_taylor.speed_exponent"), (3.5, Origin::Given));
    let note_expected = "extended_taylor.speed_exponent is 3.5, as line 8 states; the constants of line 6 would give 5";
    assert!(set.notes.iter().any(|note| note == note_expected), "{:?}", set.notes);
    let (force, origin) = value(&set, "force.specific_force");
    assert!((force - 1618.842).abs() < 1e-3 && origin == Origin::Handbook);
    let load = Pair::of_set(&set).unwrap().force.load(&Cut::nominal(3.0, 0.3e-3, 1.5e-3));
    assert!((load.sharp - 949.4026).abs() < 1e-3);
    assert_eq!(value(&set, "force.flank_pressure").1, Origin::Based("c45_t15k6".to_owned()));
}

#[test]
fn a_material_group_gives_a_force_only_where_nothing_else_does() {
    let set =
        read("law = \"energy_balance\"\nmaterial = { iso513 = \"P\", vdi3323 = 8, hardness = \"300 HB\" }\n").unwrap();
    let force = set.value("force", "specific_force").unwrap();
    let expected = 1725.0 * 45f64.to_radians().sin().powf(-0.24);
    assert!((force.value - expected).abs() < 1e-9 && force.source.contains("VDI 3323 group 8"), "{}", force.source);
    assert_eq!(set.prior["force.specific_force"], Spread::Factor(1.25));
    let stated = "[parameters.force]\nspecific_force = { value = \"2000 N\", source = \"ours\" }\n";
    let both = read(&format!("material = {{ iso513 = \"P\" }}\n{stated}")).unwrap();
    assert_eq!(value(&both, "force.specific_force"), (2000.0, Origin::Given));
    assert!(refused("material = { iso513 = \"M\", vdi3323 = 8 }").contains("is of ISO 513 group P"));
}

#[test]
fn sets_are_based_on_files_and_cycles_are_refused() {
    let folder = folder("chain");
    let write = |name: &str, based_on: &str, body: &str| {
        let text = format!("schema = 1\nname = \"{name}\"\ntitle = \"t\"\nbased_on = \"{based_on}\"\n{body}");
        std::fs::write(folder.join(format!("{name}.toml")), text).unwrap();
    };
    write("one", "c45_t15k6", "[parameters.chipping]\nrate = { value = \"0.2 1/km\", source = \"log\" }\n");
    write("two", "one.toml", "");
    let set = ParameterSet::load("two.toml", &folder, &TURNING_SETS).unwrap();
    assert_eq!(value(&set, "chipping.rate"), (0.2, Origin::Based("one".to_owned())));
    assert_eq!(value(&set, "limits.wear_limit").1, Origin::Based("c45_t15k6".to_owned()));
    assert_eq!(set.files.len(), 2);
    write("a", "b.toml", "");
    write("b", "./a.toml", "");
    let error = ParameterSet::load("./a.toml", &folder, &TURNING_SETS).unwrap_err().to_string();
    assert!(error.contains("leads back"), "{error}");
    for i in 0..5 {
        write(&format!("l{i}"), &format!("l{}.toml", i + 1), "");
    }
    write("l5", "c45_t15k6", "");
    let error = ParameterSet::load("l0.toml", &folder, &TURNING_SETS).unwrap_err().to_string();
    assert!(error.contains("more than 4 sets"), "{error}");
    assert!(ParameterSet::load("l2.toml", &folder, &TURNING_SETS).is_ok());
    let missing = ParameterSet::load("./ones.toml", &folder, &TURNING_SETS).unwrap_err().to_string();
    assert!(missing.contains("one.toml"), "{missing}");
    std::fs::write(folder.join("shop.toml"), "schema = 1\n[shop]\nname = \"shop\"\n").unwrap();
    std::fs::write(folder.join("my-posterior.parquet"), [0x50, 0x41, 0x52, 0x31, 0x8e]).unwrap();
    for (file, kind) in [("./shop.toml", "is a scenario"), ("./my-posterior.parquet", "`parameters_from` names it")] {
        let other = ParameterSet::load(file, &folder, &TURNING_SETS).unwrap_err().to_string();
        assert!(other.contains(kind), "{other}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn every_fault_is_named_with_its_place_and_fix() {
    let unknown = ParameterSet::load("c45_t15k", Path::new("/nowhere"), &TURNING_SETS).unwrap_err().to_string();
    assert!(unknown.contains("did you mean `c45_t15k6`"), "{unknown}");
    for (body, expected) in [
        ("law = \"usui\"\n", "nothing gives [parameters.usui]"),
        ("process = \"milling\"\n", "a set for turning is due"),
        (
            "[parameters.force]\nspecific_forse = { value = \"1 N\", source = \"s\" }\n",
            "did you mean `specific_force`?",
        ),
        ("[parameters.forces]\n", "did you mean `force`?"),
        ("[parameters.force]\nspecific_force = { value = \"1 mm\", source = \"s\" }\n", "own.toml:6"),
        ("[parameters.force]\nspecific_force = { value = \"1 N\" }\n", "lacks `source`"),
        ("[prior]\n\"extended_taylor.speed\" = { factor = 1.3 }\n", "did you mean `extended_taylor.speed_exponent`"),
        ("[prior]\n\"extended_taylor.speed_exponent\" = { factor = 0.3 }\n", "a number above 1"),
        (
            "handbook = { taylor = { form = \"v = C / (T^m ap^x f^y)\", C = \"420 m/min\", source = \"s\" } }\n",
            "lacks `m`",
        ),
        (
            "handbook = { taylor = { form = \"v = C / (T^m ap^x f^y)\", C = \"420 m/min\", m = 2, x = 0, y = 0, source = \"s\" } }\n",
            "write m = 0.5",
        ),
        (
            "handbook = { taylor = { form = \"v = C / (T^m ap^x f^y)\", C = \"420 m/min\", m = 0.2, x = 0.1, source = \"s\" } }\n",
            "lacks `y`",
        ),
        ("[scatter]\ncommon_ware = 0.2\n", "did you mean `common_wear`?"),
    ] {
        let message = refused(body);
        assert!(message.contains(expected), "{body}: {message}");
    }
    // Life in seconds taken for minutes: both readings are reported.
    let seconds = TAYLOR.replace("420 m/min", "20 m/min");
    let message = refused(&seconds);
    assert!(message.contains("in minutes") && message.contains("in seconds") && message.contains("60^m"), "{message}");
    // The wear limit of the lives is another one than the set's.
    let limit = format!("{TAYLOR}[parameters.limits]\nwear_limit = {{ value = \"0.6 mm\", source = \"s\" }}\n");
    assert!(refused(&limit).contains("0.6 mm, line"), "{}", refused(&limit));
    // Two laws, and two sources of one life.
    let laws = "[parameters.usui]\n[parameters.extended_taylor]\nspeed_exponent = { value = 5, source = \"s\" }\n";
    let usui = "wear_at_reference = { value = \"0.02 um/m\", source = \"s\" }\n";
    let two = laws.replace("[parameters.usui]\n", &format!("[parameters.usui]\n{usui}"));
    assert!(refused(&two).contains("2 wear laws"), "{}", refused(&two));
    let twice = format!("{TAYLOR}one_life = {{ life = \"15 min\", cutting_speed = \"200 m/min\" }}\n");
    assert!(refused(&twice).contains("two sources"), "{}", refused(&twice));
}

#[test]
fn classic_diffusion_is_brought_to_the_reference_temperature() {
    let group = |more: &str| {
        format!(
            "law = \"takeyama_murata\"\n[parameters.takeyama_murata]\n\
             abrasive_wear = {{ value = \"0.25 um/m\", source = \"s\" }}\n\
             activation_energy = {{ value = \"173.4 kJ/mol\", source = \"s\" }}\n{more}"
        )
    };
    let classic = "diffusion_wear = { value = \"1e8 um/min\", source = \"s\" }\n";
    let set = read(&group(classic)).unwrap();
    let expected = 1e8 * (-173.4e3 / (8.314462618 * 1000.0f64)).exp();
    let (diffusion, _) = value(&set, "takeyama_murata.diffusion_wear_at_reference");
    assert!((diffusion / expected - 1.0).abs() < 1e-12);
    assert_eq!(value(&set, "takeyama_murata.run_in_land").0, 0.0);
    let both = "diffusion_wear_at_reference = { value = \"5 um/min\", source = \"s\" }\n\
                reference_temperature = { value = \"1000 K\", source = \"s\" }\n";
    assert!(refused(&group(&format!("{classic}{both}"))).contains("does not apply beside"));
}

#[test]
fn what_lives_do_not_vary_is_that_of_the_base_or_assumed_and_never_called_a_handbook() {
    let lives = "[handbook]\nlives = [{ cutting_speed = \"160 m/min\", life = \"52 min\", feed = \"0.2 mm\" }, \
                 { cutting_speed = \"200 m/min\", life = \"22.4 min\", feed = \"0.2 mm\" }, \
                 { cutting_speed = \"250 m/min\", life = \"9.8 min\", feed = \"0.2 mm\" }]\n";
    let alone = read(lives).unwrap();
    assert_eq!(value(&alone, "extended_taylor.feed_exponent"), (1.5, Origin::Assumed));
    assert_eq!(value(&alone, "extended_taylor.depth_exponent"), (0.75, Origin::Assumed));
    // The exponent that the file states leads from the feed of the lives to the reference cut, too.
    let stated =
        format!("{lives}[parameters.extended_taylor]\nfeed_exponent = {{ value = 1.0, source = \"our log\" }}\n");
    let stated = read(&stated).unwrap();
    assert_eq!(value(&stated, "extended_taylor.feed_exponent"), (1.0, Origin::Given));
    let life = |set: &ParameterSet| value(set, "extended_taylor.reference_life").0;
    let feeds = value(&alone, "extended_taylor.reference_feed").0 / 0.2;
    assert!((life(&stated) / life(&alone) / feeds.powf(0.5) - 1.0).abs() < 1e-9);
}

#[test]
fn lives_of_a_test_become_exponents_with_their_uncertainty() {
    let lives = [(160, [52.0, 44.5, 61.2]), (200, [22.4, 27.9, 19.6]), (250, [9.8, 8.1, 11.6]), (315, [4.4, 3.5, 3.9])];
    let entries = lives.iter().flat_map(|(speed, minutes)| {
        minutes.map(|life| format!("{{ cutting_speed = \"{speed} m/min\", life = \"{life} min\" }}"))
    });
    let body = format!("[handbook]\nlives = [{}]\n", entries.collect::<Vec<_>>().join(", "));
    let set = read(&body).unwrap();
    assert!((value(&set, "extended_taylor.speed_exponent").0 - 3.826123).abs() < 1e-6);
    assert!(set.notes[0].contains("3.52666 to 4.12558"), "{:?}", set.notes);
    assert!(
        refused("[handbook]\nlives = [{ cutting_speed = \"160 m/min\", life = \"50 min\" }]\n").contains("second one")
    );
}

#[test]
fn a_written_set_reads_back_the_same() {
    for (name, _) in PARAMETER_SETS {
        let set = ParameterSet::load(name, Path::new(""), &TURNING_SETS).unwrap();
        let again = ParameterSet::parse("again", &set.to_toml(), &TURNING_SETS).unwrap();
        assert_eq!(Pair::of_set(&again).unwrap(), Pair::of_set(&set).unwrap(), "{name}");
    }
    let set = read(TAYLOR).unwrap();
    let again = ParameterSet::parse("again", &set.to_toml(), &TURNING_SETS).unwrap();
    assert_eq!(Pair::of_set(&again).unwrap(), Pair::of_set(&set).unwrap());
}

proptest! {
    #[test]
    fn no_text_brings_the_reader_down(text in "\\PC{0,200}", cut in 0usize..4000, insert in "\\PC{0,8}") {
        let _ = ParameterSet::parse("any", &text, &TURNING_SETS);
        let mut broken = PARAMETER_SETS[0].1.to_owned();
        let mut boundary = cut.min(broken.len());
        while !broken.is_char_boundary(boundary) {
            boundary -= 1;
        }
        broken.insert_str(boundary, &insert);
        let _ = ParameterSet::parse("any", &broken, &TURNING_SETS);
    }

    #[test]
    fn any_value_survives_writing(speed in 1.0..20.0f64, life in 1.0..500.0f64) {
        let body = format!(
            "law = \"extended_taylor\"\n{TAYLOR}[parameters.extended_taylor]\nspeed_exponent = {{ value = {speed:?}, source = \"s\" }}\n\
             reference_life = {{ value = \"{life:?} min\", source = \"s\" }}\n"
        );
        let set = read(&body).unwrap();
        let again = ParameterSet::parse("again", &set.to_toml(), &TURNING_SETS).unwrap();
        prop_assert_eq!(Pair::of_set(&again).unwrap(), Pair::of_set(&set).unwrap());
    }
}

#[test]
fn a_fault_of_the_handbook_is_told_alone_and_not_that_the_law_has_nothing_behind_it() {
    for (right, wrong, told) in [
        ("m = 0.2", "m = 1.2", "`m` = 1.2 is no exponent of the life"),
        ("C = \"420 m/min\"", "C = \"420\"", "`420` has no unit"),
        ("[handbook]\ntaylor", "[handbook]\ntaylr", "did you mean `taylor`?"),
    ] {
        let message = refused(&format!("law = \"extended_taylor\"\n{}", TAYLOR.replace(right, wrong)));
        assert!(message.contains(told), "{message}");
        assert!(!message.contains("nothing gives"), "{message}");
    }
    // Without a handbook it is the fault.
    assert!(refused("law = \"extended_taylor\"\n").contains("nothing gives [parameters.extended_taylor]"));
}
