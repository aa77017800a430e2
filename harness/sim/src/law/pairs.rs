//! The laws of all pairs of materials, owned.

use bitgrain_kernel::contact::{PairLaws, Rolling, RollingResistance};
use serde::{Deserialize, Serialize};

/// The laws of all pairs of so many materials, in the order of [`PairLaws::pairs`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    try_from = "Spelled<L>",
    bound(deserialize = "L: Copy + Deserialize<'de>")
)]
pub struct Pairs<L> {
    materials: u8,
    laws: Vec<L>,
}

/// The same as a file spells it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Spelled<L> {
    materials: u8,
    laws: Vec<L>,
}

impl<L: Copy> TryFrom<Spelled<L>> for Pairs<L> {
    type Error = &'static str;

    fn try_from(Spelled { materials, laws }: Spelled<L>) -> Result<Self, &'static str> {
        Self::new(materials, laws).ok_or("not one law for each pair of materials")
    }
}

impl<L: Copy> Pairs<L> {
    /// So many materials with these laws; `None` if there is not one for each pair.
    pub fn new(materials: u8, laws: Vec<L>) -> Option<Self> {
        PairLaws::new(materials, &laws)?;
        Some(Self { materials, laws })
    }

    /// The same laws with resistance to rolling, pair by pair.
    ///
    /// # Panics
    /// If there is not one for each pair.
    pub fn rolling(&self, resistances: &[RollingResistance<f64>]) -> Pairs<Rolling<f64, L>> {
        assert_eq!(resistances.len(), self.laws.len(), "one for each pair");
        let both = self.laws.iter().zip(resistances);
        let laws = both.map(|(law, resistance)| Rolling {
            law: *law,
            resistance: *resistance,
        });
        Pairs {
            materials: self.materials,
            laws: laws.collect(),
        }
    }

    /// How many materials.
    pub fn materials(&self) -> u8 {
        self.materials
    }

    /// The law of each pair, in order.
    pub fn laws(&self) -> &[L] {
        &self.laws
    }

    /// The law that contacts are evaluated by.
    ///
    /// # Panics
    /// Never: it was checked as it was made.
    pub fn lend(&self) -> PairLaws<'_, L> {
        PairLaws::new(self.materials, &self.laws).expect("one law for each pair")
    }
}
