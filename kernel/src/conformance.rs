//! Small worlds whose digests are published: a machine that reproduces them keeps the bit contract.
//!
//! Between them they hold every law, obstacle and kind of group. They are written down here and read
//! from nowhere, and all of them fit, one at a time, into one [`Room`].

use crate::contact::{HertzHistory, HertzTsuji, Law};
use crate::digest::blake3::Hasher;
use crate::digest::state::digest;
use crate::error::Error;
use crate::math::real::Real;
use crate::state::domain::Domain;
use crate::state::grains::Group;
use crate::state::obstacle::Obstacle;
use crate::step::{start, step};
use crate::store::Store;

/// Most grains of a world.
pub const GRAINS: usize = 30;

/// Storage for any of the worlds: 12 kB in double precision.
pub type Room<R> = Store<R, GRAINS, 54, 12, 5>;

/// Steps between two lines.
pub const EVERY: u64 = 50;

/// Bytes of a line as text.
pub const LINE: usize = 100;

/// The state that a world has reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// The number type, `f64` or `f32`.
    pub real: &'static str,
    /// The world.
    pub world: &'static str,
    /// Steps done.
    pub step: u64,
    /// Digest of the whole state.
    pub digest: [u8; 32],
}

impl Line {
    /// `f64 collapse-hertz_history        50 DIGEST` and a line feed: the same bytes everywhere.
    pub fn text(&self) -> [u8; LINE] {
        let mut out = [b' '; LINE];
        let mut put = |at: usize, byte: u8| {
            if let Some(slot) = out.get_mut(at) {
                *slot = byte;
            }
        };
        for (k, byte) in self.real.bytes().enumerate() {
            put(k, byte);
        }
        for (k, byte) in self.world.bytes().enumerate() {
            put(4 + k, byte);
        }
        let mut left = self.step;
        for k in 0..6 {
            if left > 0 || k == 0 {
                put(33 - k, b'0' + (left % 10) as u8);
            }
            left /= 10;
        }
        for (k, byte) in self.digest.iter().enumerate() {
            put(35 + 2 * k, hexadecimal(byte >> 4));
            put(36 + 2 * k, hexadecimal(byte & 15));
        }
        put(LINE - 1, b'\n');
        out
    }
}

/// The line that ends a list: the hash of all lines above it, as text.
pub fn last(all: &Hasher) -> Line {
    Line {
        real: "all",
        world: "lines above",
        step: 0,
        digest: all.finish(),
    }
}

/// The digit of a number below 16.
fn hexadecimal(four_bits: u8) -> u8 {
    if four_bits < 10 {
        b'0' + four_bits
    } else {
        b'a' + four_bits - 10
    }
}

/// The worlds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum World {
    /// Eighteen grains of every kind fall on a row of frozen ones, a row of free ones and a row that
    /// is carried, over a floor, past a ball and a bar that move.
    CollapseHistory,
    /// The same under the other law.
    CollapseTsuji,
    /// A bed on a frozen layer comes to rest; then a ball is dragged through it.
    Bed,
    /// A base and a heavy lid are carried past a bar, grains without weight between them, under a
    /// ceiling.
    Rig,
}

/// A stage of a world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage {
    /// Up to this step.
    pub last: u64,
    /// Damping of [`HertzHistory`] (1 / (time length)); `None` under [`HertzTsuji`].
    pub gamma: Option<f64>,
    /// What the first obstacle's speed along x becomes, if it changes.
    pub speed: Option<f64>,
}

impl World {
    /// In the order in which they are run.
    pub const ALL: [Self; 4] = [
        Self::CollapseHistory,
        Self::CollapseTsuji,
        Self::Bed,
        Self::Rig,
    ];

    /// What a line calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::CollapseHistory => "collapse-hertz_history",
            Self::CollapseTsuji => "collapse-hertz_tsuji",
            Self::Bed => "bed",
            Self::Rig => "rig",
        }
    }

    /// Its stages, one after the other.
    pub fn stages(self) -> &'static [Stage] {
        const fn stage(last: u64, gamma: Option<f64>, speed: Option<f64>) -> Stage {
            Stage { last, gamma, speed }
        }
        match self {
            Self::CollapseHistory => const { &[stage(600, Some(50.0), None)] },
            Self::CollapseTsuji => const { &[stage(600, None, None)] },
            // Damped at first, the bed is at rest before the ball sets off.
            Self::Bed => {
                const {
                    &[
                        stage(800, Some(300.0), None),
                        stage(1300, Some(50.0), Some(1.0)),
                    ]
                }
            }
            Self::Rig => const { &[stage(800, None, None)] },
        }
    }

    /// Makes it in `room`, whatever was there; not yet started.
    ///
    /// # Errors
    /// None, since [`Room`] is large enough for every world.
    // Inlined, what it keeps on the stack would stay there through the steps.
    #[inline(never)]
    pub fn lay<R: Real>(self, room: &mut Room<R>) -> Result<(), Error> {
        match self {
            Self::CollapseHistory | Self::CollapseTsuji => collapse(room),
            Self::Bed => bed(room),
            Self::Rig => rig(room),
        }
    }
}

