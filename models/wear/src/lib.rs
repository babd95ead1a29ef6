//! Tool wear in turning.

mod chipping;
mod contact;
mod cut;
mod emf;
mod energy_balance;
mod force;
mod law;
mod limits;
mod pair;
mod takeyama_murata;
mod taylor;
mod temperature;

pub use chipping::Chipping;
pub use contact::{Contact, Point};
pub use cut::Cut;
pub use emf::Emf;
pub use energy_balance::EnergyBalance;
pub use force::Force;
pub use law::{Wear, WearLaw};
pub use limits::Limits;
pub use pair::{PARAMETER_SETS, Pair, PairError};
pub use takeyama_murata::TakeyamaMurata;
pub use taylor::ExtendedTaylor;
pub use temperature::{Heating, Temperature};
