//! Published and independently computed numbers, each with its tolerance.

mod literature {
    pub mod amplitude;
    pub mod milling;
    pub mod paper;
    pub mod turning;
}
