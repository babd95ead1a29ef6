//! Where the value of a parameter of a law comes from.

/// Where the value of a parameter of the law comes from.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Slot {
    /// The working coordinate of this index.
    Free(usize),
    /// A tilt of the wear stages that is held while their contrast is free.
    Tilt(f64),
    /// A fixed value.
    Fixed(f64),
}
