//! What parts tell each other: each writes a letter at the end of a leg of its way, and goes on as soon as all others
//! have written theirs.
//!
//! Letters are numbered. A part has two sheets, for even and odd numbers: it writes the next letter on the sheet of the
//! one before the last, which everyone has read, since everyone has written the last one after reading it. So no lock
//! is ever waited for; the locks are there so that the compiler knows it.

use super::sync::{AtomicU64, Ordering, RwLock, RwLockReadGuard};

/// The letters of all parts.
pub(super) struct Exchange<T> {
    desks: Vec<Desk<T>>,
}

/// The letters of one part.
struct Desk<T> {
    /// The last letter that is written.
    number: Apart<AtomicU64>,
    sheets: Apart<[RwLock<T>; 2]>,
}

/// On cache lines of its own: others look at a number all the time, while letters are written.
#[repr(align(128))]
struct Apart<T>(T);

/// Which sheet a letter is on.
fn sheet(number: u64) -> usize {
    (number & 1) as usize
}

impl<T: Default> Exchange<T> {
    /// Between so many parts, none of which has written.
    pub fn between(parts: usize) -> Self {
        let desk = || Desk {
            number: Apart(AtomicU64::new(0)),
            sheets: Apart([RwLock::new(T::default()), RwLock::new(T::default())]),
        };
        Self {
            desks: (0..parts).map(|_| desk()).collect(),
        }
    }
}

impl<T> Exchange<T> {
    /// The number of the last letter of a part.
    pub fn number(&self, part: usize) -> u64 {
        self.desks[part].number.0.load(Ordering::Acquire)
    }

    /// Whether all others have written as many letters as a part has.
    pub fn is_answered(&self, part: usize) -> bool {
        let number = self.number(part);
        (0..self.desks.len()).all(|other| self.number(other) >= number)
    }

    /// A part that has written fewer letters than this one.
    pub fn late(&self, part: usize) -> impl Iterator<Item = usize> + '_ {
        let number = self.number(part);
        (0..self.desks.len()).filter(move |other| self.number(*other) < number)
    }

    /// Writes the next letter of a part, on a sheet with what was written there before. Only who drives the part may,
    /// after its last letter was answered.
    pub fn write(&self, part: usize, write: impl FnOnce(&mut T)) {
        let desk = &self.desks[part];
        let next = desk.number.0.load(Ordering::Relaxed) + 1;
        let letter = desk.sheets.0[sheet(next)].try_write();
        write(&mut *letter.expect("everyone has read what was on it"));
        desk.number.0.store(next, Ordering::Release);
    }

    /// The letter that a part wrote as the answer to the last one of `reader`.
    pub fn read(&self, reader: usize, part: usize) -> RwLockReadGuard<'_, T> {
        let letter = self.desks[part].sheets.0[sheet(self.number(reader))].try_read();
        letter.expect("it is written only once everyone has read it")
    }
}
