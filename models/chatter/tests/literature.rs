//! Published and independently computed numbers, each with its tolerance.

mod literature {
    pub mod paper;
}
