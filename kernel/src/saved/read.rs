//! Reading.

use core::marker::PhantomData;

use super::layout::{
    CURVED, Counts, DRAINS, FORMAT, FREE, GROUP_MATERIAL, HASHES, INTEGRATES, KEEPING, KIND, MAGIC,
    MATERIAL, OPEN, PLAIN, SPINS, TAKES_OUT, counts, name, size, width, words_of,
};
use super::write::checksum;
use crate::blake3::Hasher;
use crate::contact::kept::MEMORY_MAX;
use crate::digest::BITS_VERSION;
use crate::error::Error;
use crate::math::real::Real;
use crate::math::rows::set;
use crate::math::vec3::Vec3;
use crate::neighbors::pair_list::{ContactHistory, KeptContact};
use crate::state::domain::Domain;
use crate::state::grains::Group;
use crate::state::losses::{Drain, LossPolicy};
use crate::state::motion::{FreeMotion, Motion};
use crate::state::obstacle::Obstacle;
use crate::state::shape::Shape;
use crate::step::take_up;
use crate::world::World;

fn axes(flags: u32) -> [bool; 3] {
    [flags & 1 != 0, flags & 2 != 0, flags & 4 != 0]
}

/// How an obstacle with these flags and numbers moves.
fn motion<R: Real>(flags: u32, [inertia, gravity, force, torque]: [Vec3<R>; 4]) -> Motion<R> {
    if flags & FREE == 0 {
        return Motion::Prescribed;
    }
    Motion::Free(FreeMotion {
        inertia,
        gravity,
        force,
        torque,
        integrates: axes(flags >> INTEGRATES),
        spins: flags & SPINS != 0,
    })
}

/// A saved world whose bytes are as they were written: what a host that owns the storage of its worlds, as
/// [`Store`](crate::Store) does, makes one from. It makes a world with this box, time step, policy, groups, obstacles
/// and so many grains, then calls [`Saved::fill`] and [`Saved::resume`].
pub struct Saved<'b, R> {
    words: &'b [[u8; 4]],
    format: u32,
    counts: Counts,
    number: PhantomData<R>,
}

impl<'b, R: Real> Saved<'b, R> {
    /// Looks at bytes that [`save`](crate::save) wrote, and that may be longer than the world in them.
    ///
    /// # Errors
    /// [`Error::BadSave`] of bytes that are not as they were written; [`Error::OtherVersion`].
    pub fn open(bytes: &'b [u8]) -> Result<Self, Error> {
        let words = bytes.as_chunks::<4>().0;
        let mut saved = Self {
            words,
            format: FORMAT,
            counts: Counts::default(),
            number: PhantomData,
        };
        let mut at = saved.from(0);
        if [at.word(), at.word()] != MAGIC {
            return Err(Error::BadSave);
        }
        saved.format = at.word();
        let is_known = matches!(saved.format, PLAIN | FORMAT | KEEPING);
        if !is_known || at.word() != BITS_VERSION || name::<R>() != at.four() {
            return Err(Error::OtherVersion);
        }
        let [grains, groups, obstacles, pairs, touches] = [(); 5].map(|()| at.word() as usize);
        let facets = match saved.format {
            PLAIN => 0,
            _ => at.word() as usize,
        };
        let kept = match saved.format {
            KEEPING => at.word() as usize,
            _ => 0,
        };
        if kept > MEMORY_MAX {
            return Err(Error::BadSave);
        }
        saved.counts = Counts {
            grains,
            groups,
            obstacles,
            pairs,
            touches,
            facets,
            words: kept,
        };
        let size = size::<R>(saved.format, saved.counts) / 4;
        let Some(words) = words.get(..size) else {
            return Err(Error::BadSave);
        };
        saved.words = words;
        let mut hasher = Hasher::new();
        for word in words.iter().take(size.saturating_sub(HASHES / 2)) {
            hasher.word(u32::from_le_bytes(*word));
        }
        match saved.checksum() == hasher.finish() {
            true => Ok(saved),
            false => Err(Error::BadSave),
        }
    }

