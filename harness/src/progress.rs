//! Progress: one bar a stage with its ETA, and a line as a stage ends, on a terminal; elsewhere
//! nothing, or the lines alone where they were asked for. And the wish to stop, which every stage
//! looks at.

use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

use crate::error::{Error, Result};
use crate::sim::Sim;

/// Time between the lines of a stage that has no bar.
const QUIET: Duration = Duration::from_secs(60);

/// All bars of a command.
pub struct Progress {
    bars: MultiProgress,
    /// Whether lines are printed where there is no terminal.
    verbose: bool,
    stop: Arc<AtomicBool>,
}

/// One stage under way. Dropping it removes its bar.
pub struct Stage {
    bar: ProgressBar,
    name: String,
    began: Instant,
    /// Step at which it was taken up.
    first: u64,
    /// When its last line was printed, where lines are printed in place of a bar.
    lines: Option<Mutex<Instant>>,
    /// Largest share of a settling shown so far.
    best: f64,
    stop: Arc<AtomicBool>,
}

impl Progress {
    /// Bars and lines on standard error where that is a terminal; elsewhere only lines, and those
    /// only where `verbose`.
    pub fn new(verbose: bool) -> Self {
        Self {
            bars: MultiProgress::new(),
            verbose,
            stop: Arc::new(AtomicBool::new(false)),
        }
    }

    /// The flag that stops every stage once it is set, as by Ctrl-C.
    pub fn stop_flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }

    /// Begins a stage of about `steps` steps.
    pub fn stage(&self, name: &str, steps: u64) -> Stage {
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
        }
    }

    /// Prints a line that must be seen, above the bars if there are any.
    pub fn warn(&self, text: &str) {
        if self.bars.is_hidden() {
            let _ = writeln!(std::io::stderr(), "bitgrain: {text}");
        } else {
            let _ = self.bars.println(text);
        }
    }

    /// Prints a line above the bars.
    pub fn line(&self, text: &str) {
        if !self.bars.is_hidden() {
            let _ = self.bars.println(text);
        } else if self.verbose {
            // A closed standard error must not end a run.
            let _ = writeln!(std::io::stderr(), "{text}");
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
        }
    }

    /// Takes the stage up at this step: what was done before counts for no speed.
    pub fn resume(&mut self, step: u64) {
        self.first = step;
        self.bar.set_position(step);
        self.bar.reset_eta();
    }

    /// Shows the steps done, their speed and a word on how it goes.
    ///
    /// # Errors
    /// [`Error::Interrupted`] once the command was asked to stop.
    pub fn at(&self, step: u64, grains: usize, message: &str) -> Result<()> {
        self.stop_at(step)?;
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

    /// Looks whether the command was asked to stop before the stage did anything.
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
        sim: &Sim,
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

    /// What the stage is called.
    pub fn name(&self) -> &str {
        &self.name
    }
}
