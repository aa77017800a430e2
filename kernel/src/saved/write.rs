//! Writing.

use super::layout::{
    CURVED, Counts, DRAINS, FORMAT, FREE, GROUP_MATERIAL, INTEGRATES, KEEPING, MAGIC, MATERIAL,
    OPEN, PLAIN, SPINS, TAKES_OUT, name, size,
};
use crate::blake3::Hasher;
use crate::digest::BITS_VERSION;
use crate::digest::state::digest_rows;
use crate::edit::settle::open;
use crate::error::Error;
use crate::math::real::Real;
use crate::math::rows::{max, prefix};
use crate::math::vec3::head;
use crate::neighbors::pair_list::ContactHistory;
use crate::state::domain::Domain;
use crate::state::facet::Facet;
use crate::state::grains::Group;
use crate::state::losses::Drain;
use crate::state::motion::Motion;
use crate::state::obstacle::Obstacle;
use crate::world::World;

/// What a world has to be written.
fn count<R: Real>(world: &World<'_, R>) -> Counts {
    let mut counts = Counts {
        grains: world.grains.count(),
        groups: world.grains.groups.len(),
        obstacles: world.obstacles.len(),
        facets: world.facets.len(),
        ..Counts::default()
    };
    for contact in world.kept_contacts() {
        match contact.history {
            ContactHistory::Pair { .. } => counts.pairs += 1,
            ContactHistory::Obstacle { .. } => counts.touches += 1,
        }
        counts.words = max(counts.words, contact.kept().words());
    }
    counts
}

/// The layout that a world with these counts is written in.
fn format<R: Real>(world: &World<'_, R>, counts: Counts) -> u32 {
    let is_plain = world.obstacles.iter().all(Obstacle::is_plain) && world.facets.is_empty();
    match (counts.words > 0 || world.clock.reach > R::ZERO, is_plain) {
        (true, _) => KEEPING,
        (false, true) => PLAIN,
        (false, false) => FORMAT,
    }
}

/// Bytes that [`save`] needs for a world as it is now.
pub fn save_size<R: Real>(world: &World<'_, R>) -> usize {
    let counts = count(world);
    size::<R>(format(world, counts), counts)
}

/// Writes a world at rest to the beginning of `out`, and returns how many bytes that took. Going on from there, in a
/// store of any capacity and with any skin, gives the bits of this world. The contact law is the host's own and not
/// in it.
///
/// # Errors
/// [`Error::NotStarted`], [`Error::GrainsLeaving`], [`Error::Edited`]; [`Error::BufferTooShort`], with nothing written.
pub fn save<R: Real>(world: &mut World<'_, R>, out: &mut [u8]) -> Result<usize, Error> {
    open(world)?;
    let needed = save_size(world);
    let Some(out) = out.get_mut(..needed) else {
        return Err(Error::BufferTooShort { needed });
    };
    let mut to = Writer::new(out.as_chunks_mut().0);
    to.world(world);
    let sum = to.hasher.finish();
    to.hash(&sum);
    Ok(needed)
}

/// The hash that the bytes of a world end with.
pub(crate) fn checksum<R: Real>(world: &World<'_, R>) -> [u8; 32] {
    let mut to = Writer::new(&mut []);
    to.world(world);
    to.hasher.finish()
}

fn flags<R: Real>(world: &World<'_, R>) -> u32 {
    let mut flags = bits(world.domain.periodic());
    if *world.domain == Domain::open() {
        flags |= OPEN;
    }
    if world.policy.takes_out {
        flags |= TAKES_OUT;
    }
    if world.policy.drain.is_some() {
        flags |= DRAINS;
    }
    flags
}

fn flag(is_set: bool, flag: u32) -> u32 {
    if is_set { flag } else { 0 }
}

fn bits([x, y, z]: [bool; 3]) -> u32 {
    u32::from(x) | u32::from(y) << 1 | u32::from(z) << 2
}

struct Writer<'a> {
    words: core::slice::IterMut<'a, [u8; 4]>,
    hasher: Hasher,
}

impl<'a> Writer<'a> {
    /// Writes to these words, and hashes what is beyond the last of them too.
    fn new(words: &'a mut [[u8; 4]]) -> Self {
        Self {
            words: words.iter_mut(),
            hasher: Hasher::new(),
        }
    }

