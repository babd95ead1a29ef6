//! Contour files, part programs, trajectories.

use std::f64::consts::{FRAC_PI_2, PI};
use toolroom_contour::{
    ContourError, ContourFile, CornerPolicy, CutterSide, FormError, Models, Objective, Parameters, Pass, PathError,
    Planner, Point, Setting, Shape, Trace, VelocityLoop, read_gcode,
};
use toolroom_form::{FormFile, ReadError};

const MC1: &str = include_str!("../../../../scenarios/contour/mc1.toml");
const RK3: &str = include_str!("../../../../scenarios/contour/rk3.toml");
const CAM: &str = include_str!("../../../../scenarios/contour/cam.toml");

#[test]
fn the_shipped_contours_are_planned() {
    for (text, sections, corners) in [(MC1, 10, 4), (RK3, 18, 0), (CAM, 40, 0)] {
        let file = read(text);
        assert!(file.contour.sections.len() >= sections && file.contour.corners.len() == corners, "{}", file.name);
        for (name, planner) in file.planners().unwrap() {
            let plan = planner.optimal(Objective::Time).unwrap();
            let handbook = planner.handbook().unwrap();
            assert!(plan.time < handbook.time, "{} {name}", file.name);
        }
    }
}

#[test]
fn the_file_of_the_headline_gives_the_published_gains() {
    let file = read(RK3);
    let planner = Planner::new(&file.contour, &file.parameters, file.pass("finish").unwrap(), &file.models).unwrap();
    let (handbook, plan) = (planner.handbook().unwrap(), planner.optimal(Objective::Cost).unwrap());
    assert!((plan.productivity_gain(&handbook) - 0.1307).abs() < 5e-5);
    assert!((plan.cost_change(&handbook) + 0.1516).abs() < 5e-5);
    assert!(matches!(file.pass("polish"), Err(ContourError::UnknownPass { .. })));
}

const HEAD: &str =
    "schema = 1\nname = \"x\"\ntitle = \"x\"\ncutter_side = \"right\"\nclosed = false\n[[pass]]\nname = \"p\"\n";

fn read(text: &str) -> ContourFile {
    ContourFile::parse("contour.toml", text, &[]).unwrap().content
}

