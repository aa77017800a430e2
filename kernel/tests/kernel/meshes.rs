//! Meshes of triangles: which triangles hold a contact, how a contact goes over edges, and that nothing depends on how
//! a file cuts a surface into triangles.

use bitgrain_kernel::contact::HertzHistory;
use bitgrain_kernel::vec3::{add, dot, scale, sub};
use bitgrain_kernel::{Domain, Facet, Group, Obstacle, Store, arrange, start, step};
use proptest::prelude::*;

use crate::common::cases::cases;

type V = [f64; 3];

/// Triangles in order, and the obstacle that they are.
fn mesh(triangles: impl IntoIterator<Item = [V; 3]>) -> (Vec<Facet<f64>>, Obstacle<f64>) {
    let mut facets: Vec<_> = triangles.into_iter().map(Facet::new).collect();
    arrange(&mut facets);
    let body = Obstacle::mesh([0.0; 3], &facets, 0);
    (facets, body)
}

/// What a grain at rest feels: for each contact the share, the overlap and the normal.
fn contacts(
    (facets, body): &(Vec<Facet<f64>>, Obstacle<f64>),
    place: V,
    radius: f64,
) -> Vec<(f64, f64, V)> {
    let all = (0..body.shape.surfaces()).filter_map(|surface| {
        let met = body.meet(surface, facets, &Domain::open(), place, radius);
        (met.overlap > 0.0).then_some((met.share, met.overlap, met.normal))
    });
    all.collect()
}

/// Its force by Hertz: the sum of `share overlap^(3/2)` along the normals.
fn force(mesh: &(Vec<Facet<f64>>, Obstacle<f64>), place: V, radius: f64) -> V {
    let push = |(share, overlap, normal): (f64, f64, V)| scale(normal, share * overlap.powf(1.5));
    contacts(mesh, place, radius)
        .into_iter()
        .map(push)
        .fold([0.0; 3], add)
}

fn size(v: V) -> f64 {
    dot(v, v).sqrt()
}

/// Two rectangles that meet along the y axis: the first level, the other rising (or falling) by an angle, each cut in
/// two triangles.
fn crease(angle: f64) -> (Vec<Facet<f64>>, Obstacle<f64>) {
    let (far, wide) = ([4.0 * angle.cos(), 4.0 * angle.sin()], 3.0);
    let at = |[x, z]: [f64; 2], y: f64| [x, y, z];
    let corners = |end: [f64; 2]| {
        let [a, b] = [at([0.0; 2], -wide), at([0.0; 2], wide)];
        let [c, d] = [at(end, wide), at(end, -wide)];
        [[a, b, c], [a, c, d]]
    };
    mesh(corners([-4.0, 0.0]).into_iter().chain(corners(far)))
}

const RADIUS: f64 = 0.5;
const DEPTH: f64 = 0.005;

/// A path of the grain's centre over a crease: as deep in the deeper plane all the way, round a convex edge.
fn path(angle: f64, along: f64) -> V {
    let height = RADIUS - DEPTH;
    let (sine, cosine) = (angle.sin(), angle.cos());
    let turn = height * (0.5 * angle).tan();
    // Where the path bends at a hollow crease.
    if angle >= 0.0 {
        if along < 0.0 {
            return [along - turn, 0.1, height];
        }
        let corner = [-turn, 0.1, height];
        return add(corner, [along * cosine, 0.0, along * sine]);
    }
    let arc = height * -angle;
    if along < 0.0 {
        return [along, 0.1, height];
    }
    if along < arc {
        let turned = along / height;
        return [height * turned.sin(), 0.1, height * turned.cos()];
    }
    let on = along - arc;
    let top = [-height * sine, 0.1, height * cosine];
    add(top, [on * cosine, 0.0, on * sine])
}

/// Over a crease of any angle the force has no jump: the largest change between two places on the way halves with
/// their distance, but where the way itself bends at a hollow crease.
#[test]
fn the_force_has_no_jump_over_a_crease() {
    let degrees: [f64; 14] = [
        0.0, 1e-6, 0.01, 0.2, 0.5, 1.0, 3.0, 5.0, 8.0, 15.0, 30.0, 60.0, 90.0, 120.0,
    ];
    for angle in degrees.iter().flat_map(|a| [*a, -a]) {
        let surface = crease(angle.to_radians());
        let largest = |count: i32| {
            let reach = 0.6;
            let at = |k: i32| path(angle.to_radians(), reach * f64::from(k) / f64::from(count));
            let forces: Vec<V> = (-count..=count)
                .map(|k| force(&surface, at(k), RADIUS))
                .collect();
            let change = |pair: &[V]| size(sub(pair[1], pair[0]));
            forces.windows(2).map(change).fold(0.0, f64::max)
        };
        let (coarse, fine) = (largest(20_000), largest(40_000));
        let whole = DEPTH.powf(1.5);
        // A change of the whole force within a path of `width` is `0.6 / 20,000 / width` of it in a step. The second
        // contact of a hollow crease of this angle grows within a path of about `angle * RADIUS`, so that at the
        // smallest angles it takes less than a step, but then both point the same way.
        let bend = angle.to_radians().abs();
        assert!(
            coarse < 1e-3 * whole || fine < 0.6 * coarse || fine < 1.1 * bend * whole,
            "{angle} degrees: {} of the force, then {}",
            coarse / whole,
            fine / whole
        );
    }
}

