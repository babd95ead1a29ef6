//! The verdict that the test of the calibrated nominal model backs.
//!
//! | the test | what the search found | verdict |
//! |---|---|---|
//! | passes | an effect that spares the model a constant beyond belief | `effect` |
//! | passes | a constant beyond belief | `constant`; `masked` where a masked effect may have pushed it there, or where an effect is not named for want of groups alone |
//! | passes | a model that the evidence asks for, with effects | `masked`: constants within belief do as well |
//! | passes | nothing | `no_gap` |
//! | rejects | an effect | `effect`; what is left beside it is said |
//! | rejects | a constant beyond belief that closes like a cause | `constant`, what is left beside it is said; `unknown` where an effect is not named for want of groups alone |
//! | rejects | nothing | `small` where nothing that is left matters, else `unknown` |
//!
//! Where the noise is read off the records there are two tests: what is left has to be exchangeable, and the map of channels
//! and covariates may show no structure beyond its null. Each of them rejects; a rule that keeps an effect from being named
//! rejects nothing.

use super::constants::{FAR_CONSTANT, LEAST_CLOSED, MATTERING_SHARE};
use super::decision::Mapped;
use super::rules::GROUPS;
use super::{Calibrated, Closure, Diagnosis, Fitness, GapVerdict, NotNamed, Structure};

impl Structure {
    /// Whether what the model leaves of the channel may matter.
    fn may_matter(&self) -> bool {
        self.scale.matters(self.upper)
    }
}

/// Sets the verdict of `diagnosis` by its tests. `pushed` says which masked effect calibration may have taken up,
/// `asked` which effects the evidence asks for and with what gain, `spared` whether the named effects do without a constant beyond belief that the model needs without them, and
/// `by_constants` what such constants close on groups left out.
pub(super) fn backed(
    diagnosis: &mut Diagnosis,
    pushed: impl Fn() -> Option<String>,
    asked: impl Fn() -> Option<(String, f64)>,
    spared: bool,
    by_constants: impl Fn() -> Option<Closure>,
) {
    let Some(fit) = diagnosis.fit.clone() else { return };
    // A model that fits with a constant that nobody believes competes with the effect by evidence, which is named.
    if fit.passed() && !(diagnosis.verdict == GapVerdict::Effect && spared) {
        if diagnosis.verdict == GapVerdict::Effect {
            diagnosis.effects.clear();
            diagnosis.fit_with_effects = None;
        }
        unrejected(diagnosis, &pushed);
        suspected(diagnosis, fit.p, asked);
        return;
    }
    if diagnosis.verdict == GapVerdict::Effect {
        if let Some(words) = diagnosis.remaining().map(|_| rejected(diagnosis.fit_with_effects.as_ref())) {
            diagnosis.notes.push(format!("beside it: {words}"));
        }
        return;
    }
    let small = !fit.structure.iter().any(|channel| channel.may_matter());
    diagnosis.verdict = if small { GapVerdict::Small } else { GapVerdict::Unknown };
    diagnosis.notes.insert(0, rejected(Some(&fit)));
    if let Some(why) = pushed() {
        diagnosis.verdict = GapVerdict::Masked;
        diagnosis.suspected = Some(why.clone());
        diagnosis.notes.push(why);
    } else if !small {
        constant_beyond_belief(diagnosis, by_constants);
    }
}

/// The effects that are not named for want of groups alone: where groups are too few to tell an effect, they are too few to
/// tell a constant from it.
fn in_want_of_groups(diagnosis: &Diagnosis) -> Option<String> {
    let alone = |own: &&NotNamed| !own.rules.is_empty() && own.rules.iter().all(|rule| rule.rule == GROUPS);
    let ids: Vec<&str> = diagnosis.not_named.iter().find(alone)?.effects.iter().map(|id| id.word()).collect();
    let ids = ids.join(" with ");
    Some(format!("{ids} may have moved the constant: so few groups tell neither from the other"))
}

