//! A law with other numbers for each pair of materials: any of Kumar 2018, eqs. 1 and 2, or Guillard 2014, eq. A1.

use super::kept::ContactMemory;
use super::law::{
    Law, Materials, NormalForce, NormalState, TangentialForce, TangentialState, Torque,
    TurningState,
};
use crate::math::real::{Real, larger};

/// One law for each pair of materials, all of one kind: `PairLaws<HertzTsuji<f64>>` is Guillard's law with other
/// numbers between grains of glass, between grains of steel, and between one of each and a wooden wall.
///
/// A contact is evaluated by the law of its pair, and by nothing else of the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairLaws<'a, L> {
    laws: &'a [L],
    /// That of material 0 with itself: for pairs that there are not.
    first: L,
    materials: u8,
}

impl<'a, L: Copy> PairLaws<'a, L> {
    /// The laws of so many materials, numbered from 0, pair by pair as [`PairLaws::pairs`] gives them; `None` if there
    /// are not so many laws, or no materials.
    pub fn new(materials: u8, laws: &'a [L]) -> Option<Self> {
        let first = *laws.first()?;
        let fits = materials > 0 && laws.len() == place([materials, materials], materials) as usize;
        fits.then_some(Self {
            laws,
            first,
            materials,
        })
    }

    /// The pairs of so many materials in order: (0, 0), (0, 1), to the last one, then (1, 1) and so on.
    pub fn pairs(materials: u8) -> impl Iterator<Item = Materials> {
        (0..materials).flat_map(move |a| (a..materials).map(move |b| [a, b]))
    }

    /// The law of a pair, in either order; of materials that there are not, one of the others.
    #[inline(always)]
    pub fn of(&self, pair: Materials) -> &L {
        let place = place(pair, self.materials);
        self.laws.get(place as usize).unwrap_or(&self.first)
    }
}

/// The number of a pair among those of so many materials.
#[inline(always)]
fn place([a, b]: Materials, materials: u8) -> u32 {
    let [a, b, count] = [a, b, materials].map(u32::from);
    let (low, high) = if a < b { (a, b) } else { (b, a) };
    // Rows of the lower material, each shorter by one.
    low.wrapping_mul((count + count).wrapping_sub(low + 1)) / 2 + high
}

impl<R: Real, L: Law<R>> Law<R> for PairLaws<'_, L> {
    const KNOWS_MATERIALS: bool = true;
    const MEMORY: usize = L::MEMORY;
    const ACTS_APART: bool = L::ACTS_APART;
    const TURNS: bool = L::TURNS;

    fn materials(&self) -> usize {
        usize::from(self.materials)
    }

    fn reach(&self) -> R {
        let reaches = self.laws.iter().map(Law::reach);
        reaches.fold(R::ZERO, larger)
    }

    fn stiffness(&self, materials: Materials) -> Option<[R; 2]> {
        self.of(materials).stiffness(materials)
    }

    #[inline(always)]
    fn acts(&self, contact: &NormalState<R>) -> bool {
        self.of(contact.materials).acts(contact)
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
        self.of(state.contact.materials)
            .tangential_force(normal, state)
    }

    #[inline(always)]
    fn torque(&self, normal: &NormalForce<R>, state: &TurningState<R>) -> Torque<R> {
        self.of(state.contact.materials).torque(normal, state)
    }

    /// That of the first pair: all laws are of one kind.
    #[inline(always)]
    fn seen_by_partner(&self, memory: ContactMemory<R>) -> ContactMemory<R> {
        self.first.seen_by_partner(memory)
    }
}
