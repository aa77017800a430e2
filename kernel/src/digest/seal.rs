//! The seal of a world at rest: it shows that nothing was written to between two steps.
//!
//! The pair list and the bound of the next step's travel are made from the rows as a step left them. A
//! host that writes a position, a velocity or a force after that would get a contact missed for a step
//! or not, as the skin happens to be. So a world is sealed when a stretch of steps ends, and the next
//! one is refused if the seal no longer fits.
//!
//! Sealed is all that the motion of a step comes from, but for the velocities of an obstacle and the host's force and
//! torque on it: they may change between steps, and each step reads them again. The forces on grains are sealed too:
//! the next drift begins with half a kick by them, so that the travel that was foreseen depends on them. Not sealed are
//! names and crossings, which move nothing; the force and torque on an obstacle that does not move freely, which are
//! results that no step reads; and pairs with their springs, storage that only the kernel writes.
//!
//! The seal is a sum over words, each mixed with where it stands, so that grains can be sealed range by
//! range in any order. Of all ways to write to a row about one in 2^32 leaves the seal as it was. It is not
//! a digest: two worlds with the same seal can be found on purpose.

use crate::integrate::GrainMotion;
use crate::math::real::Real;
use crate::math::rows::Row;
use crate::math::vec3::Vec3;
use crate::state::motion::Motion;
use crate::state::shape::Shape;
use crate::world::World;

/// The seal of a range of grains, or of several.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sealed(u64);

impl Sealed {
    /// The seal of no grains.
    pub const NONE: Self = Self(0);

    /// This seal and that of other grains.
    #[inline(always)]
    pub fn and(self, other: Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }

    /// What this seal adds to a sum that another one was in.
    pub(crate) fn less(self, other: Self) -> u64 {
        self.0.wrapping_sub(other.0)
    }
}

/// Where in a row a word stands: digits of pi.
const WORDS: [u64; 4] = [
    0x243f_6a88_85a3_08d3,
    0x1319_8a2e_0370_7344,
    0xa409_3822_299f_31d0,
    0x082e_fa98_ec4e_6c89,
];

/// Which rows they are: more of them, odd.
const ROWS: [u64; 5] = [
    0x4528_21e6_38d0_1377,
    0xbe54_66cf_34e9_0c6d,
    0xc0ac_29b7_c97c_50dd,
    0x3f84_d5b5_b547_0917,
    0x9216_d5d9_8979_fb1b,
];

/// Seals a range of grains of which the first is at the place `first` of all.
#[inline(always)]
pub fn seal<R: Real>(m: &GrainMotion<'_, R>, first: usize) -> Sealed {
    let mut sums = [[0u64; 4]; 5];
    let mut place = first as u64;
    let moving = m.position.iter().zip(&*m.velocity).zip(&*m.spin);
    let pushes = m.force.iter().zip(&*m.torque);
    for ((((x, v), w), (force, torque)), group) in moving.zip(pushes).zip(m.group) {
        // A grain of another group is as one at another place.
        let here = scattered(place ^ (u64::from(*group) << 48));
        place = place.wrapping_add(1);
        let keys = WORDS.map(|key| here ^ key);
        let rows = [x, v, w, force, torque];
        for (sum, row) in sums.iter_mut().zip(rows) {
            *sum = with(sum, row, &keys);
        }
    }
    let mut all = 0u64;
    for (sum, odd) in sums.iter().zip(ROWS) {
        let row = sum.iter().fold(0u64, |row, lane| row.wrapping_add(*lane));
        all = all.wrapping_add(row.wrapping_mul(odd));
    }
    Sealed(all)
}

/// Adds the words of a row, one to each lane.
#[inline(always)]
fn with<R: Real>(sum: &[u64; 4], row: &Row<R>, keys: &[u64; 4]) -> [u64; 4] {
    let lane = |a: usize| sum[a].wrapping_add(mixed(word(row[a]), keys[a]));
    [lane(0), lane(1), lane(2), lane(3)]
}

/// A word mixed with a key: the product of the halves of both together.
#[inline(always)]
fn mixed(word: u64, key: u64) -> u64 {
    let both = word ^ key;
    (both & 0xffff_ffff).wrapping_mul(both >> 32)
}

/// Turns the numbers of places into keys that are unrelated to each other.
#[inline(always)]
fn scattered(place: u64) -> u64 {
    let key = place.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let key = (key ^ (key >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    key ^ (key >> 27)
}

/// Two halves as a word.
#[inline(always)]
fn pair(low: u32, high: u32) -> u64 {
    u64::from(low) | (u64::from(high) << 32)
}

/// The bits of a number: 0.0 and -0.0 differ.
#[inline(always)]
fn word<R: Real>(x: R) -> u64 {
    let (low, high) = x.to_words();
    pair(low, high.unwrap_or(0))
}

/// The seal of a world, of which `grains` seals the grains.
#[inline(never)]
pub(crate) fn whole<R: Real>(world: &World<'_, R>, grains: Sealed) -> u64 {
    let mut rest = Rest {
        sum: grains.0,
        words: 0,
    };
    rest.number(world.dt);
    rest.vector(world.domain.lo());
    rest.vector(world.domain.hi());
    rest.flags(world.domain.periodic());
    for count in [
        world.clock.count,
        world.grains.groups.len(),
        world.obstacles.len(),
    ] {
        rest.word(count as u64);
    }
    for group in world.grains.groups {
        rest.flags(group.integrates);
        rest.flags([group.spins, group.infinite_mass, false]);
        rest.vector(group.gravity);
        rest.word(u64::from(group.material));
    }
    for body in world.obstacles.iter() {
        let (kind, direction, sizes) = body.shape.written();
        rest.word(u64::from(kind) | u64::from(body.curved) << 32 | u64::from(body.material) << 40);
        rest.vector(direction);
        rest.vector(sizes);
        if let Shape::Mesh { .. } = body.shape {
            for word in body.shape.table() {
                rest.word(u64::from(word));
            }
        }
        rest.vector(body.point);
        for number in body.orientation {
            rest.number(number);
        }
        rest.number(body.inverse_mass);
        if let Motion::Free(free) = &body.motion {
            // Half a kick by them begins the next drift.
            rest.vector(body.force);
            rest.vector(body.torque);
            rest.vector(free.inertia);
            rest.vector(free.gravity);
            rest.flags(free.integrates);
            rest.flags([free.spins, true, true]);
        }
    }
    rest.sum
}

/// The part of a seal that is not of grains: words one after the other.
struct Rest {
    sum: u64,
    words: u64,
}

impl Rest {
    fn word(&mut self, word: u64) {
        // Counted down from the last place, where there is no grain.
        let here = scattered(!self.words);
        self.words = self.words.wrapping_add(1);
        self.sum = self.sum.wrapping_add(mixed(word, here));
    }

    fn number<R: Real>(&mut self, number: R) {
        self.word(word(number));
    }

    fn vector<R: Real>(&mut self, v: Vec3<R>) {
        for x in v {
            self.number(x);
        }
    }

    fn flags(&mut self, flags: [bool; 3]) {
        for flag in flags {
            self.word(u64::from(flag));
        }
    }
}
