//! The store of fixed capacity, on its own: a small bed collapses round a ball and comes to rest.

use bitgrain_kernel::contact::HertzHistory;
use bitgrain_kernel::vec3::{dot, head, sub};
use bitgrain_kernel::{
    Domain, Error, Group, Obstacle, Store, World, digest, start, step, step_watched,
};

const LAW: HertzHistory<f64> = HertzHistory {
    kn: 2e5,
    kt: 2.45e5,
    gamma_n: 792.0,
    gamma_t: 792.0,
    mu: 0.5,
};

const GRAINS: usize = 30;

/// The ball that the bed collapses round: centre and radius.
const BALL: ([f64; 3], f64) = ([2.75, 2.5, 0.8], 0.8);

/// Thirty grains of unequal sizes in loose layers over a floor, beside and above a resting ball, in
/// a box that is periodic along x and y.
fn bed<const PAIRS: usize>(skin: f64) -> Box<Store<f64, GRAINS, PAIRS, 64, 2>> {
    let domain = Domain::new([0.0, 0.0, -1.0], [5.5, 5.0, 20.0], [true, true, false]).unwrap();
    let mut store = Box::new(Store::new(domain, 5e-4, skin));
    store.add_group(Group::free([0.0, 0.0, -1.0])).unwrap();
    store
        .add_obstacle(Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]))
        .unwrap();
    store
        .add_obstacle(Obstacle::sphere(BALL.0, BALL.1))
        .unwrap();
    let mut id = 0;
    for site in 0..60u32 {
        let [x, y, z] = [site % 4, site / 4 % 4, site / 16].map(f64::from);
        // Layers lean, so that grains fall beside each other and the collapse is not a column's.
        let place = [1.3 * x + 0.6 + 0.2 * z, 1.2 * y + 0.6, 1.2 * z + 0.6];
        let away = sub(place, BALL.0);
        let free = dot(away, away).sqrt() > BALL.1 + 0.55;
        if free && id < GRAINS as u32 {
            let radius = 0.45 + 0.01 * f64::from(site * 7 % 11);
            let mass = 4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius;
            id += 1;
            store.add_grain(id, 0, place, radius, mass).unwrap();
        }
    }
    assert_eq!(id as usize, GRAINS);
    store
}

/// Kinetic energy (translation and rotation), and energy of height.
fn energies(world: &World<'_, f64>) -> (f64, f64) {
    let g = &world.grains;
    (0..g.count()).fold((0.0, 0.0), |(kinetic, height), i| {
        let (x, v, w) = (g.position[i], g.velocity[i], head(g.spin[i]));
        let rolls = 0.4 * x[3] * x[3] * dot(w, w);
        let moving = 0.5 * v[3] * (dot(head(v), head(v)) + rolls);
        (kinetic + moving, height + v[3] * x[2])
    })
}

#[test]
fn a_bed_collapses_round_a_ball_and_rests() {
    let mut store = bed::<256>(0.1);
    let mut world = store.world();
    start(&mut world, &LAW).unwrap();
    let (_, before) = energies(&world);
    let mut most = 0.0f64;
    for _ in 0..40_000 {
        step(&mut world, &LAW).unwrap();
        most = most.max(energies(&world).0);
    }
    let (kinetic, after) = energies(&world);
    // A loose packing settles by some tenths of its height; none of it was ever all in motion.
    assert!(after < 0.9 * before, "it fell from {before} to {after}");
    assert!(
        most > 0.01 * before && most < before - after,
        "{most} moved"
    );
    // A loose grain rolls on for ever, as no law here resists rolling: a part in ten thousand of
    // what was set free is left for that.
    assert!(
        kinetic < 1e-4 * (before - after),
        "still moving with {kinetic:e}"
    );

    let weight: f64 = world.grains.velocity.iter().map(|v| v[3]).sum();
    let (floor, ball) = (world.obstacles[0].force, world.obstacles[1].force);
    assert!(ball[2] < 0.0, "grains lean on the ball: {ball:?}");
    // Floor and ball carry the weight, and hold each other, up to what still shakes: contacts are
    // so stiff that a hundredth of the weight is an oscillation of a millionth of a diameter.
    let left = [
        floor[0] + ball[0],
        floor[1] + ball[1],
        floor[2] + ball[2] + weight,
    ];
    for force in left {
        assert!(force.abs() < 1e-2 * weight, "{left:?} is left over");
    }

    let mut deepest = 0.0f64;
    step_watched(&mut world, &LAW, |p| deepest = deepest.max(p.overlap)).unwrap();
    // Even the whole weight on one contact presses it in by less than this: F = sqrt(R) kn d^1.5.
    let limit = (weight / (LAW.kn * 0.22f64.sqrt())).powf(2.0 / 3.0);
    assert!(deepest > 0.0 && deepest < limit, "{deepest} of {limit}");
}

