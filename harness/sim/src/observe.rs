//! What is read off a state: free surface, packing fraction, coordination, support of the weight.
//!
//! Every function reads and none changes a state; sums run by ascending id.

use bitgrain_kernel::vec3::head;
use bitgrain_kernel::{ContactHistory, Domain, Obstacle, Shape};

use crate::contact_count::ContactCount;
use crate::simulation::{Role, Simulation};

/// Number of the intruder among the obstacles of a bed.
pub const INTRUDER: u32 = 0;

/// Height of the free surface: the median, over square columns about two mean diameters wide, of
/// the highest grain top; columns without grains are left out, and so is a lid.
pub fn surface_height(sim: &Simulation, mean_diameter: f64) -> f64 {
    let (lo, hi) = (sim.domain.lo(), sim.domain.hi());
    let columns = |a: usize| (((hi[a] - lo[a]) / (2.0 * mean_diameter)) as usize).max(1);
    let (nx, ny) = (columns(0), columns(1));
    let mut tops = vec![f64::NEG_INFINITY; nx * ny];
    for (i, x) in sim.position.iter().enumerate() {
        if sim.role(i) == Role::Lid {
            continue;
        }
        let place = |a: usize, n: usize| {
            let k = ((x[a] - lo[a]) / (hi[a] - lo[a]) * n as f64) as usize;
            k.min(n - 1)
        };
        let top = &mut tops[place(1, ny) * nx + place(0, nx)];
        if x[2] + x[3] > *top {
            *top = x[2] + x[3];
        }
    }
    tops.retain(|top| top.is_finite());
    tops.sort_by(f64::total_cmp);
    match tops.len() {
        0 => 0.0,
        n if n % 2 == 1 => tops[n / 2],
        n => 0.5 * (tops[n / 2 - 1] + tops[n / 2]),
    }
}

/// Volume of the part of a ball below the plane at height `z`.
fn ball_below(center: f64, radius: f64, z: f64) -> f64 {
    let h = (z - (center - radius)).clamp(0.0, 2.0 * radius);
    std::f64::consts::PI * h * h * (radius - h / 3.0)
}

/// Volume of the part of the intruder below the plane at height `z`, in a box of this width along y; bars lie.
fn intruder_below(body: &Obstacle<f64>, width: f64, z: f64) -> f64 {
    let radius = girth(body);
    let length = match body.shape {
        Shape::Cylinder { .. } => width,
        Shape::FiniteCylinder { half_length, .. } => 2.0 * half_length,
        _ => return ball_below(body.point[2], radius, z),
    };
    // A segment of the circle: the sector less the triangle.
    let h = (z - (body.point[2] - radius)).clamp(0.0, 2.0 * radius);
    let rest = radius - h;
    let chord = (h * (2.0 * radius - h)).sqrt();
    length * (radius * radius * libm::acos(rest / radius) - rest * chord)
}

/// Area of the bed as seen from above (length^2): of the box, or of the round tank that stands in it.
pub fn cross_section(sim: &Simulation) -> f64 {
    let tank = sim.obstacles.iter().find_map(|body| match body.shape {
        Shape::Drum { radius, .. } => Some(radius),
        _ => None,
    });
    let (lo, hi) = (sim.domain.lo(), sim.domain.hi());
    match tank {
        Some(radius) => std::f64::consts::PI * radius * radius,
        None => (hi[0] - lo[0]) * (hi[1] - lo[1]),
    }
}

/// Solid fraction of the layer between two heights, the intruder's part of it and the lid left out.
pub fn packing_fraction(sim: &Simulation, from: f64, to: f64) -> f64 {
    let (lo, hi) = (sim.domain.lo(), sim.domain.hi());
    let within = |z: f64, r: f64| ball_below(z, r, to) - ball_below(z, r, from);
    let grains = (0..sim.count()).filter(|&i| sim.role(i) != Role::Lid);
    let solid: f64 = grains
        .map(|i| within(sim.position[i][2], sim.position[i][3]))
        .sum();
    let room = cross_section(sim) * (to - from);
    let body = &sim.obstacles[INTRUDER as usize];
    let width = hi[1] - lo[1];
    solid / (room - (intruder_below(body, width, to) - intruder_below(body, width, from)))
}

