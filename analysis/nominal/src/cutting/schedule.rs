//! The steps in which an edge is taken through its operations.

use super::run::{MOST, OfLand, Parts, Step, taken};
use super::{Cutting, Nominal};
use toolroom_process::Record;

/// The start of a cut that force, power and temperature means leave out, s.
const LEFT_OUT: f64 = 20.0;
/// Longest step, s.
const LONGEST_STEP: f64 = 90.0;
/// Greatest growth of the land in a step, relative to itself and a small land.
const GROWTH: f64 = 0.35;
const SMALL_LAND: f64 = 0.03e-3;
/// Error of the land that a step may make: so much, m, and this share of what the land grows by in it. Assumption: errors of
/// all steps of a life have one sign, and a hundred edges read with 6 µm know the land at the end of a life to 0.6 µm.
const STEP_ERROR: (f64, f64) = (0.01e-6, 0.0005);
/// Step below which nothing is made finer, s.
const SHORTEST_STEP: f64 = 2.0;
/// Factors on the rate of wear of the edges for which the steps are fine enough. Assumption: edges scatter by a fifth, twice
/// which is a factor of 1.5.
const SCHEDULED: [f64; 3] = [1.0, 1.5, 1.0 / 1.5];

impl<P: Nominal> Cutting<P> {
    /// Fixes the steps of every row by a nominal run; wear at the end of each row. Steps are fine enough for edges that wear
    /// faster and slower, too: where wear speeds up towards the end of a life, a fast edge is there rows before the nominal one.
    pub(super) fn schedule(&mut self) -> Vec<f64> {
        let mut steps = vec![Vec::new(); self.inputs.len()];
        let mut wear = vec![0.0; self.inputs.len()];
        let parts = Parts::of::<P>();
        let lag = self.process.lag();
        for rows in &self.rows {
            let mut edges = SCHEDULED.map(|factor| (factor, self.fresh(1.0)));
            for row in rows {
                edges.iter_mut().for_each(|(_, x)| self.cool(&parts, *row, x));
                let held = self.process.held(&self.inputs[*row]);
                let duration = self.durations[*row];
                let short = duration <= LEFT_OUT;
                let mut time = 0.0;
                while time < duration {
                    let mut end = time + next::<P>(&parts, &held, &edges, (duration - time, lag));
                    if time < LEFT_OUT && end > LEFT_OUT && duration > LEFT_OUT {
                        end = LEFT_OUT;
                    }
                    // No slivers at the end, unless all that counts of a cut a little longer than what is left out is one.
                    if end > duration - 1.0 && (short || time >= LEFT_OUT) {
                        end = duration;
                    }
                    let step = Step::new(time, end, time >= LEFT_OUT || short, lag);
                    for (factor, x) in &mut edges {
                        taken::<P>(&parts, &held, x, &step, [*factor; 2], &OfLand::even());
                    }
                    steps[*row].push(step);
                    time = end;
                }
                wear[*row] = edges[0].1[parts.land];
            }
        }
        self.steps = steps;
        wear
    }
}

/// The length of the next step of a row of which so much time is `left`, by the growth of the first of the edges and fine
/// enough for all of them. Each is the factor by which it wears faster, and its state.
fn next<P: Nominal>(parts: &Parts, held: &P::Held<'_>, edges: &[(f64, [f64; MOST])], (left, lag): (f64, f64)) -> f64 {
    let (factor, x) = &edges[0];
    let rate = P::rates(held, &P::State::from_slice(x), *factor).get(parts.land).unwrap_or(0.0);
    let allowed = GROWTH * (x[parts.land] + SMALL_LAND) / rate.max(f64::MIN_POSITIVE);
    let allowed = allowed.clamp(SHORTEST_STEP, LONGEST_STEP).min(left);
    let finer = |allowed, (factor, x): &(f64, _)| fine_enough::<P>(parts, held, x, *factor, (allowed, lag));
    edges.iter().fold(allowed, finer)
}