/// A constant that went farther than is believed of it is what the gap is, if such constants close it on groups left out.
fn constant_beyond_belief(diagnosis: &mut Diagnosis, by_constants: impl Fn() -> Option<Closure>) {
    let Some(constant) = diagnosis.constant() else { return };
    if !by_constants().is_some_and(|closed| closed.closed > LEAST_CLOSED && closed.ci90[0] > 0.0) {
        return;
    }
    match in_want_of_groups(diagnosis) {
        Some(why) => diagnosis.notes.insert(0, why),
        None => {
            diagnosis.verdict = GapVerdict::Constant;
            diagnosis.notes.insert(0, constant);
        }
    }
}

/// Sets the verdict where no test stands against the calibrated model: calibration that went far says why it did, or is
/// the finding.
pub(super) fn unrejected(diagnosis: &mut Diagnosis, pushed: impl Fn() -> Option<String>) {
    diagnosis.verdict = GapVerdict::NoGap;
    let constant = diagnosis.constant();
    if let Some(why) = pushed().or_else(|| constant.as_ref().and_then(|_| in_want_of_groups(diagnosis))) {
        diagnosis.verdict = GapVerdict::Masked;
        diagnosis.suspected = Some(why.clone());
        diagnosis.notes.push(why);
    } else if let Some(constant) = constant {
        diagnosis.verdict = GapVerdict::Constant;
        diagnosis.notes.insert(0, constant);
    }
}

/// Sets the verdict where the noise was read off the records. Names are no question of its tests: there calibration may
/// follow what an effect does, and evidence tells them apart. `structure` says what the map shows beyond its null; the others
/// are as in [`backed`]. Where a constant is off beyond belief, that is the finding.
pub(super) fn doubted(
    diagnosis: &mut Diagnosis,
    structure: Option<Mapped>,
    pushed: impl Fn() -> Option<String>,
    asked: impl Fn() -> Option<(String, f64)>,
    by_constants: impl Fn() -> Option<Closure>,
) {
    if let Some(with) = diagnosis.fit_with_effects.as_ref().filter(|fit| !fit.passed()) {
        let words = rejected(Some(with));
        diagnosis.notes.push(format!("beside it: {words}"));
    }
    let Some(fit) = diagnosis.fit.clone() else { return };
    let abstained = diagnosis.verdict == GapVerdict::Unknown;
    if fit.passed() && structure.is_none() {
        if abstained {
            // An effect was kept from being named, and no test asks for one.
            unrejected(diagnosis, pushed);
            suspected(diagnosis, fit.p, asked);
        }
    } else if abstained || (diagnosis.verdict == GapVerdict::NoGap && !fit.passed()) {
        let matters = structure.as_ref().is_some_and(|own| own.share > MATTERING_SHARE)
            || (!fit.passed() && fit.structure.iter().any(Structure::may_matter));
        diagnosis.verdict = if matters { GapVerdict::Unknown } else { GapVerdict::Small };
        let by_map = structure.map(|own| own.words).filter(|_| fit.passed());
        diagnosis.notes.insert(0, by_map.unwrap_or_else(|| rejected(Some(&fit))));
        if matters {
            constant_beyond_belief(diagnosis, by_constants);
        }
    }
}

/// Where no test stands against the calibrated model, says which effects the evidence asks for all the same.
fn suspected(diagnosis: &mut Diagnosis, p: f64, asked: impl Fn() -> Option<(String, f64)>) {
    if diagnosis.verdict == GapVerdict::NoGap
        && let Some((ids, gain)) = asked()
    {
        diagnosis.verdict = GapVerdict::Masked;
        let why = format!(
            "{ids} would explain the records better (gain {gain:.1}), but constants within what is believed of \
             them explain them as well (p = {p:.3}): the next experiment decides"
        );
        diagnosis.suspected = Some(why.clone());
        diagnosis.notes.insert(0, why);
    }
}

