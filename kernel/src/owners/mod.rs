//! Who owns what a world borrows: a value of fixed capacity, or memory that a host lends.

pub(crate) mod capacity;
pub(crate) mod flags;
pub(crate) mod lent;
pub(crate) mod store;
