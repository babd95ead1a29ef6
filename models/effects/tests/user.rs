//! Effects that users write as formulas.

use num_dual::Dual64;
use toolroom_effects::{Context, Definition, Effect, Effects, Terms, UserEffect, parse_definitions, vocabulary};
use toolroom_form::ReadError;
use toolroom_process::{AnyRecord, EffectValue, ModelError};

/// An effect of these changes.
fn file(changes: &str) -> String {
    format!(
        "[[effect]]\nid = \"my.crater\"\nprocess = [\"turning\"]\n\
         size = {{ unit = \"1\", ordinary = 0.1, range = [0.0, 2.0] }}\n\
         shape = {{ reference_speed = {{ value = \"200 m/min\", range = [\"60 m/min\", \"400 m/min\"], fit = true }} }}\n\
         changes = [{changes}]\n"
    )
}

fn read(changes: &str) -> Result<&'static Definition, String> {
    match parse_definitions("effects.toml", &file(changes)) {
        Ok(all) => Ok(all[0]),
        Err(ReadError::Faults(list)) => {
            let all = list.problems.iter().map(|problem| format!("{}: {}", problem.fault.code(), problem.fault));
            Err(all.collect::<Vec<_>>().join("\n"))
        }
        Err(other) => Err(other.to_string()),
    }
}

fn factor(formula: &str) -> Result<&'static Definition, String> {
    read(&format!("{{ term = \"cutting_force\", factor = \"{formula}\" }}"))
}

fn of(definition: &'static Definition, size: f64) -> Effects {
    Effects::new(vec![Effect::User(UserEffect::new(definition)).with_size(size)]).expect("one effect")
}

/// 0.21 mm of wear at 165 m/min.
fn worn() -> Context {
    Context { flank_wear: 0.21e-3, cutting_speed: 165.0 / 60.0, cutting_time: 240.0, ..Context::neutral() }
}

fn close(found: f64, due: f64) {
    assert!((found / due - 1.0).abs() < 1e-7, "{found}, and {due} is due");
}

const CRATER: &str = "1 + size * (flank_wear / 0.3 mm) * (cutting_speed / reference_speed)^1.5";

#[test]
fn a_formula_gives_its_published_number_and_exact_slopes() {
    let crater = of(factor(CRATER).unwrap(), 0.21);
    close(crater.terms::<f64>(&worn()).cutting_force, 1.1101535);
    // By size, by wear in 1/m, by speed in s/m: an independent calculation.
    let slope = |along: fn(&mut Context<Dual64>)| {
        let mut context = worn().map(Dual64::from);
        along(&mut context);
        crater.terms::<Dual64>(&context).cutting_force.eps
    };
    close(slope(|at| at.flank_wear.eps = 1.0), 524.54042);
    close(slope(|at| at.cutting_speed.eps = 1.0), 0.060083721);
    let one = Effect::User(UserEffect::new(factor(CRATER).unwrap()));
    let mut terms = Terms::<Dual64>::neutral();
    let dual = one.map(Dual64::from).with_size(Dual64::from(0.21).derivative());
    dual.act(&worn().map(Dual64::from), &mut terms);
    close(terms.cutting_force.eps, 0.524_540_42);
}

#[test]
fn a_copy_of_a_catalogue_effect_gives_the_same_bits() {
    let copy = of(factor("1 + size * (flank_wear / 0.3 mm)").unwrap(), 0.2);
    let built_in = Effects::new(vec!["wear_force=0.2".parse().unwrap()]).unwrap();
    for wear in [0.0, 0.05e-3, 0.21e-3, 0.3e-3, 1.1e-3] {
        let context = Context { flank_wear: wear, ..Context::<f64>::neutral() };
        assert_eq!(
            copy.terms::<f64>(&context).cutting_force.to_bits(),
            built_in.terms::<f64>(&context).cutting_force.to_bits()
        );
    }
}

#[test]
fn every_operator_and_function_means_what_it_says() {
    let value = |formula: &str| {
        let definition =
            factor(&format!("1 + size * ({formula})")).unwrap_or_else(|error| panic!("{formula}: {error}"));
        of(definition, 1.0).terms::<f64>(&worn()).cutting_force - 1.0
    };
    for (formula, due) in [
        ("2 + 3 * 4 - 6 / 3", 12.0),
        ("-2^2 + 10", 6.0),
        ("2^3^2 / 512", 1.0),
        ("2^-1", 0.5),
        ("flank_wear / 0.3 mm", 0.7),
        ("cutting_speed / 200 m/min", 0.825),
        ("cutting_time / 1 h", 4.0 / 60.0),
        ("200 mm/min * 3 min / 0.1 m", 6.0),
        ("if(flank_wear > 0.2 mm and cutting_time < 5 min, 3, 4)", 3.0),
        ("if(not (flank_wear > 0.2 mm) or 1 == 2, 3, 4)", 4.0),
        ("min(cutting_time, 3 min) / 1 min", 3.0),
        ("max(1, 2, 0.5)", 2.0),
        ("abs(1 - 3)", 2.0),
        ("exp(0) + ln(1) + sqrt(4) + sin(0) + cos(0) + tanh(0)", 4.0),
        ("sqrt(flank_wear^2) / 0.21 mm", 1.0),
        ("step(flank_wear / 0.2 mm - 1) + step(-1)", 1.0),
        ("bump(cutting_speed, 165 m/min, 10 m/min)", 1.0),
        ("(2e-1 + .3) * 2", 1.0),
        ("20 % * 5", 1.0),
        ("(0.2 mm)^2 / 0.04 mm2", 1.0),
    ] {
        assert!((value(formula) - due).abs() < 1e-12, "{formula} is {} and not {due}", value(formula));
    }
}

