//! The other threads of a pool, who help if they have time.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use super::crew::Crew;

/// Threads of a pool that were asked to help, for as long as a simulation lives.
#[derive(Default)]
pub(super) struct Helpers {
    crew: Mutex<Option<Arc<Crew>>>,
    /// Those that have not come yet.
    asked: AtomicUsize,
}

impl Helpers {
    /// Asks the other threads of the pool that this is called in to help a crew.
    pub fn ask(self: &Arc<Self>, crew: &Arc<Crew>) {
        *self.crew.lock().unwrap_or_else(PoisonError::into_inner) = Some(Arc::clone(crew));
        let wanted = crew.count().saturating_sub(1);
        // Threads that are busy elsewhere come late or not at all: no more are ever asked than can be used.
        while self.asked.load(Ordering::Relaxed) < wanted {
            self.asked.fetch_add(1, Ordering::Relaxed);
            let helpers = Arc::clone(self);
            rayon::spawn(move || helpers.come());
        }
    }

    fn come(&self) {
        self.asked.fetch_sub(1, Ordering::Relaxed);
        let crew = {
            let crew = self.crew.lock().unwrap_or_else(PoisonError::into_inner);
            crew.clone()
        };
        if let Some(crew) = crew {
            crew.help(rayon::current_thread_index().unwrap_or_default());
        }
    }

    /// Lets those that come later find nothing to do.
    pub fn dismiss(&self) {
        *self.crew.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }
}
