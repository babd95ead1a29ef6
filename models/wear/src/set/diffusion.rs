//! Diffusion wear as classic files state it: at infinite temperature.

use super::values::{Placed, Values};
use super::{Origin, ParameterSet};
use toolroom_form::{Fault, Section, Walk};
use toolroom_process::{Field, Record};

toolroom_process::record! {
    /// The coefficient of diffusion as classic files of Takeyama and Murata's law state it.
    pub struct ClassicDiffusion {
        /// Diffusion wear rate at infinite temperature, D.
        diffusion_wear: Real["m/s" => "um/min"] = 100.0, 0.0..=1e15;
    }
}

/// Parameters that a file may give in place of present ones.
pub(super) fn legacy(group: &str) -> &'static [Field] {
    if group == "takeyama_murata" { ClassicDiffusion::<f64>::FIELDS } else { &[] }
}

/// Brings diffusion stated at infinite temperature to the reference temperature.
pub(super) fn at_reference(
    walk: &mut Walk,
    law: &'static str,
    root: &Section<'_>,
    values: &mut Values,
    base: Option<&ParameterSet>,
) {
    let group = "takeyama_murata";
    let Some(classic) = values.remove(&(group, "diffusion_wear")) else { return };
    if law != group {
        return;
    }
    let key = (group, "diffusion_wear_at_reference");
    if values.contains_key(&key) {
        let rule = "one of the two states the diffusion";
        let fault = Fault::Beside { key: "diffusion_wear", beside: "diffusion_wear_at_reference", rule };
        walk.fault(classic.span, fault);
        return;
    }
    let defaults = crate::TakeyamaMurata::default();
    let value = |name: &'static str, default: f64| {
        let inherited = base.and_then(|base| base.value(group, name)).map(|value| value.value);
        values.get(&(group, name)).map(|placed| placed.value).or(inherited).unwrap_or(default)
    };
    let temperature = value("reference_temperature", defaults.reference_temperature);
    let energy = value("activation_energy", f64::NAN);
    let gas = value("gas_constant", defaults.gas_constant);
    let at_reference = classic.value * (-energy / (gas * temperature)).exp();
    let field = crate::TakeyamaMurata::<f64>::FIELDS.iter().find(|field| field.name == key.1);
    if let Some(Err(reason)) = field.filter(|_| energy.is_finite()).map(|field| field.check(at_reference)) {
        walk.fault(classic.span, Fault::Model { subject: root.path.clone(), reason });
        return;
    }
    let source = format!("{}; brought to {temperature} K", classic.source);
    values.insert(key, Placed { value: at_reference, source, ..classic.clone() });
    values.entry((group, "reference_temperature")).or_insert(Placed {
        value: temperature,
        source: "assumption: where the classic coefficient is stated again".to_owned(),
        origin: Origin::Assumed,
        span: classic.span,
    });
}
