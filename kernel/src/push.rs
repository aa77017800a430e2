//! Forces: which listed pairs touch, what the law says, and the sums in the contract's order.
//!
//! The force on a grain is the sum from +0.0 over obstacles by ascending number, then over
//! neighbours by ascending id. A half list walked with `i` and `j` ascending gives that order to
//! both partners without a sort: grain `g` hears from the rows before its own, in order, and then
//! walks its own row. The chain of orderings, so that no change breaks one link unseen:
//!
//! * rows ascend, and partners ascend in a row;
//! * the filter keeps that order and only leaves out pairs that cannot touch;
//! * a block of lanes is evaluated at once but summed lane by lane;
//! * a range of rows first takes what lower ranges send it (their [`Spill`]s, in order), then walks
//!   its rows up to its own end, then adds its own spills: the pairs whose partner lies beyond it.
//!   So any cut into ranges gives the bits of one range.

use core::ops::Range;

use crate::domain::Domain;
use crate::fault::Fault;
use crate::grains::Row;
use crate::law::{Contact, Law};
use crate::pairs::{PLACE, TOUCHING};
use crate::real::{Real, smaller};
use crate::rows::{at, gain, halves_mut, lose, set};
use crate::vec3::{Vec3, add, cross, dot, head, scale, sub};

/// Contacts evaluated at once where the caller does not say: four doubles fill a register of AVX2;
/// small cores have no wide registers, and one lane takes a quarter of the code. It has no effect on
/// any bit.
pub const LANES: usize = if cfg!(any(target_arch = "arm", target_arch = "riscv32")) {
    1
} else {
    4
};

/// What the force phase reads: the whole world, shared by all ranges.
#[derive(Clone, Copy)]
pub struct Sight<'a, R> {
    /// The box.
    pub domain: &'a Domain<R>,
    /// Positions and radii.
    pub position: &'a [Row<R>],
    /// Velocities and masses.
    pub velocity: &'a [Row<R>],
    /// Spins and inverse contact masses.
    pub spin: &'a [Row<R>],
    /// Where each grain's row of pairs begins.
    pub row: &'a [u32],
    /// Time that the tangential springs advance by; 0 at step 0.
    pub dt: R,
}

/// What the force phase writes for one range of rows; ranges share nothing.
pub struct Part<'a, R> {
    /// The grains of the range.
    pub rows: Range<usize>,
    /// Their forces.
    pub force: &'a mut [Row<R>],
    /// Their torques.
    pub torque: &'a mut [Row<R>],
    /// The partners of their rows.
    pub partner: &'a mut [u32],
    /// The springs of their rows.
    pub spring: &'a mut [Row<R>],
}

impl<'a, R: Real> Part<'a, R> {
    /// The first `grains` rows of the range, and the others; `row` is that of [`Sight`].
    pub fn split(self, grains: usize, row: &[u32]) -> (Self, Self) {
        let (first, end) = (self.rows.start, self.rows.end);
        let middle = if grains < end - first {
            first + grains
        } else {
            end
        };
        let pairs = (at(row, middle) as usize).saturating_sub(at(row, first) as usize);
        let force = halves_mut(self.force, middle - first);
        let torque = halves_mut(self.torque, middle - first);
        let partner = halves_mut(self.partner, pairs);
        let spring = halves_mut(self.spring, pairs);
        let left = Self {
            rows: first..middle,
            force: force.0,
            torque: torque.0,
            partner: partner.0,
            spring: spring.0,
        };
        let right = Self {
            rows: middle..end,
            force: force.1,
            torque: torque.1,
            partner: partner.1,
            spring: spring.1,
        };
        (left, right)
    }

    /// Where the row of grain `i` lies in the range's own slices.
    #[inline(always)]
    fn row(&self, row: &[u32], i: usize) -> Range<usize> {
        row_of(row, at(row, self.rows.start), i)
    }

    /// Pairs of the range whose partner lies beyond it: what [`spill`] needs room for.
    pub fn spills(&self, row: &[u32]) -> usize {
        let end = self.rows.end;
        let rows = self.rows.clone();
        rows.map(|i| beyond(self.partner, self.row(row, i), end).len())
            .sum()
    }
}

/// The row of grain `i` in slices that begin at pair `base`.
#[inline(always)]
fn row_of(row: &[u32], base: u32, i: usize) -> Range<usize> {
    let (begin, end) = (at(row, i), at(row, i + 1));
    begin.wrapping_sub(base) as usize..end.wrapping_sub(base) as usize
}

