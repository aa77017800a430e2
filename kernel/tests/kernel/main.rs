//! The kernel's own tests, by what they look at.

mod common {
    pub mod cases;
    pub mod crowd;
    pub mod range_bounds;
}

mod canary;
mod edits;
mod examples;
mod images;
mod oracle;
mod reference;
mod resolution;
mod search;
mod store;
mod sums;
