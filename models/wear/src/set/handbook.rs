//! Constants as handbooks and tests give them, converted to the parameters of a set.

use toolroom_process::ModelError;

/// Taylor's law as handbooks state it, `v = C / (T^m ap^x f^y)` with the life T in minutes or
/// seconds, depth and feed in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HandbookTaylor {
    /// Speed at a life of one `life_unit`, 1 mm of depth and 1 mm of feed, m/s.
    pub constant: f64,
    /// Exponent of life, m.
    pub life_exponent: f64,
    /// Exponent of depth of cut, x.
    pub depth_exponent: f64,
    /// Exponent of feed, y.
    pub feed_exponent: f64,
    /// Unit of the life, s.
    pub life_unit: f64,
}

/// Taylor's law about a reference cut, `T = life · (v/v_r)^-p (f/f_r)^-q (ap/a_r)^-r`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceLife {
    /// Tool life at the reference cut, s.
    pub life: f64,
    /// Exponent of speed, p.
    pub speed_exponent: f64,
    /// Exponent of feed, q.
    pub feed_exponent: f64,
    /// Exponent of depth of cut, r.
    pub depth_exponent: f64,
}

/// Length in which handbooks count feed and depth, m.
const MILLIMETRE: f64 = 1e-3;

impl HandbookTaylor {
    /// The product form `v T^n f^a ap^b = C`.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::HandbookTaylor;
    /// // v T^0.25 f^0.3 ap^0.1 = 300 m/min, T in minutes.
    /// let law = HandbookTaylor::of_product(300.0 / 60.0, 0.25, 0.3, 0.1, 60.0);
    /// let life = law.about(240.0 / 60.0, 0.25e-3, 2e-3);
    /// assert!((life.life / 60.0 - 9.765625).abs() < 1e-9);
    /// assert!((life.feed_exponent - 1.2).abs() < 1e-12 && (life.depth_exponent - 0.4).abs() < 1e-12);
    /// ```
    pub fn of_product(constant: f64, n: f64, feed: f64, depth: f64, life_unit: f64) -> Self {
        Self { constant, life_exponent: n, depth_exponent: depth, feed_exponent: feed, life_unit }
    }

    /// The same law about a reference cut (m/s, m, m): p = 1/m, q = y/m, r = x/m.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::HandbookTaylor;
    /// let law = HandbookTaylor {
    ///     constant: 420.0 / 60.0, life_exponent: 0.2, depth_exponent: 0.15, feed_exponent: 0.2, life_unit: 60.0,
    /// };
    /// let life = law.about(222.0 / 60.0, 0.3e-3, 1.5e-3);
    /// assert!((life.life / 60.0 - 59.60626).abs() < 1e-5);
    /// assert!((life.speed_exponent - 5.0).abs() < 1e-12 && (life.feed_exponent - 1.0).abs() < 1e-12);
    /// ```
    pub fn about(&self, cutting_speed: f64, feed: f64, depth_of_cut: f64) -> ReferenceLife {
        let Self { constant, life_exponent: m, depth_exponent: x, feed_exponent: y, life_unit } = *self;
        let power = constant / (cutting_speed * (depth_of_cut / MILLIMETRE).powf(x) * (feed / MILLIMETRE).powf(y));
        ReferenceLife {
            life: life_unit * power.powf(m.recip()),
            speed_exponent: m.recip(),
            feed_exponent: y / m,
            depth_exponent: x / m,
        }
    }
}

/// Kienzle's specific cutting force, `F_c = kc11 · b · h^(1 - mc)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kienzle {
    /// Specific force of a chip of 1 mm by 1 mm, Pa.
    pub kc11: f64,
    /// Exponent of chip thickness.
    pub exponent: f64,
    /// Angle between cutting edge and feed, rad.
    pub cutting_edge_angle: f64,
}

/// Fall of the cutting force with the rake angle, 1.5 % a degree, 1/rad (Kienzle & Victor; recalled).
const RAKE: f64 = 1.5 * 180.0 / std::f64::consts::PI / 100.0;

impl Kienzle {
    /// Force at 1 mm of depth and 1 mm of feed, N, and exponent of feed. With h = f·sin κ and
    /// b = a/sin κ the force is `kc11·sin(κ)^-mc·(1 mm)²` there; the exponent of depth is 1, that of
    /// speed 0.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::Kienzle;
    /// let steel = Kienzle { kc11: 1500e6, exponent: 0.22, cutting_edge_angle: 45f64.to_radians() };
    /// let (force, feed_exponent) = steel.force();
    /// assert!((force - 1618.842).abs() < 1e-3 && feed_exponent == 0.78);
    /// assert!((force * 0.3f64.powf(feed_exponent) * 1.5 - 949.4026).abs() < 1e-3);
    /// ```
    pub fn force(&self) -> (f64, f64) {
        let unit = self.kc11 * MILLIMETRE * MILLIMETRE;
        (unit * self.cutting_edge_angle.sin().powf(-self.exponent), 1.0 - self.exponent)
    }

