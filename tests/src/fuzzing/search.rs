//! The neighbour search against all pairs: grains on the edges of cells and of the box, across periods, at
//! equal places and just touching, which fly through each other without a force.

use crate::fuzzing::lent::add;
use crate::fuzzing::lent::reserve;
use bitgrain_kernel::contact::HertzHistory;
use bitgrain_kernel::phases::{
    After, MotionPhase, accumulate, begin, drift, end, ensure_pair_list, ensure_pair_list_ahead,
    finish, integrate, no_fetch, obstacle_forces, seal,
};
use bitgrain_kernel::vec3::{dot, head, scale, sub};
use bitgrain_kernel::{
    Domain, Error as KernelError, Group, Obstacle, Partner, Shape, TOUCHING, World, start_watched,
};

use super::bytes::Bytes;
use super::lent::Lent;
use super::parts::{Ghosts, Parts};
use super::world::owners;

/// Most grains: enough for four cells along an axis with several grains each.
const GRAINS: u8 = 24;
const STEPS: u8 = 16;

/// Contacts: places of two grains, or of a grain and an obstacle above `TOUCHING`.
type Met = Vec<(u32, u32)>;

/// A law without forces, so that grains fly straight.
const NOTHING: HertzHistory<f64> = HertzHistory {
    kn: 0.0,
    kt: 0.0,
    gamma_n: 0.0,
    gamma_t: 0.0,
    mu: 0.0,
};

/// A crowd that flies: at every step the contacts that are evaluated are those that all pairs show, and
/// the lists hold them in order, whatever skin, reach, cells and parts were drawn.
pub fn search(data: &[u8]) -> bool {
    let mut bytes = Bytes(data);
    let Some(mut lent) = crowd(&mut bytes) else {
        return false;
    };
    let mut met = Met::new();
    loop {
        met.clear();
        let started = start_watched(&mut lent.world(), &NOTHING, |one| met.push(named(one)));
        match started {
            Ok(()) => break,
            Err(fault) if lent.grow(fault) => {}
            // Grains may overlap as deep as they like: they were found, but the steps end there.
            Err(KernelError::OverlapTooDeep { .. } | KernelError::ObstacleTooDeep { .. }) => {
                compare(&lent.world(), &met);
                return true;
            }
            Err(_) => return false,
        }
    }
    compare(&lent.world(), &met);
    for _ in 0..1 + bytes.byte() % STEPS {
        let flown = match bytes.below(4) {
            0 => fly_in_parts(&mut bytes, &mut lent, &mut met),
            way => fly(&mut lent, way == 1, &mut met),
        };
        match flown {
            Ok(()) => compare(&lent.world(), &met),
            Err(_) => return true,
        }
    }
    true
}

fn named(one: bitgrain_kernel::ContactForce<f64>) -> (u32, u32) {
    match one.partner {
        Partner::Grain(j) => (one.i, j),
        Partner::Obstacle(k) => (one.i, k | TOUCHING),
    }
}

/// One step by its phases, without the check of overlaps; the list is looked at before the drift or after it.
fn fly(lent: &mut Lent<f64>, before: bool, met: &mut Met) -> Result<(), KernelError> {
    let mut world = lent.world();
    let sealed = seal(&world.grain_motion(), 0);
    begin(&mut world, sealed)?;
    while before && let Err(fault) = ensure_pair_list_ahead(&mut lent.world()) {
        if !lent.grow(fault) {
            return Err(fault);
        }
    }
    let mut world = lent.world();
    let passed = integrate(&mut world.grain_motion(), MotionPhase::Drift);
    drift(&mut world, passed)?;
    while let Err(fault) = ensure_pair_list(&mut lent.world()) {
        if !lent.grow(fault) {
            return Err(fault);
        }
    }
    met.clear();
    let mut world = lent.world();
    let (mut part, mut touch) = world.force_ranges(world.dt);
    obstacle_forces(&mut part, &mut touch, &NOTHING, |one| met.push(named(one)));
    let watch = |one| met.push(named(one));
    accumulate(&mut part, &NOTHING, watch, no_fetch(), After::Stay);
    let passed = integrate(&mut world.grain_motion(), MotionPhase::Kick);
    finish(&mut world, passed)?;
    let sealed = seal(&world.grain_motion(), 0);
    end(&mut world, sealed)
}

