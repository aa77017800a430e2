//! Progress: one bar a stage with its ETA, and a line as a stage ends, on a terminal; elsewhere
//! nothing, or the lines alone if they were asked for. And the request to stop, which every stage
//! checks.

use std::io::Write;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

use crate::pace::{Pace, PaceLog, Paced, Settled, StageKind};
use crate::plain::plain;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::simulation::Simulation;

/// Time between the lines of a stage that has no bar.
const QUIET: Duration = Duration::from_secs(60);

/// All bars of a command.
pub struct Progress {
    bars: MultiProgress,
    /// Whether lines are printed if there is no terminal.
    verbose: bool,
    stop: Arc<AtomicBool>,
    /// Grain-steps done by all stages, and the bar that shows them if many stages make one whole.
    work: Arc<Work>,
    /// How fast stages go, for the next forecast.
    pace: Arc<PaceLog>,
    /// What stands before every stage and line: of which run it is.
    label: String,
}

#[derive(Default)]
struct Work {
    done: AtomicU64,
    bar: Mutex<Option<ProgressBar>>,
}

impl Work {
    fn add(&self, grain_steps: u64) {
        let done = grain_steps + self.done.fetch_add(grain_steps, Ordering::Relaxed);
        if let Ok(bar) = self.bar.lock()
            && let Some(bar) = &*bar
        {
            // Plans are approximate: a bar must not be full before its end.
            let length = bar.length().unwrap_or(done);
            bar.set_position(done.min(length));
        }
    }
}

/// Many stages as one whole, as those of a campaign.
pub struct Overall<'a> {
    progress: &'a Progress,
    bar: ProgressBar,
    began: Instant,
    /// Grain-steps in all, as far as is known, and those that were done before.
    total: AtomicU64,
    before: u64,
    /// Runs in all, done, and failed.
    runs: usize,
    ended: AtomicUsize,
    failed: AtomicUsize,
}

/// One stage in progress. Dropping it removes its bar.
pub struct Stage {
    bar: ProgressBar,
    name: String,
    began: Instant,
    /// Step from which it goes on.
    first: u64,
    /// When its last line was printed, if lines are printed in place of a bar.
    lines: Option<Mutex<Instant>>,
    /// Largest share of a settling shown so far.
    best: f64,
    stop: Arc<AtomicBool>,
    work: Arc<Work>,
    /// Step up to which its grain-steps are in the work done.
    counted: AtomicU64,
    /// What it tells the next forecast, if it is one that a forecast knows.
    paced: Option<Paced>,
}

impl Progress {
    /// Bars and lines on standard error if that is a terminal; else only lines, and those
    /// only if `verbose`.
    pub fn new(verbose: bool) -> Self {
        Self {
            bars: MultiProgress::new(),
            verbose,
            stop: Arc::new(AtomicBool::new(false)),
            work: Arc::default(),
            pace: Arc::default(),
            label: String::new(),
        }
    }

    /// The same, whose stages and lines begin with a name.
    pub fn labelled(&self, name: &str) -> Self {
        Self {
            bars: self.bars.clone(),
            verbose: self.verbose,
            stop: Arc::clone(&self.stop),
            work: Arc::clone(&self.work),
            pace: Arc::clone(&self.pace),
            label: format!("{name} "),
        }
    }