/// On the flanks of a hollow crease that is not in the grain there are two whole contacts; over a convex one there is
/// always one.
#[test]
fn a_hollow_has_two_contacts_and_a_ridge_one() {
    let corner = crease(90f64.to_radians());
    let both = contacts(&corner, [-0.495, 0.1, 0.495], RADIUS);
    assert_eq!(
        both.iter().map(|(share, ..)| *share).collect::<Vec<_>>(),
        [1.0; 2]
    );
    for angle in [1.0f64, 30.0, 90.0, 150.0] {
        let ridge = crease(-angle.to_radians());
        for k in -600..600 {
            let place = path(-angle.to_radians(), f64::from(k) / 1000.0);
            let all = contacts(&ridge, place, RADIUS);
            assert_eq!(all.len(), 1, "{angle} degrees at {place:?}");
            let (share, overlap, _) = all[0];
            assert!(
                share == 1.0 && (overlap - DEPTH).abs() < 1e-15,
                "{share} {overlap}"
            );
        }
    }
}

/// A square cut into triangles any way is a plane: a fan round a corner, a strip, a grid. Places on edges and corners,
/// to the last bit, are tried too.
#[test]
fn flat_triangles_are_a_plane() {
    let fan = |count: usize| {
        let rim = move |k: usize| {
            let turn = std::f64::consts::TAU * (k % count) as f64 / count as f64;
            [3.0 * turn.cos(), 3.0 * turn.sin(), 0.25]
        };
        mesh((0..count).map(move |k| [[0.0, 0.0, 0.25], rim(k), rim(k + 1)]))
    };
    let grid = || {
        let corner = |x: i32, y: i32| [0.3 * f64::from(x), 0.3 * f64::from(y), 0.25];
        let squares = (-9..9).flat_map(|x| (-9..9).map(move |y| (x, y)));
        mesh(squares.flat_map(move |(x, y)| {
            let [a, b, c, d] = [
                corner(x, y),
                corner(x + 1, y),
                corner(x + 1, y + 1),
                corner(x, y + 1),
            ];
            [[a, b, c], [a, c, d]]
        }))
    };
    for (k, surface) in [fan(3), fan(6), fan(7), fan(24), grid()].iter().enumerate() {
        for n in 0..40_000u32 {
            let number =
                |n: u32| f64::from(n.wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24) - 0.5;
            let place = match n % 4 {
                0 => [0.0, 0.3 * f64::from(n % 7) - 0.9, 0.0],
                1 => [f64::from(n) * 1e-21, f64::from(n % 5) * -1e-17, 0.0],
                2 => [number(n), number(n), 0.0],
                _ => [number(n), number(n + 7), 0.0],
            };
            let place = add(place, [0.0, 0.0, 0.25 + RADIUS - DEPTH]);
            let all = contacts(surface, place, RADIUS);
            let whole: f64 = all.iter().map(|(share, ..)| share).sum();
            // A rounding of the sum of shares for each contact.
            assert!((whole - 1.0).abs() < 1e-14, "{k}: {all:?} at {place:?}");
            for (_, overlap, normal) in all {
                assert!((overlap - DEPTH).abs() < 1e-15 && (normal[2] - 1.0).abs() < 1e-15);
            }
        }
    }
}

/// A grain that lies on flat triangles and slides from one to the next feels what it feels on a plane: its spring goes
/// along.
#[test]
fn springs_go_along_over_flat_triangles() {
    let law = HertzHistory {
        kn: 2e5,
        kt: 2.45e5,
        gamma_n: 100.0,
        gamma_t: 100.0,
        mu: 0.5,
    };
    let (facets, body) = crease(0.0);
    let facets: &'static [Facet<f64>] = facets.leak();
    let plane = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
    let [flat, mesh] = [plane, body].map(|body| {
        let mut store = Store::<f64, 1, 4, 64, 1>::new(Domain::open(), 1e-4, 0.1);
        store.set_facets(facets);
        let free = store.add_group(Group::free([0.0, 0.0, -1.0])).unwrap();
        store.add_obstacle(body).unwrap();
        store
            .add_grain(
                1,
                free,
                [-0.05, -0.2, 0.49976],
                0.5,
                std::f64::consts::FRAC_PI_6,
            )
            .unwrap();
        let mut world = store.world();
        world.grains.velocity[0][..2].copy_from_slice(&[0.4, 0.3]);
        start(&mut world, &law).unwrap();
        for _ in 0..6000 {
            step(&mut world, &law).unwrap();
        }
        let g = &world.grains;
        [g.position[0], g.velocity[0], g.spin[0], g.force[0]]
    });
    assert!(flat[0][0] > 0.05, "it crosses the edges");
    for (one, other) in flat.iter().flatten().zip(mesh.iter().flatten()) {
        // Roundings of 6,000 steps.
        assert!((one - other).abs() < 1e-10, "{flat:?} {mesh:?}");
    }
}

