//! Bodies the obvious way, by what is written of them: where a grain meets them, and how they move. Nothing is shared
//! with the kernel but vectors.

use bitgrain_kernel::vec3::{add, cross, dot, scale, sub};
use bitgrain_kernel::{Domain, Motion, Obstacle, Shape};

type V = [f64; 3];
type Q = [f64; 4];

/// Unit vector to the grain and overlap.
type Met = (V, f64);

fn over(v: V, s: f64) -> V {
    v.map(|x| x / s)
}

/// `v + w t + u x t` with `t = 2 u x v`.
pub fn out([w, x, y, z]: Q, v: V) -> V {
    let u = [x, y, z];
    let t = add(cross(u, v), cross(u, v));
    add(add(v, scale(t, w)), cross(u, t))
}

/// The same backwards.
pub fn back([w, x, y, z]: Q, v: V) -> V {
    out([w, -x, -y, -z], v)
}

fn product(p: Q, q: Q) -> Q {
    let (u, v) = ([p[1], p[2], p[3]], [q[1], q[2], q[3]]);
    let w = add(add(scale(v, p[0]), scale(u, q[0])), cross(u, v));
    [p[0] * q[0] - dot(u, v), w[0], w[1], w[2]]
}

fn of_length_one(q: Q) -> Q {
    let length = (((q[0] * q[0] + q[1] * q[1]) + q[2] * q[2]) + q[3] * q[3]).sqrt();
    q.map(|x| x / length)
}

/// Where a grain with this radius meets a surface, by the offset of its centre, in the own axes of the shape.
fn nearest(shape: &Shape<f64>, surface: u32, d: V, radius: f64) -> Met {
    let round = |apart: V, own: f64| {
        let far = dot(apart, apart).sqrt();
        (over(apart, far), (radius + own) - far)
    };
    match *shape {
        Shape::Plane { normal } => (normal, radius - dot(d, normal)),
        Shape::Sphere { radius: own } => round(d, own),
        Shape::Cylinder { axis, radius: own } => round(sub(d, scale(axis, dot(d, axis))), own),
        Shape::Capsule {
            axis,
            radius: own,
            half_length,
        } => {
            let middle = dot(d, axis).clamp(-half_length, half_length);
            round(sub(d, scale(axis, middle)), own)
        }
        Shape::Box { half } => {
            let apart = [0, 1, 2].map(|a| d[a] - d[a].clamp(-half[a], half[a]));
            if apart != [0.0; 3] {
                return round(apart, 0.0);
            }
            let depths = [0, 1, 2].map(|a| half[a] - d[a].abs());
            let face = (1..3).fold(0, |face, a| if depths[a] < depths[face] { a } else { face });
            let mut normal = [0.0; 3];
            normal[face] = if d[face] < 0.0 { -1.0 } else { 1.0 };
            (normal, radius + depths[face])
        }
        Shape::FiniteCylinder {
            axis,
            radius: own,
            half_length,
        } => {
            let along = dot(d, axis);
            let across = sub(d, scale(axis, along));
            let far = dot(across, across).sqrt();
            let (beside, beyond) = (far - own, along.abs() - half_length);
            if beside > 0.0 && beyond > 0.0 {
                let end = scale(axis, along.clamp(-half_length, half_length));
                let rim = sub(across, scale(across, beside / far));
                return round(sub(sub(d, end), rim), 0.0);
            }
            if beyond > beside {
                let side = if along < 0.0 { -1.0 } else { 1.0 };
                return (scale(axis, side), radius - beyond);
            }
            round(across, own)
        }
        Shape::Drum {
            axis,
            radius: own,
            half_length,
        } => {
            let along = dot(d, axis);
            let across = sub(d, scale(axis, along));
            let far = dot(across, across).sqrt();
            match surface {
                0 => (over(scale(across, -1.0), far), (far + radius) - own),
                1 => (axis, radius - (half_length + along)),
                _ => (scale(axis, -1.0), radius - (half_length - along)),
            }
        }
        Shape::Mesh { .. } => unreachable!("see `slow_mesh`"),
    }
}

