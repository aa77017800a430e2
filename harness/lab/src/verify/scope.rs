//! What of a run is to be verified.

/// A stage, or a stretch of its steps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Segment {
    /// Name of the stage.
    pub stage: String,
    /// First and last step.
    pub steps: Option<(u64, u64)>,
}

impl std::str::FromStr for Segment {
    type Err = String;

    /// `run-1`, or `run-1:20000-40000`.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let Some((stage, steps)) = text.split_once(':') else {
            return Ok(Self {
                stage: text.into(),
                steps: None,
            });
        };
        let ends = steps
            .split_once('-')
            .and_then(|(from, to)| Some((from.parse().ok()?, to.parse().ok()?)));
        match ends {
            Some((from, to)) if from < to => Ok(Self {
                stage: stage.into(),
                steps: Some((from, to)),
            }),
            _ => Err("expected STAGE or STAGE:FROM-TO, as in run-1:20000-40000".into()),
        }
    }
}

/// What to verify.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    /// Stages, or stretches of them; all if there are none.
    pub segments: Vec<Segment>,
    /// How many pieces, chosen at random by a seed, of these.
    pub sample: Option<(usize, u64)>,
}

impl Scope {
    /// Whether all of a run is asked for.
    pub fn is_all(&self) -> bool {
        self.segments.is_empty() && self.sample.is_none()
    }
}
