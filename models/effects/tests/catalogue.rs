//! What holds for every effect, whichever the catalogue has.

use num_dual::Dual64;
use proptest::prelude::*;
use std::collections::BTreeSet;
use toolroom_effects::{Context, Effect, EffectError, Effects, Search, Sign, Terms};
use toolroom_process::{AnyRecord, Field, Record, num_dual, unit};

const SIZE: usize = 0;

/// A number inside a field's range, `share` of the way on a scale of orders of magnitude.
fn inside(field: &Field, share: f64) -> f64 {
    let low = if field.min > 0.0 { field.min } else { field.max * 1e-6 };
    low * (field.max / low).powf(share)
}

fn context(shares: &[f64]) -> Context {
    let mut context = Context::default();
    for (i, field) in Context::<f64>::FIELDS.iter().enumerate() {
        context.set(i, inside(field, shares[i % shares.len()]));
    }
    context
}

/// The effect with every parameter, size included, inside its range.
fn shaped(mut effect: Effect, shares: &[f64]) -> Effect {
    for (i, field) in effect.parameters().fields().iter().enumerate() {
        effect.parameters_mut().set_value(i, inside(field, shares[i % shares.len()]));
    }
    effect
}

fn bits(terms: &Terms) -> Vec<u64> {
    (0..Terms::<f64>::LEN).map(|i| terms.get(i).unwrap_or(f64::NAN).to_bits()).collect()
}

fn only(effect: Effect) -> Effects {
    Effects::new(vec![effect]).expect("one effect is not listed twice")
}

fn shares() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(0.0..1.0f64, 8)
}

proptest! {
    #[test]
    fn strength_zero_is_absent_bit_for_bit(where_ in shares(), shape in shares()) {
        for effect in Effect::all() {
            let off = only(shaped(effect, &shape).with_size(0.0));
            prop_assert_eq!(bits(&off.terms(&context(&where_))), bits(&Terms::neutral()), "{:?}", effect);
        }
    }

    #[test]
    fn strength_zero_changes_nothing_beside_other_effects(where_ in shares(), shape in shares()) {
        let on: Vec<Effect> = Effect::all().map(|effect| shaped(effect, &shape)).collect();
        for i in 0..on.len() {
            let mut with = on.clone();
            let id = with.remove(i).entry().id;
            let effects = Effects::new(with.clone()).expect("distinct");
            with.insert(i, Effect::named(id).expect("in the catalogue"));
            let with = Effects::new(with).expect("distinct");
            prop_assert_eq!(bits(&with.terms(&context(&where_))), bits(&effects.terms(&context(&where_))), "{}", id);
        }
    }

    #[test]
    fn terms_stay_in_their_ranges_at_moderate_sizes(where_ in shares(), shape in shares()) {
        for effect in Effect::all() {
            let size = effect.entry().size.max * 1e-3;
            let terms = only(shaped(effect, &shape).with_size(size)).terms(&context(&where_));
            let finite = (0..Terms::<f64>::LEN).all(|i| terms.get(i).is_some_and(f64::is_finite));
            prop_assert!(finite, "{:?}: {:?}", effect, terms);
        }
    }

    #[test]
    fn an_effect_reads_back_from_toml_and_json_as_written(shape in shares()) {
        for effect in Effect::all() {
            let effect = shaped(effect, &shape);
            let text = toml::to_string(&effect).expect("an effect can be written");
            prop_assert_eq!(toml::from_str::<Effect>(&text).map_err(|error| error.to_string()), Ok(effect), "{}", text);
            let text = serde_json::to_string(&effect).expect("an effect can be written");
            prop_assert_eq!(serde_json::from_str::<Effect>(&text).map_err(|error| error.to_string()), Ok(effect));
        }
    }

    #[test]
    fn other_units_give_the_same_terms(where_ in shares(), shape in shares()) {
        for effect in Effect::all() {
            let effect = shaped(effect, &shape);
            let mut here = context(&where_);
            let mut expected = only(effect).terms(&here);
            let mut there = effect;
            rescale(&mut here);
            rescale(&mut expected);
            rescale(there.parameters_mut());
            let terms = only(there).terms(&here);
            for i in 0..Terms::<f64>::LEN {
                let (a, b) = (expected.get(i).unwrap_or(0.0), terms.get(i).unwrap_or(0.0));
                // Exponentials that fade to subnormal numbers have few digits left.
                let few_digits = 1e-9 * a.abs().max(b.abs()) + f64::MIN_POSITIVE;
                prop_assert!((a - b).abs() <= few_digits, "{:?}: {} and {}", effect, a, b);
            }
        }
    }

    #[test]
    fn the_slope_in_size_is_exact_even_at_zero(where_ in shares(), shape in shares()) {
        for effect in Effect::all() {
            let effect = shaped(effect, &shape);
            let here = context(&where_);
            let mut dual = effect.map(Dual64::from);
            dual = dual.with_size(Dual64::from(0.0).derivative());
            let mut terms = Terms::neutral();
            dual.act(&here.map(Dual64::from), &mut terms);
            let h = effect.entry().size.max * 1e-3;
            let far = only(effect.with_size(h)).terms(&here);
            let slopes = terms.map(|term| term.eps);
            // Every effect so far is linear in its size.
            for i in 0..Terms::<f64>::LEN {
                let neutral = Terms::<f64>::neutral().get(i).unwrap_or(f64::NAN);
                let difference = (far.get(i).unwrap_or(f64::NAN) - neutral) / h;
                let slope = slopes.get(i).unwrap_or(f64::NAN);
                prop_assert!((slope - difference).abs() <= 1e-9 * (slope.abs() + 1.0 / h), "{:?}", effect);
            }
        }
    }
}

