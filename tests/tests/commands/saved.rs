//! A world as bytes is the same from C and from the owned simulation, and either goes on from the other's.

use std::ptr::null_mut;
use std::sync::Arc;

use bitgrain::law::{AnyLaw, Pairs};
use bitgrain::simulation::{Grain, Simulation, sphere_mass};
use bitgrain_capi::grains::bg_insert;
use bitgrain_capi::laws::bg_set_pair_law;
use bitgrain_capi::obstacles::bg_add_obstacle;
use bitgrain_capi::saved::{bg_load, bg_save, bg_save_size};
use bitgrain_capi::setup::{bg_add_group, bg_init, bg_set_policy, bg_size};
use bitgrain_capi::status::{BG_LAW_MISFIT, BG_OK};
use bitgrain_capi::steps::{bg_start, bg_step};
use bitgrain_capi::types::{
    BG_HERTZ_HISTORY, BG_HERTZ_TSUJI, BG_NO_ROLLING, BG_PLANE, BG_ROLLING_EPSD2, BG_ROLLING_SDS,
    bg_capacity, bg_config, bg_grain, bg_group, bg_law, bg_obstacle, bg_policy, bg_world,
};
use bitgrain_kernel::contact::{HertzHistory, HertzTsuji, RollingResistance, RollingSpring};
use bitgrain_kernel::{Domain, Drain, Group, LossPolicy, Obstacle};

const BOX: [f64; 3] = [4.0, 4.0, 20.0];
const GRAVITY: [f64; 3] = [0.0, 0.0, -1.0];
const BELOW: [f64; 3] = [0.0, 0.0, -5.0];
const UP: [f64; 3] = [0.0, 0.0, 1.0];

fn sized<T>() -> u32 {
    size_of::<T>() as u32
}

fn grains() -> Vec<Grain> {
    let grain = |k: u32| Grain {
        id: 2 * k + 1,
        group: 0,
        diameter: 0.9 + 0.02 * f64::from(k % 5),
        density: 1.5,
        position: [
            0.6 + 1.02 * f64::from(k % 3),
            0.6 + 1.02 * f64::from(k / 3 % 3),
            0.5 + 1.01 * f64::from(k / 9),
        ],
        velocity: [1.0, 0.1, 0.0],
        spin: [0.0, 0.2, 0.0],
    };
    (0..30).map(grain).collect()
}

/// The world as a simulation, after some steps.
fn owned(law: AnyLaw, steps: u64) -> Simulation {
    let domain = Domain::new([0.0; 3], BOX, [true, true, false]).unwrap();
    let floor = Obstacle {
        material: law.materials() - 1,
        ..Obstacle::plane([0.0; 3], UP)
    };
    let groups = vec![Group::free(GRAVITY)];
    let mut sim = Simulation::new(law, domain, 1e-3, groups, &grains(), vec![floor]);
    sim.policy = LossPolicy {
        takes_out: true,
        drain: Some(Drain {
            point: BELOW,
            normal: UP,
        }),
    };
    sim.start().unwrap();
    sim.steps(steps).unwrap();
    sim
}