    /// Whether a store has room for it.
    pub(crate) fn check_room(
        &self,
        grains: usize,
        groups: usize,
        obstacles: usize,
    ) -> Result<(), Error> {
        let needed = self.counts.grains;
        if needed > grains {
            return Err(Error::GrainsFull { needed });
        }
        match self.counts.groups <= groups && self.counts.obstacles <= obstacles {
            true => Ok(()),
            false => Err(Error::BadStorage),
        }
    }

    /// How many grains it has.
    pub fn count(&self) -> usize {
        self.counts.grains
    }

    /// Its length in bytes.
    pub fn size(&self) -> usize {
        4 * self.words.len()
    }

    fn from(&self, word: usize) -> Reader<'b> {
        Reader(self.words.get(word..).unwrap_or_default())
    }

    /// Where a part begins: after the head, groups, obstacles, grains, histories.
    fn part(&self, parts: usize) -> Reader<'b> {
        self.from(words_of::<R>(self.format, self.counts, parts))
    }

    fn flags(&self) -> u32 {
        self.from(counts(self.format) - 3).word()
    }

    /// Its time step.
    pub fn dt(&self) -> R {
        self.from(counts(self.format)).number()
    }

    /// Its box; one that is none becomes a box without space, which no world starts in.
    pub fn domain(&self) -> Domain<R> {
        let mut at = self.from(counts(self.format));
        let _: R = at.number();
        let (lo, hi) = (at.vector(), at.vector());
        match self.flags() & OPEN != 0 {
            true => Domain::open(),
            false => Domain::new(lo, hi, axes(self.flags())).unwrap_or(Domain::VACANT),
        }
    }

    /// What becomes of its grains that leave.
    pub fn policy(&self) -> LossPolicy<R> {
        let mut at = self.from(counts(self.format));
        for _ in 0..7 {
            let _: R = at.number();
        }
        let drain = Drain {
            point: at.vector(),
            normal: at.vector(),
        };
        LossPolicy {
            takes_out: self.flags() & TAKES_OUT != 0,
            drain: (self.flags() & DRAINS != 0).then_some(drain),
        }
    }

    /// How far beyond touching its law acts (length).
    fn reach(&self) -> R {
        match self.format {
            KEEPING => {
                let first = words_of::<R>(self.format, self.counts, 1);
                self.from(first.saturating_sub(width::<R>())).number()
            }
            _ => R::ZERO,
        }
    }

    /// Its groups by number.
    pub fn groups(&self) -> impl Iterator<Item = Group<R>> + use<'b, R> {
        let mut at = self.part(1);
        (0..self.counts.groups).map(move |_| {
            let flags = at.word();
            Group {
                integrates: axes(flags),
                spins: flags & 8 != 0,
                infinite_mass: flags & 16 != 0,
                gravity: at.vector(),
                material: (flags >> GROUP_MATERIAL) as u8,
            }
        })
    }

    /// Its obstacles by number.
    pub fn obstacles(&self) -> impl Iterator<Item = Obstacle<R>> + use<'b, R> {
        let mut at = self.part(2);
        let is_plain = self.format == PLAIN;
        (0..self.counts.obstacles).map(move |_| {
            let flags = at.word();
            let image = at.images();
            let (direction, size) = (at.vector(), at.number());
            let shape = |sizes, table| Shape::read(flags & KIND, direction, sizes, table);
            let plain = Obstacle {
                point: at.vector(),
                image,
                velocity: at.vector(),
                inverse_mass: at.number(),
                force: at.vector(),
                torque: at.vector(),
                ..Obstacle::new(shape([size, R::ZERO, R::ZERO], [0; 4]), [R::ZERO; 3])
            };
            if is_plain {
                return plain;
            }
            Obstacle {
                shape: shape([size, at.number(), at.number()], at.four()),
                orientation: at.row(),
                angular_velocity: at.vector(),
                curved: flags & CURVED != 0,
                material: (flags >> MATERIAL) as u8,
                motion: motion(flags, [(); 4].map(|()| at.vector())),
                ..plain
            }
        })
    }

    /// The corners of the triangles of its meshes, in order (length): what a host makes its [`World::facets`] from,
    /// with [`arrange`](crate::arrange) for each mesh by itself.
    pub fn facets(&self) -> impl Iterator<Item = [Vec3<R>; 3]> + use<'b, R> {
        let mut at = self.part(5);
        (0..self.counts.facets).map(move |_| [(); 3].map(|()| at.vector()))
    }

    /// Writes the rows of its grains, and its step, to a world with so many rows.
    pub fn fill(&self, world: &mut World<'_, R>) {
        let mut at = self.part(3);
        let g = &mut world.grains;
        for i in 0..self.count() {
            set(g.id, i, at.word());
            // A group beyond the last one, which no byte may name, is refused as the world resumes.
            set(g.group, i, u8::try_from(at.word()).unwrap_or(u8::MAX));
            set(g.image, i, at.images());
            set(g.position, i, at.row());
            set(g.velocity, i, at.row());
            for rows in [&mut g.spin, &mut g.force, &mut g.torque] {
                let [x, y, z] = at.vector();
                set(rows, i, [x, y, z, R::ZERO]);
            }
        }
        let mut at = self.from(counts(self.format) - 2);
        world.clock.reach = self.reach();
        world.clock.step = u64::from(at.word()) | u64::from(at.word()) << 32;
    }

    fn histories(&self) -> impl Iterator<Item = KeptContact<R>> + use<'b, R> {
        let mut at = self.part(4);
        let Counts {
            pairs,
            touches,
            words,
            ..
        } = self.counts;
        (0..pairs.saturating_add(touches)).map(move |k| {
            let (i, j, spring) = (at.word(), at.word(), at.vector());
            let mut memory = [R::ZERO; MEMORY_MAX];
            for word in memory.iter_mut().take(words) {
                *word = at.number();
            }
            let history = match k < pairs {
                true => ContactHistory::Pair { i, j, spring },
                false => ContactHistory::Obstacle {
                    i,
                    obstacle: j,
                    spring,
                },
            };
            KeptContact { history, memory }
        })
    }

    /// Goes on from its histories in a world that was filled with it. It may be called again after a list proved full.
    ///
    /// # Errors
    /// As [`resume`](crate::resume), of forged bytes and of full lists; [`Error::BadSave`] if the world would not be
    /// saved as these bytes, with the same digest and with nothing in words that say nothing. It is then stopped.
    pub fn resume(&self, world: &mut World<'_, R>) -> Result<(), Error> {
        take_up(world, self.histories(), false)?;
        match checksum(world) == self.checksum() {
            true => Ok(()),
            false => {
                world.clock.stop();
                Err(Error::BadSave)
            }
        }
    }

    fn checksum(&self) -> [u8; 32] {
        self.from(self.words.len().saturating_sub(HASHES / 2))
            .hash()
    }
}

/// Words that are still to be read; zeros behind the last one.
struct Reader<'b>(&'b [[u8; 4]]);

impl Reader<'_> {
    fn word(&mut self) -> u32 {
        match self.0 {
            [first, others @ ..] => {
                self.0 = others;
                u32::from_le_bytes(*first)
            }
            [] => 0,
        }
    }

    fn four(&mut self) -> [u32; 4] {
        [(); 4].map(|()| self.word())
    }

    fn number<R: Real>(&mut self) -> R {
        let low = self.word();
        R::from_words(low, (width::<R>() == 2).then(|| self.word()))
    }

    fn vector<R: Real>(&mut self) -> Vec3<R> {
        [(); 3].map(|()| self.number())
    }

    fn row<R: Real>(&mut self) -> crate::Row<R> {
        [(); 4].map(|()| self.number())
    }

    fn images(&mut self) -> [i32; 3] {
        [(); 3].map(|()| self.word() as i32)
    }

    fn hash(&mut self) -> [u8; 32] {
        let mut bytes = [0; 32];
        for to in bytes.as_chunks_mut::<4>().0 {
            *to = self.word().to_le_bytes();
        }
        bytes
    }
}
