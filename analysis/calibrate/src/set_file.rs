//! The calibrated parameter set as a file.

use crate::base::{Base, Process};
use crate::calibration::Calibration;
use crate::channels::ChannelFit;
use crate::model::Model;
use crate::parameter::{Parameter, Scale};
use crate::sample::Posterior;
use crate::wear_model::{EDGE_SCATTER, LIFE_NOISE_NAME};
use std::fmt::Write as _;

/// A number to the seven digits that files give.
fn rounded(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}

impl Calibration {
    /// The set of the maximum as a file based on the set `based_on`, a shipped name or a path. `[prior]` holds the
    /// posterior, for the next round.
    ///
    /// What edges differ by is all in the scatter of edges here; scatter of hardness and allowance cannot be told apart
    /// from it and is set to zero, so that a shop does not count it twice. The same holds for noise of the rate within a life
    /// where it was not fitted: the readings have it in their error.
    pub fn set_file(&self, name: &str, based_on: &str) -> String {
        let fit = self.carried();
        let model = &fit.model;
        let u = self.posterior.map.u.as_slice();
        let quoted = |text: &str| format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""));
        let source = format!("calibrated: {} edges, {} readings", self.measured.edges.len(), self.measured.readings());
        let mut text = String::new();
        let _ = writeln!(text, "# {}", self.sentence());
        let _ = writeln!(
            text,
            "schema = 1\nname = {}\ntitle = {}",
            quoted(name),
            quoted(&format!("{source}, based on {based_on}"))
        );
        let law = self.choice.carried.law.group();
        let process = self.measured.process;
        let _ = writeln!(text, "process = \"{}\"\nbased_on = {}", process.name(), quoted(based_on));
        if let Process::Turning = process {
            let _ = writeln!(text, "law = \"{law}\"");
        }
        let _ = writeln!(text, "\n[parameters.{law}]");
        let (mut fitted, mut based) = (model.at(u), self.stated.clone());
        let same_law = match (&fitted, &based) {
            (Base::Turning { pair: fitted, .. }, Base::Turning { pair: based, .. }) => {
                fitted.law.group() == based.law.group()
            }
            // Its level is stated at another cut than that of the set.
            (Base::Milling { .. }, Base::Milling { .. }) => false,
            (Base::Turning { .. }, Base::Milling { .. }) | (Base::Milling { .. }, Base::Turning { .. }) => false,
        };
        let (record, based) = (fitted.law_mut(), based.law_mut());
        for (index, field) in record.fields().iter().enumerate() {
            let value = record.value(index).unwrap_or(field.start);
            let name = format!("{law}.{}", field.name);
            let calibrated = model.parameters().iter().any(|parameter| parameter.name == name);
            // What the file does not state comes from the set on which it is based.
            if !calibrated && same_law && based.value(index) == Some(value) {
                continue;
            }
            let number = rounded(field.to_display(value));
            let value =
                if field.display == "1" { format!("{number:?}") } else { format!("\"{number:?} {}\"", field.display) };
            let source = if calibrated { source.as_str() } else { "not fitted: value of this calibration" };
            let _ = writeln!(text, "{} = {{ value = {value}, source = {} }}", field.name, quoted(source));
        }
        let limit = self.request.limit;
        match process {
            Process::Turning => {
                let _ = writeln!(
                    text,
                    "\n[parameters.limits]\nwear_limit = {{ value = \"{limit:?} mm\", source = \"limit of the calibration\" }}"
                );
            }
            // The group `life` holds it.
            Process::Milling => {}
        }
        for group in ["temperature", "emf", "force"] {
            let fitted: Vec<String> = self.channels.iter().flat_map(|fit| values(fit, group)).collect();
            if !fitted.is_empty() {
                let _ = writeln!(text, "\n[parameters.{group}]\n{}", fitted.join("\n"));
            }
        }
        if let Some(fit) = self.chips() {
            let source = quoted(&format!("calibrated: {} of {} edges", fit.chips, self.measured.edges.len()));
            let _ = writeln!(
                text,
                "\n[parameters.chipping]\nrate = {{ value = \"{:?} 1/km\", source = {source} }}",
                rounded(fit.rate)
            );
            if fit.shaped {
                let _ = writeln!(text, "shape = {{ value = {:?}, source = {source} }}", rounded(fit.shape));
            }
        }
        let _ = writeln!(text, "\n[prior]");
        let contrast = record.fields().iter().position(|field| field.name == "stage_contrast");
        let left = 1.0 - contrast.and_then(|place| record.value(place)).unwrap_or(0.0);
        priors(&mut text, model.parameters(), &self.posterior, left);
        for fit in &self.channels {
            priors(&mut text, fit.model.parameters(), &fit.posterior, left);
        }
        if let Some(index) = model.parameters().iter().position(|parameter| parameter.name == EDGE_SCATTER) {
            let _ = writeln!(text, "\n[scatter]\ncommon_wear = {:?}", rounded(u[index].exp()));
            let _ = writeln!(
                text,
                "mechanical_wear = 0.0\nthermal_wear = 0.0\nbatch_hardness = 0.0\npiece_hardness = 0.0\nallowance = \"0 mm\"\n\
                 initial_wear = \"0 mm\" # edges were taken as new"
            );
            let noise = model.parameters().iter().position(|parameter| parameter.name == LIFE_NOISE_NAME);
            let _ = match noise {
                Some(index) => writeln!(text, "life_noise = {:?}", rounded(u[index].exp())),
                None => {
                    writeln!(text, "life_noise = 0.0 # not fitted: what there is of it is in the error of readings")
                }
            };
            let why = match &self.chipping {
                // What a shop assumes of edges of which nothing is known.
                None => None,
                Some(fit) if fit.chips == 0 => Some("no edge chipped: the rate of the set stands"),
                Some(_) => Some("chips come by the rate"),
            };
            if let Some(why) = why {
                let _ = writeln!(text, "chipped_share = 0.0 # {why}");
            }
        }
        text
    }
}

