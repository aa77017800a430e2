//! Writing.

use super::layout::{DRAINS, FORMAT, MAGIC, OPEN, TAKES_OUT, name, size};
use crate::digest::BITS_VERSION;
use crate::digest::blake3::Hasher;
use crate::digest::state::digest;
use crate::edit::settle::open;
use crate::error::Error;
use crate::math::real::Real;
use crate::math::vec3::head;
use crate::neighbors::pair_list::ContactHistory;
use crate::state::domain::Domain;
use crate::state::grains::Group;
use crate::state::losses::Drain;
use crate::state::obstacle::{Obstacle, Shape};
use crate::world::World;

/// How many of a world's histories are of pairs and of obstacle contacts.
fn histories<R: Real>(world: &World<'_, R>) -> [usize; 2] {
    let (mut pairs, mut touches) = (0, 0);
    for history in world.contact_histories() {
        match history {
            ContactHistory::Pair { .. } => pairs += 1,
            ContactHistory::Obstacle { .. } => touches += 1,
        }
    }
    [pairs, touches]
}

/// Bytes that [`save`] needs for a world as it is now.
pub fn save_size<R: Real>(world: &World<'_, R>) -> usize {
    let [pairs, touches] = histories(world);
    size::<R>([
        world.grains.count(),
        world.grains.groups.len(),
        world.obstacles.len(),
        pairs + touches,
    ])
}

/// Writes a world at rest to the beginning of `out`, and returns how many bytes that took. Going on from there, in a
/// store of any capacity and with any skin, gives the bits of this world. The contact law is the host's own and not in
/// it.
///
/// # Errors
/// [`Error::NotStarted`], [`Error::GrainsLeaving`], [`Error::Edited`]; [`Error::BufferTooShort`], with nothing written.
pub fn save<R: Real>(world: &mut World<'_, R>, out: &mut [u8]) -> Result<usize, Error> {
    open(world)?;
    let needed = save_size(world);
    let Some(out) = out.get_mut(..needed) else {
        return Err(Error::BufferTooShort { needed });
    };
    let mut to = Writer {
        words: out.as_chunks_mut().0.iter_mut(),
        hasher: Hasher::new(),
    };
    let [pairs, touches] = histories(world);
    let g = &world.grains;
    for half in MAGIC {
        to.word(half);
    }
    to.word(FORMAT);
    to.word(BITS_VERSION);
    for word in name::<R>() {
        to.word(word);
    }
    let counts = [
        g.count(),
        g.groups.len(),
        world.obstacles.len(),
        pairs,
        touches,
    ];
    for count in counts {
        to.word(count as u32);
    }
    to.word(flags(world));
    to.word(world.clock.step as u32);
    to.word((world.clock.step >> 32) as u32);
    to.number(world.dt);
    to.numbers(&world.domain.lo());
    to.numbers(&world.domain.hi());
    let drain = world.policy.drain.unwrap_or(Drain {
        point: [R::ZERO; 3],
        normal: [R::ZERO; 3],
    });
    to.numbers(&drain.point);
    to.numbers(&drain.normal);
    for group in g.groups {
        to.group(group);
    }
    for body in world.obstacles.iter() {
        to.obstacle(body);
    }
    let moving = g.position.iter().zip(&*g.velocity).zip(&*g.spin);
    let pushes = g.force.iter().zip(&*g.torque);
    let names = g.id.iter().zip(&*g.group).zip(&*g.image);
    for ((((x, v), w), (force, torque)), ((id, group), image)) in moving.zip(pushes).zip(names) {
        to.word(*id);
        to.word(u32::from(*group));
        to.images(image);
        to.numbers(x);
        to.numbers(v);
        for row in [w, force, torque] {
            to.numbers(&head(*row));
        }
    }
    for history in world.contact_histories() {
        let (i, j, spring) = match history {
            ContactHistory::Pair { i, j, spring } => (i, j, spring),
            ContactHistory::Obstacle {
                i,
                obstacle,
                spring,
            } => (i, obstacle, spring),
        };
        to.word(i);
        to.word(j);
        to.numbers(&spring);
    }
    to.hash(&digest(world).whole);
    let sum = to.hasher.finish();
    to.hash(&sum);
    Ok(needed)
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

fn bits([x, y, z]: [bool; 3]) -> u32 {
    u32::from(x) | u32::from(y) << 1 | u32::from(z) << 2
}

struct Writer<'a> {
    words: core::slice::IterMut<'a, [u8; 4]>,
    hasher: Hasher,
}

impl Writer<'_> {
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
        self.word(bits(group.integrates) | more);
        self.numbers(&group.gravity);
    }

    fn obstacle<R: Real>(&mut self, body: &Obstacle<R>) {
        let (kind, direction, size) = match body.shape {
            Shape::Sphere { radius } => (0, [R::ZERO; 3], radius),
            Shape::Cylinder { axis, radius } => (1, axis, radius),
            Shape::Plane { normal } => (2, normal, R::ZERO),
        };
        self.word(kind);
        self.images(&body.image);
        self.numbers(&direction);
        self.number(size);
        self.numbers(&body.point);
        self.numbers(&body.velocity);
        self.number(body.inverse_mass);
        self.numbers(&body.force);
        self.numbers(&body.torque);
    }

    fn hash(&mut self, hash: &[u8; 32]) {
        for word in hash.as_chunks::<4>().0 {
            self.word(u32::from_le_bytes(*word));
        }
    }
}