/// Offset of a grain's centre from a body's, in the axes of the world and of the body.
pub fn own_offset(body: &Obstacle<f64>, domain: &Domain<f64>, place: V) -> (V, V) {
    let offset = domain.separation(place, body.point);
    (offset, back(body.orientation, offset))
}

/// Unit vector to the grain, offset of its centre and overlap, in the axes of the world.
pub fn meet(
    body: &Obstacle<f64>,
    surface: u32,
    domain: &Domain<f64>,
    place: V,
    radius: f64,
) -> (V, V, f64) {
    let offset = match body.shape {
        Shape::Plane { .. } => sub(place, body.point),
        _ => domain.separation(place, body.point),
    };
    let endless = matches!(body.shape, Shape::Plane { .. } | Shape::Cylinder { .. });
    if endless || body.orientation == [1.0, 0.0, 0.0, 0.0] {
        let (normal, overlap) = nearest(&body.shape, surface, offset, radius);
        return (normal, offset, overlap);
    }
    let own = back(body.orientation, offset);
    let (normal, overlap) = nearest(&body.shape, surface, own, radius);
    (out(body.orientation, normal), offset, overlap)
}

/// Half a kick.
pub fn kick(body: &mut Obstacle<f64>, dt: f64) {
    let Motion::Free(free) = body.motion else {
        return;
    };
    for a in 0..3 {
        if free.integrates[a] {
            let pull = (body.force[a] + free.force[a]) * body.inverse_mass + free.gravity[a];
            body.velocity[a] += pull * (dt * 0.5);
        }
    }
    if free.spins {
        let torque = back(body.orientation, add(body.torque, free.torque));
        let own = [0, 1, 2].map(|a| torque[a] * (dt * 0.5) / free.inertia[a]);
        body.angular_velocity = add(body.angular_velocity, out(body.orientation, own));
    }
}

/// A step of the way and of the turn.
pub fn drift(body: &mut Obstacle<f64>, domain: &Domain<f64>, dt: f64) {
    for a in 0..3 {
        body.point[a] += body.velocity[a] * dt;
    }
    domain.wrap(&mut body.point, &mut body.image);
    let mut q = body.orientation;
    match body.motion {
        Motion::Free(free) if free.spins => {
            let mut w = back(q, body.angular_velocity);
            let quarter = (dt * 0.5) * 0.5;
            for (a, time) in [
                (0, quarter),
                (1, quarter),
                (2, dt * 0.5),
                (1, quarter),
                (0, quarter),
            ] {
                let t = w[a] * time;
                let (cosine, sine) = ((1.0 - t * t) / (1.0 + t * t), (t + t) / (1.0 + t * t));
                let (b, c) = ((a + 1) % 3, (a + 2) % 3);
                let (lb, lc) = (free.inertia[b] * w[b], free.inertia[c] * w[c]);
                w[b] = (lb * cosine + lc * sine) / free.inertia[b];
                w[c] = (lc * cosine - lb * sine) / free.inertia[c];
                let mut turn = [1.0, 0.0, 0.0, 0.0];
                turn[a + 1] = t;
                q = product(q, turn);
            }
            body.orientation = of_length_one(q);
            body.angular_velocity = out(body.orientation, w);
        }
        _ if body.angular_velocity != [0.0; 3] => {
            let h = scale(body.angular_velocity, dt * 0.5);
            // |h| / tan |h|, from the innermost of eight levels on.
            let mut c = 1.0;
            for odd in [15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0] {
                c = 1.0 - (dot(h, h) * (1.0 / (odd * (odd + 2.0)))) / c;
            }
            body.orientation = of_length_one(product([c, h[0], h[1], h[2]], q));
        }
        _ => {}
    }
}