#[test]
fn units_are_checked_on_the_tree() {
    let refused = |formula: &str| factor(formula).expect_err(formula);
    let with = |formula: &str, code: &str, words: &str| {
        let error = refused(formula);
        assert!(error.starts_with(code) && error.contains(words), "{formula}: {error}");
    };
    factor("1 + size * flank_wear / 0.3 mm").expect("a number");
    factor("1 + size * min(cutting_time, 4 min) / 1 min").expect("a number");
    let lag = "{ term = \"temperature_offset\", summand = \"size * 5 K * tanh(pass_time / 20 s)\" }";
    read(lag).expect("a temperature");
    with("1 + size * exp(cutting_time)", "effect-unit", "exp needs a number, has s");
    with("1 + cutting_speed^size", "effect-unit", "the exponent of ^ is a constant");
    with("1 + size * flank_wear", "effect-unit", "a factor is a number; the term is m");
    with("if(flank_wear > 0.2 mm, size, 0)", "effect-neutral", "at size 0 it is 0 and not 1");
    with("1 + size * (flank_wear > 3 s)", "effect-unit", "needs equal units");
    let degrees = "{ term = \"temperature_offset\", summand = \"size * 5 degC\" }";
    assert!(read(degrees).expect_err("a difference").contains("degC"));
    let length = "{ term = \"temperature_offset\", summand = \"size * flank_wear\" }";
    assert!(read(length).expect_err("a length").contains("a summand has the unit of its term, K; this one is m"));
}

#[test]
fn what_is_no_formula_is_marked_at_its_column() {
    let with = |formula: &str, words: &str| {
        let error = factor(formula).expect_err(formula);
        assert!(error.starts_with("effect-parse") && error.contains(words), "{formula}: {error}");
    };
    with("1 + size * flank_were / 0.3 mm", "column 12: unknown name `flank_were`; nearest: `flank_wear`");
    with("1 + size * (flank_wear / 0.3 mm", "column 12: this bracket is not closed");
    with("1 + size * flank_wear / 0,3 mm", "column 26: a comma");
    with("1 + size * flank_wear / 0.3 mm^1", "can be read in two ways");
    with("1 + size * exq(1)", "unknown function `exq`");
    with("1 + size * max(1)", "`max` takes 2 to 8 arguments, here are 1");
    with("1 + size * exp", "its arguments stand in brackets");
    with("1 +", "column 4: the formula ends");
    with("1 + size $ 2", "`$`");
    with("", "the formula ends");
    with(&format!("1 + size * {}1{}", "(".repeat(60), ")".repeat(60)), "stand in each other");
    with(&format!("1 + size * (1{})", " + 1".repeat(40)), "at most 64");
}

#[test]
fn an_effect_of_size_zero_is_absent_and_none_leaves_its_range() {
    let with = |formula: &str, code: &str, words: &str| {
        let error = factor(formula).expect_err(formula);
        assert!(error.starts_with(code) && error.contains(words), "{formula}: {error}");
    };
    with("1.0001 + size * flank_wear / 0.3 mm", "effect-neutral", "1.0001");
    with("flank_wear / flank_wear + size", "effect-neutral", "write it as 1 + size * …");
    with("1 + size * ln(cutting_time / 1 min)", "effect-range", "cutting_time 0");
    with("1 - size * flank_wear / 0.3 mm", "effect-range", "its range is 0");
    with("1 + size * sqrt(flank_wear / 1 mm - 1)", "effect-range", "NaN");
    for formula in
        ["(1 + size)^2", "(cutting_speed / 1 m/s)^size", "exp(size * cutting_speed / 100 m/s)", "max(1 - size, 0)"]
    {
        let definition = factor(formula).unwrap_or_else(|error| panic!("{formula}: {error}"));
        assert_eq!(of(definition, 0.0).terms::<f64>(&worn()), Terms::neutral(), "{formula}");
    }
}

