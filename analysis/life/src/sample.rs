//! Lives as they were observed.

/// What is known of the life of one edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Observation {
    /// It ended at this age.
    Failed(f64),
    /// It was still good at this age: the test stopped, or it was replaced, or something else
    /// ended it.
    Censored(f64),
    /// It was good at the inspection at the first age and spent at the second.
    Between(f64, f64),
}

impl Observation {
    /// The age in which it counts when only one number may: the middle between inspections.
    pub fn age(&self) -> f64 {
        match *self {
            Self::Failed(age) | Self::Censored(age) => age,
            Self::Between(low, high) => 0.5 * (low + high),
        }
    }

    /// Whether the end was seen.
    pub fn ended(&self) -> bool {
        !matches!(self, Self::Censored(_))
    }
}

/// Why lives cannot be analysed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SampleError {
    /// No life.
    #[error("there is no life")]
    Empty,
    /// An age that no edge has.
    #[error("life number {number} is {age}: a life is a positive number")]
    Age {
        /// Position, from 1.
        number: usize,
        /// What was read.
        age: f64,
    },
    /// Inspections out of order.
    #[error("life number {number} lies between {low} and {high}: the second inspection is the later one")]
    Inspections {
        /// Position, from 1.
        number: usize,
        /// First inspection.
        low: f64,
        /// Second inspection.
        high: f64,
    },
    /// A weight that is negative, infinite or not a number.
    #[error("life number {number} has the weight {weight}")]
    Weight {
        /// Position, from 1.
        number: usize,
        /// What was read.
        weight: f64,
    },
    /// Nothing ended.
    #[error(
        "all {count} lives are censored: no edge was seen to fail, and the life can be anything above the longest age, {longest}"
    )]
    AllCensored {
        /// Number of lives.
        count: usize,
        /// Longest of them.
        longest: f64,
    },
    /// A likelihood that is 0 wherever the search starts.
    #[error("no start with a likelihood above 0 was found: the lives lie too far apart for this law")]
    NoMaximum,
    /// Too little for a law.
    #[error("{distinct} different lives that ended do not determine {parameters} parameters")]
    TooFew {
        /// Different ages at which an edge ended.
        distinct: usize,
        /// Parameters of the law.
        parameters: usize,
    },
}

/// Lives with weights: a weight of 3 counts as three equal lives.
///
/// # Examples
/// ```
/// use toolroom_life::sample::{Observation, Sample};
/// let sample = Sample::new([Observation::Failed(12.0), Observation::Censored(15.0)])?;
/// assert_eq!((sample.size(), sample.ended()), (2.0, 1.0));
/// # Ok::<(), toolroom_life::sample::SampleError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    lives: Vec<(Observation, f64)>,
}

impl Sample {
    /// Lives of weight 1.
    ///
    /// # Errors
    /// [`SampleError`] for what is no life.
    pub fn new(lives: impl IntoIterator<Item = Observation>) -> Result<Self, SampleError> {
        Self::weighted(lives.into_iter().map(|life| (life, 1.0)))
    }

    /// Lives with weights; those of weight 0 are left out.
    ///
    /// # Errors
    /// [`SampleError`] for what is no life.
    pub fn weighted(lives: impl IntoIterator<Item = (Observation, f64)>) -> Result<Self, SampleError> {
        let mut kept = Vec::new();
        for (i, (life, weight)) in lives.into_iter().enumerate() {
            let number = i + 1;
            let good = |age: f64| age.is_finite() && age > 0.0;
            match life {
                Observation::Failed(age) | Observation::Censored(age) if !good(age) => {
                    return Err(SampleError::Age { number, age });
                }
                Observation::Between(low, high) if !(low >= 0.0 && good(high) && low < high) => {
                    return Err(SampleError::Inspections { number, low, high });
                }
                Observation::Failed(_) | Observation::Censored(_) | Observation::Between(..) => {}
            }
            if !(weight >= 0.0 && weight.is_finite()) {
                return Err(SampleError::Weight { number, weight });
            }
            if weight > 0.0 {
                kept.push((life, weight));
            }
        }
        if kept.is_empty() { Err(SampleError::Empty) } else { Ok(Self { lives: kept }) }
    }

    /// The lives and their weights.
    pub fn lives(&self) -> &[(Observation, f64)] {
        &self.lives
    }

