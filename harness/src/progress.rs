//! Progress: one bar a stage with its ETA, on a terminal; elsewhere one line as a stage ends.

use std::io::Write;
use std::time::Instant;

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

/// All bars of a command.
pub struct Progress {
    bars: MultiProgress,
}

/// One stage under way. Dropping it removes its bar.
pub struct Stage {
    bar: ProgressBar,
    name: String,
    began: Instant,
    /// Largest share of a settling shown so far.
    best: f64,
}

impl Progress {
    /// Bars on standard error; nothing is drawn where that is no terminal.
    pub fn new() -> Self {
        Self {
            bars: MultiProgress::new(),
        }
    }

    /// Begins a stage of about `steps` steps.
    pub fn stage(&self, name: &str, steps: u64) -> Stage {
        let bar = self.bars.add(ProgressBar::new(steps));
        let look = "{prefix:<22} {bar:30} {percent:>3}%  ETA {eta:<5} {msg}";
        if let Ok(style) = ProgressStyle::with_template(look) {
            bar.set_style(style);
        }
        bar.set_prefix(name.to_string());
        Stage {
            bar,
            name: name.to_string(),
            began: Instant::now(),
            best: 0.0,
        }
    }

    /// Prints a line above the bars.
    pub fn line(&self, text: &str) {
        if self.bars.is_hidden() {
            // A closed standard error must not end a run.
            let _ = writeln!(std::io::stderr(), "{text}");
        } else {
            let _ = self.bars.println(text);
        }
    }
}

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Stage {
    /// A stage that draws nothing: for tests and library use.
    pub fn silent() -> Self {
        Self {
            bar: ProgressBar::hidden(),
            name: String::new(),
            began: Instant::now(),
            best: 0.0,
        }
    }

    /// Steps done, with a word on how it goes.
    pub fn at(&self, step: u64, message: String) {
        self.bar.set_position(step);
        self.bar.set_message(message);
    }

    /// How far settling is: the fall first, then the kinetic energy, which falls by about a factor
    /// of ten in half a fall's time, then the weight. The bar never goes back.
    pub fn settling(&mut self, step: u64, energy: f64, bound: f64, carried: f64, fall_steps: u64) {
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
        self.at(step, message);
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
