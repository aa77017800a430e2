//! Who drives the parts: any thread, one leg at a time, so that nothing depends on a certain thread.
//!
//! A thread keeps a part as long as it gets on, and looks at the letters of the others while it waits. If a part that
//! it waits for is not driven by anyone, it does that leg itself: so one thread alone can bring all parts to their end,
//! however many others were asked, and whether or not they come. For a thread that stalls within a leg the others wait.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::PoisonError;

use super::exchange::Exchange;
use super::letter::Letter;
use super::part::{Errand, Part};
use super::post::Post;
use super::sync::{
    AtomicBool, AtomicUsize, Bell, HELP, Mutex, MutexGuard, Ordering, PATIENCE, do_other_work, nap,
    pause,
};

/// The parts, and what they tell each other.
pub(super) struct Crew {
    /// Of the parts of this process, the first of which has the number `first`.
    seats: Vec<Seat>,
    first: usize,
    letters: Exchange<Letter>,
    /// Where letters go to and come from other processes.
    post: Option<Post>,
    /// Parts that have ended.
    ended: AtomicUsize,
    /// Whether a thread panicked.
    dead: AtomicBool,
    panic: Mutex<Option<Box<dyn Any + Send>>>,
    /// Rung when a letter was written.
    bell: Bell,
}

struct Seat {
    // In a place of its own: others look at the lock while its holder works on the part.
    part: Mutex<Box<Part>>,
    ended: AtomicBool,
}

impl Crew {
    /// Of these parts of so many, the first of which has this number; the others, if any, are elsewhere.
    pub fn new(parts: Vec<Part>, first: usize, count: usize, post: Option<Post>) -> Self {
        let seat = |part| Seat {
            part: Mutex::new(Box::new(part)),
            ended: AtomicBool::new(true),
        };
        Self {
            letters: Exchange::between(count),
            first,
            post,
            ended: AtomicUsize::new(parts.len()),
            seats: parts.into_iter().map(seat).collect(),
            dead: AtomicBool::new(false),
            panic: Mutex::new(None),
            bell: Bell::default(),
        }
    }

    /// How many parts it has.
    pub fn count(&self) -> usize {
        self.seats.len()
    }

    /// All parts, between two errands.
    pub fn parts(&self) -> Vec<MutexGuard<'_, Box<Part>>> {
        let part = |seat| -> MutexGuard<'_, Box<Part>> {
            let seat: &Seat = seat;
            seat.part.lock().unwrap_or_else(PoisonError::into_inner)
        };
        self.seats.iter().map(part).collect()
    }

    /// Sends all parts off, before a step or before a search; then [`Crew::work`] brings them to their end.
    pub fn depart(&self, errand: &Errand, searches: bool) {
        self.ended.store(0, Ordering::SeqCst);
        for (part, seat) in self.parts().iter_mut().zip(&self.seats) {
            part.depart(errand, searches);
            seat.ended.store(false, Ordering::SeqCst);
        }
    }

    /// Brings all parts to their end, with whoever else is at work.
    ///
    /// # Panics
    /// If another thread panicked at it, with what that one said.
    pub fn work(&self, first: usize) {
        self.take_part(first, false);
        if self.dead.load(Ordering::SeqCst) {
            let mut panic = self.panic.lock().unwrap_or_else(PoisonError::into_inner);
            match panic.take() {
                Some(panic) => resume_unwind(panic),
                None => panic!("a thread of this simulation panicked before"),
            }
        }
    }

    /// Helps with the parts as long as there is something to do; a panic is kept for the thread that all began with.
    pub fn help(&self, first: usize) {
        self.take_part(first, true);
    }

    fn take_part(&self, first: usize, helps: bool) {
        let done = catch_unwind(AssertUnwindSafe(|| self.drive_parts(first, helps)));
        if let Err(panic) = done {
            let mut kept = self.panic.lock().unwrap_or_else(PoisonError::into_inner);
            kept.get_or_insert(panic);
            self.dead.store(true, Ordering::SeqCst);
            self.bell.ring_for_all();
        }
    }

    fn is_over(&self) -> bool {
        self.ended.load(Ordering::Acquire) == self.seats.len() || self.dead.load(Ordering::Acquire)
    }

    fn drive_parts(&self, first: usize, helps: bool) {
        let count = self.seats.len();
        let mut idle = 0;
        while !self.is_over() {
            let mut others = (0..count).map(|k| self.first + (first + k) % count);
            if let Some((number, part)) = others.find_map(|number| self.claim(number)) {
                idle = 0;
                self.drive(number, part);
                self.rest();
                continue;
            }
            self.look();
            idle += 1;
            if idle < self.looks() {
                pause(idle);
            } else if !helps || !do_other_work() {
                self.rest();
            }
        }
    }

    /// Lets go of the core until there may be something to do.
    fn rest(&self) {
        if self.post.is_some() {
            // Letters of other processes ring no bell.
            if !self.is_over() {
                nap();
            }
            return;
        }
        let numbers = || self.first..self.first + self.seats.len();
        let ready = |number| self.letters.is_answered(number) && self.claim(number).is_some();
        self.bell.wait(|| self.is_over() || numbers().any(ready));
    }

    /// A part that has not ended and that nobody drives.
    fn claim(&self, number: usize) -> Option<(usize, MutexGuard<'_, Box<Part>>)> {
        let seat = self.seats.get(number.checked_sub(self.first)?)?;
        // A part whose driver panicked stays where it is.
        let part = seat.part.try_lock().ok()?;
        (!seat.ended.load(Ordering::Acquire)).then_some((number, part))
    }

    /// Drives a part until it ends, or has to wait too long.
    fn drive(&self, number: usize, mut part: MutexGuard<'_, Box<Part>>) {
        let mut waited = 0;
        while !self.is_over() {
            if self.letters.is_answered(number) {
                if self.advance(number, &mut part) {
                    return;
                }
                waited = 0;
                continue;
            }
            self.look();
            waited += 1;
            if waited > self.looks() {
                self.expect_answers(number);
                return;
            }
            pause(waited);
            if waited % HELP == 0 {
                self.help_late(number);
            }
        }
    }

    /// Goes a leg of a part that this one waits for, if nobody drives it.
    fn help_late(&self, number: usize) {
        let mut late = self.letters.late(number);
        if let Some((late, mut part)) = late.find_map(|late| self.claim(late))
            && self.letters.is_answered(late)
        {
            self.advance(late, &mut part);
        }
    }

    /// Looks in vain after which a thread lets go of a part.
    fn looks(&self) -> u32 {
        self.post.as_ref().map_or(PATIENCE, |post| post.looks)
    }

    /// Takes in letters from elsewhere.
    fn look(&self) {
        if let Some(post) = &self.post {
            post.look(&self.letters);
        }
    }

    /// Ends everything if another process has been silent for too long.
    fn expect_answers(&self, number: usize) {
        if let Some(post) = &self.post {
            post.expect_answers(number, &self.letters);
        }
    }

    /// A leg of a part; whether it has ended.
    fn advance(&self, number: usize, part: &mut Part) -> bool {
        let before = self.letters.number(number);
        part.advance(&self.letters);
        if let Some(post) = &self.post
            && self.letters.number(number) > before
        {
            post.send(number, &self.letters);
        }
        let ended = part.end().is_some();
        if ended {
            self.seats[number - self.first]
                .ended
                .store(true, Ordering::Release);
            if self.ended.fetch_add(1, Ordering::AcqRel) + 1 == self.seats.len() {
                self.bell.ring_for_all();
            }
        }
        self.bell.ring();
        ended
    }
}
