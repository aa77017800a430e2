//! What a law keeps of a contact from step to step.

use crate::math::real::Real;
use crate::math::vec3::Vec3;

/// So many words a law can keep of a contact beside its tangential spring.
pub const MEMORY_MAX: usize = 8;

/// The words that a law keeps of a contact beside its tangential spring, in units of its own; those beyond
/// [`Law::MEMORY`](crate::contact::Law::MEMORY) are zero. All are zero as a contact begins.
pub type ContactMemory<R> = [R; MEMORY_MAX];

/// What a law keeps of a contact from step to step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kept<R> {
    /// Tangential spring, from the side of the grain (length).
    pub spring: Vec3<R>,
    /// The law's own words.
    pub memory: ContactMemory<R>,
}

impl<R: Real> Kept<R> {
    /// As a contact begins.
    pub const NOTHING: Self = Self {
        spring: [R::ZERO; 3],
        memory: [R::ZERO; MEMORY_MAX],
    };

    /// How many words there are up to the last one that is not +0.
    pub(crate) fn words(&self) -> usize {
        let last = self.memory.iter().rposition(is_used);
        last.map_or(0, |last| last + 1)
    }

    /// Whether there is anything else than +0.
    pub fn is_any(&self) -> bool {
        self.words() > 0 || self.spring.iter().any(is_used)
    }
}

/// Whether a word is another one than +0.
fn is_used<R: Real>(word: &R) -> bool {
    word.to_words() != R::ZERO.to_words()
}
