//! Where the reference worlds begin: boxes, obstacles, and grains that the compiler places.

use crate::error::Error;
use crate::math::real::Real;
use crate::owners::store::Store;
use crate::state::domain::Domain;
use crate::state::grains::Group;
use crate::state::obstacle::Obstacle;

/// Most grains of a world.
pub const GRAINS: usize = 30;

/// Storage for any of the worlds: 16 kB in double precision.
pub type Room<R> = Store<R, GRAINS, 54, 12, 5, 3>;

/// Groups by number, in each of the worlds.
const FREE: u8 = 0;
const FROZEN: u8 = 1;
const CARRIED: u8 = 2;
const WEIGHTLESS: u8 = 3;
const LID: u8 = 4;

/// Empties the room for a box from z = -1 to 9 that is periodic along x and y, with all groups; those that do not fall
/// freely are of this material.
fn clear<R: Real>(
    room: &mut Room<R>,
    along_x: f64,
    along_y: f64,
    material: u8,
) -> Result<(), Error> {
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
        Group::frozen().of_material(material),
        Group::prescribed_velocity().of_material(material),
        Group::free([R::ZERO; 3]),
        Group::free_along_z(down).of_material(material),
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

/// A grain as a world begins with it.
#[derive(Clone, Copy)]
struct Placed {
    group: u8,
    place: [f64; 3],
    radius: f64,
    mass: f64,
    /// Velocity, in halves.
    halves: [i8; 3],
}

/// The grains that a world begins with.
struct Crowd {
    count: usize,
    grains: [Placed; GRAINS],
}

impl Crowd {
    const fn new() -> Self {
        let nothing = Placed {
            group: FREE,
            place: [0.0; 3],
            radius: 0.0,
            mass: 0.0,
            halves: [0; 3],
        };
        Self {
            count: 0,
            grains: [nothing; GRAINS],
        }
    }

    /// Adds a grain near a place: its diameter, 0.9 to 1, and its place within 0.02 follow from its number.
    const fn with(mut self, group: u8, place: [f64; 3], halves: [i8; 3]) -> Self {
        let number = self.count as u32 + 1;
        let [x, y, z] = place;
        let radius = 0.45 + 0.05 * chance(number, 3);
        self.grains[self.count] = Placed {
            group,
            place: [
                x + 0.04 * (chance(number, 0) - 0.5),
                y + 0.04 * (chance(number, 1) - 0.5),
                z + 0.04 * (chance(number, 2) - 0.5),
            ],
            radius,
            mass: 4.0 / 3.0 * core::f64::consts::PI * (radius * radius * radius),
            halves,
        };
        self.count += 1;
        self
    }
}

/// Eight bits of a product that scatters them, over 256.
const fn chance(number: u32, k: u32) -> f64 {
    ((4 * number + k).wrapping_mul(2_654_435_761) >> 24) as f64 * 0.00390625
}

fn add_grains<R: Real>(room: &mut Room<R>, crowd: &Crowd) -> Result<(), Error> {
    for (k, grain) in crowd.grains.iter().take(crowd.count).enumerate() {
        let number = k as u32 + 1;
        let mut place = grain.place.map(R::from_f64);
        room.world().domain.wrap(&mut place, &mut [0; 3]);
        let (radius, mass) = (R::from_f64(grain.radius), R::from_f64(grain.mass));
        // Every third number is left out: ids are not places.
        let id = number + number / 3;
        room.add_grain(id, grain.group, place, radius, mass)?;
        if let Some(row) = room.world().grains.velocity.last_mut() {
            let [vx, vy, vz] = grain.halves.map(|n| {
                let size = R::from_count(u32::from(n.unsigned_abs())) * R::HALF;
                if n < 0 { -size } else { size }
            });
            *row = [vx, vy, vz, mass];
        }
    }
    Ok(())
}

static COLLAPSE: Crowd = {
    let mut crowd = Crowd::new();
    let mut n = 0;
    while n < 4 {
        let x = n as f64 + 0.5;
        crowd = crowd.with(FROZEN, [x, 0.5, 0.53], [0; 3]);
        crowd = crowd.with(FREE, [x, 1.5, 0.5], [0; 3]);
        crowd = crowd.with(CARRIED, [x, 2.45, 0.57], [1, 0, 0]);
        n += 1;
    }
    let mut n = 0;
    while n < 18 {
        let (layer, site) = (n / 6, n % 6);
        let x = (2 * (site % 2) + (site / 2 + layer) % 2) as f64;
        let (y, z) = ((site / 2) as f64, layer as f64);
        let group = match n {
            4 | 8 => WEIGHTLESS,
            14 | 16 | 17 => LID,
            _ => FREE,
        };
        let along = if group == LID { 1 } else { 0 };
        crowd = crowd.with(group, [x + 0.5, y + 0.5, 1.1 * z + 3.1], [along, 0, -3]);
        n += 1;
    }
    crowd
};

pub(super) fn collapse<R: Real>(room: &mut Room<R>, material: u8) -> Result<(), Error> {
    clear(room, 4.0, 3.0, material)?;
    let half = R::HALF;
    let place = |x: f64, y: f64, z: f64| [x, y, z].map(R::from_f64);
    obstacle(
        room,
        Obstacle::plane(place(0.0, 0.0, 0.0), place(0.0, 0.0, 1.0)),
        [0.0; 3],
    )?;
    let mut ball = Obstacle::sphere(place(1.0, 0.5, 2.0), half);
    ball.inverse_mass = R::ONE;
    ball.material = material;
    obstacle(room, ball, [0.0, 0.25, 0.0])?;
    let bar = Obstacle::cylinder(place(3.0, 0.0, 2.0), place(0.0, 1.0, 0.0), R::from_f64(0.4));
    obstacle(room, bar, [-0.125, 0.0, 0.0])?;
    add_grains(room, &COLLAPSE)
}

/// Each layer lies over the holes of the one below it, so that it soon rests.
static BED: Crowd = {
    let mut crowd = Crowd::new();
    let mut n = 0;
    while n < 27 {
        let (layer, site) = (n / 9, n % 9);
        let shift = if layer == 1 { 1.0 } else { 0.5 };
        let (x, y) = ((site % 3) as f64, (site / 3) as f64);
        let place = [x + shift, y + shift, 0.72 * layer as f64];
        // On top only three corners: the ball is in the middle.
        if layer < 2 || site == 2 || site == 6 || site == 8 {
            let group = if layer == 0 { FROZEN } else { FREE };
            crowd = crowd.with(group, place, [0; 3]);
        }
        n += 1;
    }
    crowd
};

pub(super) fn bed<R: Real>(room: &mut Room<R>) -> Result<(), Error> {
    clear(room, 3.0, 3.0, 0)?;
    let place = [1.5, 1.5, 1.6].map(R::from_f64);
    obstacle(room, Obstacle::sphere(place, R::from_f64(0.6)), [0.0; 3])?;
    add_grains(room, &BED)
}

static RIG: Crowd = {
    let mut crowd = Crowd::new();
    let mut n = 0;
    while n < 40 {
        let (layer, site) = (n / 8, n % 8);
        let (x, y) = ((site % 4) as f64, (site / 4) as f64);
        let place = [x + 0.5, 1.125 * y + 0.5625, layer as f64];
        let group = match layer {
            0 => CARRIED,
            4 => LID,
            _ => WEIGHTLESS,
        };
        let taken = match layer {
            1 | 2 => site % 4 == 1 || site % 4 == 2,
            3 => site > 5,
            _ => false,
        };
        if !taken {
            let along = if group == WEIGHTLESS { 0 } else { 1 };
            crowd = crowd.with(group, place, [along, 0, 0]);
        }
        n += 1;
    }
    crowd
};

pub(super) fn rig<R: Real>(room: &mut Room<R>) -> Result<(), Error> {
    clear(room, 4.0, 2.25, 0)?;
    let place = |x: f64, y: f64, z: f64| [x, y, z].map(R::from_f64);
    let bar = Obstacle::cylinder(
        place(2.0, 0.0, 1.75),
        place(0.0, 1.0, 0.0),
        R::from_f64(0.45),
    );
    obstacle(room, bar, [0.0; 3])?;
    let ceiling = Obstacle::plane(place(0.0, 0.0, 5.0), place(0.0, 0.0, -1.0));
    obstacle(room, ceiling, [0.5, 0.0, 0.0])?;
    add_grains(room, &RIG)
}
