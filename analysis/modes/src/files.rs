//! The files of a modal fit.

use super::ModesStudy;
use super::picture::report;
use toolroom_chart::ResultFiles;
use toolroom_chart::page::Provenance;
use toolroom_dynamics::Measurement;
use toolroom_process::table::{Cell, csv_text};

/// Why a table can be written.
const AS_LONG: &str = "every row is as long as the header";

/// Names of all files.
pub const NAMES: &[&str] = &["frf.csv", "stabilisation.csv", "modes.json", "report.html"];

impl ModesStudy {
    /// `frf.csv`, `stabilisation.csv`, `modes.json` and `report.html`.
    pub fn files(&self, provenance: Provenance) -> ResultFiles {
        let mut files = ResultFiles::default();
        files.push("frf.csv", self.responses());
        let poles = self.fit.poles.iter().map(|pole| -> [Cell<'_>; 4] {
            [pole.order.into(), pole.natural_frequency.into(), pole.damping_ratio.into(), pole.stable.into()]
        });
        let header = ["order", "natural_frequency [Hz]", "damping_ratio", "stable"];
        files.push("stabilisation.csv", csv_text(header, poles).expect(AS_LONG));
        files.push("modes.json", format!("{:#}\n", self.json()));
        files.push("report.html", report(self, provenance).html());
        files
    }

    /// Measured and fitted receptance of every function.
    fn responses(&self) -> String {
        let mut header = vec!["frequency [Hz]".to_owned()];
        for function in &self.measured.functions {
            let name = function.name();
            for part in ["real", "imag", "fitted_real", "fitted_imag"] {
                header.push(format!("{name}.{part} [um/N]"));
            }
        }
        let rows = (0..self.measured.frequencies.len()).map(|i| {
            let values = self.measured.functions.iter().zip(&self.fit.fitted).flat_map(move |(function, fitted)| {
                let (measured, fitted) = (function.receptance[i] * 1e6, fitted[i] * 1e6);
                [measured.re, measured.im, fitted.re, fitted.im]
            });
            std::iter::once(self.measured.frequencies[i]).chain(values).map(Cell::from).collect::<Vec<_>>()
        });
        csv_text(header, rows).expect(AS_LONG)
    }
}

/// A response under an exponential window, which a table cannot carry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the response had not died away within its frame, so that an exponential window adds to its damping; a table does not carry \
     it: fit the record itself with `toolroom modes`, or record for longer after every hit"
)]
pub struct WindowedError;

/// What was measured as a table that `toolroom modes` reads: receptance of every function with its coherence, where it is known.
///
/// # Errors
/// [`WindowedError`]: damping that the table would not tell from that of the structure.
pub fn table(measured: &Measurement) -> Result<String, WindowedError> {
    if measured.window_decay > 0.0 {
        return Err(WindowedError);
    }
    let mut header = vec!["frequency [Hz]".to_owned()];
    for function in &measured.functions {
        let name = function.name();
        header.extend(["real [um/N]", "imag [um/N]"].map(|part| format!("{name}.{part}")));
        header.extend(function.coherence.as_ref().map(|_| format!("{name}.coherence")));
    }
    let rows = (0..measured.frequencies.len()).map(|i| {
        let values = measured.functions.iter().flat_map(move |function| {
            let value = function.receptance[i] * 1e6;
            [Some(value.re), Some(value.im), function.coherence.as_ref().map(|values| values[i])].into_iter().flatten()
        });
        std::iter::once(measured.frequencies[i]).chain(values).map(Cell::from).collect::<Vec<_>>()
    });
    Ok(csv_text(header, rows).expect(AS_LONG))
}
