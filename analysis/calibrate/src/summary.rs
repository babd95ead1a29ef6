//! A calibration as JSON and as text.

use crate::base::Process;
use crate::calibration::Calibration;
use crate::channel::Channel;
use crate::channels::ChannelFit;
use crate::chipping::ChippingFit;
use crate::choice::Verdict;
use crate::identify::Identifiability;
use crate::model::Model;
use crate::parameter::{Parameter, Scale};
use crate::sample::Posterior;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use toolroom_chart::number;

/// A value in its unit of files, with its interval.
fn values(posterior: &Posterior, index: usize, parameter: &Parameter) -> (f64, f64, [f64; 2]) {
    let value = |u: f64| parameter.scale.value(u);
    let draws = posterior.draws.iter().map(|draw| value(draw[index]));
    let mean = draws.sum::<f64>() / posterior.draws.len() as f64;
    let ends = [posterior.quantile(index, 0.05), posterior.quantile(index, 0.95)].map(value);
    (value(posterior.map.u[index]), mean, ends)
}

/// Parameters with their values for programs.
fn listed(parameters: &[Parameter], posterior: &Posterior, identifiability: &Identifiability) -> Vec<Value> {
    let one = |(index, parameter): (usize, &Parameter)| {
        let (map, mean, ci90) = values(posterior, index, parameter);
        let key = if parameter.scale == Scale::Logarithm { "sd_ln" } else { "sd" };
        json!({
            "name": parameter.name, "unit": parameter.unit, "map": map, "mean": mean, "ci90": ci90,
            "coordinate": {
                "map": posterior.map.u[index], "mean": posterior.mean[index], "sd": posterior.deviation(index),
                "ci90": [posterior.quantile(index, 0.05), posterior.quantile(index, 0.95)],
            },
            "prior": { "mean": parameter.scale.value(parameter.prior.mean), key: parameter.prior.deviation },
            "shrink": identifiability.shrink[index], "determined": identifiability.determined(index),
        })
    };
    parameters.iter().enumerate().map(one).collect()
}

/// Parameters with their values for people.
fn table(text: &mut String, parameters: &[Parameter], posterior: &Posterior, identifiability: &Identifiability) {
    let width = parameters.iter().map(|parameter| with_unit(parameter).len()).max().unwrap_or(0);
    let _ = writeln!(text, "\n{:width$}  {:>9}  {:>21}  {:>13}", "parameter", "MAP", "90 %", "prior left");
    for (index, parameter) in parameters.iter().enumerate() {
        let (map, _, [low, high]) = values(posterior, index, parameter);
        let left = identifiability.shrink[index];
        let mark = if identifiability.determined(index) { "" } else { "  not determined" };
        let name = with_unit(parameter);
        let _ = writeln!(text, "{name:width$}  {map:>9.4}  {low:>9.4} … {high:>9.4}  {left:>13.2}{mark}");
    }
}

/// Name with the unit, as JSON keys and table headers have it.
pub(crate) fn with_unit(parameter: &Parameter) -> String {
    if parameter.unit == "1" { parameter.name.clone() } else { format!("{} [{}]", parameter.name, parameter.unit) }
}

