//! Reference results: an input and what the unit makes of it (layered standard FMI-LS-REF).

use super::PackageError;
use crate::catalogue::Entry;
use crate::component::Interface;
use crate::description::{Description, TOOL};
use crate::log::Log;
use crate::variable::{Role, ValueType, Variable};
use toolroom_process::table::{Cell, csv_text};

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
    let input = input(&renewals, stop)?;
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
fn input(renewals: &[&Variable], stop: f64) -> Result<String, PackageError> {
    let (rise, fall) = (RENEWAL.0 * stop, RENEWAL.1 * stop);
    let rows = [(0.0, 0_u32), (rise, 0), (rise, 1), (fall, 1), (fall, 0)];
    let cells = |(time, value): (f64, u32)| {
        std::iter::once(Cell::Scientific(time)).chain(renewals.iter().map(move |_| value.into()))
    };
    csv_text(header(renewals), rows.map(cells)).map_err(|error| PackageError::Write(error.into()))
}

fn header<'a>(variables: &[&'a Variable]) -> impl Iterator<Item = &'a str> {
    std::iter::once("time").chain(variables.iter().map(|variable| variable.name.as_str()))
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
    let mut rows: Vec<Vec<Cell<'_>>> = Vec::new();
    let steps = (stop / step).round() as usize;
    for i in 0..=steps {
        let time = i as f64 * step;
        if i.is_multiple_of((steps / ROWS).max(1)) {
            let mut row = vec![Cell::Scientific(time)];
            for variable in &outputs {
                let mut value = [0.0];
                instance.read(variable.value_type, &[variable.slot.reference()], &mut value)?;
                row.push(Cell::Scientific(value[0]));
            }
            rows.push(row);
        }
        let raised = time >= RENEWAL.0 * stop && time < RENEWAL.1 * stop;
        for renewal in renewals {
            instance.write(ValueType::Boolean, &[renewal.slot.reference()], &[f64::from(raised)])?;
        }
        if i < steps {
            instance.do_step(time, step)?;
        }
    }
    csv_text(header(&outputs), rows).map_err(|error| PackageError::Write(error.into()))
}
