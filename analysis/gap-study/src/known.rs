//! A model and records of a diagnosis, as its document and an application know them.

use crate::GapStudyError;
use std::path::{Path, PathBuf};
use toolroom_apply::{Applied, Process, applied_to, model_hash};
use toolroom_gap::{DiagnosisWithBasis, NominalModel, ProcessData};
use toolroom_records::{Records, write_csv};
use toolroom_scenario::Calibration;
use toolroom_shards::fingerprint;

/// A model over its records.
pub struct RecordedModel {
    path: PathBuf,
    hash: String,
    process: &'static str,
    target: String,
    data: String,
    pub records: Option<Records>,
    aside: Vec<Calibration>,
    /// The model as its file states it, where calibration was set aside for the fit.
    nominal: Option<ProcessData>,
}

impl RecordedModel {
    /// A model without usable records.
    pub fn nothing(model: &NominalModel, path: &Path, set: &[String]) -> Result<Self, GapStudyError> {
        let text = toolroom_form::bytes(path)
            .and_then(|bytes| String::from_utf8(bytes).map_err(std::io::Error::other))
            .map_err(|source| GapStudyError::Unreadable { path: path.to_owned(), source })?;
        let hash = model_hash(&text, set)?;
        let (process, target) = (model.kind().name(), model.target());
        let (data, aside) = (String::new(), Vec::new());
        Ok(Self { path: path.to_owned(), hash, process, target, data, records: None, aside, nominal: None })
    }

    /// A model over its records, and the model that is fitted to them.
    pub fn from_nominal_model(
        model: NominalModel,
        path: &Path,
        set: &[String],
        records: &Records,
        asked: &dyn Fn(&NominalModel) -> ProcessData,
    ) -> Result<(Self, NominalModel), GapStudyError> {
        let mut known = Self::nothing(&model, path, set)?;
        let mut table = Vec::new();
        let written = write_csv(records, &mut table);
        known.data = written.map(|()| fingerprint(&table)).map_err(|error| GapStudyError::Work(error.to_string()))?;
        known.records = Some(records.clone());
        if !model.stated.seen.contains(&known.data) {
            return Ok((known, model));
        }
        let (fitted, aside) = model.set_aside();
        if !aside.is_empty() {
            known.nominal = Some(asked(&model));
            known.aside = aside;
        }
        Ok((known, fitted))
    }

    /// Whether calibration was set aside for the fit, since the model has seen these records.
    pub fn is_set_aside(&self) -> bool {
        self.nominal.is_some()
    }

    /// The applied point of each part of a diagnosis.
    pub fn applied(&self, asked: &ProcessData, diagnosed: &[DiagnosisWithBasis]) -> Vec<Applied> {
        let parts = asked.parts.iter().zip(diagnosed).enumerate();
        parts
            .map(|(i, (part, own))| {
                let nominal = self.nominal.as_ref().and_then(|nominal| nominal.parts.get(i)).unwrap_or(part);
                let near = [&own.decision.base, own.decision.model()].map(|trial| &trial.fit.linear.point);
                applied_to(part.as_ref(), nominal.as_ref(), &self.aside, &own.basis, own.named(), Some(near))
            })
            .collect()
    }

    /// The same as the document wants it.
    pub fn process<'a>(&'a self, parts: &'a [Applied]) -> Process<'a> {
        let (hash, target) = (self.hash.clone(), self.target.clone());
        Process { name: self.process, path: &self.path, hash, target, parts }
    }
}

/// Hash, rows and span of all records of a diagnosis.
pub fn data(all: &[RecordedModel]) -> (String, usize, Option<(f64, f64)>) {
    let hash = match all {
        [only] => only.data.clone(),
        _ => fingerprint(all.iter().map(|own| own.data.as_str()).collect::<Vec<_>>().join(" ").as_bytes()),
    };
    let records = || all.iter().filter_map(|own| own.records.as_ref());
    let times = records().flat_map(|own| {
        let times = own.numbers("start_time").or_else(|| own.numbers("time")).unwrap_or(&[]);
        times.iter().copied().filter(|time| time.is_finite()).collect::<Vec<f64>>()
    });
    let span = times.fold(None, |span: Option<(f64, f64)>, time| {
        Some(span.map_or((time, time), |(low, high)| (low.min(time), high.max(time))))
    });
    (hash, records().map(Records::len).sum(), span)
}