/// Some steps in parts, without the check of overlaps; what the last one evaluates is kept.
fn fly_in_parts(bytes: &mut Bytes, lent: &mut Lent<f64>, met: &mut Met) -> Result<(), KernelError> {
    let owner = owners(bytes, lent.position.len());
    let ghosts = [Ghosts::All, Ghosts::Near][bytes.below(2)];
    let mut world = lent.world();
    let sealed = seal(&world.grain_motion(), 0);
    begin(&mut world, sealed)?;
    let mut parts = Parts::of(&world, &owner, ghosts);
    parts.checks_forces = false;
    parts.steps(&NOTHING, bytes.below(3) as u64, &mut |_| ())?;
    met.clear();
    parts.steps(&NOTHING, 1, &mut |one| met.push(named(one)))?;
    while let Err(fault) = parts.rejoin(&mut lent.world()) {
        if !lent.grow(fault) {
            return Err(fault);
        }
    }
    let mut world = lent.world();
    let sealed = seal(&world.grain_motion(), 0);
    end(&mut world, sealed)
}

/// Distance of two grains' surfaces; below zero they touch.
fn gap(world: &World<'_, f64>, i: u32, j: u32) -> f64 {
    let (x, y) = (
        world.grains.position[i as usize],
        world.grains.position[j as usize],
    );
    let d = world.domain.separation(head(x), head(y));
    -((x[3] + y[3]) - dot(d, d).sqrt())
}

/// Distance to the nearest image by trying three along each axis, less the radii.
fn gap_by_images(world: &World<'_, f64>, i: u32, j: u32) -> f64 {
    let (x, y) = (
        world.grains.position[i as usize],
        world.grains.position[j as usize],
    );
    let along = |a: usize| {
        let period = world.domain.hi()[a] - world.domain.lo()[a];
        let period = if world.domain.periodic()[a] {
            period
        } else {
            0.0
        };
        let raw = x[a] - y[a];
        raw.abs()
            .min((raw + period).abs())
            .min((raw - period).abs())
    };
    let d = [along(0), along(1), along(2)];
    dot(d, d).sqrt() - (x[3] + y[3])
}

/// Distance of a grain's surface from an obstacle's.
fn gap_to(world: &World<'_, f64>, i: u32, k: usize) -> f64 {
    let (x, body) = (world.grains.position[i as usize], &world.obstacles[k]);
    match body.shape {
        Shape::Sphere { radius } => {
            let d = world.domain.separation(head(x), body.point);
            -((x[3] + radius) - dot(d, d).sqrt())
        }
        Shape::Cylinder { axis, radius } => {
            let offset = world.domain.separation(head(x), body.point);
            let d = sub(offset, scale(axis, dot(offset, axis)));
            -((x[3] + radius) - dot(d, d).sqrt())
        }
        Shape::Plane { normal } => dot(sub(head(x), body.point), normal) - x[3],
        _ => -body.meet(0, &[], world.domain, head(x), x[3]).overlap,
    }
}

/// Compares the contacts evaluated and those listed with all pairs. Beside rounding, the images must agree: 1e-9
/// is far above that at coordinates of some hundred.
fn compare(world: &World<'_, f64>, met: &Met) {
    let (g, n) = (&world.grains, world.grains.count() as u32);
    let heavy = |i: u32| g.groups[usize::from(g.group[i as usize])].infinite_mass;
    let listed: Met = world.listed_pairs().collect();
    assert_eq!(listed.len(), world.clock.listed());
    assert!(listed.is_sorted_by(|a, b| a < b), "pairs ascend");
    let touches: Met = (0..world.clock.obstacle_contacts())
        .map(|t| {
            (
                world.pairs.obstacle_contact_grain[t],
                world.pairs.obstacle_contact_obstacle[t] & !TOUCHING,
            )
        })
        .collect();
    assert!(
        touches.is_sorted_by(|a, b| a < b),
        "obstacle contacts ascend"
    );
    let mut wanted = Met::new();
    for i in 0..n {
        for j in i + 1..n {
            if heavy(i) && heavy(j) {
                assert!(!listed.contains(&(i, j)), "two heavy grains are listed");
                continue;
            }
            let gap = gap(world, i, j);
            let off = gap - gap_by_images(world, i, j);
            assert!(
                off.abs() < 1e-9,
                "{i} and {j} are not at their nearest images"
            );
            if gap < 0.0 {
                wanted.push((i, j));
            }
        }
        for (k, body) in world.obstacles.iter().enumerate() {
            let able = !heavy(i) || body.inverse_mass > 0.0;
            if able && gap_to(world, i, k) < 0.0 {
                wanted.push((i, k as u32 | TOUCHING));
            }
        }
    }
    let mut met = met.clone();
    met.sort_unstable();
    wanted.sort_unstable();
    assert_eq!(met, wanted, "who is evaluated and who touches");
}

