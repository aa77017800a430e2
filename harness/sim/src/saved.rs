//! A simulation as bytes that the C library's `bg_save` writes too: the contact law and its BLAKE3 hash, then the
//! kernel's saved world.

use std::sync::Arc;

use bitgrain_kernel::contact::{
    HertzHistory, HertzTsuji, PairLaws, Rolling, RollingResistance, RollingSpring,
};
use bitgrain_kernel::{Error as KernelError, Saved, save, save_size};

use crate::law::{AnyLaw, MATERIALS_MAX, Pairs};
use crate::mesh::{Triangle, restored};
use crate::simulation::Simulation;

/// How the bytes begin: a name and the format.
const MAGIC: &[u8; 8] = b"bglw\x01\0\0\0";

/// Bytes of a law of one material: the beginning, the number of its kind, five numbers.
const LAW: usize = HEAD + NUMBERS;
const HEAD: usize = 8 + 4;
const NUMBERS: usize = 5 * 8;

/// Numbers of a pair that resists rolling: those of the law, 0 for `sds` and 1 for `epsd2`, stiffness, damping and
/// coefficient.
const ROLLING_NUMBERS: usize = 5 + 4;

/// Bytes of a law of several: the beginning, the number of its kind, that of the materials, numbers for each pair.
fn table_size(materials: u8, numbers: usize) -> usize {
    HEAD + 4 + 8 * numbers * PairLaws::<()>::pairs(materials).count()
}

/// Bytes of a hash.
const HASH: usize = 32;

/// Numbers of the kinds.
const HISTORY: u32 = 1;
const TSUJI: u32 = 2;
const HISTORY_PAIRS: u32 = 3;
const TSUJI_PAIRS: u32 = 4;
const HISTORY_ROLLING: u32 = 5;
const TSUJI_ROLLING: u32 = 6;

impl Simulation {
    /// A simulation at rest as bytes. [`Simulation::load`] goes on from there with the same bits, on any machine.
    ///
    /// # Errors
    /// [`KernelError::NotStarted`], [`KernelError::GrainsLeaving`], [`KernelError::Edited`].
    pub fn save(&mut self) -> Result<Vec<u8>, KernelError> {
        let mut bytes = law_bytes(&self.law);
        bytes.extend_from_slice(blake3::hash(&bytes).as_bytes());
        let head = bytes.len();
        let mut world = self.world();
        bytes.resize(head + save_size(&world), 0);
        save(&mut world, &mut bytes[head..])?;
        Ok(bytes)
    }

