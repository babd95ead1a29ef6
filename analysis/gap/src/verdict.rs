//! The verdict that the test of the calibrated nominal model backs.
//!
//! | the test | what the search found | verdict |
//! |---|---|---|
//! | passes | an effect that spares the model a constant beyond belief | `effect` |
//! | passes | a constant beyond belief | `constant`; `masked` where a masked effect may have pushed it there |
//! | passes | a model that the evidence asks for, with effects | `masked`: constants within belief do as well |
//! | passes | nothing | `no_gap` |
//! | rejects | an effect | `effect`; what is left beside it is said |
//! | rejects | a constant beyond belief that closes like a cause | `constant`; what is left beside it is said |
//! | rejects | nothing | `small` where nothing that is left matters, else `unknown` |

use super::constants::{FAR_CONSTANT, LEAST_CLOSED};
use super::{Closure, Diagnosis, Fitness, GapVerdict, Structure};

/// Share of a channel's value below which structure does not matter (1). Assumption:
/// nobody acts on one per cent.
const SHARE: f64 = 0.01;
/// The same in standard deviations of its sensor (1). Assumption: less is not seen in a single reading.
const SENSORS: f64 = 0.5;

impl Structure {
    /// Whether what the model leaves of the channel may matter.
    fn may_matter(&self) -> bool {
        self.upper > (SHARE * self.level).max(SENSORS * self.sensor)
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
        if diagnosis.verdict == GapVerdict::NoGap
            && let Some((ids, gain)) = asked()
        {
            diagnosis.verdict = GapVerdict::Masked;
            let why = format!(
                "{ids} would explain the records better (gain {gain:.1}), but constants within what is believed of \
                 them explain them as well (p = {:.3}): the next experiment tells",
                fit.p
            );
            diagnosis.suspected = Some(why.clone());
            diagnosis.notes.insert(0, why);
        }
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
    } else if !small
        && let Some(constant) = diagnosis.constant()
        && by_constants().is_some_and(|closed| closed.closed > LEAST_CLOSED && closed.ci90[0] > 0.0)
    {
        diagnosis.verdict = GapVerdict::Constant;
        diagnosis.notes.insert(0, constant);
    }
}

/// Sets the verdict where no test stands against the calibrated model: calibration that went far says why it did, or is
/// the finding.
pub(super) fn unrejected(diagnosis: &mut Diagnosis, pushed: impl Fn() -> Option<String>) {
    diagnosis.verdict = GapVerdict::NoGap;
    if let Some(why) = pushed() {
        diagnosis.verdict = GapVerdict::Masked;
        diagnosis.suspected = Some(why.clone());
        diagnosis.notes.push(why);
    } else if let Some(constant) = diagnosis.constant() {
        diagnosis.verdict = GapVerdict::Constant;
        diagnosis.notes.insert(0, constant);
    }
}

/// Takes back a `no_gap` that the test of a model contradicts whose noise was read off the records. Names are no question
/// of it: there calibration may follow what an effect does, and evidence tells them apart.
pub(super) fn doubted(diagnosis: &mut Diagnosis) {
    if let Some(with) = diagnosis.fit_with_effects.as_ref().filter(|fit| !fit.passed()) {
        let words = rejected(Some(with));
        diagnosis.notes.push(format!("beside it: {words}"));
    }
    let Some(fit) = diagnosis.fit.as_ref().filter(|fit| !fit.passed()) else { return };
    if diagnosis.verdict == GapVerdict::NoGap {
        let small = !fit.structure.iter().any(Structure::may_matter);
        let words = rejected(Some(fit));
        diagnosis.verdict = if small { GapVerdict::Small } else { GapVerdict::Unknown };
        diagnosis.notes.insert(0, words);
    }
}

/// Where a rejected model is off, and by how much.
fn rejected(fit: Option<&Fitness>) -> String {
    let Some(fit) = fit else { return String::new() };
    let Some(part) = fit.parts.first() else { return String::new() };
    let follows = if part.follows.is_empty() { String::new() } else { format!(" ({})", part.follows) };
    let mut words = format!("the fit is rejected (p = {:.3}): {} {}{follows}", fit.p, part.what, part.test);
    let size = |own: &&Structure| format!("{} up to {:.2} times its sensor", own.channel, own.upper / own.sensor);
    let large: Vec<String> = fit.structure.iter().filter(|own| own.may_matter()).map(|own| size(&own)).collect();
    if !large.is_empty() {
        words += &format!("; beside noise and scatter {}", large.join(", "));
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

    /// `unknown` where the model does not fit with the named effects, or with the constant that is off, either.
    pub fn remaining(&self) -> Option<&'static str> {
        let constant = self.fit.as_ref().filter(|_| self.verdict == GapVerdict::Constant);
        let named = self.fit_with_effects.as_ref().or(constant);
        named.filter(|fit| !fit.passed()).map(|_| GapVerdict::Unknown.name())
    }
}