#[test]
fn a_full_store_gives_back_what_it_did_not_take() {
    let mut store = bed::<256>(0.1);
    start(&mut store.world(), &LAW).unwrap();
    let before = digest(&store.world());
    store.add_group(Group::frozen()).unwrap();
    let group = Group::prescribed_velocity();
    assert_eq!(store.add_group(group), Err(group));
    let obstacle = Obstacle::sphere([1.0, 2.0, 3.0], 0.25);
    assert_eq!(store.add_obstacle(obstacle), Err(obstacle));
    let refused = store.add_grain(99, 0, [1.0; 3], 0.5, 0.5);
    assert!(matches!(refused, Err(Error::GrainsFull { .. })));
    assert_eq!(digest(&store.world()), before, "nothing was changed");
    // The one group that was taken asks for a new start, and the bed is as it was.
    assert_eq!(step(&mut store.world(), &LAW), Err(Error::NotStarted));
    start(&mut store.world(), &LAW).unwrap();
    assert_eq!(digest(&store.world()), before);
}

#[test]
fn a_refused_addition_does_not_stop_a_run() {
    let mut store = bed::<256>(0.1);
    store.add_group(Group::frozen()).unwrap();
    start(&mut store.world(), &LAW).unwrap();
    assert!(store.add_group(Group::prescribed_velocity()).is_err());
    let ball = Obstacle::sphere([1.0, 2.0, 3.0], 0.25);
    assert!(store.add_obstacle(ball).is_err());
    assert!(store.add_grain(99, 0, [1.0; 3], 0.5, 0.5).is_err());
    assert_eq!(step(&mut store.world(), &LAW), Ok(()));
}

/// A list too short for the skin says how long it had to be and changes nothing; with a smaller
/// skin the same store goes on, with the bits of a roomy one.
#[test]
fn a_list_too_short_for_its_skin_goes_on_with_a_smaller_one() {
    let (mut roomy, mut tight) = (bed::<512>(3.0), bed::<96>(3.0));
    start(&mut roomy.world(), &LAW).unwrap();
    let full = start(&mut tight.world(), &LAW);
    let listed = roomy.world().clock.listed();
    assert_eq!(full, Err(Error::OuterListFull { needed: listed }));
    tight.set_skin(0.02);
    start(&mut tight.world(), &LAW).unwrap();
    for n in 0..4000 {
        if n == 2000 {
            tight.set_skin(3.0);
            let before = digest(&tight.world());
            // Until the list runs out the run goes on; then it stops before anything moves.
            let mut world = tight.world();
            let mut after = before;
            let fault = loop {
                match step(&mut world, &LAW) {
                    Ok(()) => after = digest(&world),
                    Err(fault) => break fault,
                }
            };
            assert!(matches!(fault, Error::OuterListFull { needed } if needed > 96));
            assert_eq!(digest(&world), after);
            tight.set_skin(0.0);
            let done = tight.world().clock.step;
            for _ in n..done {
                step(&mut roomy.world(), &LAW).unwrap();
            }
        }
        step(&mut roomy.world(), &LAW).unwrap();
        step(&mut tight.world(), &LAW).unwrap();
    }
    assert_eq!(digest(&tight.world()), digest(&roomy.world()));
}