    /// Sum of the weights.
    pub fn size(&self) -> f64 {
        self.lives.iter().map(|(_, weight)| weight).sum()
    }

    /// Sum of the weights of lives whose end was seen.
    pub fn ended(&self) -> f64 {
        self.lives.iter().filter(|(life, _)| life.ended()).map(|(_, weight)| weight).sum()
    }

    /// Shortest and longest age of the sample.
    pub fn range(&self) -> (f64, f64) {
        let ages = || self.lives.iter().map(|(life, _)| life.age());
        (ages().fold(f64::INFINITY, f64::min), ages().fold(0.0, f64::max))
    }

    /// Whether some ends are known only to lie between inspections.
    pub fn inspected(&self) -> bool {
        self.lives.iter().any(|(life, _)| matches!(life, Observation::Between(..)))
    }

    /// The same lives with up to `joined` neighbouring classes as one, where that leaves less than half of them; a class is an end
    /// between two inspections of which the second is the first one of the next class.
    pub(super) fn coarser(&self, joined: usize) -> Option<Self> {
        let mut lives: Vec<(Observation, f64)> = Vec::new();
        let mut count = 0;
        for (life, weight) in &self.lives {
            match (lives.last_mut(), *life) {
                (Some((Observation::Between(_, end), sum)), Observation::Between(low, high))
                    if *end == low && count < joined =>
                {
                    (*end, *sum, count) = (high, *sum + weight, count + 1);
                }
                _ => {
                    lives.push((*life, *weight));
                    count = 1;
                }
            }
        }
        (2 * lives.len() < self.lives.len()).then_some(Self { lives })
    }

    /// Refuses what does not determine `parameters` parameters.
    pub(super) fn suffices(&self, parameters: usize) -> Result<(), SampleError> {
        let mut ages: Vec<f64> =
            self.lives.iter().filter(|(life, _)| life.ended()).map(|(life, _)| life.age()).collect();
        if ages.is_empty() {
            return Err(SampleError::AllCensored { count: self.lives.len(), longest: self.range().1 });
        }
        ages.sort_by(f64::total_cmp);
        ages.dedup();
        let distinct = ages.len();
        if distinct < parameters { Err(SampleError::TooFew { distinct, parameters }) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_classes_are_joined_and_nothing_else() {
        use Observation::{Between, Censored};
        let class = |i: u32| (Between(f64::from(i), f64::from(i + 1)), 2.0);
        let classes = (0..9).chain(20..24).map(class).chain([(Censored(30.0), 1.0)]);
        let sample = Sample::weighted(classes).unwrap();
        let joined = sample.coarser(4).unwrap();
        let expected = [(0.0, 4.0, 8.0), (4.0, 8.0, 8.0), (8.0, 9.0, 2.0), (20.0, 24.0, 8.0)];
        let expected: Vec<_> = expected.map(|(low, high, weight)| (Between(low, high), weight)).to_vec();
        assert_eq!(joined.lives()[..4], expected);
        assert_eq!((joined.size(), joined.lives().len()), (sample.size(), 5));
        assert_eq!(sample.coarser(1), None);
    }

    #[test]
    fn what_is_no_life_is_named_with_its_place() {
        use Observation::{Between, Censored, Failed};
        assert_eq!(Sample::new([]), Err(SampleError::Empty));
        assert_eq!(Sample::new([Failed(1.0), Censored(-2.0)]), Err(SampleError::Age { number: 2, age: -2.0 }));
        assert!(matches!(Sample::new([Failed(f64::NAN)]), Err(SampleError::Age { number: 1, .. })));
        assert!(matches!(Sample::new([Between(3.0, 2.0)]), Err(SampleError::Inspections { .. })));
        assert!(matches!(Sample::weighted([(Failed(1.0), -1.0)]), Err(SampleError::Weight { .. })));
        let censored = Sample::new([Censored(5.0), Censored(7.0)]).unwrap();
        assert_eq!(censored.suffices(2), Err(SampleError::AllCensored { count: 2, longest: 7.0 }));
        let sample = Sample::new([Failed(5.0), Failed(5.0)]).unwrap();
        assert_eq!(sample.suffices(2), Err(SampleError::TooFew { distinct: 1, parameters: 2 }));
    }
}
