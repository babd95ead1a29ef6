//! Published and reference numbers, each with its tolerance and origin.

mod literature {
    mod static_algebra;
}