/// Line, column and code of every fault, and all that is said.
fn faults(text: &str, set: &[&str]) -> (Vec<(usize, usize, &'static str)>, String) {
    let set: Vec<String> = set.iter().map(|each| (*each).to_owned()).collect();
    let Err(ReadError::Faults(list)) = ContourFile::parse("contour.toml", text, &set) else { panic!("{text}") };
    let placed = list.problems.iter().map(|problem| {
        let place = list.place(problem);
        (place.line, place.column, problem.fault.code())
    });
    (placed.collect(), list.to_string())
}

const LINE: &str = "[[section]]\nline = \"50 mm\"\n";

#[test]
fn faults_name_line_and_column() {
    for (body, expected) in [
        (format!("allowance = \"0.5 min\"\n{LINE}"), (8, 18, "quantity")),
        (format!("alowance = \"0.5 mm\"\n{LINE}"), (8, 1, "unknown-key")),
        (format!("allowance = \"5 m\"\n{LINE}"), (8, 13, "out-of-range")),
        ("[[section]]\nline = \"50\"\n".to_owned(), (9, 8, "quantity")),
        (
            format!(
                "{LINE}[[section]]\narc_to = [\"60 mm\", \"11 mm\"]\ncenter = [\"50 mm\", \"10 mm\"]\ndirection = \"left\"\n"
            ),
            (10, 1, "arc-misses-end"),
        ),
        ("[[section]]\narc = \"90 deg\"\n".to_owned(), (8, 1, "section-form")),
        (format!("{LINE}direction = \"left\"\n"), (8, 1, "section-form")),
        ("[[section]]\nline_to = [\"50 mm\"]\n".to_owned(), (9, 11, "wrong-type")),
        (format!("{LINE}[[section]]\nturn = \"-90 deg\"\nline = \"50 mm\"\n"), (8, 1, "unreachable-corner")),
        (String::new(), (1, 1, "empty-contour")),
        (format!("[[pass]]\nname = \"p\"\n{LINE}"), (9, 8, "duplicate-name")),
    ] {
        let (found, said) = faults(&format!("{HEAD}{body}"), &[]);
        assert_eq!(found, [expected], "{said}");
    }
    let (found, _) = faults(&format!("{}{LINE}", HEAD.replace("schema = 1", "schema = 7")), &[]);
    assert_eq!(found, [(1, 10, "schema")]);
    let (_, said) = faults(&format!("{}{LINE}", HEAD.replace("closed = false", "closed = true")), &[]);
    assert!(said.contains("the contour is open: its end is 50.0000 mm from its start"), "{said}");
}

#[test]
fn all_faults_are_told_at_once() {
    let text = format!(
        "{HEAD}alowance = \"1 mm\"\ntolerance = \"9 m\"\n[machine]\nnonsense = 1\n[corners]\npolicy = \"lop\"\n\
         [path_error]\nmodel = \"servo\"\nvelocity_loop_damping = 0.7\n[[section]]\nline = \"5 s\"\n{LINE}radius = \"1 mm\"\n"
    );
    let (found, said) = faults(&text, &[]);
    let codes: Vec<&str> = found.iter().map(|(_, _, code)| *code).collect();
    let expected =
        ["unknown-key", "out-of-range", "unknown-key", "unknown-choice", "missing-key", "quantity", "section-form"];
    assert_eq!(codes, expected, "{said}");
    assert!(said.contains("did you mean `allowance`?") && said.contains("did you mean `loop`?"), "{said}");
}

#[test]
fn values_are_replaced_in_every_pass_or_in_one() {
    let text = format!("{HEAD}[[pass]]\nname = \"q\"\n{LINE}");
    let tolerances = |set: &str| {
        let file = ContourFile::parse("c.toml", &text, &[set.to_owned()]).unwrap().content;
        file.passes.iter().map(|(_, pass)| pass.tolerance * 1e6).map(f64::round).collect::<Vec<_>>()
    };
    let usual = (Pass::default().tolerance * 1e6).round();
    assert_eq!(tolerances("pass.tolerance=30 um"), [30.0, 30.0]);
    assert_eq!(tolerances("pass.q.tolerance=30 um"), [usual, 30.0]);
    let file = ContourFile::parse("c.toml", &text, &["scatter.hardness=0.5".to_owned()]).unwrap().content;
    assert_eq!(file.scatter.hardness, 0.5);
    for (set, code) in [("pass.r.tolerance=1 mm", "override"), ("economics.edge_price=1 EUR", "unknown-key")] {
        assert_eq!(faults(&text, &[set]).0[0].2, code);
    }
}

#[test]
fn units_of_the_file_do_not_matter() {
    let metric = "[[section]]\nline = \"25.4 mm\"\n[[section]]\narc = \"90 deg\"\nradius = \"50.8 mm\"\n";
    let inch = "[[section]]\nline = \"1 in\"\n[[section]]\narc = \"1.5707963267948966 rad\"\nradius = \"2 in\"\n";
    let read = |pass: &str, body: &str| read(&format!("{HEAD}{pass}{body}"));
    let one = read("allowance = \"0.508 mm\"\ntolerance = \"50.8 um\"\n", metric);
    let other = read("allowance = \"0.02 in\"\ntolerance = \"0.002 in\"\n", inch);
    let time = |file: &ContourFile| file.planners().unwrap()[0].1.optimal(Objective::Cost).unwrap().cost;
    assert!((time(&one) / time(&other) - 1.0).abs() < 1e-12);
}

/// The path between the lead-in and the lead-out of a part program.
fn read_back(program: &str) -> toolroom_contour::Contour {
    let lines: Vec<&str> = program.lines().collect();
    let find = |word: &str| lines.iter().position(|line| *line == word).unwrap();
    let (contour, exit) = (find("(CONTOUR)"), find("(EXIT)"));
    // The arc of entry ends where the contour begins.
    let words: Vec<&str> = lines[contour - 1].split(' ').filter(|word| word.starts_with(['X', 'Y'])).collect();
    let text = format!("G21 G90\nG0 {}\n{}\n", words.join(" "), lines[contour..exit].join("\n"));
    let control = toolroom_program::Control::default();
    read_gcode(&text, &control, Some(CutterSide::Left), true).unwrap_or_else(|error| panic!("{error}\n{program}"))
}

#[test]
fn a_part_program_reads_back_as_the_centre_path() {
    for (text, loops) in [(RK3, false), (CAM, false), (MC1, true)] {
        let file = read(text);
        let (_, planner) = &file.planners().unwrap()[0];
        let plan = planner.optimal(Objective::Time).unwrap();
        let program = planner.part_program(&plan, &file.name).unwrap();
        let centre = read_back(&program);
        let length = centre.length();
        let corners: f64 = plan.corners.iter().map(|corner| corner.length).sum();
        let expected = file.contour.centre_length(file.parameters.cutter.radius()) + corners;
        assert!((length - expected).abs() < 1e-6 * centre.sections.len() as f64, "{}: {length} {expected}", file.name);
        assert_eq!(!plan.corners.is_empty(), loops);
    }
}

#[test]
fn part_programs_pass_corners_by_every_policy() {
    let file = read(MC1);
    let pass = file.pass("finish").unwrap();
    for (corners, word) in [
        (CornerPolicy::ExactStop, "G9 G1"),
        (CornerPolicy::SlowDown { tolerance: None }, "G1"),
        (CornerPolicy::Loop { radius: 2e-3, tolerance: None }, "G3"),
    ] {
        let models = Models { corners, ..file.models };
        let planner = Planner::new(&file.contour, &file.parameters, pass, &models).unwrap();
        let plan = planner.optimal(Objective::Time).unwrap();
        let program = planner.part_program(&plan, "mc1").unwrap();
        assert!(program.contains(word));
        assert_eq!(plan.corners.len(), 4);
        let length = read_back(&program).length();
        let moves: f64 = plan.corners.iter().map(|corner| corner.length).sum();
        let expected = file.contour.centre_length(16e-3) + moves;
        assert!((length - expected).abs() < 1e-5, "{corners:?} {length} {expected}");
    }
}

/// One round bore of 30 mm radius, cutter inside.
fn bore(pieces: u32) -> toolroom_contour::Contour {
    let mut trace = Trace::new(Point::default(), 0.0);
    for _ in 0..pieces {
        trace.arc(30e-3, 2.0 * PI / f64::from(pieces)).unwrap();
    }
    trace.finish(CutterSide::Left, true).unwrap()
}

#[test]
fn the_simulated_drives_settle_to_the_closed_form() {
    let (parameters, pass) = (Parameters::default(), Pass::default());
    for velocity_loop in [None, Some(VelocityLoop { frequency: 120.0, damping: 0.7 })] {
        let models = Models { path_error: PathError::Servo { velocity_loop }, ..Models::default() };
        let contour = bore(4);
        let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
        let plan = planner.optimal(Objective::Time).unwrap();
        let closed = plan.sections[3].evaluation.path_error;
        let at = |step: f64| {
            let deviations = planner.follow(&plan, velocity_loop, step);
            // The arc turns left, its centre lies there: the path comes out smaller.
            assert!(deviations[3].left > deviations[3].right);
            deviations[3].left
        };
        assert!((at(1e-4) / closed - 1.0).abs() < 1e-3, "{} {closed}", at(1e-4));
        let (coarse, fine) = ((at(8e-4) - closed).abs(), (at(1e-4) - closed).abs());
        assert!(fine < coarse || fine < 1e-12, "{fine} {coarse}");
    }
}

#[test]
fn finer_sections_converge() {
    let (parameters, pass, models) = (Parameters::default(), Pass::default(), Models::default());
    let setting = Setting { spindle_speed: 150.0, feed_per_tooth: 0.05e-3 };
    let life = |sections: u32| {
        let mut trace = Trace::new(Point::default(), 0.0);
        trace.lobed(0.1, 0.0035, 3, sections).unwrap();
        let contour = trace.finish(CutterSide::Left, true).unwrap();
        let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
        planner.plan(&vec![setting; sections as usize]).unwrap().life_fraction
    };
    let exact = life(9216);
    let errors = [36, 72, 144].map(|sections| (life(sections) / exact - 1.0).abs());
    // Second order: a quarter of the error with twice the sections.
    assert!(errors[0] > 1e-4 && errors.windows(2).all(|pair| (pair[0] / pair[1] - 4.0).abs() < 0.3), "{errors:?}");
}

#[test]
fn dividing_an_arc_changes_nothing() {
    let (parameters, pass) = (Parameters::default(), Pass::default());
    for path_error in [PathError::default(), PathError::Empirical] {
        let models = Models { path_error, ..Models::default() };
        let time = |pieces: u32| {
            let contour = bore(pieces);
            Planner::new(&contour, &parameters, &pass, &models).unwrap().optimal(Objective::Time).unwrap().time
        };
        assert!((time(1) / time(7) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn the_helical_form_error_is_the_stricter_one() {
    let (parameters, pass) = (Parameters::default(), Pass::default());
    let contour = bore(4);
    let deflection = |form_error: FormError| {
        let models = Models { form_error, ..Models::default() };
        let planner = Planner::new(&contour, &parameters, &pass, &models).unwrap();
        let plan = planner.handbook().unwrap();
        assert!(!plan.warnings.iter().any(|w| matches!(w, toolroom_contour::Warning::MeanForce { .. })));
        planner.evaluate(0, plan.sections[0].setting).unwrap().deflection
    };
    assert!(deflection(FormError::Helical) > 1.05 * deflection(FormError::Mean));
}

#[test]
fn a_bore_by_radius_has_the_engagement_of_its_shape() {
    let contour = bore(3);
    assert_eq!(contour.shape(&contour.sections[0]), Shape::Concave(1.0 / (1.0 / 30e-3)));
    assert!((contour.sections[0].arc_angle - 2.0 * PI).abs() < 1e-12);
    assert!(contour.sections[0].end_heading() > FRAC_PI_2);
}

proptest::proptest! {
    // A contour whose limits hold along the path is planned in some ten times as many pieces as it has sections.
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(32))]

    #[test]
    fn a_damaged_file_is_answered_without_panic(at in 0usize..2000, cut in 0usize..40, put in "[-0-9a-z\"\\[\\]{}=. ]{0,6}") {
        for text in [MC1, RK3, CAM] {
            let from = at % text.len();
            let to = (from + cut).min(text.len());
            let damaged = format!("{}{put}{}", &text[..from], &text[to..]);
            if let Ok(FormFile { content: file, .. }) = ContourFile::parse("damaged.toml", &damaged, &[]) {
                let planned = file.planners().map(|planners| {
                    planners.iter().map(|(_, planner)| planner.optimal(Objective::Time).is_ok()).collect::<Vec<_>>()
                });
                drop(planned);
            }
        }
    }
}
