//! What runs and campaigns say, compared with the papers, and the pages that show it.
//!
//! [`fit`] draws curves through points, [`analysis`] is what a campaign's table says, [`claims`] compares it
//! with the papers; [`remarks`] say what weakens the numbers, [`report`] draws pages, [`present`] from the files of a
//! run directory.

#![forbid(unsafe_code)]

pub mod analysis;
pub mod claims;
pub mod present;
pub mod released;
pub mod remarks;
pub mod report;

pub use bitgrain_fit as fit;
