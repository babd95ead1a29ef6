//! What a machine has learnt about chatter.

/// What a machine has learnt about chatter in one kind of pass.
#[derive(Clone, Debug)]
pub struct Reaction {
    /// What is cut: the number of its controller.
    pub kind: u32,
    /// Speeds that chattered, m/s, with the amplitude that was heard, m.
    pub tried: Vec<(f64, f64)>,
    /// Speed that is commanded now, m/s.
    pub speed: f64,
    /// Whether no other speed is left to try.
    pub exhausted: bool,
}
