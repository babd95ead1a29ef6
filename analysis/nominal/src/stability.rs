//! Recorded cuts beside the stability limit of the structure that a model file names.

use super::{NominalModel, NominalProcess, features};
use std::collections::BTreeMap;
use toolroom_cutting::{MillingInput, MillingState, TurningInput, TurningState};
use toolroom_process::Process;
use toolroom_records::Records;

/// Places along a pass at which a workpiece that bends is judged, as in the shop.
const PLACES: usize = 9;

/// A recorded cut of which is known whether it chattered.
#[derive(Clone, Debug, PartialEq)]
pub struct HeardCut {
    /// Row of the records.
    pub row: usize,
    /// Machine.
    pub machine: String,
    /// Piece, by number: its cuts share the hardness of the work.
    pub piece: usize,
    /// Lot of the piece, by number.
    pub lot: usize,
    /// Cutting speed, m/s.
    pub cutting_speed: f64,
    /// Feed per revolution in turning, per tooth in milling, m.
    pub feed: f64,
    /// Depth of cut, m.
    pub depth: f64,
    /// Width of cut in milling, m.
    pub width: f64,
    /// Diameter of the work in turning, m.
    pub diameter: f64,
    /// Place of the tool from the jaws at the start, and how far it goes towards them, m; zeros where the place is not known.
    pub places: [f64; 2],
    /// Land of the edge, m.
    pub flank_wear: f64,
    /// Whether it chattered.
    pub chatter: bool,
    /// Its frequency, Hz, where it was read.
    pub frequency: Option<f64>,
}

/// What is known of the structure beside the file: standard deviations of logarithms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StructurePrior {
    /// Natural frequencies of a machine.
    pub natural_frequency: f64,
    /// Damping ratios of a machine.
    pub damping_ratio: f64,
    /// Depth of the limit at given frequency and damping: stiffness over the coefficient of the force.
    pub depth: f64,
    /// The same from lot to lot, and from piece to piece, by hardness.
    pub hardness: [f64; 2],
}

/// What changes from mounting to mounting at least (assumptions, those of `toolroom modes`): frequency, damping, stiffness.
const MOUNTING: [f64; 3] = [0.005, 0.1, 0.05];

impl NominalModel {
    /// Whether something vibrates around the cut.
    pub fn vibrates(&self) -> bool {
        match &self.process {
            NominalProcess::Turning(process) => process.structure.is_some(),
            NominalProcess::Milling(process) => process.structure.is_some(),
            NominalProcess::Grinding(_)
            | NominalProcess::Empirical
            | NominalProcess::Program(_)
            | NominalProcess::Shop(_) => false,
        }
    }

    /// The cuts whose records say whether they chattered; none without a structure. Land that was not read is that of the
    /// reading before on the same edge. A turned cut without spindle speed is none: its speed says nothing of the waves
    /// between two revolutions.
    pub fn heard_cuts(&self, records: &Records) -> Vec<HeardCut> {
        let (Some(heard), Some(machines), true) =
            (records.numbers("chatter"), records.texts("machine"), self.vibrates())
        else {
            return Vec::new();
        };
        let column = |name: &str| records.numbers(name);
        let at = |name: &str, row: usize| column(name).map_or(f64::NAN, |values| values[row]);
        let turning = matches!(self.process, NominalProcess::Turning(_));
        let lots = features::lots(records, &self.settings.lots);
        let mut pieces: BTreeMap<&str, usize> = BTreeMap::new();
        let (ids, edges) = (records.texts("operation_id"), records.texts("tool_id"));
        let mut lands: BTreeMap<&str, f64> = BTreeMap::new();
        let mut cuts = Vec::new();
        for row in 0..records.len() {
            let land = lands.entry(edges.map_or("", |edges| edges[row].as_str())).or_default();
            let read = at("flank_wear", row);
            if read.is_finite() {
                *land = read.max(0.0);
            }
            let flank_wear = *land;
            if heard[row] != 0.0 && heard[row] != 1.0 {
                continue;
            }
            let cutting_speed = at("cutting_speed", row);
            let spindle_speed = at("spindle_speed", row);
            let diameter = if turning { 2.0 * cutting_speed / spindle_speed } else { 0.0 };
            let feed = at(if turning { "feed_per_rev" } else { "feed_per_tooth" }, row);
            let (depth, width) = (at("depth_of_cut", row), if turning { 0.0 } else { at("width_of_cut", row) });
            let travel = spindle_speed / std::f64::consts::TAU * feed * at("cutting_time", row);
            let start = at("position", row);
            let known = turning && start > 0.0 && travel.is_finite();
            let needed = [cutting_speed, feed, depth, width, diameter];
            if needed.iter().any(|value| !value.is_finite() || *value < 0.0) || cutting_speed <= 0.0 || depth <= 0.0 {
                continue;
            }
            let number = pieces.len();
            let piece = ids.map_or("", |ids| piece_of(&ids[row]));
            let frequency = at("chatter_frequency", row);
            cuts.push(HeardCut {
                row,
                machine: machines[row].clone(),
                piece: *pieces.entry(piece).or_insert(number),
                lot: lots[row],
                cutting_speed,
                feed,
                depth,
                width,
                diameter,
                places: if known { [start, travel.min(start)] } else { [0.0; 2] },
                flank_wear,
                chatter: heard[row] == 1.0,
                frequency: (heard[row] == 1.0 && frequency > 0.0).then_some(frequency),
            });
        }
        cuts
    }

