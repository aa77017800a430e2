//! A simulation as bytes that the C library's `bg_save` writes too: the contact law and its BLAKE3 hash, then the
//! kernel's saved world.

use std::sync::Arc;

use bitgrain_kernel::contact::{HertzHistory, HertzTsuji};
use bitgrain_kernel::{Error as KernelError, Saved, save, save_size};

use crate::law::AnyLaw;
use crate::mesh::{Triangle, restored};
use crate::simulation::Simulation;

/// How the bytes begin: a name and the format.
const MAGIC: &[u8; 8] = b"bglw\x01\0\0\0";

/// Bytes of the law: the beginning, the number of its kind, five numbers.
const LAW: usize = 8 + 4 + 5 * 8;

/// Bytes of a hash.
const HASH: usize = 32;

/// Numbers of the kinds.
const HISTORY: u32 = 1;
const TSUJI: u32 = 2;

impl Simulation {
    /// A simulation at rest as bytes. [`Simulation::load`] goes on from there with the same bits, on any machine.
    ///
    /// # Errors
    /// [`KernelError::NotStarted`], [`KernelError::GrainsLeaving`], [`KernelError::Edited`].
    pub fn save(&mut self) -> Result<Vec<u8>, KernelError> {
        let mut bytes = law_bytes(self.law).to_vec();
        bytes.extend_from_slice(blake3::hash(&bytes).as_bytes());
        let mut world = self.world();
        bytes.resize(LAW + HASH + save_size(&world), 0);
        save(&mut world, &mut bytes[LAW + HASH..])?;
        Ok(bytes)
    }

    /// The simulation that [`Simulation::save`], or C's `bg_save`, wrote. Skin and reach are those of
    /// [`Simulation::choose_skin`]. Bytes behind the saved world are not looked at.
    ///
    /// # Errors
    /// [`KernelError::BadSave`] of bytes that are not as they were written; [`KernelError::OtherVersion`]; of forged
    /// bytes whatever is wrong with the world in them.
    pub fn load(bytes: &[u8]) -> Result<Self, KernelError> {
        let (law, rest) = bytes.split_at_checked(LAW).ok_or(KernelError::BadSave)?;
        let (hash, rest) = rest.split_at_checked(HASH).ok_or(KernelError::BadSave)?;
        if blake3::hash(law).as_bytes() != hash {
            return Err(KernelError::BadSave);
        }
        let law = law_in(law)?;
        let saved = Saved::open(rest)?;
        let groups = saved.groups().collect();
        let obstacles = saved.obstacles().collect();
        let mut sim = Self::new(law, saved.domain(), saved.dt(), groups, &[], obstacles);
        let corners: Vec<Triangle> = saved.facets().collect();
        sim.facets = Arc::new(restored(&corners, &sim.obstacles));
        sim.policy = saved.policy();
        sim.set_rows(saved.count());
        saved.fill(&mut sim.world());
        sim.fit_storage();
        sim.choose_skin();
        sim.check_crowds()?;
        sim.grow_while_full(|sim| saved.resume(&mut sim.world()))?;
        Ok(sim)
    }
}

fn law_bytes(law: AnyLaw) -> [u8; LAW] {
    let (kind, numbers) = match law {
        AnyLaw::HertzHistory(l) => (HISTORY, [l.kn, l.kt, l.gamma_n, l.gamma_t, l.mu]),
        AnyLaw::HertzTsuji(l) => (TSUJI, [l.kn, l.kt, l.cn, l.ct, l.mu]),
    };
    let mut bytes = [0; LAW];
    bytes[..8].copy_from_slice(MAGIC);
    bytes[8..12].copy_from_slice(&kind.to_le_bytes());
    for (to, number) in bytes[12..].as_chunks_mut().0.iter_mut().zip(numbers) {
        *to = number.to_le_bytes();
    }
    bytes
}

