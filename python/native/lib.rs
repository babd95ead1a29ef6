//! The Python package `toolroom` over the library of that name.
//!
//! | file | what it holds |
//! |---|---|
//! | `shop` | scenarios: compared and run into a folder, the files of the command line |
//! | `studies` | tool lives, stability charts, trials of grinding, calibration, diagnosis and its application |
//! | `point` | a process at many operating points |
//! | `unit` | exported FMI units |
//! | `table` | tables, which cross by Arrow's C interface without copying |
//! | `work` | long work beside the interpreter: other threads of Python go on, Ctrl-C ends it |
//! | `failure` | errors as `toolroom.Error` |
//!
//! What is friendly about the package (classes, pictures in notebooks) is Python, in `src/toolroom`.

mod failure;
mod point;
mod shop;
mod studies;
mod table;
mod unit;
mod work;

/// The compiled part of the package.
#[pyo3::pymodule]
mod _native {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::point::point;
    #[pymodule_export]
    use crate::shop::{check, echo, study};
    #[pymodule_export]
    use crate::studies::{apply, calibrate, diagnose, identify, life, lobes, verdict};
    #[pymodule_export]
    use crate::table::{Column, Table};
    #[pymodule_export]
    use crate::unit::export_fmu;

    /// Draws of parameters and units of others are read by name from scenarios: both are made known once.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        toolroom::study::draws::register();
        #[cfg(feature = "fmu-import")]
        toolroom_fmu_import::register();
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