/// Runs every world in `room`, shows a line at step 0 and every [`EVERY`] steps, and takes the same
/// lines, as text, into `all`.
///
/// # Errors
/// What stops a world. On a machine that keeps the contract, nothing does.
pub fn run<R: Real>(
    room: &mut Room<R>,
    all: &mut Hasher,
    mut show: impl FnMut(&Line),
) -> Result<(), Error> {
    for one in World::ALL {
        let mut tell = |step: u64, digest: [u8; 32]| {
            let line = Line {
                real: R::NAME,
                world: one.name(),
                step,
                digest,
            };
            for four in line.text().as_chunks().0 {
                all.word(u32::from_le_bytes(*four));
            }
            show(&line);
        };
        one.lay(room)?;
        for stage in one.stages() {
            if let (Some(speed), Some(body)) = (stage.speed, room.world().obstacles.first_mut()) {
                body.velocity[0] = R::from_f64(speed);
            }
            match stage.gamma {
                Some(gamma) => follow(room, &history(gamma), stage.last, &mut tell)?,
                None => follow(room, &tsuji(), stage.last, &mut tell)?,
            }
        }
    }
    Ok(())
}

/// Goes on to step `last`, reporting the digest of step 0 and of every [`EVERY`]th.
#[inline(never)]
fn follow<R: Real, L: Law<R>>(
    room: &mut Room<R>,
    law: &L,
    last: u64,
    tell: &mut dyn FnMut(u64, [u8; 32]),
) -> Result<(), Error> {
    let mut world = room.world();
    if world.clock.step == 0 {
        start(&mut world, law)?;
        tell(0, digest(&world).whole);
    }
    while world.clock.step < last {
        step(&mut world, law)?;
        if world.clock.step.is_multiple_of(EVERY) {
            tell(world.clock.step, digest(&world).whole);
        }
    }
    Ok(())
}

/// The law of a stage with damping.
pub fn history<R: Real>(gamma: f64) -> HertzHistory<R> {
    let [kn, kt, gamma, mu] = [2e3, 2.45e3, gamma, 0.5].map(R::from_f64);
    HertzHistory {
        kn,
        kt,
        gamma_n: gamma,
        gamma_t: gamma,
        mu,
    }
}

/// The law of a stage without.
pub fn tsuji<R: Real>() -> HertzTsuji<R> {
    HertzTsuji::new(4e3, 0.3, 0.6, 0.5)
}

/// Groups by number, in each of the worlds.
const FREE: u8 = 0;
const FROZEN: u8 = 1;
const CARRIED: u8 = 2;
const WEIGHTLESS: u8 = 3;
const LID: u8 = 4;

/// Empties the room for a box from z = -1 to 9 that is periodic along x and y, with all groups.
fn clear<R: Real>(room: &mut Room<R>, along_x: f64, along_y: f64) -> Result<(), Error> {
    let (lo, hi) = ([0.0, 0.0, -1.0], [along_x, along_y, 9.0]);
    let domain = Domain::new(
        lo.map(R::from_f64),
        hi.map(R::from_f64),
        [true, true, false],
    )?;
    // 1/256 and 1/32: the same in every precision.
    room.clear(domain, R::from_f64(0.00390625), R::from_f64(0.03125));
    let down = [R::ZERO, R::ZERO, -R::ONE];
    for group in [
        Group::free(down),
        Group::frozen(),
        Group::prescribed_velocity(),
        Group::free([R::ZERO; 3]),
        Group::free_along_z(down),
    ] {
        room.add_group(group).map_err(|_| Error::BadStorage)?;
    }
    Ok(())
}

fn obstacle<R: Real>(
    room: &mut Room<R>,
    body: Obstacle<R>,
    velocity: [f64; 3],
) -> Result<(), Error> {
    let velocity = velocity.map(R::from_f64);
    let moving = Obstacle { velocity, ..body };
    room.add_obstacle(moving).map_err(|_| Error::BadStorage)
}

