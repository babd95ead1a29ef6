//! Reference results: an input and what the unit makes of it (layered standard FMI-LS-REF).

use super::PackageError;
use crate::catalogue::Entry;
use crate::component::Interface;
use crate::description::{Description, TOOL};
use crate::log::Log;
use crate::variable::{Role, ValueType, Variable};
use std::fmt::Write as _;

/// Rows of the reference result.
const ROWS: usize = 100;

/// When the renewal inputs rise, as a share of the experiment, and when they fall.
const RENEWAL: (f64, f64) = (0.5, 0.6);

/// Name and text of each file.
pub(super) fn files(unit: &Entry, description: &Description) -> Result<Vec<(String, String)>, PackageError> {
    let renewals: Vec<&Variable> = description
        .variables
        .iter()
        .filter(|variable| variable.role == Role::Input && variable.value_type == ValueType::Boolean)
        .filter(|variable| !variable.name.starts_with("process."))
        .collect();
    let (stop, step) = description.experiment;
    let input = input(&renewals, stop);
    let output = output(unit, description, &renewals, stop, step)?;
    let manifest = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <fmiLayeredStandardManifest xmlns:fmi-ls=\"http://fmi-standard.org/fmi-ls-manifest\" \
         fmi-ls:fmi-ls-name=\"org.fmi-standard.fmi-ls-ref\" fmi-ls:fmi-ls-version=\"1.0.0-alpha.1\" \
         fmi-ls:fmi-ls-description=\"Reference results of {} by {TOOL}\"/>\n",
        description.identifier
    );
    let name = description.identifier;
    Ok(vec![
        ("fmi-ls-manifest.xml".to_owned(), manifest),
        (format!("{name}_in.csv"), input),
        (format!("{name}_out.csv"), output),
    ])
}

/// The renewal inputs over time; everything else stays at its start value.
fn input(renewals: &[&Variable], stop: f64) -> String {
    let mut text = header(renewals);
    for (time, value) in
        [(0.0, 0), (RENEWAL.0 * stop, 0), (RENEWAL.0 * stop, 1), (RENEWAL.1 * stop, 1), (RENEWAL.1 * stop, 0)]
    {
        let _ = write!(text, "\n{time:?}");
        text.push_str(&format!(",{value}").repeat(renewals.len()));
    }
    text + "\n"
}

fn header(variables: &[&Variable]) -> String {
    std::iter::once("time").chain(variables.iter().map(|variable| variable.name.as_str())).collect::<Vec<_>>().join(",")
}

fn output(
    unit: &Entry,
    description: &Description,
    renewals: &[&Variable],
    stop: f64,
    step: f64,
) -> Result<String, PackageError> {
    let wanted = |variable: &&Variable| variable.role == Role::Output && variable.field.len == 1;
    let outputs: Vec<&Variable> = description.variables.iter().filter(wanted).collect();
    let held = Interface::CoSimulation { event_mode: false, early_return: false };
    let mut instance = unit.instantiate(held, None, Log::new(None, false));
    instance.enter_initialization()?;
    instance.exit_initialization()?;
    let mut text = header(&outputs);
    let steps = (stop / step).round() as usize;
    for i in 0..=steps {
        let time = i as f64 * step;
        if i.is_multiple_of((steps / ROWS).max(1)) {
            let _ = write!(text, "\n{time:?}");
            for variable in &outputs {
                let mut value = [0.0];
                instance.read(variable.value_type, &[variable.slot.reference()], &mut value)?;
                let _ = write!(text, ",{:?}", value[0]);
            }
        }
        let raised = time >= RENEWAL.0 * stop && time < RENEWAL.1 * stop;
        for renewal in renewals {
            instance.write(ValueType::Boolean, &[renewal.slot.reference()], &[f64::from(raised)])?;
        }
        if i < steps {
            instance.do_step(time, step)?;
        }
    }
    Ok(text + "\n")
}
