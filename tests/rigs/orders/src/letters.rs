//! The letters of parts in Loom, which tries every order of what two threads do and every value that a load may see in
//! the memory model: nobody waits for a lock, each letter is whole when it is read, and all come to the end.

use loom::sync::Arc;
use loom::thread;

mod sync {
    pub(super) use loom::sync::atomic::{AtomicU64, Ordering};
    pub(super) use loom::sync::{RwLock, RwLockReadGuard};
}

#[allow(dead_code)]
#[path = "../../../../harness/sim/src/parts/exchange.rs"]
mod exchange;

use exchange::Exchange;

/// Who wrote it, and which of its letters it is: two words that belong together.
#[derive(Default)]
struct Letter(usize, u64);

/// The way of one part: it reads what all wrote, and writes the next letter.
fn go(letters: &Exchange<Letter>, part: usize) {
    for leg in 0..3 {
        while !letters.is_answered(part) {
            thread::yield_now();
        }
        for from in (0..2).filter(|_| leg > 0) {
            let letter = letters.read(part, from);
            assert_eq!((letter.0, letter.1), (from, leg));
        }
        letters.write(part, |letter| {
            // The sheet of the letter before the last one.
            assert!(leg < 2 || (letter.0, letter.1) == (part, leg - 1));
            *letter = Letter(part, leg + 1);
        });
    }
}

/// With three preemptions at most, which is all that such a short way has faults for. Three parts have too many orders;
/// the crew's own test has some of them.
#[test]
fn letters_are_read_whole_in_every_order() {
    let mut model = loom::model::Builder::new();
    model.preemption_bound = Some(3);
    model.check(move || {
        let letters = Arc::new(Exchange::between(2));
        let others = Arc::clone(&letters);
        let other = thread::spawn(move || go(&others, 1));
        go(&letters, 0);
        other.join().expect("no thread panics");
    });
}
