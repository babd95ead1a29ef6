//! A process at many operating points in one call.

use crate::failure::Failure;
use crate::table::Table;
use crate::work::through;
use polars::prelude::{IntoColumn, NamedFrom, Series};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use std::path::PathBuf;
use toolroom::cutting::LifeModel;
use toolroom::gap_study::user_effects;
use toolroom::planning::point::{Axis, Column, PointGrid, PointOptions, PointProcess};

/// An axis of the grid: name, values as the bytes of 64-bit numbers of this machine, unit.
type Given = (String, PyBackedBytes, String);

/// Inputs, state and outputs at every point of the axes, which are equally long.
#[pyfunction]
#[pyo3(signature = (process, tool, axes, changes, effects, definitions, advance, life_model))]
#[allow(clippy::too_many_arguments)] // keyword arguments of Python
pub fn point(
    py: Python<'_>,
    process: &str,
    tool: Option<String>,
    axes: Vec<Given>,
    changes: Vec<String>,
    effects: Vec<String>,
    definitions: Vec<PathBuf>,
    advance: Option<String>,
    life_model: &str,
) -> Result<Table, Failure> {
    let process = match process {
        "turning" => PointProcess::Turning,
        "milling" => PointProcess::Milling,
        "infeed" => PointProcess::Infeed,
        other => {
            return Err(Failure::argument(format_args!("there is no process \"{other}\""), "turning, milling, infeed"));
        }
    };
    let models = [LifeModel::QuasiSteady, LifeModel::Ode];
    let Some(life_model) = models.into_iter().find(|model| model.name() == life_model) else {
        return Err(Failure::argument(format_args!("there is no life model \"{life_model}\""), "quasi_steady, ode"));
    };
    let defined = user_effects(&definitions)?;
    let options = PointOptions { tool, changes, effects, defined, advance, life_model };
    through(py, move || {
        let numbers: Vec<Vec<f64>> = axes.iter().map(|(_, bytes, _)| numbers(bytes)).collect();
        let axes: Vec<Axis<'_>> =
            axes.iter().zip(&numbers).map(|((key, _, unit), values)| Axis { key, values, unit }).collect();
        let grid = PointGrid::new(process, &options, &axes).map_err(|error| Failure::argument(&error, error.fix()))?;
        let column = |(head, column): (String, Column)| match column {
            Column::Numbers(numbers) => Series::new(head.into(), numbers).into_column(),
            Column::Texts(texts) => {
                Series::new(head.into(), texts.iter().map(AsRef::as_ref).collect::<Vec<&str>>()).into_column()
            }
        };
        Table::of(grid.columns.into_iter().map(column).collect())
    })
}

fn numbers(bytes: &[u8]) -> Vec<f64> {
    bytes.as_chunks::<8>().0.iter().map(|number| f64::from_ne_bytes(*number)).collect()
}