/// Triangles of any form: also slivers, lines, points and copies.
fn triangle() -> impl Strategy<Value = [V; 3]> {
    let number = prop_oneof![-1.0..1.0f64, (-4..4i32).prop_map(|k| f64::from(k) * 0.25)];
    let corner = prop::array::uniform3(number);
    (prop::array::uniform3(corner), 0..8u8, -1e-12..1e-12f64).prop_map(
        |([a, b, c], form, little)| match form {
            0 => [a, b, b],
            1 => [a, a, a],
            2 => [a, b, add(scale(add(a, b), 0.5), [little, 0.0, 0.0])],
            3 => [a, b, add(b, [0.0, little, 0.0])],
            _ => [a, b, c],
        },
    )
}

proptest! {
    #![proptest_config(cases(400))]

    /// The order of triangles and of their corners says nothing, not to a bit.
    #[test]
    fn the_order_of_triangles_says_nothing(
        triangles in prop::collection::vec(triangle(), 1..30),
        keys in prop::collection::vec(any::<u32>(), 30),
        place in prop::array::uniform3(-1.2..1.2f64),
        radius in 0.05..0.8f64,
    ) {
        let mut others: Vec<_> = triangles.iter().zip(&keys).map(|([a, b, c], key)| {
            let turned = match key % 3 { 0 => [*c, *b, *a], 1 => [*b, *c, *a], _ => [*a, *b, *c] };
            (*key, turned)
        }).collect();
        others.sort_by_key(|(key, _)| *key);
        let others: Vec<_> = others.into_iter().map(|(_, triangle)| triangle).collect();
        let (one, other) = (mesh(triangles), mesh(others));
        prop_assert_eq!(one.1, other.1);
        let bits = |all: Vec<(f64, f64, V)>| -> Vec<_> {
            all.into_iter().map(|(s, o, n)| (s.to_bits(), o.to_bits(), n.map(f64::to_bits))).collect()
        };
        prop_assert_eq!(bits(contacts(&one, place, radius)), bits(contacts(&other, place, radius)));
    }

    /// What reaches into a grain pushes it: some contact remains, and what is least distant is one; shares are parts.
    #[test]
    fn the_nearest_place_is_a_contact(
        triangles in prop::collection::vec(triangle(), 1..30),
        place in prop::array::uniform3(-1.2..1.2f64),
        radius in 0.05..0.8f64,
    ) {
        let surface = mesh(triangles);
        let all = contacts(&surface, place, radius);
        let deepest = all.iter().map(|(_, overlap, _)| *overlap).fold(0.0, f64::max);
        let distance = surface.0.iter().map(|facet| nearest(facet.corners(), place)).fold(f64::INFINITY, f64::min);
        // Rounding of the normals of slivers, which are as thin as 1e-8 of their length.
        prop_assert!((deepest - (radius - distance).max(0.0)).abs() < 1e-7, "{} {}", deepest, radius - distance);
        for (share, overlap, normal) in all {
            prop_assert!(share > 0.0 && share <= 1.0 && overlap > 0.0, "{} {}", share, overlap);
            prop_assert!((size(normal) - 1.0).abs() < 1e-12);
        }
    }
}

/// Distance from a triangle by halving: the foot is sought among places `a + s (b - a) + t (c - a)`, in which the
/// distance is convex.
fn nearest([a, b, c]: [V; 3], place: V) -> f64 {
    let least = |f: &dyn Fn(f64) -> f64, most: f64| {
        let (mut low, mut high) = (0.0, most);
        for _ in 0..100 {
            let (one, two) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if f(one) < f(two) {
                high = two
            } else {
                low = one
            }
        }
        f(0.5 * (low + high)).min(f(0.0)).min(f(most))
    };
    let (along, across) = (sub(b, a), sub(c, a));
    let far = |s: f64, t: f64| size(sub(place, add(a, add(scale(along, s), scale(across, t)))));
    least(&|s| least(&|t| far(s, t), 1.0 - s), 1.0)
}