/// A world in C, with its memory.
struct InC(#[allow(dead_code)] Vec<u64>, *mut bg_world);

fn done(status: i32) {
    assert_eq!(status, BG_OK);
}

impl InC {
    /// An empty world.
    fn new(law: bg_law, is_table: bool) -> Self {
        let capacity = bg_capacity {
            size: sized::<bg_capacity>(),
            grains: 40,
            pairs: 1000,
            candidates: 1000,
            obstacle_contacts: 100,
            cells: 200,
            obstacles: 2,
            groups: 2,
            facets: 0,
            materials: if is_table { 2 } else { 0 },
        };
        let config = bg_config {
            size: sized::<bg_config>(),
            periodic: 0b011,
            lo: [0.0; 3],
            hi: BOX,
            dt: 1e-3,
            skin: 0.05,
            outer_skin: 0.2,
            law,
        };
        let size = bg_size(&capacity);
        let mut memory = vec![0u64; size / 8];
        let mut world = null_mut();
        done(bg_init(
            memory.as_mut_ptr().cast(),
            size,
            &capacity,
            &config,
            &mut world,
        ));
        Self(memory, world)
    }

    /// The same as [`owned`].
    fn made(law: bg_law, between: &[([u32; 2], bg_law)], steps: u64) -> Self {
        let this = Self::new(law, !between.is_empty());
        let (world, mut number) = (this.1, 0);
        let group = bg_group {
            size: sized::<bg_group>(),
            integrates: 0b111,
            spins: 1,
            infinite_mass: 0,
            gravity: GRAVITY,
            material: 0,
            reserved: 0,
        };
        done(bg_add_group(world, &group, &mut number));
        for ([a, b], law) in between {
            done(bg_set_pair_law(world, *a, *b, law));
        }
        let floor = bg_obstacle {
            size: sized::<bg_obstacle>(),
            kind: BG_PLANE,
            point: [0.0; 3],
            direction: UP,
            radius: 0.0,
            inverse_mass: 0.0,
            velocity: [0.0; 3],
            material: u32::from(!between.is_empty()),
            ..bg_obstacle::default()
        };
        done(bg_add_obstacle(world, &floor, &mut number));
        let policy = bg_policy {
            size: sized::<bg_policy>(),
            takes_out: 1,
            drains: 1,
            reserved: 0,
            point: BELOW,
            normal: UP,
        };
        done(bg_set_policy(world, &policy));
        let grain = |g: &Grain| bg_grain {
            size: sized::<bg_grain>(),
            id: g.id,
            group: g.group.into(),
            reserved: 0,
            position: g.position,
            radius: 0.5 * g.diameter,
            mass: sphere_mass(g.diameter, g.density),
            velocity: g.velocity,
            spin: g.spin,
        };
        let grains: Vec<bg_grain> = grains().iter().map(grain).collect();
        done(bg_insert(world, grains.as_ptr(), grains.len()));
        done(bg_start(world));
        done(bg_step(world, steps));
        this
    }

    fn save(&self) -> Vec<u8> {
        let mut needed = 0;
        done(bg_save_size(self.1, &mut needed));
        let mut bytes = vec![0u8; needed];
        done(bg_save(self.1, bytes.as_mut_ptr().cast(), needed));
        bytes
    }
}

/// Both laws, as each side has them.
fn laws() -> [(AnyLaw, bg_law); 2] {
    let (kn, kt, gamma_n, gamma_t, mu) = (2e4, 2.45e4, 500.0, 400.0, 0.5);
    let history = HertzHistory {
        kn,
        kt,
        gamma_n,
        gamma_t,
        mu,
    };
    let in_c = bg_law {
        size: sized::<bg_law>(),
        kind: BG_HERTZ_HISTORY,
        kn,
        kt,
        gamma_n,
        gamma_t,
        mu,
        rolling: BG_NO_ROLLING,
        reserved: 0,
        rolling_k: 0.0,
        rolling_gamma: 0.0,
        rolling_mu: 0.0,
    };
    let tsuji = HertzTsuji::new(2e4, 0.3, 0.3, 0.5);
    let tsuji_in_c = bg_law {
        kind: BG_HERTZ_TSUJI,
        kn: tsuji.kn,
        kt: tsuji.kt,
        gamma_n: tsuji.cn,
        gamma_t: tsuji.ct,
        mu: tsuji.mu,
        ..in_c
    };
    [
        (AnyLaw::HertzHistory(history), in_c),
        (AnyLaw::HertzTsuji(tsuji), tsuji_in_c),
    ]
}

#[test]
fn c_and_rust_write_the_same_bytes_and_read_each_others() {
    for (law, in_c) in laws() {
        let (mut sim, world) = (owned(law, 6000), InC::made(in_c, &[], 6000));
        assert!(sim.contact_histories().len() > 10);
        let bytes = sim.save().unwrap();
        assert_eq!(bytes, world.save());

        // Each goes on from the bytes, with another law and no grains before.
        let (_, other) = laws()[usize::from(in_c.kind == BG_HERTZ_HISTORY)];
        let loaded = InC::new(other, false);
        done(bg_load(loaded.1, bytes.as_ptr().cast(), bytes.len()));
        done(bg_step(loaded.1, 500));
        let mut again = Simulation::load(&world.save()).unwrap();
        again.steps(500).unwrap();
        sim.steps(500).unwrap();
        let later = sim.save().unwrap();
        assert_ne!(later, bytes);
        assert_eq!(again.save().unwrap(), later);
        assert_eq!(loaded.save(), later);
    }
}

/// The law of two materials, as each side has it: with resistance to rolling between them, or without any.
fn table(rolls: bool, is_history: bool) -> (AnyLaw, bg_law, Vec<([u32; 2], bg_law)>) {
    let [(one, history), (two, tsuji)] = laws();
    let base = if is_history { history } else { tsuji };
    let rolling = |rolling: u32, rolling_mu: f64| bg_law {
        rolling: if rolls { rolling } else { BG_NO_ROLLING },
        rolling_k: 300.0,
        rolling_gamma: 1.5,
        rolling_mu,
        ..base
    };
    // Grains resist each other by one model, the floor by the other.
    let on_floor = bg_law {
        kn: 1.5 * base.kn,
        mu: 0.3,
        ..rolling(BG_ROLLING_EPSD2, 0.2)
    };
    let between = vec![([0, 0], rolling(BG_ROLLING_SDS, 0.05)), ([1, 0], on_floor)];
    let resistance = |spring, k, gamma, mu| RollingResistance {
        spring,
        k,
        gamma,
        mu,
    };
    let resistances = [
        resistance(RollingSpring::Sds, 300.0, 1.5, 0.05),
        resistance(RollingSpring::Epsd2, 300.0, 1.5, 0.2),
        RollingResistance::NONE,
    ];
    let law = match (one, two) {
        (AnyLaw::HertzHistory(law), _) if is_history => {
            let floor = HertzHistory {
                kn: 1.5 * law.kn,
                mu: 0.3,
                ..law
            };
            let pairs = Pairs::new(2, vec![law, floor, law]).unwrap();
            match rolls {
                true => AnyLaw::HertzHistoryRolling(Arc::new(pairs.rolling(&resistances))),
                false => AnyLaw::HertzHistoryPairs(Arc::new(pairs)),
            }
        }
        (_, AnyLaw::HertzTsuji(law)) => {
            let floor = HertzTsuji {
                kn: 1.5 * law.kn,
                mu: 0.3,
                ..law
            };
            let pairs = Pairs::new(2, vec![law, floor, law]).unwrap();
            match rolls {
                true => AnyLaw::HertzTsujiRolling(Arc::new(pairs.rolling(&resistances))),
                false => AnyLaw::HertzTsujiPairs(Arc::new(pairs)),
            }
        }
        _ => panic!("these laws"),
    };
    (law, base, between)
}

/// Several materials and resistance to rolling: the same bits and bytes from both.
#[test]
fn tables_of_laws_are_the_same_in_c() {
    for (rolls, is_history) in [(false, true), (false, false), (true, true), (true, false)] {
        let (law, base, between) = table(rolls, is_history);
        let mut sim = owned(law, 4000);
        let world = InC::made(base, &between, 4000);
        let bytes = sim.save().unwrap();
        assert_eq!(bytes, world.save(), "{rolls} {is_history}");
        // Into a table of the other law, and into a world without room for one.
        let (_, other, _) = table(rolls, !is_history);
        let loaded = InC::new(other, true);
        done(bg_load(loaded.1, bytes.as_ptr().cast(), bytes.len()));
        done(bg_step(loaded.1, 500));
        let small = InC::new(base, false);
        let refused = bg_load(small.1, bytes.as_ptr().cast(), bytes.len());
        assert_eq!(refused, BG_LAW_MISFIT);
        let mut again = Simulation::load(&world.save()).unwrap();
        again.steps(500).unwrap();
        sim.steps(500).unwrap();
        let later = sim.save().unwrap();
        assert_ne!(later, bytes);
        assert_eq!(again.save().unwrap(), later);
        assert_eq!(loaded.save(), later);
        for at in (0..bytes.len()).step_by(3) {
            let mut changed = bytes.clone();
            changed[at] ^= 1 << (at % 8);
            let refused = bg_load(loaded.1, changed.as_ptr().cast(), changed.len());
            assert_ne!(refused, BG_OK, "byte {at}");
            assert!(Simulation::load(&changed).is_err(), "byte {at}");
        }
        assert_eq!(loaded.save(), later, "nothing was lost");
    }
}
