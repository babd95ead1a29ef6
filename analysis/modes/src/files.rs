//! The files of a modal fit.

use super::ModesStudy;
use super::picture::report;
use toolroom_chart::ResultFiles;
use toolroom_chart::page::Provenance;
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
