//! Words that a law keeps of contacts, in columns: one for each word, as long as the list of the contacts, and none for
//! laws without words, which need no storage for them.

use crate::contact::kept::{ContactMemory, MEMORY_MAX};
use crate::math::real::Real;
use crate::math::rows::{get_or_default, set};

/// Columns of words; those beyond the words that there is storage for are empty.
pub type MemoryColumns<'a, R> = [&'a mut [R]; MEMORY_MAX];

/// Columns of as many words as there are parts, each as long as a list.
pub fn memory_columns<'a, R>(parts: impl IntoIterator<Item = &'a mut [R]>) -> MemoryColumns<'a, R> {
    let mut columns = [(); MEMORY_MAX].map(|()| -> &mut [R] { &mut [] });
    for (column, part) in columns.iter_mut().zip(parts) {
        *column = part;
    }
    columns
}

/// How many words there is storage for.
pub(crate) fn words<R>(columns: &MemoryColumns<'_, R>) -> usize {
    let used = columns.iter().take_while(|word| !word.is_empty());
    used.count()
}

/// Whether there is storage for so many words of each of these contacts.
#[inline(always)]
pub(crate) fn has_room<R>(columns: &MemoryColumns<'_, R>, words: usize, contacts: usize) -> bool {
    let mut used = columns.iter().take(words);
    used.all(|word| word.len() >= contacts)
}

/// Whether the first columns are so long and the others empty.
pub(crate) fn is_whole<R>(columns: &MemoryColumns<'_, R>, length: usize) -> bool {
    let used = words(columns);
    let mut first = columns.iter().take(used);
    let mut later = columns.iter().skip(used);
    first.all(|word| word.len() == length) && later.all(|word| word.is_empty())
}

/// The words of a contact; zeros where there is no storage.
#[inline(always)]
pub(crate) fn taken<R: Real>(columns: &MemoryColumns<'_, R>, entry: usize) -> ContactMemory<R> {
    columns.each_ref().map(|word| get_or_default(word, entry))
}

/// Writes the words of a contact as far as there is storage.
#[inline(always)]
pub(crate) fn put<R: Real>(
    columns: &mut MemoryColumns<'_, R>,
    entry: usize,
    memory: ContactMemory<R>,
) {
    for (column, word) in columns.iter_mut().zip(memory) {
        set(column, entry, word);
    }
}