    /// A bar over all stages that follow: `total` grain-steps, `before` of which were done before, and so
    /// many runs, of which some have `ended`.
    pub fn overall(
        &self,
        name: &str,
        total: u64,
        before: u64,
        runs: usize,
        ended: usize,
    ) -> Overall<'_> {
        let bar = self.bars.add(ProgressBar::new(total));
        let look = "{prefix:<22} {bar:20} {percent:>3}%  {msg}, ETA {eta}";
        if let Ok(style) = ProgressStyle::with_template(look) {
            bar.set_style(style);
        }
        bar.set_prefix(plain(name));
        bar.set_position(before);
        bar.reset_eta();
        self.work.done.store(before, Ordering::Relaxed);
        if let Ok(mut shown) = self.work.bar.lock() {
            *shown = Some(bar.clone());
        }
        let overall = Overall {
            progress: self,
            bar,
            began: Instant::now(),
            total: AtomicU64::new(total),
            before,
            runs,
            ended: AtomicUsize::new(ended),
            failed: AtomicUsize::new(0),
        };
        overall.show();
        overall
    }

    /// The flag that stops every stage once it is set, as by Ctrl-C.
    pub fn stop_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }

    /// Begins a stage of about `steps` steps.
    pub fn stage(&self, name: &str, steps: u64) -> Stage {
        let name = &plain(&format!("{}{name}", self.label));
        let bar = self.bars.add(ProgressBar::new(steps));
        let look = "{prefix:<22} {bar:20} {percent:>3}%  step {pos}  ETA {eta:<5} {msg}";
        if let Ok(style) = ProgressStyle::with_template(look) {
            bar.set_style(style);
        }
        bar.set_prefix(name.to_string());
        Stage {
            bar,
            name: name.to_string(),
            began: Instant::now(),
            first: 0,
            lines: (self.verbose && self.bars.is_hidden()).then(|| Mutex::new(Instant::now())),
            best: 0.0,
            stop: Arc::clone(&self.stop),
            work: Arc::clone(&self.work),
            counted: AtomicU64::new(0),
            paced: None,
        }
    }

    /// Begins a stage that the next forecast learns from.
    pub fn paced_stage(&self, name: &str, steps: u64, kind: StageKind) -> Stage {
        Stage {
            paced: Some(Paced::new(kind, Arc::clone(&self.pace))),
            ..self.stage(name, steps)
        }
    }

    /// Keeps in a folder how fast stages go from now on, after what it says already.
    pub(crate) fn keep_pace(&self, folder: &Path) {
        self.pace.keep_in(folder);
    }

    /// Adds what another folder says of how fast stages went.
    pub(crate) fn add_pace(&self, folder: &Path) {
        self.pace.add(Pace::read(folder));
    }

    /// A bed of so many grains settled in that many steps instead of those planned.
    pub(crate) fn settled(&self, grains: usize, planned: u64, taken: u64) {
        let [planned, taken] = [planned, taken].map(|steps| steps as f64 * grains as f64);
        self.pace.settled(Settled { planned, taken });
    }

    /// How fast stages went.
    pub(crate) fn pace(&self) -> Pace {
        self.pace.pace()
    }

    /// Prints a line that must be seen, above the bars if there are any.
    pub fn warn(&self, text: &str) {
        let text = plain(&format!("{}{text}", self.label));
        if self.bars.is_hidden() {
            let _ = writeln!(std::io::stderr(), "bitgrain: {text}");
        } else {
            let _ = self.bars.println(text);
        }
    }

    /// Prints a line above the bars.
    pub fn line(&self, text: &str) {
        let text = plain(&format!("{}{text}", self.label));
        if !self.bars.is_hidden() {
            let _ = self.bars.println(text);
        } else if self.verbose {
            // A closed standard error must not end a run.
            let _ = writeln!(std::io::stderr(), "{text}");
        }
    }
}

impl Overall<'_> {
    /// A stage took another number of grain-steps than planned.
    pub fn took(&self, planned: u64, others: u64) {
        let old = self
            .total
            .fetch_add(others.wrapping_sub(planned), Ordering::Relaxed);
        self.bar
            .set_length(old.wrapping_add(others).wrapping_sub(planned));
    }

    /// Grain-steps done since it began, and its seconds.
    fn so_far(&self) -> (u64, f64) {
        let done = self.progress.work.done.load(Ordering::Relaxed);
        (
            done.saturating_sub(self.before),
            self.began.elapsed().as_secs_f64(),
        )
    }

    /// A run came to its end.
    pub fn run_ended(&self, failed: bool) {
        self.ended.fetch_add(1, Ordering::Relaxed);
        self.failed
            .fetch_add(usize::from(failed), Ordering::Relaxed);
        self.show();
    }

    fn show(&self) {
        let ended = self.ended.load(Ordering::Relaxed);
        let failed = match self.failed.load(Ordering::Relaxed) {
            0 => String::new(),
            n => format!(", {n} failed"),
        };
        let text = format!("{ended} of {} runs{failed}", self.runs);
        if !self.progress.bars.is_hidden() {
            self.bar.set_message(text);
            return;
        }
        let (now, seconds) = self.so_far();
        let done = self.before + now;
        let total = self.total.load(Ordering::Relaxed);
        let left = total.saturating_sub(done) as f64;
        let minutes = left / now as f64 * seconds / 60.0;
        let eta = match minutes.is_finite() {
            true => format!(", ETA {minutes:.0} min"),
            false => String::new(),
        };
        let percent = 100.0 * done.min(total) as f64 / total as f64;
        self.progress
            .line(&format!("{text}, {percent:.0} % of the work{eta}"));
    }
}

