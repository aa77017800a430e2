//! A law with other numbers for each pair of materials.

use super::law::{Law, Materials, NormalForce, NormalState, TangentialForce, TangentialState};
use crate::math::real::Real;

/// One law for each pair of at most `N` materials, all of one kind: `PairLaws<HertzTsuji<f64>, 3>` is Guillard's law
/// with other numbers between grains of glass, between grains of steel, and between one of each and a wooden wall.
///
/// A contact is evaluated by the law of its pair, and by nothing else of the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairLaws<L, const N: usize> {
    /// Both halves of a symmetric table.
    laws: [[L; N]; N],
    materials: u8,
}

impl<L: Copy, const N: usize> PairLaws<L, N> {
    /// So many materials, at least 1 and at most `N`, with this law for every pair; `None` of another number.
    pub fn new(materials: u8, law: L) -> Option<Self> {
        (1..=N).contains(&usize::from(materials)).then_some(Self {
            laws: [[law; N]; N],
            materials,
        })
    }

    /// How many materials there are, numbered from 0.
    pub fn count(&self) -> u8 {
        self.materials
    }

    /// Sets the law of a pair, in either order; `None` if there is no such pair.
    pub fn set(&mut self, [a, b]: Materials, law: L) -> Option<()> {
        let known = a < self.materials && b < self.materials;
        for (row, column) in [(a, b), (b, a)] {
            let row = self.laws.get_mut(usize::from(row)).filter(|_| known)?;
            *row.get_mut(usize::from(column))? = law;
        }
        Some(())
    }

    /// The law of a pair. A material beyond the last that there is room for counts as that one.
    #[inline(always)]
    pub fn of(&self, [a, b]: Materials) -> &L {
        // A table of which the rows have at least one entry: so that no place is beyond it.
        let last = const {
            assert!(N > 0 && N <= 256, "from 1 to 256 materials");
            N - 1
        };
        let place = |material: u8| {
            let material = usize::from(material);
            if material < last { material } else { last }
        };
        &self.laws[place(a)][place(b)]
    }
}

impl<R: Real, L: Law<R>, const N: usize> Law<R> for PairLaws<L, N> {
    const KNOWS_MATERIALS: bool = true;

    fn materials(&self) -> usize {
        usize::from(self.materials)
    }

    #[inline(always)]
    fn normal_force(&self, contact: &NormalState<R>) -> NormalForce<R> {
        self.of(contact.materials).normal_force(contact)
    }

    #[inline(always)]
    fn tangential_force(
        &self,
        normal: &NormalForce<R>,
        state: &TangentialState<R>,
    ) -> TangentialForce<R> {
        self.of(state.materials).tangential_force(normal, state)
    }
}
