//! Whether a recorded milling cut chatters, and at which speeds it would not.

mod request;
mod text;

pub use request::{ListenError, ListenRequest};

use crate::lobes::{Cut, LobesFile};
use toolroom_chatter::ChatterError;
use toolroom_dynamics::{Cutting, Heard, Record, listen};

/// Speeds that are suggested without a chart, over the speed of the cut (assumption: a change of tool or material beyond).
const RANGE: [f64; 2] = [0.5, 2.5];

/// A speed at which the teeth do not feed the chatter.
#[derive(Clone, Debug)]
pub struct Suggestion {
    /// Spindle speed (rad/s).
    pub spindle_speed: f64,
    /// Least unstable depth there (m) by the lobes file; none up to the depth of its chart. `None` without such a file.
    pub limit: Option<Result<Option<f64>, ChatterError>>,
}

/// A record listened to.
#[derive(Debug)]
pub struct ListenStudy {
    /// The record, as messages call it.
    pub source: String,
    /// What was heard.
    pub heard: Heard,
    /// Speeds that would be quiet, from the greatest down.
    pub suggestions: Vec<Suggestion>,
}

impl ListenStudy {
    /// Listens to a record, with a record of the air cut and the lobes file where there are any.
    ///
    /// # Errors
    /// [`ListenError`]: arguments that cannot be used, a record in which the teeth are not heard.
    pub fn new(
        record: &Record,
        air: Option<&Record>,
        request: &ListenRequest<'_>,
        lobes: Option<&LobesFile>,
    ) -> Result<Self, ListenError> {
        let spindle_speed = request.spindle_speed()?;
        let (mut natural_frequencies, mut range) = (Vec::new(), None);
        if let Some(LobesFile { cut, chart, .. }) = lobes {
            let Cut::Milling(cut, _) = cut else { return Err(ListenError::NoMilling) };
            let drawn = cut.cutter.teeth;
            if drawn != request.teeth as usize {
                return Err(ListenError::Teeth { told: request.teeth, drawn });
            }
            natural_frequencies = cut.modes.iter().map(|mode| mode.natural_frequency).collect();
            range = Some([chart.speed.start, chart.speed.end]);
        }
        let cutting = Cutting { teeth: request.teeth, spindle_speed, air, natural_frequencies: &natural_frequencies };
        let heard = listen(record, &cutting)?;
        let [least, most] = range.unwrap_or(RANGE.map(|share| share * heard.spindle_speed));
        let suggestions = heard.suggested_speeds(request.teeth, least, most).into_iter().map(|spindle_speed| {
            let limit = lobes.map(|LobesFile { cut, chart, .. }| {
                cut.judge(spindle_speed, 0.0, chart).map(|judgement| judgement.limit)
            });
            Suggestion { spindle_speed, limit }
        });
        let suggestions = suggestions.collect();
        Ok(Self { source: record.source.clone(), heard, suggestions })
    }
}