impl Calibration {
    /// The result for programs.
    pub fn json(&self) -> Value {
        let fit = self.carried();
        let parameters = fit.model.parameters();
        let name = |index: usize| parameters[index].name.clone();
        let mut ends: BTreeMap<&str, usize> = BTreeMap::new();
        self.measured.ends.iter().for_each(|end| *ends.entry(end.name()).or_default() += 1);
        let scores: Map<String, Value> = self
            .choice
            .scores
            .iter()
            .map(|score| {
                let value =
                    json!({ "elpd": score.elpd, "margin": score.margin, "se": score.error, "weight": score.weight });
                (score.candidate.name(), value)
            })
            .collect();
        let densities: Map<String, Value> =
            self.fits.iter().map(|fit| (fit.model.candidate().name(), json!(fit.maximum.ln_density))).collect();
        let of_law = listed(parameters, &self.posterior, &self.identifiability);
        let undetermined: Vec<Value> = self
            .identifiability
            .undetermined
            .iter()
            .map(|direction| {
                let parts: Map<String, Value> =
                    direction.direction.iter().map(|(index, part)| (name(*index), json!(part))).collect();
                let lift: Vec<&str> =
                    direction.direction.iter().map(|(index, _)| parameters[*index].lift.as_str()).collect();
                json!({ "direction": parts, "variance_left": direction.variance_left, "lift": lift.join("; ") })
            })
            .collect();
        let correlations: Vec<Value> =
            self.identifiability.correlations.iter().map(|(a, b, r)| json!([name(*a), name(*b), r])).collect();
        let products: Vec<Value> = self
            .identifiability
            .products
            .iter()
            .map(|product| {
                json!({
                    "parameters": product.pair.map(name), "exponents": product.exponents, "mean": product.mean,
                    "sd": product.deviation,
                })
            })
            .collect();
        let scatter = parameters.iter().position(|parameter| parameter.name == crate::EDGE_SCATTER);
        let scatter = scatter.map(|index| {
            let (map, _, ci90) = values(&self.posterior, index, &parameters[index]);
            json!({ "value": map, "ci90": ci90 })
        });
        let life: Vec<Value> = self
            .lives
            .iter()
            .map(|life| {
                let [speed, feed, depth, width] = life.condition.quantities();
                let unit = self.measured.clock.unit();
                let mut value = json!({
                    "cutting_speed [m/min]": speed * 60.0, "depth_of_cut [mm]": depth * 1e3, "ci90": life.ci90,
                    "next_edge90": life.next_edge90, "tested": life.tested,
                });
                value[format!("{} [mm]", self.measured.process.feed())] = json!(feed * 1e3);
                value[format!("median [{unit}]")] = json!(life.median);
                if life.condition.width.is_some() {
                    value["width_of_cut [mm]"] = json!(width * 1e3);
                }
                if let Some(word) = self.measured.groups.get(life.condition.group) {
                    value["group"] = json!(word);
                }
                value
            })
            .collect();
        let of_fit = |fit: &ChannelFit| {
            json!({
                "channel": fit.model.channel().column(), "edges": fit.model.edges(),
                "read": { "when": fit.when.name(), "lead": fit.lead },
                "parameters": listed(fit.model.parameters(), &fit.posterior, &fit.identifiability),
                "gain_of_wear": { "elpd": fit.gain.0, "se": fit.gain.1 },
            })
        };
        let of_channel =
            |channels: &[Channel]| self.channels.iter().find(|fit| channels.contains(&fit.model.channel())).map(of_fit);
        let force = of_channel(&[Channel::CuttingForce, Channel::SpindlePower]);
        let feed_force = of_channel(&[Channel::FeedForce]);
        let (heat, emf) = (of_channel(&[Channel::Temperature]), of_channel(&[Channel::ThermoEmf]));
        let finite = |value: f64| if value.is_finite() { json!(value) } else { Value::Null };
        let notes: Vec<&String> = self.measured.notes.iter().collect();
        let worst = self.coverage.worst.map(|edge| self.measured.edges[edge].name.clone());
        json!({
            "schema": 1, "process": self.measured.process.name(), "law": self.choice.carried.law.group(),
            "shape": self.choice.carried.shape.name(), "time": self.measured.clock.unit(), "groups": self.measured.groups,
            "wear_limit [mm]": self.request.limit,
            "choice": {
                "verdict": self.choice.verdict.name(),
                "class": self.choice.class.iter().map(|candidate| candidate.name()).collect::<Vec<_>>(),
                "reason": self.choice.reason, "scores": scores, "ln_posterior": densities,
            },
            "edges": self.measured.edges.len(), "readings": self.measured.readings(), "ends": ends,
            "parameters": of_law, "correlations": correlations, "products": products, "undetermined": undetermined,
            "best_known": { "cutting_speed [m/min]": self.best_known.0, "sd_ln_life": self.best_known.1 },
            "sampling": {
                "method": self.posterior.method.name(), "draws": self.posterior.draws.len(),
                "effective": self.posterior.effective, "pareto_k": finite(self.posterior.pareto_k),
                "split_r": finite(self.posterior.split_r), "seed": self.request.seed,
            },
            "coverage": {
                "edges_left_out": self.coverage.edges, "readings": self.coverage.readings,
                "inside50": finite(self.coverage.inside50), "inside90": finite(self.coverage.inside90),
                "histogram": self.coverage.histogram, "worst_edge": worst,
            },
            "scatter": { "common_wear": scatter, "chipping_rate [1/km]": self.chipping_json() }, "force": force,
            "feed_force": feed_force, "temperature": heat, "thermo_emf": emf, "temperatures": self.temperatures(),
            "held_out": self.held_out_json(), "profiles": self.profiles_json(),
            "life": life, "refusals": self.measured.refusals, "warnings": self.warnings(), "notes": notes,
        })
    }