/// Lines of a parameter file with what a channel tells of a group.
fn values(fit: &ChannelFit, group: &str) -> Vec<String> {
    let readings: usize = (0..fit.model.edges()).map(|edge| fit.model.readings(edge).len()).sum();
    let channel = fit.model.channel().column();
    let source = format!("calibrated: {} edges, {readings} readings of {channel}", fit.model.edges());
    let line = |(parameter, u): (&Parameter, &f64)| {
        let name = parameter.name.strip_prefix(group)?.strip_prefix('.')?;
        let number = rounded(parameter.scale.value(*u));
        let value =
            if parameter.unit == "1" { format!("{number:?}") } else { format!("\"{number:?} {}\"", parameter.unit) };
        Some(format!("{name} = {{ value = {value}, source = \"{source}\" }}"))
    };
    fit.model.parameters().iter().zip(fit.posterior.map.u.iter()).filter_map(line).collect()
}

/// Posterior deviations as priors of the next round, in units of files; what no set has a name for is left out. A tilt is a share of what
/// the contrast leaves it, `left`.
fn priors(text: &mut String, parameters: &[Parameter], posterior: &Posterior, left: f64) {
    for (index, parameter) in parameters.iter().enumerate().filter(|(_, parameter)| is_of_set(parameter)) {
        let (u, deviation) = (posterior.map.u[index], posterior.deviation(index));
        let spread = match parameter.scale {
            Scale::Logarithm => format!("factor = {:?}", rounded(deviation.exp())),
            Scale::Plain => format!("deviation = {:?}", rounded(deviation)),
            // To first order at the maximum.
            Scale::Contrast | Scale::Tilt => {
                let step = 1e-4;
                let slope = (parameter.scale.value(u + step) - parameter.scale.value(u)) / step;
                let left = if parameter.scale == Scale::Tilt { left } else { 1.0 };
                format!("deviation = {:?}", rounded(deviation * slope * left))
            }
        };
        let _ = writeln!(text, "\"{}\" = {{ {spread} }}", parameter.name);
    }
}

/// Whether a parameter set has a name for a parameter: noise and groups of edges belong to none, and the scatter of edges is that of
/// `[scatter]`.
fn is_of_set(parameter: &Parameter) -> bool {
    parameter.name == EDGE_SCATTER || parameter.name.contains('.') && !parameter.name.contains('=')
}