/// Weight of all grains above a height over the area of the bed: the mean vertical stress there if
/// nothing but the bed carries it. Grains without gravity weigh nothing, but those of the base, which in a tank reach
/// up its wall, as much as free ones.
pub fn pressure_at(sim: &Simulation, height: f64) -> f64 {
    let mut weight = 0.0;
    for (i, x) in sim.position.iter().enumerate() {
        let whole = ball_below(0.0, x[3], x[3]);
        let above = (whole - ball_below(x[2], x[3], height)) / whole;
        let group = match sim.role(i) {
            Role::Base => 0,
            _ => sim.group[i] as usize,
        };
        weight += above * sim.velocity[i][3] * -sim.groups[group].gravity[2];
    }
    weight / cross_section(sim)
}

/// Mean number of contacts, with grains and obstacles, which were counted, of the free grains whose centres lie below
/// `top`; 0 if there are none.
pub fn coordination_number(sim: &Simulation, count: &ContactCount, top: f64) -> f64 {
    let counted = |i: &usize| sim.role(*i) == Role::Free && sim.position[*i][2] < top;
    let grains = (0..sim.count()).filter(counted);
    let (grains, contacts) = grains.fold((0usize, 0usize), |(grains, contacts), i| {
        (grains + 1, contacts + count.contacts[i] as usize)
    });
    match grains {
        0 => 0.0,
        n => contacts as f64 / n as f64,
    }
}

/// From a body's centre, or the nearest point of a bar's axis, to a place, minimum image.
pub fn offset(domain: &Domain<f64>, body: &Obstacle<f64>, place: [f64; 3]) -> [f64; 3] {
    let mut d = domain.separation(place, body.point);
    let (axis, most) = match body.shape {
        Shape::Cylinder { axis, .. } => (axis, f64::INFINITY),
        Shape::FiniteCylinder { half_length, .. } => (body.direction(), half_length),
        _ => return d,
    };
    let along = d[0] * axis[0] + d[1] * axis[1] + d[2] * axis[2];
    let along = along.clamp(-most, most);
    for a in 0..3 {
        d[a] -= along * axis[a];
    }
    d
}

/// How far a body's surface is from its centre, or from the axis of a bar (length).
pub fn girth(body: &Obstacle<f64>) -> f64 {
    match body.shape {
        Shape::FiniteCylinder { radius, .. } => radius,
        _ => body.reach(),
    }
}

/// Where a place is along a bar that turns about z, from its middle (length, negative on one half), and the
/// direction in which that half moves: a horizontal unit vector across the bar. `None` of a body of another shape.
pub fn on_turning_bar(
    domain: &Domain<f64>,
    body: &Obstacle<f64>,
    place: [f64; 3],
) -> Option<(f64, [f64; 3])> {
    let Shape::FiniteCylinder { .. } = body.shape else {
        return None;
    };
    let (d, [x, y, z]) = (domain.separation(place, body.point), body.direction());
    let along = d[0] * x + d[1] * y + d[2] * z;
    let ahead = match along < 0.0 {
        true => [y, -x, 0.0],
        false => [-y, x, 0.0],
    };
    Some((along, ahead))
}