/// Grains and obstacles of sizes within a factor of eight, in a box of a few cells; storage as drawn.
fn crowd(bytes: &mut Bytes) -> Option<Lent<f64>> {
    let periodic = [0; 3].map(|_| bytes.below(2) == 0);
    let lo = [0; 3].map(|_| bytes.between(-50.0, 50.0));
    let length = [0; 3].map(|_| bytes.between(2.0, 9.0));
    let hi = [0, 1, 2].map(|a| lo[a] + length[a]);
    let open = bytes.below(8) == 0;
    let domain = match open {
        true => Domain::open(),
        false => Domain::new(lo, hi, periodic).ok()?,
    };
    let mut lent = Lent::new(domain, 0.125);
    lent.skin = [0.0, 0.01, 0.3, 2.0][bytes.below(4)] * bytes.between(0.0, 1.0);
    lent.outer_skin = [0.0, 0.1, 1.0, 1e3][bytes.below(4)] * bytes.between(0.0, 1.0);
    lent.groups = vec![
        Group::free([0.0; 3]),
        Group::frozen(),
        Group::prescribed_velocity(),
        Group::free_along_z([0.0; 3]),
    ];
    for _ in 0..bytes.below(4) {
        let point = [0, 1, 2].map(|a| bytes.between(lo[a], hi[a]));
        let radius = bytes.between(0.05, 1.5);
        let lying = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]][bytes.below(3)];
        let mut body = match bytes.below(4) {
            0 => Obstacle::plane(point, lying),
            1 => Obstacle::cylinder(point, lying, radius),
            2 => Obstacle::sphere(point, radius),
            _ => Obstacle::cylinder(point, bytes.direction(), radius),
        };
        body.inverse_mass = bytes.below(2) as f64;
        body.velocity = bytes.vector().map(|v| v * 0.2);
        lent.obstacles.push(body);
    }
    let mut before = lo;
    for _ in 0..bytes.byte() % GRAINS {
        let radius = 0.5 * [1.0, 1.0, 0.125, 0.7][bytes.below(4)];
        // The search's cells are as wide as the widest pair and the distance that it looks beyond.
        let width = 1.0 + lent.skin + lent.outer_skin;
        let mut place = [0, 1, 2].map(|a| {
            let (kind, along, ulps) = (bytes.below(6), bytes.between(0.0, 1.0), bytes.below(5));
            let cells = (length[a] / width).floor().max(1.0);
            let x = match kind {
                0 => lo[a] + length[a] * ((along * (cells + 1.0)).floor() / cells),
                1 => lo[a] + width * (along * 8.0).floor(),
                2 => before[a],
                3 => before[a] + 2.0 * radius * (along * 3.0).floor() - 2.0 * radius,
                _ => lo[a] + length[a] * along,
            };
            let x = [x, x.next_up(), x.next_down(), x + 1e-15, x - 1e-12][ulps];
            if periodic[a] && !open {
                x.clamp(lo[a], hi[a].next_down())
            } else {
                x.clamp(lo[a], hi[a])
            }
        });
        domain.wrap(&mut place, &mut [0; 3]);
        before = place;
        let speed = [0.0, 0.01, 0.9, 0.999][bytes.below(4)] * radius / lent.dt;
        let velocity = bytes.vector().map(|v| v * speed);
        let group = [0, 0, 0, 1, 2, 3][bytes.below(6)];
        let velocity = if group == 1 { [0.0; 3] } else { velocity };
        let [x, y, z] = place;
        let [u, v, w] = velocity;
        add(
            &mut lent,
            group,
            [x, y, z, radius],
            [u, v, w, 1.0],
            [0.0; 3],
        );
    }
    let cells = 2 + bytes.below(100);
    lent.cell_start = vec![7; cells];
    reserve(&mut lent, bytes.below(60), bytes.below(60), bytes.below(20));
    Some(lent)
}
