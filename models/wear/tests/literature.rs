//! Published and reference numbers, each with its tolerance and origin.

mod literature {
    mod control;
    mod gains;
    mod laws;
    mod life;
    mod static_algebra;
}