    /// The simulation that [`Simulation::save`], or C's `bg_save`, wrote. Skin and reach are those of
    /// [`Simulation::choose_skin`].
    ///
    /// # Errors
    /// [`KernelError::BadSave`] of bytes that are not as they were written, or more of them;
    /// [`KernelError::OtherVersion`]; of forged bytes whatever is wrong with the world in them.
    pub fn load(bytes: &[u8]) -> Result<Self, KernelError> {
        let size = law_size(bytes).ok_or(KernelError::BadSave)?;
        let (law, rest) = bytes.split_at_checked(size).ok_or(KernelError::BadSave)?;
        let (hash, rest) = rest.split_at_checked(HASH).ok_or(KernelError::BadSave)?;
        if blake3::hash(law).as_bytes() != hash {
            return Err(KernelError::BadSave);
        }
        let law = law_in(law)?;
        let saved = Saved::open(rest)?;
        if saved.size() != rest.len() {
            return Err(KernelError::BadSave);
        }
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

fn law_bytes(law: &AnyLaw) -> Vec<u8> {
    let (kind, materials, laws) = match law {
        AnyLaw::HertzHistory(law) => (HISTORY, None, history(law).to_vec()),
        AnyLaw::HertzTsuji(law) => (TSUJI, None, tsuji(law).to_vec()),
        AnyLaw::HertzHistoryPairs(laws) => {
            let laws = laws.laws().iter().flat_map(history).collect();
            (HISTORY_PAIRS, law.materials().into(), laws)
        }
        AnyLaw::HertzTsujiPairs(laws) => {
            let laws = laws.laws().iter().flat_map(tsuji).collect();
            (TSUJI_PAIRS, law.materials().into(), laws)
        }
        AnyLaw::HertzHistoryRolling(laws) => {
            let laws = laws.laws().iter().flat_map(|law| rolling(law, history));
            (HISTORY_ROLLING, law.materials().into(), laws.collect())
        }
        AnyLaw::HertzTsujiRolling(laws) => {
            let laws = laws.laws().iter().flat_map(|law| rolling(law, tsuji));
            (TSUJI_ROLLING, law.materials().into(), laws.collect())
        }
    };
    let materials: Option<u8> = materials;
    let laws: Vec<f64> = laws;
    let mut bytes = MAGIC.to_vec();
    bytes.extend(u32::to_le_bytes(kind));
    bytes.extend(
        materials
            .map(|count| u32::from(count).to_le_bytes())
            .iter()
            .flatten(),
    );
    bytes.extend(laws.iter().flat_map(|number| number.to_le_bytes()));
    bytes
}

fn history(l: &HertzHistory<f64>) -> [f64; 5] {
    [l.kn, l.kt, l.gamma_n, l.gamma_t, l.mu]
}

fn tsuji(l: &HertzTsuji<f64>) -> [f64; 5] {
    [l.kn, l.kt, l.cn, l.ct, l.mu]
}

/// The numbers of a law that resists rolling.
fn rolling<L>(law: &Rolling<f64, L>, own: fn(&L) -> [f64; 5]) -> [f64; ROLLING_NUMBERS] {
    let [a, b, c, d, e] = own(&law.law);
    let of = &law.resistance;
    let spring = match of.spring {
        RollingSpring::Sds => 0.0,
        RollingSpring::Epsd2 => 1.0,
    };
    [a, b, c, d, e, spring, of.k, of.gamma, of.mu]
}

/// The resistance in the numbers of a law that has one.
fn resistance([spring, k, gamma, mu]: [f64; 4]) -> Option<RollingResistance<f64>> {
    let spring = match spring {
        0.0 => RollingSpring::Sds,
        1.0 => RollingSpring::Epsd2,
        _ => return None,
    };
    Some(RollingResistance {
        spring,
        k,
        gamma,
        mu,
    })
}

/// How many numbers each pair of a kind of law has; none of a law of one material.
fn numbers_of(kind: u32) -> Option<usize> {
    match kind {
        HISTORY_PAIRS | TSUJI_PAIRS => Some(5),
        HISTORY_ROLLING | TSUJI_ROLLING => Some(ROLLING_NUMBERS),
        _ => None,
    }
}

/// A word behind the name of the format.
fn word(bytes: &[u8], at: usize) -> Option<u32> {
    let word = bytes.get(at..)?.first_chunk()?;
    Some(u32::from_le_bytes(*word))
}

/// The number of materials of a law of several.
fn materials(bytes: &[u8]) -> Option<u8> {
    let count = u8::try_from(word(bytes, HEAD)?).ok()?;
    (1..=MATERIALS_MAX)
        .contains(&usize::from(count))
        .then_some(count)
}

/// Bytes of the law that these begin with.
fn law_size(bytes: &[u8]) -> Option<usize> {
    match numbers_of(word(bytes, MAGIC.len())?) {
        Some(numbers) => Some(table_size(materials(bytes)?, numbers)),
        None => Some(LAW),
    }
}

/// The law in its bytes.
fn law_in(bytes: &[u8]) -> Result<AnyLaw, KernelError> {
    if !bytes.starts_with(MAGIC) {
        return Err(KernelError::OtherVersion);
    }
    known_law(bytes).ok_or(KernelError::BadSave)
}

fn known_law(bytes: &[u8]) -> Option<AnyLaw> {
    let kind = word(bytes, MAGIC.len())?;
    let begin = HEAD + if numbers_of(kind).is_some() { 4 } else { 0 };
    let numbers: Vec<f64> = bytes
        .get(begin..)?
        .as_chunks()
        .0
        .iter()
        .copied()
        .map(f64::from_le_bytes)
        .collect();
    let numbers = &numbers[..];
    match kind {
        HISTORY => Some(AnyLaw::HertzHistory(history_of(*numbers.first_chunk()?)?)),
        TSUJI => Some(AnyLaw::HertzTsuji(tsuji_of(*numbers.first_chunk()?)?)),
        HISTORY_PAIRS => table(bytes, numbers, history_of).map(AnyLaw::HertzHistoryPairs),
        TSUJI_PAIRS => table(bytes, numbers, tsuji_of).map(AnyLaw::HertzTsujiPairs),
        HISTORY_ROLLING => {
            table(bytes, numbers, |of| rolling_of(of, history_of)).map(AnyLaw::HertzHistoryRolling)
        }
        TSUJI_ROLLING => {
            table(bytes, numbers, |of| rolling_of(of, tsuji_of)).map(AnyLaw::HertzTsujiRolling)
        }
        _ => None,
    }
}

/// The laws of all pairs, each of so many numbers.
fn table<L: Copy, const NUMBERS: usize>(
    bytes: &[u8],
    numbers: &[f64],
    law: impl Fn([f64; NUMBERS]) -> Option<L>,
) -> Option<Arc<Pairs<L>>> {
    let laws = numbers.as_chunks().0.iter().map(|numbers| law(*numbers));
    Pairs::new(materials(bytes)?, laws.collect::<Option<_>>()?).map(Arc::new)
}

fn is_sound(numbers: &[f64]) -> bool {
    numbers.iter().all(|x| *x >= 0.0 && x.is_finite())
}

fn history_of(numbers: [f64; 5]) -> Option<HertzHistory<f64>> {
    let [kn, kt, gamma_n, gamma_t, mu] = numbers;
    let law = HertzHistory {
        kn,
        kt,
        gamma_n,
        gamma_t,
        mu,
    };
    (is_sound(&numbers) && kn > 0.0).then_some(law)
}

fn tsuji_of(numbers: [f64; 5]) -> Option<HertzTsuji<f64>> {
    let [kn, kt, cn, ct, mu] = numbers;
    let law = HertzTsuji { kn, kt, cn, ct, mu };
    (is_sound(&numbers) && kn > 0.0).then_some(law)
}

fn rolling_of<L>(
    numbers: [f64; ROLLING_NUMBERS],
    law: fn([f64; 5]) -> Option<L>,
) -> Option<Rolling<f64, L>> {
    let [a, b, c, d, e, own @ ..] = numbers;
    Some(Rolling {
        law: law([a, b, c, d, e])?,
        resistance: resistance(own).filter(|_| is_sound(&own))?,
    })
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
                (&again.law, again.policy, again.dt),
                (&sim.law, sim.policy, sim.dt)
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
    fn changed_cut_and_longer_bytes_are_refused() {
        let bytes = heap(laws()[0].clone()).save().unwrap();
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 1 << (at % 8);
            assert!(Simulation::load(&changed).is_err(), "byte {at}");
        }
        for length in [0, LAW, LAW + HASH, bytes.len() / 2, bytes.len() - 1] {
            let cut = Simulation::load(&bytes[..length]);
            assert_eq!(cut.err(), Some(KernelError::BadSave), "{length}");
        }
        for more in [1, 4, 100] {
            let longer = Simulation::load(&[&bytes[..], &vec![0; more]].concat());
            assert_eq!(longer.err(), Some(KernelError::BadSave), "{more}");
        }
    }

    #[test]
    fn laws_of_another_kind_or_format_or_without_sense_are_refused() {
        let bytes = heap(laws()[1].clone()).save().unwrap();
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
        let mut sim = Simulation::new(laws()[0].clone(), Domain::open(), 1e-3, vec![], &[], vec![]);
        assert_eq!(sim.save(), Err(KernelError::NotStarted));
    }
}