    /// Depth (m) at which a cut like `cut` becomes unstable somewhere along its pass, and the frequency (Hz) of that vibration,
    /// where natural frequencies (at the same modal masses) and damping ratios are those of the file times a factor. Infinite
    /// or without frequency (0) where none was found.
    pub fn stability_limit(&self, cut: &HeardCut, frequency_factor: f64, damping_factor: f64) -> (f64, f64) {
        match &self.process {
            NominalProcess::Turning(process) => {
                let state = TurningState { flank_wear: cut.flank_wear, ..process.initial() };
                let places = if cut.places[0] > 0.0 { PLACES } else { 1 };
                let limit = |place: usize| {
                    let share = place as f64 / (PLACES - 1) as f64;
                    let input = TurningInput { position: cut.places[0] - share * cut.places[1], ..turned(cut) };
                    let input = TurningInput {
                        natural_frequency_factor: frequency_factor,
                        modal_damping_factor: damping_factor,
                        ..input
                    };
                    process.stability_limit(&state, &input).unwrap_or((f64::INFINITY, 0.0))
                };
                (0..places).map(limit).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::INFINITY, 0.0))
            }
            NominalProcess::Milling(process) => {
                let state = MillingState { flank_wear: cut.flank_wear, ..process.initial() };
                let input = MillingInput {
                    natural_frequency_factor: frequency_factor,
                    modal_damping_factor: damping_factor,
                    ..milled(cut)
                };
                process.stability_limit(&state, &input).unwrap_or((f64::INFINITY, 0.0))
            }
            NominalProcess::Grinding(_)
            | NominalProcess::Empirical
            | NominalProcess::Program(_)
            | NominalProcess::Shop(_) => (f64::INFINITY, 0.0),
        }
    }

    /// Natural frequency (Hz) of the file's mode that is nearest to `frequency` in a cut like `cut`.
    pub fn nearest_mode(&self, cut: &HeardCut, frequency: f64) -> Option<f64> {
        let place = |share: f64| cut.places[0] - share * cut.places[1];
        let modes: Vec<f64> = match &self.process {
            NominalProcess::Turning(process) => {
                let input = TurningInput { position: place(0.5), ..turned(cut) };
                let found = process.regenerative(&process.initial(), &input)?;
                found.modes.iter().map(|mode| mode.natural_frequency).collect()
            }
            NominalProcess::Milling(process) => {
                let found = process.regenerative(&process.initial(), &milled(cut))?;
                found.modes.iter().map(|mode| mode.natural_frequency).collect()
            }
            NominalProcess::Grinding(_)
            | NominalProcess::Empirical
            | NominalProcess::Program(_)
            | NominalProcess::Shop(_) => Vec::new(),
        };
        modes.into_iter().min_by(|a, b| (a - frequency).abs().total_cmp(&(b - frequency).abs()))
    }

    /// How well the structure is known before any cut: as the file says, and no better than from mounting to mounting.
    pub fn structure_prior(&self) -> StructurePrior {
        let exponent = match &self.process {
            NominalProcess::Turning(process) => process.pair.force.hardness_exponent,
            NominalProcess::Milling(process) => process.force.hardness_exponent,
            NominalProcess::Grinding(_)
            | NominalProcess::Empirical
            | NominalProcess::Program(_)
            | NominalProcess::Shop(_) => 0.0,
        };
        let [frequency, damping, stiffness] = MOUNTING;
        let [stated_frequency, stated_damping] = self.settings.structure_scatter;
        let hardness = self.settings.scatter.map_or([0.0; 2], |own| [own.batch_hardness, own.piece_hardness]);
        StructurePrior {
            natural_frequency: stated_frequency.max(frequency),
            damping_ratio: stated_damping.max(damping),
            depth: self.settings.force.hypot(stiffness),
            hardness: hardness.map(|deviation| exponent * deviation),
        }
    }
}

fn turned(cut: &HeardCut) -> TurningInput {
    TurningInput {
        cutting_speed: cut.cutting_speed,
        feed_per_rev: cut.feed,
        depth_of_cut: cut.depth,
        workpiece_diameter: cut.diameter,
        ..TurningInput::default()
    }
}

fn milled(cut: &HeardCut) -> MillingInput {
    MillingInput {
        cutting_speed: cut.cutting_speed,
        feed_per_tooth: cut.feed,
        depth_of_cut: cut.depth,
        width_of_cut: cut.width,
        ..MillingInput::default()
    }
}

/// What the id of an operation says of its piece: all but the number of the pass.
fn piece_of(id: &str) -> &str {
    match id.rsplit_once('/') {
        Some((piece, pass)) if !pass.is_empty() && pass.bytes().all(|byte| byte.is_ascii_digit()) => piece,
        Some(_) | None => id,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_of_an_operation_are_of_one_piece() {
        assert_eq!([piece_of("J12/turn/3"), piece_of("J12/turn"), piece_of("17")], ["J12/turn", "J12/turn", "17"]);
    }
}