impl Drop for Overall<'_> {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
        if let Ok(mut shown) = self.progress.work.bar.lock() {
            *shown = None;
        }
    }
}

impl Stage {
    /// A stage that draws nothing and is never stopped: for tests and library use.
    pub fn silent() -> Self {
        Self {
            bar: ProgressBar::hidden(),
            name: String::new(),
            began: Instant::now(),
            first: 0,
            lines: None,
            best: 0.0,
            stop: Arc::new(AtomicBool::new(false)),
            work: Arc::default(),
            counted: AtomicU64::new(0),
            paced: None,
        }
    }

    /// Continues the stage at this step: what was done before does not count for the speed.
    pub fn resume(&mut self, step: u64) {
        self.first = step;
        self.counted.store(step, Ordering::Relaxed);
        if let Some(paced) = &self.paced {
            paced.begin();
        }
        self.bar.set_position(step);
        self.bar.reset_eta();
    }

    /// Shows the steps done, their speed and a word on how it goes.
    ///
    /// # Errors
    /// [`Error::Interrupted`] once the command was asked to stop.
    pub fn at(&self, step: u64, grains: usize, message: &str) -> Result<()> {
        self.stop_at(step)?;
        let counted = self.counted.swap(step, Ordering::Relaxed);
        let steps = step.saturating_sub(counted);
        self.work.add(steps * grains as u64);
        if let Some(paced) = &self.paced {
            paced.did(steps, grains, false);
        }
        let done = step.saturating_sub(self.first) as f64;
        let speed = done * grains as f64 / self.began.elapsed().as_secs_f64();
        if self.is_line_due() {
            let all = self.bar.length().unwrap_or(step);
            let minutes = all.saturating_sub(step) as f64 * grains as f64 / speed / 60.0;
            let name = &self.name;
            // A closed standard error must not end a run.
            let _ = writeln!(
                std::io::stderr(),
                "{name}: step {step} of about {all}, ETA {minutes:.0} min, {:.1}M grain-steps/s, {message}",
                1e-6 * speed
            );
        }
        if !self.bar.is_hidden() {
            self.bar.set_position(step);
            self.bar
                .set_message(format!("{:.1}M grain-steps/s, {message}", 1e-6 * speed));
        }
        Ok(())
    }

    /// Checks whether the command was asked to stop before the stage did anything.
    ///
    /// # Errors
    /// As [`Stage::at`].
    pub fn look(&self) -> Result<()> {
        self.stop_at(self.first)
    }

    fn stop_at(&self, step: u64) -> Result<()> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(Error::Interrupted {
                stage: self.name.clone(),
                step,
                saved: false,
            });
        }
        Ok(())
    }

    fn is_line_due(&self) -> bool {
        let Some(mut last) = self.lines.as_ref().and_then(|last| last.lock().ok()) else {
            return false;
        };
        let due = last.elapsed() >= QUIET;
        if due {
            *last = Instant::now();
        }
        due
    }

    /// How far settling is: the fall first, then the kinetic energy, which falls by about a factor
    /// of ten in half a fall's time, then the weight. The bar never goes back.
    ///
    /// # Errors
    /// As [`Stage::at`].
    pub fn settling(
        &mut self,
        sim: &Simulation,
        energy: f64,
        bound: f64,
        carried: f64,
        fall_steps: u64,
    ) -> Result<()> {
        let step = sim.step_count();
        let decades = if energy > bound && bound > 0.0 {
            libm::log10(energy / bound)
        } else {
            0.2
        };
        let quiet = (0.5 * decades * fall_steps as f64) as u64;
        let left = quiet.max(fall_steps.saturating_sub(step));
        let share = step as f64 / (step + left) as f64;
        if share > self.best {
            self.best = share;
        }
        self.bar.set_length((step as f64 / self.best) as u64);
        let message = format!(
            "kinetic energy {energy:.0e} (settled below {bound:.0e}), weight carried {carried:.4}"
        );
        self.at(step, sim.count(), &message)
    }

    /// Ends the stage and returns its seconds.
    pub fn finish(self) -> f64 {
        self.bar.finish_and_clear();
        self.began.elapsed().as_secs_f64()
    }

    /// Name of the stage.
    pub fn name(&self) -> &str {
        &self.name
    }
}