    /// All of a world but the checksum.
    fn world<R: Real>(&mut self, world: &World<'_, R>) {
        let of = count(world);
        let g = &world.grains;
        for half in MAGIC {
            self.word(half);
        }
        let format = format(world, of);
        self.word(format);
        self.word(BITS_VERSION);
        for word in name::<R>() {
            self.word(word);
        }
        for count in [of.grains, of.groups, of.obstacles, of.pairs, of.touches] {
            self.word(count as u32);
        }
        if format != PLAIN {
            self.word(of.facets as u32);
        }
        if format == KEEPING {
            self.word(of.words as u32);
        }
        self.word(flags(world));
        self.word(world.clock.step as u32);
        self.word((world.clock.step >> 32) as u32);
        self.number(world.dt);
        self.numbers(&world.domain.lo());
        self.numbers(&world.domain.hi());
        let drain = world.policy.drain.unwrap_or(Drain {
            point: [R::ZERO; 3],
            normal: [R::ZERO; 3],
        });
        self.numbers(&drain.point);
        self.numbers(&drain.normal);
        if format == KEEPING {
            self.number(world.clock.reach);
        }
        for group in g.groups {
            self.group(group);
        }
        for body in world.obstacles.iter() {
            self.obstacle(body, format);
        }
        let moving = g.position.iter().zip(&*g.velocity).zip(&*g.spin);
        let pushes = g.force.iter().zip(&*g.torque);
        let names = g.id.iter().zip(&*g.group).zip(&*g.image);
        for ((((x, v), w), (force, torque)), ((id, group), image)) in moving.zip(pushes).zip(names)
        {
            self.word(*id);
            self.word(u32::from(*group));
            self.images(image);
            self.numbers(x);
            self.numbers(v);
            for row in [w, force, torque] {
                self.numbers(&head(*row));
            }
        }
        for contact in world.kept_contacts() {
            let (ContactHistory::Pair { i, j, .. }
            | ContactHistory::Obstacle { i, obstacle: j, .. }) = contact.history;
            self.word(i);
            self.word(j);
            let kept = contact.kept();
            self.numbers(&kept.spring);
            self.numbers(prefix(&kept.memory, of.words));
        }
        for corner in world.facets.iter().flat_map(Facet::corners) {
            self.numbers(&corner);
        }
        self.hash(&digest_rows(world).whole);
    }

    fn word(&mut self, word: u32) {
        self.hasher.word(word);
        if let Some(to) = self.words.next() {
            *to = word.to_le_bytes();
        }
    }

    fn number<R: Real>(&mut self, number: R) {
        let (low, high) = number.to_words();
        self.word(low);
        if let Some(high) = high {
            self.word(high);
        }
    }

    fn numbers<R: Real>(&mut self, numbers: &[R]) {
        for number in numbers {
            self.number(*number);
        }
    }

    fn images(&mut self, image: &[i32; 3]) {
        for k in image {
            self.word(*k as u32);
        }
    }

    fn group<R: Real>(&mut self, group: &Group<R>) {
        let more = u32::from(group.spins) << 3 | u32::from(group.infinite_mass) << 4;
        let material = u32::from(group.material) << GROUP_MATERIAL;
        self.word(bits(group.integrates) | more | material);
        self.numbers(&group.gravity);
    }

    fn obstacle<R: Real>(&mut self, body: &Obstacle<R>, format: u32) {
        let (kind, direction, sizes) = body.shape.written();
        let free = match body.motion {
            Motion::Free(free) => Some(free),
            Motion::Prescribed => None,
        };
        let flags = match (format, free) {
            (PLAIN, _) => 0,
            (_, None) => flag(body.curved, CURVED),
            (_, Some(free)) => {
                flag(body.curved, CURVED)
                    | FREE
                    | flag(free.spins, SPINS)
                    | bits(free.integrates) << INTEGRATES
            }
        };
        self.word(kind | flags | u32::from(body.material) << MATERIAL);
        self.images(&body.image);
        self.numbers(&direction);
        self.number(sizes[0]);
        self.numbers(&body.point);
        self.numbers(&body.velocity);
        self.number(body.inverse_mass);
        self.numbers(&body.force);
        self.numbers(&body.torque);
        if format == PLAIN {
            return;
        }
        self.numbers(&[sizes[1], sizes[2]]);
        for word in body.shape.table() {
            self.word(word);
        }
        self.numbers(&body.orientation);
        self.numbers(&body.angular_velocity);
        let nothing = [R::ZERO; 3];
        let free = free.map(|free| [free.inertia, free.gravity, free.force, free.torque]);
        for numbers in free.unwrap_or([nothing; 4]) {
            self.numbers(&numbers);
        }
    }

    fn hash(&mut self, hash: &[u8; 32]) {
        for word in hash.as_chunks::<4>().0 {
            self.word(u32::from_le_bytes(*word));
        }
    }
}