/// The length of a step, at most `allowed`, that is fine enough for an edge at `x` which wears by `factor`
/// faster: halved until two halves of it lead to the same land.
fn fine_enough<P: Nominal>(
    parts: &Parts,
    held: &P::Held<'_>,
    x: &[f64; MOST],
    factor: f64,
    (allowed, lag): (f64, f64),
) -> f64 {
    let land_after = |steps: i32, length: f64| {
        let mut x = *x;
        let step = Step::new(0.0, length, true, lag);
        (0..steps).for_each(|_| _ = taken::<P>(parts, held, &mut x, &step, [factor; 2], &OfLand::even()));
        x[parts.land]
    };
    let mut length = allowed;
    while length > SHORTEST_STEP {
        let (whole, halves) = (land_after(1, length), land_after(2, 0.5 * length));
        if (whole - halves).abs() <= STEP_ERROR.0 + STEP_ERROR.1 * (halves - x[parts.land]).abs() {
            break;
        }
        length = (0.5 * length).max(SHORTEST_STEP);
    }
    length
}

/// How much the land of an edge grows in a cut of `duration` from `land`, m. The body of the tool is as cold as that of a
/// new edge.
pub(super) fn grown<P: Nominal>(process: &P, input: &P::Input, duration: f64, land: f64) -> f64 {
    let (parts, held, lag) = (Parts::of::<P>(), process.held(input), process.lag());
    let mut x = [0.0; MOST];
    process.initial().write_to(&mut x);
    let start = x[parts.land].max(land);
    x[parts.land] = start;
    let mut left = duration;
    while left > 0.0 {
        let length = next::<P>(&parts, &held, &[(1.0, x)], (left, lag));
        taken::<P>(&parts, &held, &mut x, &Step::new(0.0, length, true, lag), [1.0; 2], &OfLand::even());
        left -= length;
    }
    x[parts.land] - start
}

#[cfg(test)]
mod tests {
    use crate::{NominalModel, Point};
    use toolroom_records::parse_csv;

    /// Taylor's law with three stages, of which the last wears 2.5 times as fast as the mean: `t/T = S(h/0.3 mm)` with
    /// `S(x) = x + c·(3x² − 2x³ − x)`.
    #[test]
    fn an_edge_that_wears_out_has_the_land_of_the_closed_form_at_every_row_and_level() {
        let (contrast, limit, minutes, rows) = (0.6, 0.3e-3, 2.2, 8_u32);
        let life = 59.606_26 * (222.0_f64 / 280.0).powi(5);
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/gap/");
        let text = include_str!("../../../../scenarios/gap/turning.toml")
            .replace("\"c45_t15k6\"", "\"../parameters/own/our-42crmo4.toml\"")
            .replace("scatter = \"lab\"", "scatter = \"none\"");
        let model = NominalModel::parse(&format!("{folder}turning.toml"), &text, &[]).unwrap();
        let mut csv =
            "operation_id,machine,tool_id,sequence,cutting_speed [m/min],feed_per_rev [mm],depth_of_cut [mm],\
                       cutting_time [min],flank_wear [mm]\n"
                .to_owned();
        for edge in 1..=10 {
            for row in 1..=rows {
                csv += &format!("O{edge}-{row},L,E{edge},{row},280,0.3,1.5,{minutes},{}\n", 0.03 * f64::from(row));
            }
        }
        let (records, _) = parse_csv("lives", csv.as_bytes(), model.kind()).unwrap();
        let (model, _) = model.over(&records, None, |_, _| false);
        let level = model.frame().parameters.iter().position(|parameter| parameter.name == "wear rate level").unwrap();
        for logarithm in [-0.3, 0.0, 0.05] {
            let mut point = Point::nominal(model.as_ref());
            point.parameters[level] = logarithm / model.frame().parameters[level].deviation;
            let lands = model.simulate(&point);
            for (observation, land) in model.frame().measured.observations.iter().zip(&lands) {
                let row = observation.row as u32 % rows + 1;
                let (x, worn) = (land / limit, f64::from(row) * minutes * f64::exp(logarithm) / life);
                let told = x + contrast * (3.0 * x * x - 2.0 * x.powi(3) - x);
                // By the rate at that land the time becomes a land.
                let slope = 1.0 + contrast * (6.0 * x * (1.0 - x) - 1.0);
                let error = (told - worn) * limit / slope;
                assert!(error.abs() < 0.6e-6, "row {row}: {land} m is off by {error} m");
            }
            assert_eq!(lands.len(), 80);
        }
    }
}
