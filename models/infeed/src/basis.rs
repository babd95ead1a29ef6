//! From what the lag is taken.

toolroom_form::vocabulary! {
    /// What the lag is taken from.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Basis {
        /// Stock and recorded force, whatever a trial has; both are weighted by their errors.
        #[default]
        Both = "both",
        /// Stock alone.
        Stock = "stock",
        /// Rise and spark-out of the force alone.
        Force = "force",
    }
}
