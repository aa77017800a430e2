//! How fast a campaign went on this machine so far: what the forecast of the rest of it learns from.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use bitgrain_sim::disk;
use bitgrain_sim::error::Result;

/// Name of the file, which belongs to the machine and not to the results.
pub(super) const NAME: &str = "performance.json";

/// Least time that a pace is believed from, in seconds.
const LEAST: f64 = 60.0;

/// What was done, and how long it took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Pace {
    /// Threads that all stages together ran on.
    pub threads: usize,
    /// Grain-steps of all stages.
    pub grain_steps: f64,
    /// Seconds from the first stage's begin to the last one's end.
    pub seconds: f64,
}

impl Pace {
    /// What the folder of a campaign says of this many threads; nothing if it says nothing.
    pub fn read(folder: &Path, threads: usize) -> Self {
        let bytes = disk::read_if_there(&path(folder)).ok().flatten();
        let read = bytes.and_then(|bytes| serde_json::from_slice::<Pace>(&bytes).ok());
        let sound = |pace: &Pace| {
            let positive = pace.grain_steps >= 0.0 && pace.seconds >= 0.0;
            pace.threads == threads && positive && (pace.grain_steps + pace.seconds).is_finite()
        };
        read.filter(sound).unwrap_or(Pace {
            threads,
            ..Pace::default()
        })
    }

    /// The same with more done.
    pub fn and(self, grain_steps: u64, seconds: f64) -> Self {
        Self {
            grain_steps: self.grain_steps + grain_steps as f64,
            seconds: self.seconds + seconds,
            ..self
        }
    }

    /// Keeps it in the folder.
    ///
    /// # Errors
    /// [`bitgrain_sim::error::Error::Write`].
    pub fn write(&self, folder: &Path) -> Result<()> {
        let text = serde_json::to_string_pretty(self).expect("numbers are text");
        disk::write_whole(&path(folder), format!("{text}\n").as_bytes())
    }

    /// Grain-steps a second of all threads together; `None` if too little was done to tell.
    pub fn speed(&self) -> Option<f64> {
        let speed = self.grain_steps / self.seconds;
        (self.seconds >= LEAST && speed.is_normal()).then_some(speed)
    }
}

fn path(folder: &Path) -> PathBuf {
    folder.join(NAME)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pace_is_kept_and_believed_from_a_minute_on() {
        let folder = tempfile::tempdir().unwrap();
        let none = Pace::read(folder.path(), 2);
        assert_eq!((none.threads, none.speed()), (2, None));
        let some = none.and(400, 40.0);
        assert_eq!(some.speed(), None);
        some.and(800, 20.0).write(folder.path()).unwrap();
        assert_eq!(Pace::read(folder.path(), 2).speed(), Some(20.0));
        // On other threads it went otherwise.
        assert_eq!(Pace::read(folder.path(), 3).speed(), None);
        std::fs::write(
            folder.path().join(NAME),
            "{\"threads\":2,\"grain_steps\":1,\"seconds\":-1}",
        )
        .unwrap();
        assert_eq!(
            Pace::read(folder.path(), 2),
            Pace {
                threads: 2,
                ..Pace::default()
            }
        );
    }
}
