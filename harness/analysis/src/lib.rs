//! What runs and campaigns say, beside the papers, and the pages that show it.
//!
//! [`fit`] draws curves through points, [`analysis`] is what a campaign's table says, [`claims`] what it comes to
//! beside the papers; [`remarks`] speak against numbers, [`report`] draws pages, [`present`] from the files of a run
//! directory.

#![forbid(unsafe_code)]

pub mod analysis;
pub mod claims;
pub mod fit;
pub mod present;
pub mod remarks;
pub mod report;
