//! Shapes of blocks at the stops of a point: of a program some pools may be stopped, and others not.

use super::action::Action;
use super::model::ShopModel;
use super::shapes::{ByRate, Profile, Shapes};
use super::stops::{Pool, Shape};
use crate::Point;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
/// Programs at their stops of which shapes are kept (count): a fit asks for the same ones again and again.
const KEPT: usize = 4096;

impl ShopModel {
    /// Rate of stops that nobody books in each block, 1/s.
    pub(super) fn rates(&self, point: &Point) -> Vec<f64> {
        let mut rates = vec![0.0; self.blocks.list.len()];
        for (action, size) in self.actions.iter().zip(&point.effects) {
            if let (Action::Stops(weights), true) = (action, *size != 0.0) {
                rates.iter_mut().zip(weights).for_each(|(rate, weight)| *rate += size * weight);
            }
        }
        rates
    }

    /// Shapes of the blocks at all rates of `points`.
    pub(super) fn shapes(&self, points: &[&Point]) -> Shapes {
        let mut wanted: BTreeMap<Profile, BTreeSet<u64>> = BTreeMap::new();
        for point in points {
            let rates = self.rates(point);
            if rates.iter().all(|rate| *rate == 0.0) {
                continue;
            }
            let mut of_programs: Vec<BTreeSet<u64>> = vec![BTreeSet::new(); self.blocks.times.len()];
            for (block, rate) in self.blocks.list.iter().zip(&rates) {
                if let Some(program) = block.program {
                    of_programs[program].insert(rate.to_bits());
                }
            }
            for (program, own) in of_programs.into_iter().enumerate() {
                if own.iter().any(|rate| f64::from_bits(*rate) != 0.0) {
                    wanted.entry(self.profile(program, &rates)).or_default().extend(own);
                }
            }
        }
        if wanted.is_empty() {
            return Shapes::new();
        }
        // The lock is never held while shapes are worked out: the thread may be given another fit meanwhile.
        let mut found: Shapes = {
            let known = self.stopped.known();
            wanted.keys().map(|profile| (profile.clone(), known.get(profile).cloned().unwrap_or_default())).collect()
        };
        let missing: Vec<(&Profile, u64)> = wanted
            .iter()
            .flat_map(|(profile, rates)| rates.iter().map(move |rate| (profile, *rate)))
            .filter(|(profile, rate)| !found[*profile].contains_key(rate))
            .collect();
        let computed: Vec<(Profile, u64, Vec<Shape>)> = missing
            .into_par_iter()
            .map(|(profile, rate)| (profile.clone(), rate, self.shapes_of(profile, f64::from_bits(rate))))
            .collect();
        let mut known = self.stopped.known();
        if known.len() > KEPT {
            known.clear();
        }
        for (profile, rate, shapes) in computed {
            known.entry(profile.clone()).or_default().insert(rate, shapes.clone());
            found.entry(profile).or_default().insert(rate, shapes);
        }
        found
    }

    /// Shapes of each program at these rates of all blocks, where it has stops.
    pub(super) fn of_programs<'a>(&self, rates: &[f64], shapes: &'a Shapes) -> Vec<Option<&'a ByRate>> {
        let programs = 0..self.blocks.times.len();
        if shapes.is_empty() {
            return programs.map(|_| None).collect();
        }
        programs.map(|program| shapes.get(&self.profile(program, rates))).collect()
    }

    fn profile(&self, program: usize, rates: &[f64]) -> Profile {
        (program, self.blocks.pools[program].iter().map(|(row, _)| rates[*row].to_bits()).collect())
    }

    /// Shapes of blocks of a program at a rate, where its pools have those of the profile.
    fn shapes_of(&self, (program, of_pools): &Profile, rate: f64) -> Vec<Shape> {
        let pools = self.blocks.pools[*program].iter().zip(of_pools);
        let pools: Vec<Pool> =
            pools.map(|((_, size), rate)| Pool { size: *size, rate: f64::from_bits(*rate) }).collect();
        let timed = self.blocks.timed(*program, &pools);
        let stops = &self.stopped.stops;
        let mut shapes = stops.shapes(rate, timed, stops.intrinsic(timed), &self.blocks.classes(*program));
        // The middle of exact times stays where it is until most operations are stopped.
        shapes.iter_mut().filter(|_| timed.exact).for_each(|shape| shape.location = 0.0);
        shapes
    }
}
