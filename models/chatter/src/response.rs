//! Response of the modes over one stretch of time, exact without force and collocated with it.

use toolroom_spectral::{Factors, MAX_NODES, Rule};

/// A mode as the cut sees it: `output` turns its coordinate into displacement, `input` the
/// cutting force into modal force.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Modal {
    /// Undamped angular frequency (rad/s).
    pub frequency: f64,
    pub damping_ratio: f64,
    pub stiffness: f64,
    pub output: [f64; 2],
    pub input: [f64; 2],
}

impl Modal {
    /// Transition of (q, q'/w) over `time` without force, row-major.
    pub fn transition(&self, time: f64) -> [f64; 4] {
        let w = self.frequency;
        let decay = self.damping_ratio * w;
        let damped = w * (1.0 - self.damping_ratio * self.damping_ratio).sqrt();
        let (sine, cosine) = (damped * time).sin_cos();
        let envelope = (-decay * time).exp();
        let s = envelope * sine / damped;
        let c = envelope * cosine;
        [c + decay * s, w * s, -w * s, c - decay * s]
    }
}

/// The modes and how many directions of displacement they share, one or two.
#[derive(Clone, Debug)]
pub(crate) struct Modes {
    pub modal: Vec<Modal>,
    pub channels: usize,
}

impl Modes {
    /// Highest natural frequency (rad/s).
    pub fn fastest(&self) -> f64 {
        self.modal.iter().map(|m| m.frequency).fold(0.0, f64::max)
    }

    /// Length of the state: coordinate q and scaled rate q'/w of every mode.
    pub fn states(&self) -> usize {
        2 * self.modal.len()
    }
}

/// Collocated response over one stretch in cut.
///
/// Samples of displacement and force are ordered by channel, then by node. All matrices are
/// column-major with `samples` or `states` rows.
#[derive(Debug)]
pub(crate) struct Response {
    pub duration: f64,
    pub nodes: usize,
    /// channels · nodes.
    pub samples: usize,
    /// Displacement at the nodes by force at the nodes.
    pub displacement: Vec<f64>,
    /// Its rate; empty unless requested.
    pub rate: Vec<f64>,
    /// Displacement at the nodes by the state at the start.
    pub free_displacement: Vec<f64>,
    /// Its rate; empty unless requested.
    pub free_rate: Vec<f64>,
    /// Transition of every mode over the stretch.
    pub end_free: Vec<[f64; 4]>,
    /// State at the end by force at the nodes, row-major: one row of `samples` a state.
    pub end_forced: Vec<f64>,
}

/// Nodes for a stretch that holds `cycles` of the fastest mode; more than [`MAX_NODES`] means that
/// it must be split.
pub(crate) fn nodes_for(cycles: f64, extra: usize) -> usize {
    (2.6 + 5.3 * cycles).ceil() as usize + extra
}

/// Cycles of the fastest mode in a part, at most: as many as a part has nodes for.
pub(crate) const LONG_PARTS: f64 = (MAX_NODES - 20) as f64 / 5.3;
/// The same of a stretch that has to be split. The work of a part goes with the square of its nodes, that of its factors with
/// the cube, and a part needs some nodes more than its oscillations: parts of two to four cycles cost least. All eigenvalues
/// at once cost least with the fewest nodes, and so with long parts.
pub(crate) const SHORT_PARTS: f64 = 3.5;

/// Into how many parts a stretch with `cycles` of the fastest mode is split, each with `most` at most where one is not enough.
pub(crate) fn parts_for(cycles: f64, most: f64) -> usize {
    if cycles <= LONG_PARTS { 1 } else { (cycles / most).ceil() as usize }
}