/// The pairs of a row whose partner lies at `end` or beyond it.
#[inline(always)]
fn beyond(partner: &[u32], row: Range<usize>, end: usize) -> Range<usize> {
    let mut begin = row.end;
    // Partners ascend, and most rows end within the range.
    while begin > row.start && (at(partner, begin - 1) & PLACE) as usize >= end {
        begin -= 1;
    }
    begin..row.end
}

/// The force of one contact whose partner lies beyond the range that evaluated it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Spill<R> {
    /// Place of the lower grain.
    pub i: u32,
    /// Place of the higher grain.
    pub j: u32,
    /// Force on `i`.
    pub force: Vec3<R>,
    /// Normal crossed with the tangential force.
    pub couple: Vec3<R>,
    /// Lever about `i`.
    pub arm_i: R,
    /// Lever about `j`.
    pub arm_j: R,
}

/// The other body of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Partner {
    /// The grain at this place.
    Grain(u32),
    /// The obstacle of this number.
    Obstacle(u32),
}

/// One touching contact as it was evaluated, for whoever watches a step.
#[derive(Clone, Copy, Debug)]
pub struct Pushed<R> {
    /// Place of the grain (the lower one of two).
    pub i: u32,
    /// Its partner.
    pub partner: Partner,
    /// Depth of the overlap (length).
    pub overlap: R,
    /// Unit vector from the partner to the grain.
    pub normal: Vec3<R>,
    /// Normal force on the grain along `normal`; negative when it pulls.
    pub normal_force: R,
    /// Tangential force on the grain.
    pub tangential_force: Vec3<R>,
}

/// Two places whose grains overlap beyond the limit, or nothing.
pub type Deep = Option<(u32, u32)>;

