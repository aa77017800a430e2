//! How fast the stages of a folder went on this machine: what a forecast of the rest learns from.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::beside::{PERFORMANCE, write_beside};
use bitgrain_kernel::BITS_VERSION;
use bitgrain_sim::disk;
use bitgrain_sim::parts::Ranks;
use bitgrain_sim::threads::threads;

/// Least time that a speed is believed from, in seconds.
const LEAST: f64 = 60.0;

/// Time between two entries of a stage.
const INTERVAL: Duration = Duration::from_secs(60);

/// What a stage does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StageKind {
    /// It pours a bed or lays a lid on one.
    Pouring,
    /// It does a drag.
    Dragging,
}

/// Work of one kind, and the time that one thread took for it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TimedWork {
    /// Grain-steps of a small bed that take as long: each of a large bed counts as more than one.
    pub grain_steps: f64,
    /// Seconds that one thread would take: of a stage on several, each thread after the first counts half.
    pub seconds: f64,
}

impl TimedWork {
    fn add(&mut self, other: TimedWork) {
        self.grain_steps += other.grain_steps;
        self.seconds += other.seconds;
    }

    /// Grain-steps a second; `None` if too little was done to tell.
    fn speed(&self) -> Option<f64> {
        let speed = self.grain_steps / self.seconds;
        (self.seconds >= LEAST && speed.is_normal() && speed > 0.0).then_some(speed)
    }
}

/// What was done in a folder on this machine, by kind of stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pace {
    /// Pouring.
    pub pouring: TimedWork,
    /// Dragging.
    pub dragging: TimedWork,
    /// Beds that settled.
    pub settled: Settled,
}

/// Beds that settled here from their first step on: plans only guess how many steps that takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Settled {
    /// Grain-steps that were planned.
    pub planned: f64,
    /// Grain-steps that it took.
    pub taken: f64,
}

/// The part of the file that is read again.
#[derive(Serialize, Deserialize)]
struct Kept {
    bits_version: u32,
    pace: Pace,
}

impl Pace {
    /// What a folder says of itself; nothing if it says nothing.
    pub fn read(folder: &Path) -> Self {
        let bytes = disk::read_if_there(&folder.join(PERFORMANCE))
            .ok()
            .flatten();
        let kept = bytes.and_then(|bytes| serde_json::from_slice::<Kept>(&bytes).ok());
        let sound = |a: f64, b: f64| a >= 0.0 && b >= 0.0 && (a + b).is_finite();
        let works = |work: TimedWork| sound(work.grain_steps, work.seconds);
        let holds = |pace: &Pace| {
            let beds = pace.settled;
            works(pace.pouring) && works(pace.dragging) && sound(beds.planned, beds.taken)
        };
        kept.map(|kept| kept.pace).filter(holds).unwrap_or_default()
    }

    /// The same and what another folder says.
    pub fn add(&mut self, other: Pace) {
        self.pouring.add(other.pouring);
        self.dragging.add(other.dragging);
        self.settled.planned += other.settled.planned;
        self.settled.taken += other.settled.taken;
    }

    /// Steps that a bed takes to settle, over those planned: 1 if none settled here.
    pub fn of_plan(&self) -> f64 {
        let ratio = self.settled.taken / self.settled.planned;
        if ratio.is_normal() { ratio } else { 1.0 }
    }

    /// Grain-steps of a small bed a second of one thread in stages of a kind, or in the others if none of it was done;
    /// `None` if too little was done to tell.
    pub fn speed(&self, kind: StageKind) -> Option<f64> {
        let [own, other] = match kind {
            StageKind::Pouring => [self.pouring, self.dragging],
            StageKind::Dragging => [self.dragging, self.pouring],
        };
        own.speed().or(other.speed())
    }
}

/// How many times as fast a stage goes on several threads, as far as forecasts are concerned: each one after the first
/// brings half.
pub(crate) fn gain(threads: f64) -> f64 {
    1.0 + 0.5 * (threads - 1.0)
}

/// Speed of beds of that many grains and more, over that of a small bed: the rows of grains leave the caches one after
/// the other.
const LARGE: [(usize, f64); 3] = [(5_000, 0.85), (50_000, 0.7), (500_000, 0.6)];

/// How many grain-steps of a small bed take as long as these of one of so many grains.
pub(crate) fn of_small(grain_steps: f64, grains: usize) -> f64 {
    let below = LARGE.iter().rev().find(|(least, _)| grains >= *least);
    grain_steps / below.map_or(1.0, |(_, part)| *part)
}

/// The pace of what is under way, kept in a folder.
#[derive(Debug, Default)]
pub(crate) struct PaceLog(Mutex<(Pace, Option<PathBuf>)>);

impl PaceLog {
    /// Goes on from what this folder says, and keeps it there from now on: what was done in another is told there.
    pub fn keep_in(&self, folder: &Path) {
        if let Ok(mut log) = self.0.lock() {
            *log = (Pace::read(folder), Some(folder.join(PERFORMANCE)));
        }
    }

    /// What there is so far.
    pub fn pace(&self) -> Pace {
        self.0.lock().map(|log| log.0).unwrap_or_default()
    }