/// The law in its bytes.
fn law_in(bytes: &[u8]) -> Result<AnyLaw, KernelError> {
    let numbers = bytes[12..].as_chunks().0;
    let [kn, kt, gamma_n, gamma_t, mu] = *numbers else {
        return Err(KernelError::BadSave);
    };
    let numbers = [kn, kt, gamma_n, gamma_t, mu].map(f64::from_le_bytes);
    if numbers[0] <= 0.0 || !numbers.iter().all(|x| *x >= 0.0 && x.is_finite()) {
        return Err(KernelError::BadSave);
    }
    let [kn, kt, gamma_n, gamma_t, mu] = numbers;
    let kind = bytes[8..]
        .first_chunk()
        .map(|kind| u32::from_le_bytes(*kind));
    match (bytes.starts_with(MAGIC), kind) {
        (false, _) => Err(KernelError::OtherVersion),
        (true, Some(HISTORY)) => Ok(AnyLaw::HertzHistory(HertzHistory {
            kn,
            kt,
            gamma_n,
            gamma_t,
            mu,
        })),
        (true, Some(TSUJI)) => {
            let (cn, ct) = (gamma_n, gamma_t);
            Ok(AnyLaw::HertzTsuji(HertzTsuji { kn, kt, cn, ct, mu }))
        }
        (true, _) => Err(KernelError::BadSave),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bitgrain_kernel::{Domain, Group, Obstacle};

    use crate::simulation::Grain;

    /// Grains in a heap on a floor of a box that is periodic along x and y, some of them in contact after 6000 steps.
    fn heap(law: AnyLaw) -> Simulation {
        let domain = Domain::new([0.0; 3], [4.0, 4.0, 20.0], [true, true, false]).unwrap();
        let grain = |k: u32| Grain {
            id: 2 * k + 1,
            group: (k == 0).into(),
            diameter: 0.9 + 0.02 * f64::from(k % 5),
            density: 1.0,
            position: [
                0.6 + 1.02 * f64::from(k % 3),
                0.6 + 1.02 * f64::from(k / 3 % 3),
                0.5 + 1.01 * f64::from(k / 9),
            ],
            velocity: [1.0, 0.1, 0.0],
            spin: [0.0, 0.2, 0.0],
        };
        let grains: Vec<Grain> = (0..40).map(grain).collect();
        let groups = vec![Group::free([0.0, 0.0, -1.0]), Group::frozen()];
        let floor = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
        let ball = Obstacle::sphere([2.0, 2.0, 9.0], 1.0);
        let mut sim = Simulation::new(law, domain, 1e-3, groups, &grains, vec![floor, ball]);
        sim.policy.takes_out = true;
        sim.start().unwrap();
        sim.steps_losing(6000, |_| ()).unwrap();
        sim
    }

    fn laws() -> [AnyLaw; 2] {
        let history = HertzHistory {
            kn: 2e4,
            kt: 2.45e4,
            gamma_n: 500.0,
            gamma_t: 400.0,
            mu: 0.5,
        };
        [
            AnyLaw::HertzHistory(history),
            AnyLaw::HertzTsuji(HertzTsuji::new(2e4, 0.3, 0.3, 0.5)),
        ]
    }

    #[test]
    fn a_simulation_goes_on_from_its_bytes_with_the_same_bits() {
        for law in laws() {
            let mut sim = heap(law);
            assert!(sim.contact_histories().len() > 10);
            let bytes = sim.save().unwrap();
            let mut again = Simulation::load(&bytes).unwrap();
            assert_eq!(
                (again.law, again.policy, again.dt),
                (sim.law, sim.policy, sim.dt)
            );
            assert_eq!(again.save().unwrap(), bytes);
            for _ in 0..3 {
                assert_eq!(again.digest().unwrap(), sim.digest().unwrap());
                assert_eq!(again.step_count(), sim.step_count());
                sim.steps_losing(100, |_| ()).unwrap();
                again.steps_losing(100, |_| ()).unwrap();
            }
        }
    }

    #[test]
    fn changed_and_cut_bytes_are_refused() {
        let bytes = heap(laws()[0]).save().unwrap();
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 1 << (at % 8);
            assert!(Simulation::load(&changed).is_err(), "byte {at}");
        }
        for length in [0, LAW, LAW + HASH, bytes.len() / 2, bytes.len() - 1] {
            let cut = Simulation::load(&bytes[..length]);
            assert_eq!(cut.err(), Some(KernelError::BadSave), "{length}");
        }
    }

    #[test]
    fn laws_of_another_kind_or_format_or_without_sense_are_refused() {
        let bytes = heap(laws()[1]).save().unwrap();
        let with = |at: usize, byte: u8| {
            let mut changed = bytes.clone();
            changed[at] = byte;
            let hash = blake3::hash(&changed[..LAW]);
            changed[LAW..LAW + HASH].copy_from_slice(hash.as_bytes());
            Simulation::load(&changed).err()
        };
        assert_eq!(with(4, 2), Some(KernelError::OtherVersion));
        assert_eq!(with(8, 3), Some(KernelError::BadSave));
        assert_eq!(with(8, 2), None);
        // The sign of the stiffness, and of the friction.
        assert_eq!(with(12 + 7, 0xc0), Some(KernelError::BadSave));
        assert_eq!(with(LAW - 1, 0xbf), Some(KernelError::BadSave));
    }

    #[test]
    fn what_has_not_started_is_not_saved() {
        let mut sim = Simulation::new(laws()[0], Domain::open(), 1e-3, vec![], &[], vec![]);
        assert_eq!(sim.save(), Err(KernelError::NotStarted));
    }
}