    /// The same for a tool whose rake angle is `by` larger than that of the measurement, rad.
    pub fn with_rake(&self, by: f64) -> Self {
        Self { kc11: self.kc11 * (1.0 - RAKE * by), ..*self }
    }
}

/// One tool life at one cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TestedLife {
    /// Cutting speed, m/s.
    pub cutting_speed: f64,
    /// Feed, m.
    pub feed: f64,
    /// Depth of cut, m.
    pub depth_of_cut: f64,
    /// Time in cut until the wear limit, s.
    pub life: f64,
}

/// Taylor's law fitted to tool lives by least squares of ln T.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedLives {
    /// ln T (s) at the mean of the logarithms of the cuts.
    level: f64,
    /// Means of ln v, ln f, ln a.
    centre: [f64; 3],
    /// Exponents p, q, r where the lives vary the quantity, with their standard errors.
    pub exponents: [Option<(f64, f64)>; 3],
    /// Standard deviation of ln T about the law.
    pub scatter: f64,
    /// Degrees of freedom of the scatter.
    pub freedom: usize,
    /// Number of lives.
    pub lives: usize,
    /// Exponents q and r where the lives do not vary feed or depth.
    unvaried: [f64; 2],
}

/// What stands where lives do not vary feed or depth, q and r (assumption: middle of handbook values
/// for carbide).
pub const ASSUMED_EXPONENTS: [f64; 2] = [1.5, 0.75];
/// Standard deviations of those two (assumption).
pub const ASSUMED_DEVIATIONS: [f64; 2] = [0.6, 0.3];

/// Smallest spread of the logarithm of a speed, feed or depth that counts as varied.
const VARIED: f64 = 0.01;

impl FittedLives {
    /// Fits ln T on ln v, and on ln f and ln a where they vary (ISO 3685).
    ///
    /// # Errors
    /// [`ModelError::NoSolution`] where the speed does not vary, or where there are not more lives than
    /// coefficients, or where the cuts do not tell the exponents apart.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{FittedLives, TestedLife};
    /// let lives = [(160.0, [52.0, 44.5, 61.2]), (200.0, [22.4, 27.9, 19.6]), (250.0, [9.8, 8.1, 11.6]), (315.0, [4.4, 3.5, 3.9])];
    /// let lives: Vec<TestedLife> = lives
    ///     .iter()
    ///     .flat_map(|(speed, minutes)| minutes.map(|life| TestedLife {
    ///         cutting_speed: speed / 60.0, feed: 0.3e-3, depth_of_cut: 1.5e-3, life: life * 60.0,
    ///     }))
    ///     .collect();
    /// let fit = FittedLives::new(&lives).unwrap();
    /// let (low, high) = fit.interval(0, 0.90).unwrap();
    /// assert!((fit.exponents[0].unwrap().0 - 3.826123).abs() < 1e-6);
    /// assert!((low - 3.526662).abs() < 1e-6 && (high - 4.125585).abs() < 1e-6);
    /// assert!((fit.scatter - 0.1443264).abs() < 1e-7);
    /// assert!((60.0 * fit.speed_for(60.0, 0.3e-3, 1.5e-3) - 451.73).abs() < 0.005); // Taylor's C
    /// ```
    pub fn new(lives: &[TestedLife]) -> Result<Self, ModelError> {
        let refused = |reason| ModelError::NoSolution { quantity: "Taylor exponents", reason };
        let count = lives.len() as f64;
        let logs = lives.iter().map(|each| [each.cutting_speed.ln(), each.feed.ln(), each.depth_of_cut.ln()]);
        let logs: Vec<[f64; 3]> = logs.collect();
        let centre: [f64; 3] = std::array::from_fn(|i| logs.iter().map(|x| x[i]).sum::<f64>() / count);
        let spread = |i: usize| logs.iter().map(|x| (x[i] - centre[i]).abs()).fold(0.0, f64::max);
        let varied: Vec<usize> = (0..3).filter(|i| spread(*i) > VARIED).collect();
        if !varied.contains(&0) {
            return Err(refused("the lives are at one speed: test a second one, at least 1.2 times as fast"));
        }
        if lives.len() <= varied.len() + 1 {
            return Err(refused("there are not more lives than constants: test more edges"));
        }
        let level = lives.iter().map(|each| each.life.ln()).sum::<f64>() / count;
        // Normal equations of the centred logarithms, with the unit matrix beside them.
        let n = varied.len();
        let mut rows: Vec<Vec<f64>> = varied
            .iter()
            .enumerate()
            .map(|(row, &i)| {
                let product = |j: usize| logs.iter().map(|x| (x[i] - centre[i]) * (x[j] - centre[j])).sum::<f64>();
                let right = logs.iter().zip(lives).map(|(x, each)| (x[i] - centre[i]) * (each.life.ln() - level));
                let mut line: Vec<f64> = varied.iter().map(|&j| product(j)).collect();
                line.extend((0..n).map(|column| if column == row { 1.0 } else { 0.0 }));
                line.push(right.sum());
                line
            })
            .collect();
        for pivot in 0..n {
            let scale = rows[pivot][pivot];
            let whole = logs.iter().map(|x| (x[varied[pivot]] - centre[varied[pivot]]).powi(2)).sum::<f64>();
            if scale <= 1e-9 * whole {
                return Err(refused("speed, feed and depth change together in these lives: vary one at a time"));
            }
            rows[pivot].iter_mut().for_each(|value| *value /= scale);
            let line = rows[pivot].clone();
            for (i, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != pivot) {
                let _ = i;
                let share = row[pivot];
                row.iter_mut().zip(&line).for_each(|(value, own)| *value -= share * own);
            }
        }
        let slope = |row: usize| rows[row][2 * n];
        let residual = |(x, each): (&[f64; 3], &TestedLife)| {
            let fitted = varied.iter().enumerate().map(|(row, &i)| slope(row) * (x[i] - centre[i])).sum::<f64>();
            (each.life.ln() - level - fitted).powi(2)
        };
        let freedom = lives.len() - n - 1;
        let scatter = (logs.iter().zip(lives).map(residual).sum::<f64>() / freedom as f64).sqrt();
        let mut exponents = [None; 3];
        for (row, &i) in varied.iter().enumerate() {
            exponents[i] = Some((-slope(row), scatter * rows[row][n + row].sqrt()));
        }
        Ok(Self { level, centre, exponents, scatter, freedom, lives: lives.len(), unvaried: ASSUMED_EXPONENTS })
    }