impl Response {
    pub fn new(modes: &Modes, duration: f64, nodes: usize, with_rate: bool) -> Self {
        let rule = Rule::of(nodes);
        let n = rule.nodes.len();
        let samples = modes.channels * n;
        let states = modes.states();
        let mut response = Self {
            duration,
            nodes: n,
            samples,
            displacement: vec![0.0; samples * samples],
            rate: vec![0.0; if with_rate { samples * samples } else { 0 }],
            free_displacement: vec![0.0; samples * states],
            free_rate: vec![0.0; if with_rate { samples * states } else { 0 }],
            end_free: modes.modal.iter().map(|m| m.transition(duration)).collect(),
            end_forced: vec![0.0; samples * states],
        };
        let mut factors = Factors::default();
        let mut column = vec![0.0; n];
        for (index, modal) in modes.modal.iter().enumerate() {
            response.free(modal, index, &rule);
            let w = modal.frequency * duration;
            let inverse_mass = modal.frequency * modal.frequency / modal.stiffness;
            // Acceleration a at the nodes: (I + 2 zeta w S + w² S²) a = force/mass.
            let matrix = factors.begin(n);
            for k in 0..n {
                for j in 0..n {
                    let place = j * n + k;
                    matrix[k * n + j] = 2.0 * modal.damping_ratio * w * rule.integration[place]
                        + w * w * rule.double_integration[place]
                        + f64::from(u8::from(j == k));
                }
            }
            factors.factorise();
            // S commutes with the matrix, so the response is its solution for S² (and S).
            for k in 0..n {
                for (j, entry) in column.iter_mut().enumerate() {
                    *entry = duration * duration * inverse_mass * rule.double_integration[j * n + k];
                }
                factors.solve(&mut column);
                add_blocks(&mut response.displacement, &column, k, modal, samples);
                if with_rate {
                    for (j, entry) in column.iter_mut().enumerate() {
                        *entry = duration * inverse_mass * rule.integration[j * n + k];
                    }
                    factors.solve(&mut column);
                    add_blocks(&mut response.rate, &column, k, modal, samples);
                }
            }
            // End of the stretch: weightsᵀ S a and weightsᵀ a.
            for (k, entry) in column.iter_mut().enumerate() {
                let ends = (0..n).map(|j| rule.weights[j] * rule.integration[j * n + k]);
                *entry = duration * duration * inverse_mass * ends.sum::<f64>();
            }
            factors.solve_transposed(&mut column);
            response.end(2 * index, &column, modal);
            for (entry, weight) in column.iter_mut().zip(&rule.weights) {
                *entry = duration * inverse_mass / modal.frequency * weight;
            }
            factors.solve_transposed(&mut column);
            response.end(2 * index + 1, &column, modal);
        }
        response
    }

    fn free(&mut self, modal: &Modal, index: usize, rule: &Rule) {
        let (n, samples) = (self.nodes, self.samples);
        for (j, node) in rule.nodes.iter().enumerate() {
            let transition = modal.transition(node * self.duration);
            for (channel, output) in modal.output.iter().enumerate().take(samples / n) {
                for side in 0..2 {
                    let place = (2 * index + side) * samples + channel * n + j;
                    self.free_displacement[place] = output * transition[side];
                    if let Some(rate) = self.free_rate.get_mut(place) {
                        *rate = output * modal.frequency * transition[2 + side];
                    }
                }
            }
        }
    }

    fn end(&mut self, state: usize, row: &[f64], modal: &Modal) {
        let (n, samples) = (self.nodes, self.samples);
        for (channel, input) in modal.input.iter().enumerate().take(samples / n) {
            for (k, entry) in row.iter().enumerate() {
                self.end_forced[state * samples + channel * n + k] = input * entry;
            }
        }
    }
}

/// Adds `column` k of one mode's response to the blocks of all pairs of channels.
fn add_blocks(matrix: &mut [f64], column: &[f64], k: usize, modal: &Modal, samples: usize) {
    let n = column.len();
    for b in 0..samples / n {
        for a in 0..samples / n {
            let factor = modal.output[a] * modal.input[b];
            if factor != 0.0 {
                let start = (b * n + k) * samples + a * n;
                toolroom_spectral::subtract(&mut matrix[start..start + n], -factor, column);
            }
        }
    }
}