/// To a system of units whose metre is 1/3 m and so on.
fn rescale(record: &mut dyn AnyRecord) {
    const BASE: [f64; 8] = [3.0, 0.7, 1.7, 1.3, 2.1, 1.0, 1.0, 1.0];
    for (i, field) in record.fields().iter().enumerate() {
        let dimension = unit::parse(field.unit).expect("a known unit").dimension;
        let scale: f64 = BASE.iter().zip(dimension).map(|(base, power)| base.powi(i32::from(power))).product();
        let value = record.value(i).expect("scalar fields");
        record.set_value(i, value * scale);
    }
}

#[test]
fn every_effect_changes_something() {
    for effect in Effect::all() {
        let on = only(shaped(effect, &[1.0]));
        assert_ne!(on.terms(&context(&[0.5])), Terms::neutral(), "{}", effect.entry().id);
    }
}

#[test]
fn the_catalogue_is_complete() {
    let ids: BTreeSet<_> = Effect::CATALOGUE.iter().map(|entry| entry.id).collect();
    assert_eq!(ids.len(), Effect::CATALOGUE.len());
    for (entry, effect) in Effect::CATALOGUE.iter().zip(Effect::all()) {
        assert_eq!(entry, effect.entry());
        assert_eq!(effect.parameters().fields()[SIZE], *entry.size);
        assert_eq!((entry.size.name, entry.size.start), ("size", 0.0), "{}", entry.id);
        // Modes, lots, sensors, stock and another coolant change either way; every other effect has one sign.
        let either = ["lot_hardness", "force_bias", "force_drift", "stock_offset", "coolant_change"];
        let signed = entry.id.starts_with("mode_") || either.contains(&entry.id);
        assert_eq!(entry.size.min < 0.0, signed, "{}", entry.id);
        assert_eq!(effect.size(), 0.0);
        assert!(!entry.channels.is_empty() && !entry.processes.is_empty(), "{}", entry.id);
        for text in [entry.title, entry.regime, entry.confounder, entry.separating_test, entry.source] {
            assert!(!text.is_empty(), "{}", entry.id);
        }
        for field in effect.parameters().fields() {
            assert_eq!(field.len, 1, "{}: an effect has scalar parameters", entry.id);
            field.check(field.start).expect("a default inside its range");
            unit::parse(field.display).expect("a known unit");
        }
    }
    assert!(Effect::CATALOGUE.iter().flat_map(|entry| entry.channels).any(|touched| touched.sign == Sign::Falls));
}