/// What the effects refuse at a wear of the land, m.
fn refused(effects: &Effects, flank_wear: f64) -> Option<EffectValue> {
    let context = Context { flank_wear, ..Context::neutral() };
    match effects.watched(|| Ok(effects.terms::<f64>(&context))) {
        Ok(_) => None,
        Err(ModelError::EffectValue(refused)) => Some(*refused),
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn a_value_between_the_points_of_the_check_is_refused_while_a_model_runs() {
    // No number between 0.1494 and 0.1506 mm, where no point of the check lies.
    let narrow = of(factor("1 + size * sqrt(1 - 2 * bump(flank_wear, 0.15 mm, 0.0005 mm))").unwrap(), 0.1);
    assert_eq!(refused(&narrow, 0.149e-3), None);
    let found = refused(&narrow, 0.15e-3).expect("a root of a negative number");
    assert_eq!(
        found.to_string(),
        "effect-value: effect `my.crater` makes cutting_force no number, its range is 0 … 1000000; \
         with size 1.0000e-1, flank_wear 1.5000e-1 mm"
    );
    let pole = of(factor("1 + size * 1e-9 mm / abs(flank_wear - 0.125 mm)").unwrap(), 0.1);
    assert_eq!(refused(&pole, 0.124e-3), None);
    assert!(refused(&pole, 0.125e-3).is_some_and(|own| own.value.is_infinite() && own.term == "cutting_force"));
    // Slopes are refused as values are.
    let dual = Context { flank_wear: 0.15e-3, ..Context::neutral() }.map(Dual64::from);
    assert!(narrow.watched(|| Ok(narrow.terms::<Dual64>(&dual))).is_err());
}

#[test]
fn effects_that_leave_a_range_together_are_refused_and_a_context_without_numbers_is_no_fault_of_theirs() {
    let one = "[[effect]]\nid = \"my.one\"\nprocess = [\"turning\"]\n\
               size = { ordinary = 0.1, range = [0, 2] }\n\
               changes = [{ term = \"cutting_force\", factor = \"1 + size * 4e5 * flank_wear / 10 mm\" }]\n";
    let text = format!("{one}{}", one.replace("my.one", "my.two"));
    let both = parse_definitions("effects.toml", &text).expect("two effects");
    let effect = |definition| Effect::User(UserEffect::new(definition)).with_size(2.0);
    let both = Effects::new(both.into_iter().map(effect).collect()).expect("two effects");
    assert_eq!(refused(&both, 0.0), None);
    let found = refused(&both, 9e-3).expect("a product of two");
    assert_eq!((found.effect, found.value > 1e11), ("my.two", true), "{found}");
    assert_eq!(refused(&both, f64::NAN), None);
}

#[test]
fn definitions_are_refused_with_what_is_wrong() {
    let with = |from: &str, to: &str, words: &str| {
        let text = file(&format!("{{ term = \"cutting_force\", factor = \"{CRATER}\" }}"));
        assert!(text.contains(from), "{from}");
        let error = parse_definitions("effects.toml", &text.replace(from, to)).expect_err(to);
        let ReadError::Faults(list) = error else { panic!("{error}") };
        let all: Vec<String> = list.problems.iter().map(|problem| problem.fault.to_string()).collect();
        assert!(all.iter().any(|fault| fault.contains(words)), "{to}: {all:?}");
    };
    with("my.crater", "crater", "and a dot");
    with("[0.0, 2.0]", "[2.0, 0.0]", "rises");
    with("[0.0, 2.0]", "[0.5, 2.0]", "begins at zero");
    with("ordinary = 0.1", "ordinary = 5", "within the range");
    with("ordinary = 0.1", "ordinary = \"1 mm\"", "has the unit 1");
    with("unit = \"1\"", "unit = \"parsec\"", "unknown unit");
    with("term = \"cutting_force\"", "term = \"cuting_force\"", "nearest: `cutting_force`");
    with("factor =", "summand =", "is changed by a factor");
    with("value = \"200 m/min\"", "value = \"500 m/min\"", "lies within its range");
    with("reference_speed = {", "flank_wear = {", "cannot be a number of the shape");
    with("reference_speed = {", "mm = {", "cannot be a number of the shape");
    with("\"turning\"", "\"milling\", \"drilling\"", "drilling");
    with("term = \"cutting_force\"", "term = \"process_stiffness\"", "turning does not read process_stiffness");
}

#[test]
fn a_quantity_that_a_process_lacks_is_refused() {
    let error = factor("1 + size * removed_volume / 1 m2").expect_err("no volume in turning");
    assert!(error.contains("turning has no removed_volume"), "{error}");
}

#[test]
fn the_text_of_a_definition_reads_back_to_the_same() {
    let definition = factor(CRATER).unwrap();
    let again = parse_definitions("again.toml", definition.text()).unwrap()[0];
    assert!(std::ptr::eq(definition, again), "{}", definition.text());
    assert_eq!(definition.fields()[1].display, "m/min");
    assert_eq!(UserEffect::new(definition).value(1), Some(200.0 / 60.0));
    let channels: Vec<&str> = definition.entry().channels.iter().map(|touched| touched.channel).collect();
    assert_eq!(channels, ["cutting_force", "spindle_power"]);
    assert_eq!(definition.entry().regime, "flank_wear, cutting_speed");
}

#[test]
fn the_vocabulary_lists_what_each_process_has() {
    let depth = vocabulary().find(|own| own.field.name == "depth_of_cut").expect("listed");
    assert_eq!((depth.processes, depth.factor), ([Some("turning"), Some("milling"), None], None));
    assert_eq!(vocabulary().filter(|own| own.factor.is_some()).count(), 27);
}