/// Length of a vector.
pub fn length(d: [f64; 3]) -> f64 {
    (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt()
}

/// From the intruder's centre or axis to a grain's centre, minimum image.
fn from_intruder(sim: &Simulation, i: usize) -> [f64; 3] {
    let x = sim.position[i];
    let body = &sim.obstacles[INTRUDER as usize];
    offset(&sim.domain, body, [x[0], x[1], x[2]])
}

/// Angle at which a grain at a place touches the intruder: `cos theta = (x_grain - x_intruder) / distance`, minimum
/// image, in radians, 0 straight ahead. The sign of eq. 6 of Kumar 2018 is a misprint, for eq. 7 needs
/// this one. Ahead of a bar that turns about z is where its half moves.
///
/// `front` is 1 if the intruder moves along +x, -1 if the bed does.
pub fn contact_angle(
    domain: &Domain<f64>,
    intruder: &Obstacle<f64>,
    place: [f64; 3],
    front: f64,
) -> f64 {
    let d = offset(domain, intruder, place);
    let forward = match on_turning_bar(domain, intruder, place) {
        Some((_, ahead)) => d[0] * ahead[0] + d[1] * ahead[1],
        None => front * d[0],
    };
    libm::acos(forward / length(d))
}

/// What is round the intruder.
pub struct Neighbourhood {
    /// Angles at which grains touch it, by ascending grain (radians).
    pub angles: Vec<f64>,
    radius: f64,
    /// Squared distance from its centre or axis and number of contacts of free grains.
    grains: Vec<(f64, f64)>,
}

impl Neighbourhood {
    /// Numbers of contacts, with grains and obstacles, of the free grains whose centres lie within `reach` of the
    /// intruder's surface, those without contacts among them; `reach` is at most the one that was looked at.
    pub fn contacts(&self, reach: f64) -> impl Iterator<Item = f64> {
        let limit = self.radius + reach;
        let near = move |grain: &&(f64, f64)| grain.0 <= limit * limit;
        self.grains.iter().filter(near).map(|grain| grain.1)
    }
}

/// What is round the intruder, as far as `reach` from its surface (Kumar 2018, Figs. 6 and 7), of contacts that were
/// counted. `front` is that of [`contact_angle`].
pub fn neighbourhood(
    sim: &Simulation,
    count: &ContactCount,
    reach: f64,
    front: f64,
) -> Neighbourhood {
    let body = sim.obstacles[INTRUDER as usize];
    let angle = |i: u32| contact_angle(&sim.domain, &body, head(sim.position[i as usize]), front);
    let radius = girth(&body);
    let limit = radius + reach;
    let near = |i: usize| {
        let d = from_intruder(sim, i);
        let squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        (sim.role(i) == Role::Free && squared <= limit * limit)
            .then(|| (squared, f64::from(count.contacts[i])))
    };
    Neighbourhood {
        grains: (0..sim.count()).filter_map(near).collect(),
        angles: sim.touching(INTRUDER).into_iter().map(angle).collect(),
        radius,
    }
}

/// Overlap of a grain, by its place, with the intruder (length).
fn overlap_with_intruder(sim: &Simulation, i: u32) -> f64 {
    let (x, body) = (sim.position[i as usize], &sim.obstacles[INTRUDER as usize]);
    match body.shape {
        // The nearest place may be on one of its ends.
        Shape::FiniteCylinder { .. } => body.meet(0, &[], &sim.domain, head(x), x[3]).overlap,
        _ => x[3] + body.reach() - length(from_intruder(sim, i as usize)),
    }
}

/// Deepest overlap of grains with each other, which were counted, and with the intruder, from the positions (length);
/// 0 if none touch.
pub fn deepest_overlap(sim: &Simulation, count: &ContactCount) -> f64 {
    let deeper = |a, b| if b > a { b } else { a };
    let touching = sim.touching(INTRUDER).into_iter();
    touching
        .map(|i| overlap_with_intruder(sim, i))
        .fold(count.deepest, deeper)
}

/// Overlaps of grains with each other and with the intruder, from the positions (length).
pub fn overlaps(sim: &mut Simulation) -> Vec<f64> {
    let contacts = sim.contact_histories();
    let overlap = |contact: &ContactHistory<f64>| match *contact {
        ContactHistory::Pair { i, j, .. } => {
            let (x, y) = (sim.position[i as usize], sim.position[j as usize]);
            let d = sim.domain.separation(head(x), head(y));
            Some(x[3] + y[3] - length(d))
        }
        ContactHistory::Obstacle { i, obstacle, .. } => {
            (obstacle == INTRUDER).then(|| overlap_with_intruder(sim, i))
        }
    };
    contacts.contacts().iter().filter_map(overlap).collect()
}

/// Share of the [`overlaps`] beyond a bound; `None` if none touch.
pub fn overlaps_beyond(sim: &mut Simulation, bound: f64) -> Option<f64> {
    let all = overlaps(sim);
    let beyond = all.iter().filter(|overlap| **overlap > bound).count();
    (!all.is_empty()).then(|| beyond as f64 / all.len() as f64)
}

/// Free grains, the weight of all that may fall, a lid's grains among them, and the upward force that
/// base, planes and intruder put on them (by the third law: what the base's grains and the obstacles
/// feel downward).
pub fn weight_and_support(sim: &Simulation) -> (usize, f64, f64) {
    let (mut free, mut weight, mut support) = (0, 0.0, 0.0);
    for i in 0..sim.count() {
        let role = sim.role(i);
        if role == Role::Base {
            support -= sim.force[i][2];
            continue;
        }
        free += usize::from(role == Role::Free);
        weight += sim.velocity[i][3] * -sim.groups[sim.group[i] as usize].gravity[2];
    }
    for body in &sim.obstacles {
        support -= body.force[2];
    }
    (free, weight, support)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ball_volumes_add_up() {
        let whole = ball_below(0.0, 0.5, 1.0);
        assert!((whole - std::f64::consts::PI / 6.0).abs() < 1e-15);
        assert!((ball_below(0.0, 0.5, 0.0) - whole / 2.0).abs() < 1e-15);
        assert_eq!(ball_below(0.0, 0.5, -0.5), 0.0);
    }
}
