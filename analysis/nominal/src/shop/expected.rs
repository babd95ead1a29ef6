//! What the nominal shop expects of every block.

use super::block::{Block, Blocks, ROOT_SCORE, TAIL};
use super::figure::{Figure, Figures};
use super::nominal::Shop;
use super::stops::{Pool, Shape, Stops};
use super::visit::Visits;
use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::gamma::gamma;
use toolroom_statistics::median;

/// What the nominal shop expects of every block.
pub(super) fn expected(shop: &Shop, visits: &Visits, blocks: &Blocks) -> Vec<Figures> {
    let stops = Stops::default();
    let pools = |program: usize| -> Vec<Pool> {
        blocks.pools[program].iter().map(|(_, size)| Pool { size: *size, rate: 0.0 }).collect()
    };
    // Of a few operations whose times scatter widely the mean lies elsewhere above the middle than of many.
    let shapes = |program: usize| {
        let scaled = blocks.scales[program].is_some();
        scaled.then(|| stops.unstopped(blocks.timed(program, &pools(program)), &blocks.classes(program)))
    };
    let shapes: Vec<Option<Vec<Shape>>> = (0..visits.programs.len()).map(shapes).collect();
    let of = |block: &Block| {
        let shape = block.program.and_then(|program| Some(shapes[program].as_ref()?[block.class]));
        nominal(shop, visits, blocks, block, shape)
    };
    blocks.list.iter().map(of).collect()
}

/// What the nominal shop expects of a block, whose times lie in this `shape` if they are taken where they are normal; NaN where
/// it has no opinion.
fn nominal(shop: &Shop, visits: &Visits, blocks: &Blocks, block: &Block, shape: Option<Shape>) -> Figures {
    let station = shop.station(&visits.machines[block.machine]);
    // A machine that the nominal shop does not know is compared with itself.
    let of_machine = |figure: Figure| {
        let others = blocks.list.iter().filter(|other| other.machine == block.machine);
        let values = others.map(|other| other.values[figure]).filter(|value| value.is_finite());
        median(&mut values.collect::<Vec<f64>>())
    };
    let handling = station
        .map_or_else(|| of_machine(Figure::HandlingTime), |station| station.handling[station.handling.len() / 2]);
    // What the file itself says of the times: plain work may be skewed.
    let known = block.program.and_then(|program| shop.programs.get(&visits.programs[program]));
    let planned = shape.or(known.map(|program| program.planned)).unwrap_or(Shape::SYMMETRIC);
    let mut figures = Figures::all(f64::NAN);
    let pace = known.map_or(1.0, |program| program.pace_on(&visits.machines[block.machine]));
    figures[Figure::CuttingTime] = block.program.map_or(f64::NAN, |program| pace * blocks.times[program]);
    figures[Figure::CuttingTail] = TAIL + planned.tail;
    figures[Figure::CuttingExcess] = planned.excess.exp();
    figures[Figure::CuttingSpread] = planned.spread;
    figures[Figure::HandlingTime] = handling;
    figures[Figure::HandlingSpread] = 1.0;
    figures[Figure::ToolChangeTime] =
        station.map_or_else(|| of_machine(Figure::ToolChangeTime), |station| station.tool_change);
    figures[Figure::FeedHoldTime] = 0.0;
    figures[Figure::StopCount] = blocks.usual_stops * block.cutting + block.short_repairs;
    let life = station.and_then(|station| station.edge_life);
    figures[Figure::EdgeLife] = life.map_or(f64::NAN, |life| life.logarithm.exp());
    figures[Figure::FailureInterval] = ROOT_SCORE.0;
    figures
}

pub(super) fn life_slope(shop: &Shop, visits: &Visits, block: &Block) -> f64 {
    shop.station(&visits.machines[block.machine]).and_then(|station| station.edge_life).map_or(0.0, |life| life.growth)
}

/// Mean root magnitude of normal scores, under an exponential distribution of the same mean, of times
/// between breakdowns that are Weibull of shape `1 + excess`.
pub(super) fn breakdown_scores(excess: f64) -> f64 {
    const STRATA: usize = 200;
    let shape = 1.0 + excess;
    let scale = gamma(1.0 + 1.0 / shape).recip();
    let normal = Normal::standard();
    let root = |i: usize| {
        let u = (i as f64 + 0.5) / STRATA as f64;
        let time = scale * (-(-u).ln_1p()).powf(1.0 / shape);
        normal.inverse_cdf((-(-time).exp_m1()).clamp(1e-5, 1.0 - 1e-5)).abs().sqrt()
    };
    (0..STRATA).map(root).sum::<f64>() / STRATA as f64
}
