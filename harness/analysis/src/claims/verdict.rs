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

/// One statement of the paper against the runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Statement {
    /// What it is about, in a few words.
    pub subject: String,
    /// What the paper says, or what a sound run must show.
    pub expected: String,
    /// What these runs measured, with errors.
    pub measured: String,
    /// Whether the two agree.
    pub verdict: Verdict,
    /// Why, in a sentence.
    pub reason: String,
}
