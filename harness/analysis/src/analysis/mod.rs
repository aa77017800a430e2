//! What the runs of a campaign say together (Kumar 2018, section III): regimes of the drag, the near
//! field of the intruder, yield forces and how they scale.
//!
//! Everything is a pure function of the campaign's table, and every fit says how good it is or why there is
//! none.

mod analyse;
mod beds;
mod curves;
mod describe;
mod exponents;
mod finding;
mod near_field;
mod path;
mod point;
mod scaling;
mod speeds;
mod stiffness;
mod table_one;
#[cfg(test)]
mod tests;
mod value;
mod yields;

pub use analyse::{Analysis, analyse, text};
pub use curves::{Curve, Material};
pub use describe::describe;
pub(crate) use describe::{grains, intruder, material};
pub use exponents::Scaled;
pub(crate) use exponents::near;
pub use finding::Finding;
pub use near_field::{Contacts, Floating, KappaWithin, NearField, Offset};
pub use point::{ErrorOf, Point, Within};
pub use scaling::{AtSpeed, Collapse, Exponent, SHALLOW, Scaling, Spread};
pub(crate) use speeds::CROSSOVERS;
pub use speeds::{Flatness, Growth, Pooled, Reading, Speeds};
pub use stiffness::{Level, Stiffness};
pub use table_one::{TableOne, law as table_one_law};
pub use value::Value;
pub(crate) use yields::PLATEAU_MU;
pub use yields::{Method, Yield};