/// Adds a grain near a place: its diameter, 0.9 to 1, and its place within 0.02 follow from its
/// number.
fn grain<R: Real>(
    room: &mut Room<R>,
    group: u8,
    place: [f64; 3],
    velocity: [f64; 3],
) -> Result<(), Error> {
    let number = room.world().grains.count() as u32 + 1;
    // Eight bits of a product that scatters them, over 256.
    let chance = |k: u32| {
        let bits = (4 * number + k).wrapping_mul(2_654_435_761) >> 24;
        f64::from(bits) * 0.00390625
    };
    let near = |k: u32, x: f64| R::from_f64(x + 0.04 * (chance(k) - 0.5));
    let [x, y, z] = place;
    let mut place = [near(0, x), near(1, y), near(2, z)];
    room.world().domain.wrap(&mut place, &mut [0; 3]);
    let radius = 0.45 + 0.05 * chance(3);
    let mass = 4.0 / 3.0 * core::f64::consts::PI * (radius * radius * radius);
    let (radius, mass) = (R::from_f64(radius), R::from_f64(mass));
    // Every third number is left out: ids are not places.
    let id = number + number / 3;
    room.add_grain(id, group, place, radius, mass)?;
    if let Some(row) = room.world().grains.velocity.last_mut() {
        let [vx, vy, vz] = velocity.map(R::from_f64);
        *row = [vx, vy, vz, mass];
    }
    Ok(())
}

fn collapse<R: Real>(room: &mut Room<R>) -> Result<(), Error> {
    clear(room, 4.0, 3.0)?;
    let half = R::HALF;
    let place = |x: f64, y: f64, z: f64| [x, y, z].map(R::from_f64);
    obstacle(
        room,
        Obstacle::plane(place(0.0, 0.0, 0.0), place(0.0, 0.0, 1.0)),
        [0.0; 3],
    )?;
    let mut ball = Obstacle::sphere(place(1.0, 0.5, 2.0), half);
    ball.inverse_mass = R::ONE;
    obstacle(room, ball, [0.0, 0.25, 0.0])?;
    let bar = Obstacle::cylinder(place(3.0, 0.0, 2.0), place(0.0, 1.0, 0.0), R::from_f64(0.4));
    obstacle(room, bar, [-0.125, 0.0, 0.0])?;
    for x in [0.5, 1.5, 2.5, 3.5] {
        grain(room, FROZEN, [x, 0.5, 0.53], [0.0; 3])?;
        grain(room, FREE, [x, 1.5, 0.5], [0.0; 3])?;
        grain(room, CARRIED, [x, 2.45, 0.57], [0.5, 0.0, 0.0])?;
    }
    for n in 0..18u8 {
        let (layer, site) = (n / 6, n % 6);
        let x = f64::from(2 * (site % 2) + (site / 2 + layer) % 2);
        let (y, z) = (f64::from(site / 2), f64::from(layer));
        let group = match n {
            4 | 8 => WEIGHTLESS,
            14 | 16 | 17 => LID,
            _ => FREE,
        };
        let along = if group == LID { 0.5 } else { 0.0 };
        grain(
            room,
            group,
            [x + 0.5, y + 0.5, 1.1 * z + 3.1],
            [along, 0.0, -1.5],
        )?;
    }
    Ok(())
}

fn bed<R: Real>(room: &mut Room<R>) -> Result<(), Error> {
    clear(room, 3.0, 3.0)?;
    let place = [1.5, 1.5, 1.6].map(R::from_f64);
    obstacle(room, Obstacle::sphere(place, R::from_f64(0.6)), [0.0; 3])?;
    // Each layer lies over the holes of the one below it, so that it soon rests.
    for layer in 0..3u8 {
        let shift = if layer == 1 { 1.0 } else { 0.5 };
        for site in 0..9u8 {
            let [x, y] = [site % 3, site / 3].map(f64::from);
            let place = [x + shift, y + shift, 0.72 * f64::from(layer)];
            // On top only three corners: the ball is in the middle.
            if layer < 2 || [2, 6, 8].contains(&site) {
                let group = if layer == 0 { FROZEN } else { FREE };
                grain(room, group, place, [0.0; 3])?;
            }
        }
    }
    Ok(())
}

fn rig<R: Real>(room: &mut Room<R>) -> Result<(), Error> {
    clear(room, 4.0, 2.25)?;
    let speed = [0.5, 0.0, 0.0];
    let place = |x: f64, y: f64, z: f64| [x, y, z].map(R::from_f64);
    let bar = Obstacle::cylinder(
        place(2.0, 0.0, 1.75),
        place(0.0, 1.0, 0.0),
        R::from_f64(0.45),
    );
    obstacle(room, bar, [0.0; 3])?;
    let ceiling = Obstacle::plane(place(0.0, 0.0, 5.0), place(0.0, 0.0, -1.0));
    obstacle(room, ceiling, speed)?;
    for layer in 0..5u8 {
        for site in 0..8u8 {
            let [x, y] = [site % 4, site / 4].map(f64::from);
            let place = [x + 0.5, 1.125 * y + 0.5625, f64::from(layer)];
            let across = x == 1.0 || x == 2.0;
            let group = match layer {
                0 => CARRIED,
                4 => LID,
                _ => WEIGHTLESS,
            };
            let taken = match layer {
                1 | 2 => across,
                3 => site > 5,
                _ => false,
            };
            if !taken {
                grain(
                    room,
                    group,
                    place,
                    if group == WEIGHTLESS { [0.0; 3] } else { speed },
                )?;
            }
        }
    }
    Ok(())
}
