//! Which cases the benchmark tries.

use crate::{Case, GENERATORS, Generator, Hidden};

/// What a case is to show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Set {
    /// One effect of the catalogue.
    Effect,
    /// Two of them.
    Pair,
    /// Nothing hidden.
    Null,
    /// Nothing hidden, groups differ nearly twice as much.
    HeavyNull,
    /// A cause that no catalogue has.
    Outside,
    /// One effect in a world of more foreign forms.
    Stress,
    /// Nothing hidden in that world.
    StressNull,
}

impl Set {
    /// Every set.
    pub const ALL: [Self; 7] =
        [Self::Effect, Self::Pair, Self::Null, Self::HeavyNull, Self::Outside, Self::Stress, Self::StressNull];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Effect => "effect",
            Self::Pair => "pair",
            Self::Null => "null",
            Self::HeavyNull => "null, heavier scatter",
            Self::Outside => "outside the catalogue",
            Self::Stress => "stress world",
            Self::StressNull => "stress world, null",
        }
    }
}

/// How many cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// A few of each set, for every build.
    Smoke,
    /// As many as bounds on error rates need.
    Full,
}

/// Strengths at which every effect is hidden.
const STRENGTHS: [f64; 3] = [0.5, 1.0, 2.0];
/// Single effects of a process that are tried at least, so that rates of error have bounds.
const SINGLES: usize = 132;
/// Scatter of the nulls with heavier scatter.
const HEAVY: f64 = 1.8;

/// Every case of the benchmark; no two share a seed, and none of another `seed` is among them.
pub fn suite(seed: u64, extent: Extent) -> Vec<Case> {
    let mut cases: Vec<Case> = GENERATORS.iter().flat_map(|generator| cases(generator, extent)).collect();
    for (index, case) in (0_u64..).zip(&mut cases) {
        case.seed = seed.wrapping_mul(100_000).wrapping_add(index);
    }
    cases
}

/// Cases of one kind of shop, seeds left open.
fn cases(generator: &Generator, extent: Extent) -> Vec<Case> {
    let process = generator.process;
    let null = |set: Set| Case {
        set,
        scatter: if set == Set::HeavyNull { HEAVY } else { 1.0 },
        stress: matches!(set, Set::Stress | Set::StressNull),
        ..Case::null(process, 0)
    };
    let with = |set: Set, ids: &[&'static str], strength: f64| Case {
        hidden: ids.iter().map(|id| Hidden { id, strength }).collect(),
        ..null(set)
    };
    let mut cases = Vec::new();
    if extent == Extent::Smoke {
        let (first, last) = (generator.effects[0].0, generator.effects[generator.effects.len() - 1].0);
        cases.extend([with(Set::Effect, &[first], 1.0), with(Set::Effect, &[last], 2.0)]);
        cases.extend([null(Set::Null), null(Set::HeavyNull), null(Set::StressNull)]);
        cases.extend(generator.outside.first().map(|id| with(Set::Outside, &[id], 1.0)));
        return cases;
    }
    let repeats = SINGLES.div_ceil(STRENGTHS.len() * generator.effects.len());
    for (id, _) in generator.effects {
        for strength in STRENGTHS {
            cases.extend((0..repeats).map(|_| with(Set::Effect, &[id], strength)));
        }
        cases.push(with(Set::Stress, &[id], 1.0));
    }
    cases.extend((0..60).map(|_| null(Set::Null)));
    cases.extend((0..20).map(|_| null(Set::HeavyNull)));
    cases.extend((0..20).map(|_| null(Set::StressNull)));
    for id in generator.outside {
        cases.extend([1.0, 1.0, 2.0, 2.0].map(|strength| with(Set::Outside, &[id], strength)));
    }
    // Every effect in pairs with others that stand a few places away from it.
    let count = generator.effects.len();
    for (index, (id, _)) in generator.effects.iter().enumerate() {
        let other = generator.effects[(index + count / 2 + index % 2) % count].0;
        if other != *id {
            cases.push(with(Set::Pair, &[id, other], 1.0));
        }
    }
    cases
}