#[test]
fn every_effect_says_how_it_is_diagnosed_in_every_process_or_why_it_is_not() {
    for effect in Effect::all() {
        let entry = effect.entry();
        let fields = effect.parameters().fields();
        let shaped = |name: &str| assert!(fields.iter().any(|field| field.name == name), "{}: {name}", entry.id);
        for (process, search) in entry.processes {
            let sizes = match *search {
                Search::Size(size)
                | Search::Lots(size)
                | Search::CoolantStiffness(size)
                | Search::Below { size, .. } => {
                    vec![size]
                }
                Search::Values { parameter, size, .. } => {
                    shaped(parameter);
                    vec![size]
                }
                Search::Window { centre, width, size, .. } => {
                    shaped(centre);
                    shaped(width.0);
                    vec![size]
                }
                Search::WheelPosition { each_part, since_dressing } => vec![each_part, since_dressing],
                Search::AtGreatest { quantity, .. } => {
                    assert!(Context::<f64>::index_of(quantity).is_some(), "{}: {quantity}", entry.id);
                    Vec::new()
                }
                Search::ShareOfMedian { .. } => Vec::new(),
                Search::Untried(reason) => {
                    assert!(!reason.is_empty(), "{} in {process}", entry.id);
                    Vec::new()
                }
                Search::Shaped => panic!("{} in {process}: only shops and power laws shape effects", entry.id),
            };
            assert!(sizes.iter().all(|size| *size > 0.0 && *size < entry.size.max), "{} in {process}", entry.id);
        }
    }
}

#[test]
fn a_quantity_may_have_any_fitting_unit() {
    let read = |text: &str| toml::from_str::<Effect>(text).map_err(|error| error.message().to_owned());
    let runout = read("id = \"runout\"\nsize = \"0.01 mm\"").expect("a length");
    assert!((runout.size() - 1e-5).abs() < 1e-18);
    let ageing = read("id = \"coolant_ageing\"\nsize = \"0.05 1/h\"").expect("a rate");
    assert!((ageing.size() * 3600.0 - 0.05).abs() < 1e-15);
    let run_in = read("id = \"run_in\"\nsize = 2\ntime_constant = \"90 s\"").expect("a shape");
    assert_eq!(run_in.parameters().value(1), Some(90.0));
}

#[test]
fn what_is_wrong_in_a_file_is_said() {
    let read = |text: &str| toml::from_str::<Effect>(text).expect_err(text).message().to_owned();
    assert_eq!(read("id = \"wear_forse\"\nsize = 0.2"), "unknown effect `wear_forse`; nearest: `wear_force`");
    assert!(read("id = \"threshold_force\"\nsize = 20").contains("has no unit; accepted: N"));
    assert!(read("id = \"runout\"\nsize = \"20 N\"").contains("not a unit of m"));
    assert!(read("id = \"wear_force\"\nsize = 0.2\nphi = 1").contains("size, reference_wear, feed_force_ratio"));
    assert!(read("id = \"wear_force\"").contains("write for example"));
    assert!(read("id = \"wear_force\"\nsize = -0.2").contains("outside"));
}

#[test]
fn a_list_holds_an_effect_once_and_only_for_its_process() {
    let twice = r#"[{ "id": "run_in", "size": 1 }, { "id": "run_in", "size": 2 }]"#;
    assert!(serde_json::from_str::<Effects>(twice).expect_err("twice").to_string().contains("listed twice"));
    let wear = only(Effect::named("wear_force").expect("in the catalogue"));
    assert_eq!(wear.check("turning"), Ok(()));
    assert!(matches!(wear.check("infeed"), Err(EffectError::NotOfProcess { id: "wear_force", .. })));
    for process in ["turning", "milling", "infeed"] {
        assert_eq!(Effects::every(process).check(process), Ok(()));
        assert!(Effects::every(process).iter().count() >= 4);
    }
}
