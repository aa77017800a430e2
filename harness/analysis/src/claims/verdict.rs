//! Whether a paper and the runs agree.

/// Whether a statement and the runs agree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Within errors.
    Agrees,
    /// Not within them.
    Disagrees,
    /// The runs cannot tell, or there are none.
    NotResolved,
}

impl Verdict {
    /// In words.
    pub fn text(self) -> &'static str {
        match self {
            Verdict::Agrees => "agrees",
            Verdict::Disagrees => "disagrees",
            Verdict::NotResolved => "not resolved",
        }
    }
}