/// The lower of two deepest pairs: what one range over both would have found first.
pub fn first_deep(a: Deep, b: Deep) -> Deep {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b < a { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// Evaluates the pairs of a range whose partner lies beyond it, `W` at once, into `out`, by
/// `(i, j)`. Returns how many there are.
///
/// # Errors
/// [`Fault::PairsFull`] where `out` is shorter than [`Part::spills`]; nothing is lost.
#[inline(always)]
pub fn spill<R: Real, L: Law<R>, const W: usize>(
    sight: Sight<'_, R>,
    part: &mut Part<'_, R>,
    law: &L,
    out: &mut [Spill<R>],
) -> Result<(usize, Deep), Fault> {
    let needed = part.spills(sight.row);
    if needed > out.len() {
        return Err(Fault::PairsFull { needed });
    }
    let (rows, end) = (part.rows.clone(), part.rows.end);
    let base = at(sight.row, rows.start);
    let mut count = 0;
    let deep = sweep::<R, L, W>(
        sight,
        rows,
        part.partner,
        part.spring,
        law,
        |partner, i| beyond(partner, row_of(sight.row, base, i), end),
        |one, _| {
            set(out, count, one);
            count += 1;
        },
    );
    Ok((count, deep))
}

/// Sums the forces and torques of a range that already hold the obstacles' share, evaluating `W`
/// contacts at once.
///
/// `lower` are the spills of the ranges before this one, in order; `own` are this range's. With one
/// range over all grains both are empty, and this is the definition. `watch` sees every contact
/// evaluated here (not the spills); it cannot change one.
#[inline(always)]
pub fn sum<'s, R: Real, L: Law<R>, const W: usize>(
    sight: Sight<'_, R>,
    part: &mut Part<'_, R>,
    law: &L,
    lower: impl Iterator<Item = &'s Spill<R>>,
    own: &[Spill<R>],
    mut watch: impl FnMut(Pushed<R>),
) -> Deep {
    let rows = part.rows.clone();
    let (first, end) = (rows.start, rows.end);
    for one in lower {
        if rows.contains(&(one.j as usize)) {
            let g = (one.j as usize).wrapping_sub(first);
            lose(part.force, g, one.force);
            lose(part.torque, g, scale(one.couple, one.arm_j));
        }
    }
    let base = at(sight.row, first);
    let within = |partner: &[u32], i: usize| {
        let row = row_of(sight.row, base, i);
        row.start..beyond(partner, row, end).start
    };
    let (force, torque) = (&mut *part.force, &mut *part.torque);
    let deep = sweep::<R, L, W>(
        sight,
        rows,
        part.partner,
        part.spring,
        law,
        within,
        |one, pushed| {
            watch(pushed);
            let place = |g: u32| (g as usize).wrapping_sub(first);
            let (i, j) = (place(one.i), place(one.j));
            gain(force, i, one.force);
            lose(force, j, one.force);
            lose(torque, i, scale(one.couple, one.arm_i));
            lose(torque, j, scale(one.couple, one.arm_j));
        },
    );
    for one in own {
        let i = (one.i as usize).wrapping_sub(first);
        gain(part.force, i, one.force);
        lose(part.torque, i, scale(one.couple, one.arm_i));
    }
    deep
}

/// Contacts that passed the filter and wait for evaluation, so that filter and law each run over
/// many at a time: fewer where the stack is small. A multiple of every number of lanes and a power of two.
const BATCH: usize = if cfg!(any(target_arch = "arm", target_arch = "riscv32")) {
    16
} else {
    64
};

/// Places of both grains of a contact and of the pair in its list.
type Waiting = [u32; 3];

/// Walks the pairs that `take` gives for each row, filters them, evaluates those that may touch in
/// blocks, keeps their springs, and hands each touching contact to `emit` in order.
#[inline(always)]
fn sweep<R: Real, L: Law<R>, const W: usize>(
    sight: Sight<'_, R>,
    rows: Range<usize>,
    partner: &mut [u32],
    spring: &mut [Row<R>],
    law: &L,
    take: impl Fn(&[u32], usize) -> Range<usize>,
    mut emit: impl FnMut(Spill<R>, Pushed<R>),
) -> Deep {
    const {
        assert!(
            W > 0 && BATCH.is_multiple_of(W),
            "lanes must divide a batch"
        )
    };
    // Copies of its own: the compiler must see that nothing written here can change them, or it does
    // not use wide registers.
    let (law, domain) = (&{ *law }, &{ *sight.domain });
    let sight = Sight { domain, ..sight };
    // Squares of distances are rounded by a few units in the last place; the filter gives 16.
    let margin = R::ONE + R::EPSILON * R::from_f64(16.0);
    let position = sight.position;
    let mut deep = None;
    let mut batch: [Waiting; BATCH] = [[0; 3]; BATCH];
    let mut count = 0;
    for i in rows {
        let x = at(position, i);
        let row = take(partner, i);
        let mut p = row.start;
        while p < row.end {
            // Idle lanes at the end of a row repeat its first and are never kept.
            let used = if row.end - p < W { row.end - p } else { W };
            let word: [u32; W] =
                core::array::from_fn(|k| at(partner, p + if k < used { k } else { 0 }));
            let y = lanes(position, word.map(|w| w & PLACE));
            let near: [bool; W] = core::array::from_fn(|k| {
                let d = sight
                    .domain
                    .separation(head(x), [y[0][k], y[1][k], y[2][k]]);
                let reach = x[3] + y[3][k];
                dot(d, d) < reach * reach * margin
            });
            let mut parted = false;
            for k in 0..W {
                // Written always, kept only when near: no branch to mispredict.
                batch[count % BATCH] = [i as u32, word[k] & PLACE, (p + k) as u32];
                count += (near[k] && k < used) as usize;
                parted |= !near[k] && word[k] & TOUCHING != 0;
            }
            if parted {
                for k in 0..W {
                    if k < used && !near[k] {
                        set(partner, p + k, word[k] & PLACE);
                        set(spring, p + k, [R::ZERO; 4]);
                    }
                }
            }
            if count > BATCH - W {
                let found =
                    evaluate_all::<R, L, W>(sight, &batch, count, partner, spring, law, &mut emit);
                deep = deep.or(found);
                count = 0;
            }
            p += W;
        }
    }
    let found = evaluate_all::<R, L, W>(sight, &batch, count, partner, spring, law, &mut emit);
    deep.or(found)
}

/// The rows at these places, turned into lanes: word by word, side by side; zeros where
/// one of them is beyond the end. One way out for all: a default for each would cost more than the
/// rows.
#[inline(always)]
fn lanes<R: Real, const W: usize>(rows: &[Row<R>], places: [u32; W]) -> [[R; W]; 4] {
    let none = [R::ZERO; 4];
    let mut row: [&Row<R>; W] = [&none; W];
    for k in 0..W {
        let Some(found) = rows.get(places[k] as usize) else {
            return [[R::ZERO; W]; 4];
        };
        row[k] = found;
    }
    core::array::from_fn(|w| core::array::from_fn(|k| row[k][w]))
}

/// The first `count` contacts of a batch, block by block.
#[inline(always)]
fn evaluate_all<R: Real, L: Law<R>, const W: usize>(
    sight: Sight<'_, R>,
    batch: &[Waiting; BATCH],
    count: usize,
    partner: &mut [u32],
    spring: &mut [Row<R>],
    law: &L,
    emit: &mut impl FnMut(Spill<R>, Pushed<R>),
) -> Deep {
    let mut deep = None;
    let mut done = 0;
    while done < count {
        // Idle lanes of the last block repeat its first contact and are ignored.
        let used = if count - done < W { count - done } else { W };
        let block: [Waiting; W] =
            core::array::from_fn(|k| batch[(done + if k < used { k } else { 0 }) % BATCH]);
        let found = evaluate(sight, &block, used, partner, spring, law, emit);
        deep = deep.or(found);
        done += W;
    }
    deep
}

/// One block: rows into lanes, the law in every lane, lanes out in order.
#[inline(always)]
fn evaluate<R: Real, L: Law<R>, const W: usize>(
    sight: Sight<'_, R>,
    block: &[Waiting; W],
    used: usize,
    partner: &mut [u32],
    spring: &mut [Row<R>],
    law: &L,
    emit: &mut impl FnMut(Spill<R>, Pushed<R>),
) -> Deep {
    let zero = [R::ZERO; W];
    let turn = |rows: &[Row<R>], body: usize| lanes(rows, block.map(|one| one[body]));
    let (xi, xj) = (turn(sight.position, 0), turn(sight.position, 1));
    let (vi, vj) = (turn(sight.velocity, 0), turn(sight.velocity, 1));
    let (wi, wj) = (turn(sight.spin, 0), turn(sight.spin, 1));
    let mut s = turn(spring, 2);

    let mut force = [zero; 3];
    let mut couple = [zero; 3];
    let mut normal = [zero; 3];
    let mut tangential = [zero; 3];
    let mut arm = [zero; 2];
    let (mut overlap, mut normal_force) = (zero, zero);
    for k in 0..W {
        let of = |v: &[[R; W]]| [v[0][k], v[1][k], v[2][k]];
        let d = sight.domain.separation(of(&xi), of(&xj));
        let distance = dot(d, d).sqrt();
        let (ri, rj) = (xi[3][k], xj[3][k]);
        let contact = Contact {
            normal: scale(d, R::ONE / distance),
            overlap: (ri + rj) - distance,
            radius_i: ri,
            radius_j: rj,
            radius_effective: (ri * rj) / (ri + rj),
            mass_effective: R::ONE / (wi[3][k] + wj[3][k]),
            velocity: sub(of(&vi), of(&vj)),
            spin_i: of(&wi),
            spin_j: of(&wj),
        };
        let r = law.react(&contact, of(&s), sight.dt);
        let push = add(scale(contact.normal, r.normal), r.tangential);
        let turn = cross(contact.normal, r.tangential);
        for w in 0..3 {
            force[w][k] = push[w];
            couple[w][k] = turn[w];
            s[w][k] = r.spring[w];
            normal[w][k] = contact.normal[w];
            tangential[w][k] = r.tangential[w];
        }
        (overlap[k], normal_force[k]) = (contact.overlap, r.normal);
        (arm[0][k], arm[1][k]) = (r.arm_i, r.arm_j);
    }

    let mut deep = None;
    for (k, [i, j, pair]) in block.iter().copied().enumerate().take(used) {
        let pair = pair as usize;
        let of = |v: &[[R; W]]| [v[0][k], v[1][k], v[2][k]];
        // Only the law's own overlap opens or erases a contact.
        if overlap[k] > R::ZERO {
            set(partner, pair, j | TOUCHING);
            set(spring, pair, [s[0][k], s[1][k], s[2][k], R::ZERO]);
            let spill = Spill {
                i,
                j,
                force: of(&force),
                couple: of(&couple),
                arm_i: arm[0][k],
                arm_j: arm[1][k],
            };
            let pushed = Pushed {
                i,
                partner: Partner::Grain(j),
                overlap: overlap[k],
                normal: of(&normal),
                normal_force: normal_force[k],
                tangential_force: of(&tangential),
            };
            emit(spill, pushed);
            if overlap[k] > smaller(xi[3][k], xj[3][k]) * R::HALF && deep.is_none() {
                deep = Some((i, j));
            }
        } else if at(partner, pair) & TOUCHING != 0 {
            set(partner, pair, j);
            set(spring, pair, [R::ZERO; 4]);
        }
    }
    deep
}
