//! What the runs of a campaign say together (Kumar 2018, section III): regimes of the drag, the near
//! field of the intruder, yield forces and how they scale.
//!
//! Everything is a pure function of the campaign's table, and every fit says how good it is or why there is
//! none.

mod analyse;
mod curves;
mod describe;
mod exponents;
mod finding;
mod near_field;
mod scaling;
mod speeds;
mod stiffness;
#[cfg(test)]
mod tests;
mod value;
mod yields;

pub use analyse::{Analysis, analyse, text};
pub use curves::{Curve, Material, Point};
pub use describe::describe;
pub(crate) use describe::{grains, intruder, material};
pub use exponents::Scaled;
pub(crate) use exponents::near;
pub use finding::Finding;
pub use near_field::{Contacts, Floating, NearField, Offset};
pub use scaling::{AtSpeed, Collapse, Exponent, Scaling, Spread};
pub use speeds::{Flatness, Pooled, Speeds};
pub use stiffness::{Level, Stiffness};
pub use value::Value;
pub use yields::{Method, Yield};