/// Where a rejected model is off, and by how much.
fn rejected(fit: Option<&Fitness>) -> String {
    let Some(fit) = fit else { return String::new() };
    let Some(part) = fit.parts.first() else { return String::new() };
    let follows = if part.follows.is_empty() { String::new() } else { format!(" ({})", part.follows) };
    let mut words = format!("the fit is rejected (p = {:.3}): {} {}{follows}", fit.p, part.what, part.test);
    let size = |own: &&Structure| {
        let [rms, upper] = [own.rms, own.upper].map(|size| size / own.scale.sensor);
        format!("{} by {rms:.2} (up to {upper:.2}) times its sensor", own.channel)
    };
    let large: Vec<String> = fit.structure.iter().filter(|own| own.may_matter()).map(|own| size(&own)).collect();
    if !large.is_empty() {
        words += &format!("; beside noise and scatter {}", large.join(", "));
    }
    let wide = |own: &&Structure| format!("{} by {:.2} times its sensor", own.channel, own.scatter / own.scale.sensor);
    let wide: Vec<String> = fit.structure.iter().filter(|own| own.is_wide()).map(|own| wide(&own)).collect();
    if !wide.is_empty() {
        words += &format!("; what is left scatters in {}", wide.join(", "));
    }
    words
}

impl Diagnosis {
    /// What to say of the constant that calibration moved furthest, if that is further than is believed.
    pub fn constant(&self) -> Option<String> {
        let constants = self.calibration.iter().filter(|each| each.constant);
        let furthest = constants.max_by(|a, b| a.prior_sd_moved.abs().total_cmp(&b.prior_sd_moved.abs()))?;
        (furthest.prior_sd_moved.abs() > FAR_CONSTANT).then(|| {
            format!(
                "the constant `{}` is off: calibrated {:.4} ({:.4} … {:.4}), {:.1} prior standard deviations from nominal",
                furthest.parameter,
                furthest.value,
                furthest.ci90[0],
                furthest.ci90[1],
                furthest.prior_sd_moved.abs()
            )
        })
    }

    /// What to say of sensors whose gain calibration moved further than is believed: no constant of the model, and so no finding,
    /// but most likely a reading in another unit than its header says.
    pub fn far_gains(&self) -> Option<String> {
        let far = self.calibration.iter().filter(|each| each.gain && each.prior_sd_moved.abs() > FAR_CONSTANT);
        let words = |each: &Calibrated| {
            let (name, far) = (&each.parameter, each.prior_sd_moved.abs());
            format!("`{name}` is {:.3}, {far:.1} prior standard deviations from nominal", each.value)
        };
        let gains: Vec<String> = far.map(words).collect();
        (!gains.is_empty()).then(|| format!("{}: check the sensor, and the unit of its column", gains.join("; ")))
    }

    /// `unknown` where the model does not fit with the named effects, or with the constant that is off, either.
    pub fn remaining(&self) -> Option<&'static str> {
        let constant = self.fit.as_ref().filter(|_| self.verdict == GapVerdict::Constant);
        let named = self.fit_with_effects.as_ref().or(constant);
        named.filter(|fit| !fit.passed()).map(|_| GapVerdict::Unknown.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ChannelId, ChannelScale, EffectId, Part, RuleFinding};

    /// A diagnosis whose rules kept an effect from being named, with a test of this probability.
    fn abstained(p: f64, upper: f64) -> Diagnosis {
        let part = Part { what: "cutting_time", test: "groups", follows: String::new(), p, statistic: 2.0 };
        let about = ChannelId::CuttingTime;
        let scale = ChannelScale { level: 1.0, sensor: 0.01, step: 0.0 };
        let structure = Structure { channel: about, rms: 0.8 * upper, upper, scale, scatter: 0.01 };
        let fit = Fitness { p, level: 0.01, parts: vec![part], least_seen: Vec::new(), structure: vec![structure] };
        Diagnosis {
            verdict: GapVerdict::Unknown,
            fit: Some(fit),
            notes: Vec::new(),
            ..Diagnosis::cannot_tell(String::new())
        }
    }