    /// The same with exponents q and r that are known otherwise, for what the lives do not vary.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{FittedLives, TestedLife};
    /// let lives = [(160.0, 52.0), (200.0, 22.4), (250.0, 9.8)].map(|(speed, life)| TestedLife {
    ///     cutting_speed: speed / 60.0, feed: 0.2e-3, depth_of_cut: 1.5e-3, life: life * 60.0,
    /// });
    /// let fit = FittedLives::new(&lives)?.with_exponents([1.2, 0.6]);
    /// let fall = fit.life(3.0, 0.3e-3, 1.5e-3) / fit.life(3.0, 0.2e-3, 1.5e-3);
    /// assert!((fall - 1.5f64.powf(-1.2)).abs() < 1e-12);
    /// # Ok::<(), toolroom_process::ModelError>(())
    /// ```
    pub fn with_exponents(self, unvaried: [f64; 2]) -> Self {
        Self { unvaried, ..self }
    }

    /// Exponents p, q, r: fitted ones, and those of [`with_exponents`](Self::with_exponents) or assumed ones where the lives do not vary the quantity.
    pub fn all_exponents(&self) -> [f64; 3] {
        let or = |i: usize, assumed: f64| self.exponents[i].map_or(assumed, |(value, _)| value);
        [or(0, f64::NAN), or(1, self.unvaried[0]), or(2, self.unvaried[1])]
    }

    /// Tool life at a cut, s: the median.
    pub fn life(&self, cutting_speed: f64, feed: f64, depth_of_cut: f64) -> f64 {
        let cut = [cutting_speed.ln(), feed.ln(), depth_of_cut.ln()];
        let exponents = self.all_exponents();
        (self.level - (0..3).map(|i| exponents[i] * (cut[i] - self.centre[i])).sum::<f64>()).exp()
    }

    /// Speed at which an edge lasts `life` (s), m/s.
    pub fn speed_for(&self, life: f64, feed: f64, depth_of_cut: f64) -> f64 {
        let at_one = self.life(1.0, feed, depth_of_cut);
        (at_one / life).powf(self.all_exponents()[0].recip())
    }

    /// Interval of exponent `i` (0 speed, 1 feed, 2 depth) that covers it with probability `level`,
    /// by Student's t; `None` where the lives do not vary it.
    pub fn interval(&self, i: usize, level: f64) -> Option<(f64, f64)> {
        use statrs::distribution::{ContinuousCDF, StudentsT};
        let (value, error) = self.exponents[i]?;
        let t = StudentsT::new(0.0, 1.0, self.freedom as f64).ok()?.inverse_cdf(0.5 + 0.5 * level);
        Some((value - t * error, value + t * error))
    }
}
