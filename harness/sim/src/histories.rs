//! Contacts with what their law keeps of them, as they are saved, sent and put back.

use bitgrain_kernel::contact::ContactMemory;
use bitgrain_kernel::{ContactHistory, KeptContact};
use serde::{Deserialize, Serialize};

/// Contacts in order. Words of the law take memory only if there are any.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Histories {
    contacts: Vec<ContactHistory<f64>>,
    /// Of each contact; empty as long as all are zero.
    memory: Vec<ContactMemory<f64>>,
}

impl Histories {
    /// How many contacts there are.
    pub fn len(&self) -> usize {
        self.contacts.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.contacts.is_empty()
    }

    /// Adds a contact at the end.
    pub fn push(&mut self, contact: KeptContact<f64>) {
        let zeros = KeptContact::from(contact.history).memory;
        let is_used = contact.memory.map(f64::to_bits) != zeros.map(f64::to_bits);
        if is_used && self.memory.is_empty() {
            self.memory.resize(self.contacts.len(), zeros);
        }
        self.contacts.push(contact.history);
        if is_used || !self.memory.is_empty() {
            self.memory.push(contact.memory);
        }
    }

    /// The contacts with their words.
    pub fn iter(&self) -> impl Iterator<Item = KeptContact<f64>> + '_ {
        let memory = self.memory.iter().map(Some).chain(std::iter::repeat(None));
        self.contacts.iter().zip(memory).map(|(history, memory)| {
            let empty = KeptContact::from(*history);
            KeptContact {
                memory: memory.copied().unwrap_or(empty.memory),
                ..empty
            }
        })
    }

    /// The contacts without words of the law.
    pub fn contacts(&self) -> &[ContactHistory<f64>] {
        &self.contacts
    }
}

impl FromIterator<KeptContact<f64>> for Histories {
    fn from_iter<I: IntoIterator<Item = KeptContact<f64>>>(contacts: I) -> Self {
        let mut all = Self::default();
        contacts.into_iter().for_each(|contact| all.push(contact));
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_stay_with_their_contacts() {
        let contact = |i: u32, words: f64| KeptContact {
            history: ContactHistory::Pair {
                i,
                j: i + 1,
                spring: [f64::from(i); 3],
            },
            memory: [words, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        };
        for words in [[0.0; 4], [0.0, 0.0, -0.0, 3.0], [1.0, 0.0, 2.0, 0.0]] {
            let all: Vec<_> = (0..4).map(|i| contact(i, words[i as usize])).collect();
            let histories: Histories = all.iter().copied().collect();
            let bits = |all: &[KeptContact<f64>]| -> Vec<_> {
                all.iter()
                    .map(|c| (c.history, c.memory.map(f64::to_bits)))
                    .collect()
            };
            let back: Vec<_> = histories.iter().collect();
            assert_eq!(bits(&back), bits(&all));
            assert_eq!((histories.len(), histories.is_empty()), (4, false));
            assert_eq!(
                histories.memory.is_empty(),
                words == [0.0; 4] && !words[2].is_sign_negative()
            );
        }
    }
}