    fn told(mut diagnosis: Diagnosis, structure: Option<f64>, gain: Option<f64>) -> Diagnosis {
        let asked = || gain.map(|gain| ("micro_stops".to_owned(), gain));
        let structure = structure.map(|share| Mapped { words: "structure is left".to_owned(), share });
        doubted(&mut diagnosis, structure, || None, asked, || None);
        diagnosis
    }

    #[test]
    fn a_gain_beyond_belief_is_said_and_is_no_constant() {
        let gain = |moved: f64| Calibrated {
            parameter: "gain of temperature, machine L1".to_owned(),
            value: (0.03 * moved).exp(),
            ci90: [1.0, 1.3],
            prior_sd_moved: moved,
            gain: true,
            constant: false,
        };
        let of = |moved| Diagnosis { calibration: vec![gain(moved)], ..Diagnosis::cannot_tell(String::new()) };
        assert_eq!((of(2.9).far_gains(), of(6.3).constant()), (None, None));
        let words = of(6.3).far_gains().expect("beyond belief");
        assert!(
            words.contains("machine L1` is 1.208, 6.3 prior") && words.ends_with("the unit of its column"),
            "{words}"
        );
    }

    #[test]
    fn groups_too_few_to_name_an_effect_are_too_few_to_name_the_constant_that_imitates_it() {
        let constant = Calibrated {
            parameter: "process stiffness Cp".to_owned(),
            value: 1.36,
            ci90: [1.35, 1.37],
            prior_sd_moved: 3.1,
            gain: false,
            constant: true,
        };
        let refused = |rules: &[&'static str]| NotNamed {
            effects: vec![EffectId::MICRO_STOPS],
            rules: rules.iter().map(|rule| RuleFinding { rule, asks: "", found: String::new() }).collect(),
        };
        let verdict = |not_named: Vec<NotNamed>| {
            let calibration = vec![constant.clone()];
            let mut diagnosis = Diagnosis { not_named, calibration, ..abstained(0.3, 0.1) };
            unrejected(&mut diagnosis, || None);
            diagnosis.verdict
        };
        assert_eq!(verdict(Vec::new()), GapVerdict::Constant);
        assert_eq!(verdict(vec![refused(&[GROUPS])]), GapVerdict::Masked);
        assert_eq!(verdict(vec![refused(&[GROUPS, "closure"])]), GapVerdict::Constant);
    }

    #[test]
    fn nothing_is_unknown_where_no_test_rejects() {
        assert_eq!(told(abstained(0.3, 0.1), None, None).verdict, GapVerdict::NoGap);
        let suspected = told(abstained(0.3, 0.1), None, Some(6.0));
        assert_eq!(suspected.verdict, GapVerdict::Masked);
        assert!(suspected.suspected.is_some_and(|words| words.contains("micro_stops") && words.contains("p = 0.300")));
    }

    #[test]
    fn unknown_says_which_test_rejects_and_small_that_nothing_matters() {
        let by_test = told(abstained(0.002, 0.1), None, Some(6.0));
        assert_eq!(by_test.verdict, GapVerdict::Unknown);
        assert!(by_test.notes[0].starts_with("the fit is rejected (p = 0.002)"), "{:?}", by_test.notes);
        let by_map = told(abstained(0.3, 0.1), Some(0.02), None);
        assert_eq!((by_map.verdict, by_map.notes[0].as_str()), (GapVerdict::Unknown, "structure is left"));
        assert_eq!(told(abstained(0.3, 0.1), Some(0.002), None).verdict, GapVerdict::Small);
    }

    #[test]
    fn a_rejected_test_takes_back_that_there_is_no_gap_and_names_nothing() {
        let found = Diagnosis { verdict: GapVerdict::NoGap, ..abstained(0.002, 0.1) };
        assert_eq!(told(found, None, Some(6.0)).verdict, GapVerdict::Unknown);
        let found = Diagnosis { verdict: GapVerdict::NoGap, ..abstained(0.3, 0.1) };
        assert_eq!(told(found, None, Some(6.0)).verdict, GapVerdict::NoGap);
    }
}
