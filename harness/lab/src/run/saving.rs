//! When an unfinished stage is saved. How often changes no result.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use crate::manifest::Ledger;
use bitgrain_sim::checkpoint::{self, StageState};
use bitgrain_sim::error::Result;
use bitgrain_sim::observer::Observer;
use bitgrain_sim::simulation::Simulation;

/// Time between saves unless something else is asked for.
const DEFAULT: Duration = Duration::from_secs(300);

/// How often a stage is saved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SaveEvery {
    /// After so much time.
    Time(Duration),
    /// After this many steps.
    Steps(u64),
}

impl Default for SaveEvery {
    fn default() -> Self {
        SaveEvery::Time(DEFAULT)
    }
}

impl std::str::FromStr for SaveEvery {
    type Err = String;

    /// `5m`, minutes, or `20000`, steps.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let wrong = || "expected minutes, as in 5m, or steps, as in 20000".to_string();
        if let Some(minutes) = text.strip_suffix('m') {
            let minutes: f64 = minutes.parse().map_err(|_| wrong())?;
            let seconds = Duration::try_from_secs_f64(60.0 * minutes).map_err(|_| wrong())?;
            return Ok(SaveEvery::Time(seconds));
        }
        match text.parse() {
            Ok(steps) if steps > 0 => Ok(SaveEvery::Steps(steps)),
            _ => Err(wrong()),
        }
    }
}

/// Saves an unfinished stage, again and again, into one file.
pub(super) struct Saver<'a> {
    ledger: &'a Ledger,
    every: SaveEvery,
    path: PathBuf,
    step: u64,
    /// Of a clock that never goes back, even if the time of day is changed.
    time: Instant,
}

impl<'a> Saver<'a> {
    /// A saver of a stage that is at this step.
    pub fn new(ledger: &'a Ledger, every: SaveEvery, path: PathBuf, step: u64) -> Self {
        Self {
            ledger,
            every,
            path,
            step,
            time: Instant::now(),
        }
    }

    /// Records that the stage was saved at this step, here or elsewhere.
    pub fn saved(&mut self, step: u64) {
        (self.step, self.time) = (step, Instant::now());
    }

    /// Saves the stage now. The manifest comes first, so that it vouches for all that was written before this
    /// state.
    pub fn save(&self, sim: &mut Simulation, note: &StageState) -> Result<()> {
        self.ledger.save()?;
        self.ledger
            .write_state(&self.path, &checkpoint::pack(sim, note)?)
    }

    /// Removes what was saved, of a stage that has ended.
    ///
    /// # Errors
    /// As [`Ledger::remove_state`].
    pub fn clear(&self) -> Result<()> {
        self.ledger.remove_state(&self.path)
    }
}

/// Saves the stage if it is due.
impl Observer for Saver<'_> {
    fn wants_checkpoint(&self, step: u64) -> bool {
        match self.every {
            SaveEvery::Time(_) => false,
            SaveEvery::Steps(steps) => step.saturating_sub(self.step) >= steps,
        }
    }

    fn on_checkpoint(
        &mut self,
        step: u64,
        sim: &mut Simulation,
        note: &dyn Fn() -> StageState,
    ) -> Result<()> {
        let due = match self.every {
            SaveEvery::Time(time) => self.time.elapsed() >= time,
            SaveEvery::Steps(_) => self.wants_checkpoint(step),
        };
        if due {
            self.save(sim, &note())?;
            self.saved(step);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_read() {
        let minutes = |m: f64| SaveEvery::Time(Duration::from_secs_f64(60.0 * m));
        assert_eq!("5m".parse(), Ok(minutes(5.0)));
        assert_eq!("0.5m".parse(), Ok(minutes(0.5)));
        assert_eq!("20000".parse(), Ok(SaveEvery::Steps(20_000)));
        for wrong in ["", "m", "0", "-1m", "nanm", "1e300m", "5 minutes", "-3"] {
            assert!(wrong.parse::<SaveEvery>().is_err(), "{wrong}");
        }
    }
}