    /// Under which temperatures activation energies hold, where the law has any.
    pub(crate) fn temperatures(&self) -> Option<String> {
        if self.choice.carried.law.states_lives() {
            return None;
        }
        let fitted = self.channels.iter().find(|fit| fit.model.channel().heats());
        Some(match fitted.map(|fit| fit.model.channel()) {
            Some(Channel::ThermoEmf) => "activation energies hold under temperatures by the thermo-EMF, whose characteristic (emf) is that \
                                         of the set"
                .to_owned(),
            Some(_) => "activation energies hold under the temperatures that were measured (group temperature of the set)".to_owned(),
            None => "activation energies hold under the temperatures of the set, which these data do not measure; to tell them: \
                     temperature or thermo_emf of new and worn edges at two speeds"
                .to_owned(),
        })
    }

    /// The verdict in a sentence.
    pub fn sentence(&self) -> String {
        let law = self.choice.carried.name();
        match self.choice.verdict {
            Verdict::Given => format!("law given: {law}"),
            Verdict::Chosen => {
                let second = &self.choice.scores[1];
                format!(
                    "law chosen: {law}, ahead of {} by {:.1} ± {:.1} logarithms on edges left out",
                    second.candidate.name(),
                    second.margin,
                    second.error
                )
            }
            Verdict::CannotTell => {
                let class: Vec<String> = self.choice.class.iter().map(|candidate| candidate.name()).collect();
                let reason = self.choice.reason.as_ref().map(|reason| format!("; {reason}")).unwrap_or_default();
                if class.len() == 1 {
                    // The scores are clear, but are no ground to choose by.
                    return format!("law: cannot tell; the set carries {law}, whose score is best{reason}");
                }
                format!("law: cannot tell among {}; the set carries {law}, the simplest{reason}", class.join("; "))
            }
        }
    }

