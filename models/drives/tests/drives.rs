//! Drives, spindle and changer: closed forms, and the tool changes that were measured on the NIST box.

use toolroom_drives::{Drives, Machine, Part, Spent, Timer, times};
use toolroom_program::{Control, Dialect, Program, Units};

fn control() -> Control {
    Control { units: Some(Units::Millimetre), ..Control::of(Dialect::Fanuc) }
}

fn program(text: &str) -> Program {
    Program::read(text, &control()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn spent(program: &Program, drives: &Drives) -> Vec<Spent> {
    let (mut timer, mut done) = (Timer::new(drives), Vec::new());
    for (key, block) in program.blocks.iter().enumerate() {
        timer.block(key, block, &mut done);
    }
    timer.finish(program.blocks.len() - 1, &mut done);
    done
}

fn total(text: &str, drives: &Drives) -> f64 {
    spent(&program(text), drives).iter().map(|spent| spent.seconds).sum()
}

fn hurco() -> Drives {
    Machine::preset("hurco-winmax").expect("a preset").drives
}

/// Two tools, as the post processor of the box writes them.
fn change(start: u32, end: u32) -> String {
    format!(
        "G0 G17 G40 G80 G90\nT1 M6\nG0 G90 G54 X10. Y0. S{start} M3\nZ1. M8\nG1 Z-1. F100.\nX100.\nG0 Z1.\nM5\nG91 G28 Z0. M9\n\
         M01\nT2 M6\nG0 G90 G54 X50. Y20. S{end} M3\nZ1. M8\nG1 Z-1. F100.\nG0 Z1.\nM5\nG91 G28 Z0. M9\nG90 G58 X12. Y20.\nM30\n"
    )
}

/// Time of the blocks from the line that begins with `first` to the one before `end`, counted from line `skip` on.
fn between(text: &str, first: &str, end: &str, skip: usize) -> f64 {
    let lines: Vec<&str> = text.lines().collect();
    let find = |word: &str, from: usize| {
        (from..lines.len()).find(|i| lines[*i].starts_with(word)).unwrap_or_else(|| panic!("{word}")) + 1
    };
    let from = find(first, skip);
    let to = find(end, from);
    let program = program(text);
    let times = times(&program, &hurco());
    program.blocks.iter().zip(times).filter(|(block, _)| (from..to).contains(&block.line)).map(|(_, time)| time).sum()
}

#[test]
fn tool_changes_take_the_times_of_the_box() {
    // From and to rpm; time from M5 to the first cut, s, by the closed form; measured, s.
    for (from, to, closed, measured) in [
        (3000, 175, 8.93, 9.0),
        (175, 12_000, 14.93, 14.9),
        (12_000, 12_000, 21.75, 21.7),
        (12_000, 3000, 15.75, 15.8),
        (7500, 175, 11.33, 11.3),
        (3200, 9500, 12.56, 12.2),
        (9500, 12_000, 19.05, 18.9),
    ] {
        let time = between(&change(from, to), "M5", "G1", 0);
        assert!((time - closed).abs() < 0.011, "{from} to {to}: {time}, {closed} expected");
        assert!((time - measured).abs() < 0.4, "{from} to {to}: {time}, {measured} measured");
    }
    let text = change(175, 12_000);
    let second = text.lines().position(|line| line.starts_with("T2")).expect("a change");
    let end = format!("{text}(END)\n");
    assert!((between(&end, "M5", "(END)", second) - 8.23).abs() < 0.01);
}

#[test]
fn the_parts_add_up_and_name_what_waits() {
    let program = program(&change(12_000, 12_000));
    let done = spent(&program, &hurco());
    let seconds_of =
        |part: Part| done.iter().filter(|spent| spent.part == part).map(|spent| spent.seconds).sum::<f64>();
    assert!((seconds_of(Part::Change) - 2.0 * 5.93).abs() < 1e-9);
    // Two ramps up less the approach beside each, two brakings less the way home beside each; the last motion of the
    // program comes from the reference point, beside the braking too.
    let waits = 2.0 * (7.0736 - 1.07) + 2.0 * (7.9958 - 1.18) - 0.75;
    assert!((seconds_of(Part::Spindle) - waits).abs() < 1e-3, "{} {waits}", seconds_of(Part::Spindle));
    let all: f64 = [Part::Feed, Part::Rapid, Part::Settling, Part::Dwell, Part::Auxiliary, Part::Change, Part::Spindle]
        .map(seconds_of)
        .iter()
        .sum();
    let times: f64 = times(&program, &hurco()).iter().sum();
    assert!((all - times).abs() < 1e-9);
}

#[test]
fn the_spindle_waits_where_its_machine_says() {
    let ramp = Drives { spindle_constant: 4.54e-8 * (60.0 / std::f64::consts::TAU).powi(2), ..Drives::default() };
    let text = "G0 X0 Y0 Z0\nS6000 M3\nG0 X100.\nG1 X200. F1000.\nM30\n";
    let time = |drives: &Drives| total(text, drives);
    let alone = time(&Drives::default());
    // 6000 rpm: k·n² = 1.634 s up and as much down; the rapid motion of 0.2 s runs beside it.
    assert!((time(&ramp) - (alone + 2.0 * 1.6344 - 0.2)).abs() < 1e-3, "{} {alone}", time(&ramp));
    let block = Drives { spindle_block_wait: 1.0, ..ramp };
    assert!((time(&block) - (alone + 2.0 * 1.6344)).abs() < 1e-3, "{}", time(&block));
}

#[test]
fn a_path_in_tenths_of_a_millimetre_takes_the_time_of_the_whole_one() {
    let drives = Drives { inverse_acceleration: 1.0, jerk_time: 0.05, ..Drives::default() };
    let pieces: String = (1..=1000).map(|i| format!("X{:.1}\n", 0.1 * f64::from(i))).collect();
    let whole = total("G0 X0 Y0 Z0\nG1 X100. F6000.\n", &drives);
    assert!((whole - 1.15).abs() < 1e-9, "{whole}");
    let cut = total(&format!("G0 X0 Y0 Z0\nG1 F6000.\n{pieces}"), &drives);
    assert!((cut / whole - 1.0).abs() < 1e-3, "{cut} {whole}");
    // Rest to rest where the acceleration is never reached, and on a slow machine.
    assert!((total("G0 X0 Y0 Z0\nG1 X4. F6000.\n", &drives) - 0.185_664).abs() < 1e-5);
    let slow = Drives { inverse_acceleration: 1.0 / 0.64, jerk_time: 0.064, ..Drives::default() };
    assert!((total("G0 X0 Y0 Z0\nG1 X0.5 F3000.\n", &slow) - 0.116_961).abs() < 1e-5);
}

#[test]
fn corners_look_ahead_blocks_and_axes_cost_what_they_should() {
    let base = Drives { inverse_acceleration: 1.0, ..Drives::default() };
    let corner = "G0 X0 Y0 Z0\nG1 X50. F6000.\nY50.\n";
    let free = total(corner, &base);
    let stop = total(corner, &Drives { corner_step: 1e-9, ..base });
    assert!((stop - 2.0 * (0.5 + 0.1)).abs() < 1e-6, "{stop}");
    assert!(free < stop);
    // A step of 1.2 m/min at a right angle is passed at 0.02 m/s.
    let step = total(corner, &Drives { corner_step: 0.02, ..base });
    let expected = 2.0 * (0.5 + 0.05 + (0.1_f64 - 0.02).powi(2) / (2.0 * 0.1));
    assert!((step - expected).abs() < 1e-6, "{step} {expected}");
    let pieces: String = (1..=100).map(|i| format!("X{i}.\n")).collect();
    let path = format!("G0 X0 Y0 Z0\nG1 F6000.\n{pieces}");
    let seen = |look_ahead: f64| total(&path, &Drives { look_ahead, ..base });
    assert!((seen(0.0) - 1.1).abs() < 1e-9 && (seen(50.0) - 1.1).abs() < 1e-9);
    // A look-ahead of one motion stops behind each: 1 mm in a triangle of 2·√(way/a).
    assert!((seen(1.0) - 100.0 * 2.0 * 1e-3_f64.sqrt()).abs() < 1e-9, "{}", seen(1.0));
    // With a jerk that takes a millisecond it does so as well, and each of its two ramps is that much longer.
    let jerky = |look_ahead: f64| total(&path, &Drives { look_ahead, jerk_time: 1e-3, ..base });
    assert!(jerky(1.0) > seen(1.0) && jerky(1.0) < 1.05 * seen(1.0), "{}", jerky(1.0));
    assert!((jerky(0.0) - 1.1).abs() < 2e-3 && (jerky(10.0) / seen(10.0) - 1.0).abs() < 0.05, "{}", jerky(10.0));
    assert!((total(&path, &Drives { block_time: 0.1, ..Drives::default() }) - 10.0).abs() < 1e-9);
    let rapid = "G0 X0 Y0 Z0\nG0 X300. Z100.\n";
    let axes = Drives { rapid_ratio_z: 0.2, ..Drives::default() };
    assert!((total(rapid, &axes) - 1.0).abs() < 1e-9);
    let jog = Drives { independent_rapid: 1.0, rapid_ratio_z: 0.5, ..base };
    // X by itself: 0.6 s at 0.5 m/s and 0.5 s of ramps; Z is done before.
    assert!((total(rapid, &jog) - 1.1).abs() < 1e-9, "{}", total(rapid, &jog));
}

#[test]
fn the_override_acts_on_feeds_and_neither_on_rapids_nor_on_threads() {
    let text = "G0 X0 Y0 Z10.\nX100.\nG1 X0 F600.\nM3 S300\nG84 Z-10. R5. F300.\nG80\n";
    let time = |feed_override: f64| total(text, &Drives { feed_override, ..Drives::default() });
    let (one, double) = (time(1.0), time(2.0));
    assert!((one - double - 5.0).abs() < 1e-9, "{one} {double}");
}

#[test]
fn reversals_of_rigid_taps_grow_with_the_ramp() {
    let tap = |speed: u32| format!("G0 X0 Y0 Z10.\nM3 S{speed}\nG84 Z-10. R5. F300.\nG80\n");
    let drives = Drives { tap_reversal: 0.3, ..hurco() };
    let reversals = |speed: u32| {
        let done = spent(&program(&tap(speed)), &drives);
        let ramp = drives.spindle_ramp(0.0, f64::from(speed) * std::f64::consts::TAU / 60.0);
        let braking = drives.spindle_ramp(f64::from(speed) * std::f64::consts::TAU / 60.0, 0.0);
        let waits: f64 = done.iter().filter(|spent| spent.part == Part::Spindle).map(|spent| spent.seconds).sum();
        // Beside the ramp up before the hole, which the way down hides in part, and the braking at the end.
        (waits - braking, ramp)
    };
    let (slow, _) = reversals(175);
    assert!(slow > 0.59 && slow < 0.66, "two reversals of 0.3 s: {slow}");
    let (fast, ramp) = reversals(700);
    assert!(fast > 4.0 * 0.6 - 1e-9 && fast < 4.0 * 0.6 + ramp, "{fast}");
}

/// The drives of a machine file.
fn drives_of(text: &str) -> Drives {
    Machine::of("m.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).content.drives
}

#[test]
fn what_waits_for_the_spindle_is_a_setting_of_the_control() {
    let spindle = "[drives.spindle]\nconstant = \"1e-7 s/rpm2\"\nbase_speed = \"1000 rpm\"\n";
    // 0.5 s from rest to 2000 rpm; 0.1 s of feed; the end waits for another 0.5 s.
    let text = "G21 G90 G0 X0 Y0 Z0\nS2000 M3\nM8\nG1 X1 F600\nM5\nM0\nG0 X1\nM30\n";
    let time = |control: &str, more: &str| total(text, &drives_of(&format!("[control]\n{control}{spindle}{more}")));
    let plain = time("", "");
    assert!((plain - 1.1).abs() < 1e-9, "{plain}");
    // Whoever waits, the time is the same here; where coolant does not wait, the feed does.
    for wait in ["M8", "first_feed", "block"] {
        assert!((time(&format!("spindle_wait = \"{wait}\"\n"), "") - plain).abs() < 1e-9, "{wait}");
    }
    let part = |control: &str, line: usize| {
        let drives = drives_of(&format!("[control]\n{control}{spindle}"));
        let spent = spent(&program(text), &drives);
        spent.iter().filter(|one| one.key == line && one.part == Part::Spindle).map(|one| one.seconds).sum::<f64>()
    };
    assert!((part("spindle_wait = \"M8\"\n", 2) - 0.5).abs() < 1e-9);
    assert!((part("spindle_wait = \"first_feed\"\n", 3) - 0.5).abs() < 1e-9);
    assert!((part("spindle_wait = \"block\"\n", 1) - 0.5).abs() < 1e-9);
    // A stop that does not wait leaves it to the end.
    let ends = |more: &str| {
        let spent = spent(&program(text), &drives_of(&format!("{spindle}{more}")));
        spent.iter().filter(|one| one.key == 5 && one.part == Part::Spindle).map(|one| one.seconds).sum::<f64>()
    };
    assert!((ends("") - 0.5).abs() < 1e-9 && ends("stop_waits = false\n") == 0.0);
}

#[test]
fn the_cosine_rule_slows_the_slower_motion_at_a_corner() {
    let drives = drives_of("[drives]\nfeed_acceleration = \"1 m/s2\"\ncorner = { rule = \"cosine\" }\n");
    // 0.1 m/s along 100 mm twice, with a turn of 60 degrees: 0.05 m/s at the corner. Each change by 0.05 m/s takes 0.05 s, in which
    // 1.25 mm are lost against 0.1 m/s: 0.0125 s on both sides.
    let y = 50.0 * 3f64.sqrt();
    let time = total(&format!("G21 G90 G0 X0 Y0 Z0\nG1 X100 F6000\nX150 Y{y:.9}\nM30\n"), &drives);
    assert!((time - (2.0 + 0.1 + 0.025)).abs() < 1e-6, "{time}");
    // At a right angle it rests.
    let square = total("G21 G90 G0 X0 Y0 Z0\nG1 X100 F6000\nY100\nM30\n", &drives);
    assert!((square - 2.2).abs() < 1e-6, "{square}");
}

#[test]
fn a_corner_is_passed_at_the_speed_of_its_deviation() {
    // Acceleration, m/s²; deviation, um; turn, deg; speed at the corner, mm/s.
    for (acceleration, deviation, turn, speed) in [(1.0, 10.0, 90.0, 4.9135), (0.64, 1.0, 10.0, 12.944)] {
        let drives = drives_of(&format!(
            "[drives]\nfeed_acceleration = \"{acceleration} m/s2\"\ncorner = {{ rule = \"deviation\", value = \
             \"{deviation} um\" }}\n"
        ));
        let (y, x) = f64::to_radians(turn).sin_cos();
        let path = format!("G21 G90 G0 X0 Y0 Z0\nG1 X100 F6000\nX{:.9} Y{:.9}\nM30\n", 100.0 + 100.0 * x, 100.0 * y);
        // Both ways of 100 mm at 0.1 m/s rest at one end and slow down to the speed at the other.
        let (full, slow) = (0.1f64, 1e-3 * speed);
        let ramps = (2.0 * full - slow) / acceleration;
        let on_ramps = (2.0 * full * full - slow * slow) / (2.0 * acceleration);
        let expected = 2.0 * (ramps + (0.1 - on_ramps) / full);
        assert!((total(&path, &drives) - expected).abs() < 2e-6, "{turn}: {} {expected}", total(&path, &drives));
    }
}

#[test]
fn rapid_motions_blend_where_the_control_lets_them() {
    let machine = |blend: bool| {
        drives_of(&format!(
            "[drives]\nrapid_speed = \"6 m/min\"\nfeed_acceleration = \"1 m/s2\"\nacceleration = \"1 m/s2\"\n\
             settling = {{ feed = \"0.2 s\", rapid = \"0.1 s\" }}\n[control]\nrapid_blend = {blend}\n"
        ))
    };
    // Two ways of 100 mm at 0.1 m/s in one line: as one of 200 mm, 2.1 s, and settling at its end alone.
    let text = "G21 G90 G0 X0 Y0 Z0\nG0 X100\nG1 X200 F6000\nM30\n";
    let (blended, resting) = (total(text, &machine(true)), total(text, &machine(false)));
    assert!((blended - 2.3).abs() < 1e-6, "{blended}");
    assert!((resting - (2.0 * 1.1 + 0.3)).abs() < 1e-6, "{resting}");
}

#[test]
fn an_arm_has_the_next_tool_ready() {
    let changer =
        |kind: &str| drives_of(&format!("[drives.changer]\nchange_time = \"2 s\"\nindex_time = \"0.5 s\"\n{kind}"));
    let text = "G21 G90 G0 X0 Y0 Z0\nT1 M6\nT5 M6\nG0 X0\nM30\n";
    assert_eq!(total(text, &changer("")), 6.0);
    assert_eq!(total(text, &changer("kind = \"carousel\"\n")), 6.0);
    assert_eq!(total(text, &changer("kind = \"arm\"\n")), 4.0);
}
