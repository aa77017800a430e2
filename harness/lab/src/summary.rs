//! The numbers of a run directory, `summary.json`, as the stages hand them on.

mod check;
mod read;
mod record;
mod released;

pub use read::{parse_record, parse_summary, read_folder, read_summary};
pub use record::{
    BedSummary, DragRecord, DragSummary, Flow, LARGE_OVERLAP, Reach, Rig, Summary, Tank,
};
pub use released::Released;