    /// The result for people.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let measured = &self.measured;
        let edges = measured.edges.len();
        let plural = if edges == 1 { "" } else { "s" };
        let _ = writeln!(text, "{edges} edge{plural}, {} readings of wear", measured.readings());
        for warning in self.warnings() {
            let _ = writeln!(text, "warning: {warning}");
        }
        let _ = writeln!(text, "{}", self.sentence());
        if self.choice.scores.len() > 1 {
            let of = |score: &crate::choice::Score| {
                let behind = format!(" (behind by {:.1} ± {:.1})", score.margin, score.error);
                let behind = if score.margin > 0.0 { behind } else { String::new() };
                format!("{} {:.1}{behind}", score.candidate.name(), score.elpd)
            };
            let scores: Vec<String> = self.choice.scores.iter().map(of).collect();
            let _ = writeln!(text, "log scores of edges left out: {}", scores.join("; "));
        }
        for refusal in &measured.refusals {
            let _ = writeln!(text, "cannot tell: {refusal}");
        }
        for note in &measured.notes {
            let _ = writeln!(text, "note: {note}");
        }
        let parameters = self.carried().model.parameters();
        table(&mut text, parameters, &self.posterior, &self.identifiability);
        for direction in &self.identifiability.undetermined {
            let parts: Vec<String> = direction
                .direction
                .iter()
                .map(|(index, part)| {
                    let name = &parameters[*index].name;
                    if direction.direction.len() == 1 { name.clone() } else { format!("{part:+.2}·{name}") }
                })
                .collect();
            let lift: Vec<&str> =
                direction.direction.iter().map(|(index, _)| parameters[*index].lift.as_str()).collect();
            let left = direction.variance_left;
            let _ = writeln!(
                text,
                "not determined by your data: {} ({left:.2} of the prior variance left); to lift it: {}",
                parts.join(" "),
                lift.join("; ")
            );
        }
        for product in &self.identifiability.products {
            let [a, b] = product.pair.map(|index| parameters[index].name.as_str());
            let [x, y] = product.exponents;
            let percent = 100.0 * product.deviation;
            let _ = writeln!(
                text,
                "your data fix {x:+.2}·{a} {y:+.2}·{b} (coordinates) to ±{percent:.1} %, not either of them"
            );
        }
        let (speed, deviation) = self.best_known;
        let _ = writeln!(
            text,
            "the life is known best at {speed:.0} m/min, to ±{:.0} % (one deviation)",
            100.0 * deviation
        );
        if let Some(temperatures) = self.temperatures() {
            let _ = writeln!(text, "{temperatures}");
        }
        self.life_table(&mut text);
        for fit in &self.channels {
            table(&mut text, fit.model.parameters(), &fit.posterior, &fit.identifiability);
            let (gain, error) = fit.gain;
            let channel = fit.model.channel().column();
            let _ =
                writeln!(text, "wear in {channel} predicts edges left out better by {gain:.1} ± {error:.1} logarithms");
        }
        self.further_text(&mut text);
        if self.coverage.readings > 0 {
            let _ = writeln!(
                text,
                "\nreadings of edges left out within their 90 % band: {:.0} %",
                100.0 * self.coverage.inside90
            );
        }
        text
    }

    fn chipping_json(&self) -> Option<Value> {
        self.chipping.as_ref().map(|fit| {
            json!({
                "value": fit.rate, "ci90": fit.ci90, "chips": fit.chips, "shape": fit.shape, "shape_fitted": fit.shaped,
            })
        })
    }

    fn held_out_json(&self) -> Option<Value> {
        let finite = |value: f64| if value.is_finite() { json!(value) } else { Value::Null };
        self.held_out.as_ref().map(|held| {
            let scores: Map<String, Value> = held
                .names
                .iter()
                .zip(&held.left_out)
                .map(|(name, left)| (name.clone(), json!({ "score": left.score, "bands": left.bands })))
                .collect();
            let coverage = &held.coverage;
            json!({
                "edges": scores, "readings": coverage.readings, "inside50": finite(coverage.inside50),
                "inside90": finite(coverage.inside90),
            })
        })
    }

    /// Profile intervals in units of files, by name.
    fn profiles_json(&self) -> Option<Value> {
        let parameters = self.carried().model.parameters();
        self.profiles.as_ref().map(|profiles| {
            let one = |(parameter, ends): (&Parameter, &[f64; 2])| {
                let ends =
                    ends.map(|end| Some(end).filter(|end| end.is_finite()).map(|end| parameter.scale.value(end)));
                (parameter.name.clone(), json!(ends))
            };
            Value::Object(parameters.iter().zip(profiles).map(one).collect())
        })
    }

    /// Chipping, held-out edges and profiles for people.
    fn further_text(&self, text: &mut String) {
        if let Some(fit) = &self.chipping {
            let [low, high] = fit.ci90;
            let edges = self.measured.edges.len();
            let _ = match fit.chips {
                0 => writeln!(
                    text,
                    "no edge of {edges} chipped: the rate is below {high:.3} /km (95 %); the set keeps its own, and no share of edges \
                     chips beside it"
                ),
                chips => writeln!(
                    text,
                    "{chips} of {edges} edges chipped or broke: {:.3} /km ({low:.3} … {high:.3}), shape {:.2}{}",
                    fit.rate,
                    fit.shape,
                    if fit.shaped { "" } else { " of the set" }
                ),
            };
        }
        if let Some(held) = &self.held_out {
            let coverage = &held.coverage;
            let score: f64 = held.left_out.iter().map(|left| left.score).sum();
            let _ = writeln!(
                text,
                "held out: {}; {} of {} readings within their 90 % band, log score {score:.1}",
                held.names.join(", "),
                (coverage.inside90 * coverage.readings as f64).round(),
                coverage.readings
            );
        }
        if let Some(profiles) = &self.profiles {
            let _ = writeln!(text, "\n{:40}  {:>23}", "profile", "90 %");
            for (parameter, ends) in self.carried().model.parameters().iter().zip(profiles) {
                let end = |end: f64| {
                    if end.is_finite() { format!("{:.4}", parameter.scale.value(end)) } else { "unbounded".to_owned() }
                };
                let _ = writeln!(text, "{:40}  {:>10} … {:>10}", with_unit(parameter), end(ends[0]), end(ends[1]));
            }
        }
    }

    /// Lives at the conditions of interest for people.
    fn life_table(&self, text: &mut String) {
        let (measured, unit) = (&self.measured, self.measured.clock.unit());
        let _ = writeln!(
            text,
            "\nlife in {unit} to a flank wear of {} mm\n{:>8}  {:>8}  {:>8}{}  {:>9}  {:>19}  {:>19}",
            number(self.request.limit, 3),
            "m/min",
            match measured.process {
                Process::Turning => "mm/rev",
                Process::Milling => "mm/tooth",
            },
            "depth mm",
            match measured.process {
                Process::Turning => "",
                Process::Milling => "  width mm",
            },
            "life",
            "90 %",
            "next edge, 90 %"
        );
        for life in &self.lives {
            let [speed, feed, depth, width] = life.condition.quantities();
            let width = match life.condition.width {
                Some(_) => format!("  {:>8}", number(width * 1e3, 3)),
                None => String::new(),
            };
            let group = match measured.groups.get(life.condition.group) {
                Some(word) => format!("  {word}"),
                None => String::new(),
            };
            let _ = writeln!(
                text,
                "{:>8.0}  {:>8}  {:>8}{width}  {:>9.1}  {:>8.1} … {:>8.1}  {:>8.1} … {:>8.1}{group}{}",
                speed * 60.0,
                number(feed * 1e3, 3),
                number(depth * 1e3, 3),
                life.median,
                life.ci90[0],
                life.ci90[1],
                life.next_edge90[0],
                life.next_edge90[1],
                if life.tested { "" } else { "  not tested" }
            );
        }
    }

    /// Header of the table of draws: one column a parameter in its unit, the law, and the weight.
    pub fn draw_columns(&self) -> Vec<String> {
        let of_channels = self.channels.iter().flat_map(|fit| shared_columns(fit.model.parameters()));
        let fitted = self.carried().model.parameters().iter().chain(of_channels).map(with_unit);
        fitted.chain(self.chips().map(|_| "chipping.rate [1/km]".to_owned())).collect()
    }

    /// The rate of chipping where some edge chipped; a bound enters no set.
    pub(crate) fn chips(&self) -> Option<&ChippingFit> {
        self.chipping.as_ref().filter(|fit| fit.chips > 0)
    }

    /// The draws in units of files, in the order of [`Calibration::draw_columns`].
    pub fn draws(&self) -> impl Iterator<Item = Vec<f64>> + '_ {
        let model = &self.carried().model;
        // Wear and force are two posteriors that do not depend on each other: any draw of one goes with any of the other.
        self.posterior.draws.iter().enumerate().map(|(number, draw)| {
            let value = |(parameter, u): (&Parameter, &f64)| parameter.scale.value(*u);
            let mut values: Vec<f64> = model.parameters().iter().zip(draw.iter()).map(value).collect();
            for fit in &self.channels {
                let parameters: Vec<&Parameter> = shared_columns(fit.model.parameters()).collect();
                let draw = &fit.posterior.draws[number % fit.posterior.draws.len()];
                values.extend(parameters.into_iter().zip(draw.iter()).map(value));
            }
            if let Some(fit) = self.chips() {
                let mut random = ChaCha8Rng::seed_from_u64(self.request.seed);
                random.set_stream(number as u64);
                values.push(fit.draw(&mut random));
            }
            values
        })
    }
}

/// Parameters of a channel that draws hold: those of the force group; scatter and noise come last and belong to none. Temperatures
/// stay as the set has them: the wear was fitted under these, and with others the same rates would not give the lives that were measured.
fn shared_columns(parameters: &[Parameter]) -> impl Iterator<Item = &Parameter> {
    parameters.iter().filter(|parameter| parameter.name.starts_with("force."))
}