    /// Adds what another folder says.
    pub fn add(&self, other: Pace) {
        if let Ok(mut log) = self.0.lock() {
            log.0.add(other);
            write(&log);
        }
    }

    /// Adds a bed that settled.
    pub fn settled(&self, settled: Settled) {
        self.add(Pace {
            settled,
            ..Pace::default()
        });
    }

    /// Adds what a stage did.
    pub fn did(&self, kind: StageKind, work: TimedWork) {
        let mut pace = Pace::default();
        match kind {
            StageKind::Pouring => pace.pouring = work,
            StageKind::Dragging => pace.dragging = work,
        }
        self.add(pace);
    }
}

/// Writes it down. If that fails the next forecast knows less, and nothing else is lost.
fn write(log: &(Pace, Option<PathBuf>)) {
    let (pace, Some(path)) = log else { return };
    let kept = Kept {
        bits_version: BITS_VERSION,
        pace: *pace,
    };
    if let Ok(text) = serde_json::to_string_pretty(&kept) {
        let _ = write_beside(path, format!("{text}\n").as_bytes());
    }
}

/// What a stage tells the next forecast.
pub(crate) struct Paced {
    kind: StageKind,
    log: Arc<PaceLog>,
    /// Grain-steps of a small bed that were not told yet, and since when they are done.
    open: Mutex<(f64, Instant)>,
}

impl Paced {
    /// Of a stage that begins now.
    pub fn new(kind: StageKind, log: Arc<PaceLog>) -> Self {
        let open = Mutex::new((0.0, Instant::now()));
        Self { kind, log, open }
    }

    /// Adds steps of a bed of so many grains, and tells them if it is time or the stage's end.
    pub fn did(&self, steps: u64, grains: usize, end: bool) {
        let Ok(mut open) = self.open.lock() else {
            return;
        };
        open.0 += of_small(steps as f64 * grains as f64, grains);
        let elapsed = open.1.elapsed();
        if open.0 == 0.0 || !(end || elapsed >= INTERVAL) {
            return;
        }
        let ranks = Ranks::joined().map_or(1, |ranks| ranks.count());
        let work = TimedWork {
            grain_steps: open.0,
            seconds: elapsed.as_secs_f64() * gain((threads() * ranks) as f64),
        };
        self.log.did(self.kind, work);
        *open = (0.0, Instant::now());
    }

    /// Begins now: nothing before counts.
    pub fn begin(&self) {
        if let Ok(mut open) = self.open.lock() {
            *open = (0.0, Instant::now());
        }
    }
}

/// What a stage did counts also if it was stopped or failed.
impl Drop for Paced {
    fn drop(&mut self) {
        self.did(0, 0, true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn work(grain_steps: f64, seconds: f64) -> TimedWork {
        TimedWork {
            grain_steps,
            seconds,
        }
    }

    #[test]
    fn a_pace_is_kept_and_believed_from_a_minute_on() {
        let folder = tempfile::tempdir().unwrap();
        let log = PaceLog::default();
        log.keep_in(folder.path());
        assert_eq!(log.pace().speed(StageKind::Pouring), None);
        log.did(StageKind::Pouring, work(400.0, 40.0));
        assert_eq!(log.pace().speed(StageKind::Pouring), None);
        log.did(StageKind::Pouring, work(800.0, 20.0));
        let read = Pace::read(folder.path());
        assert_eq!(read, log.pace());
        assert_eq!(read.speed(StageKind::Pouring), Some(20.0));
        // Nothing was dragged: the speed of pouring is what is known.
        assert_eq!(read.speed(StageKind::Dragging), Some(20.0));
        log.did(StageKind::Dragging, work(700.0, 70.0));
        assert_eq!(log.pace().speed(StageKind::Dragging), Some(10.0));
        assert_eq!(log.pace().of_plan(), 1.0);
        let (planned, taken) = (30.0, 20.0);
        log.settled(Settled { planned, taken });
        assert_eq!(Pace::read(folder.path()).of_plan(), 20.0 / 30.0);
        // Another process goes on from what is there.
        let next = PaceLog::default();
        next.keep_in(folder.path());
        next.add(Pace::read(folder.path()));
        assert_eq!(next.pace().dragging, work(1400.0, 140.0));
    }

    #[test]
    fn a_pace_that_cannot_be_counts_as_none() {
        let folder = tempfile::tempdir().unwrap();
        let log = PaceLog::default();
        log.keep_in(folder.path());
        for (grain_steps, seconds) in [(-1.0, 1.0), (1.0, -1.0)] {
            log.did(StageKind::Pouring, work(grain_steps, seconds));
            assert_eq!(Pace::read(folder.path()), Pace::default());
            log.did(StageKind::Pouring, work(-grain_steps, -seconds));
        }
        for text in [
            "",
            "{}",
            "{\"bits_version\": 1, \"pace\": {\"pouring\": 3}}",
        ] {
            std::fs::write(folder.path().join(PERFORMANCE), text).unwrap();
            assert_eq!(Pace::read(folder.path()), Pace::default(), "{text}");
        }
    }
}
