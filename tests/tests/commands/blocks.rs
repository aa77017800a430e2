//! Worlds of the C library in blocks of memory to which others write: bytes are flipped, and all functions are called.
//! A process of its own does it, since a crash would end this one.

use std::fs::File;
use std::process::Command;
use std::ptr::null_mut;
use std::time::{Duration, Instant};

use bitgrain_capi::grains::{bg_insert, bg_nudge, bg_regroup, bg_remove};
use bitgrain_capi::laws::bg_set_pair_law;
use bitgrain_capi::obstacles::{bg_add_mesh, bg_add_obstacle, bg_drive, bg_get_obstacle, bg_push};
use bitgrain_capi::rows::bg_read;
use bitgrain_capi::saved::{bg_load, bg_save, bg_save_size};
use bitgrain_capi::setup::{
    bg_add_group, bg_get_counts, bg_get_fault, bg_init, bg_set_policy, bg_size,
};
use bitgrain_capi::status::BG_OK;
use bitgrain_capi::steps::{bg_get_digest, bg_start, bg_step};
use bitgrain_capi::types::{
    BG_BOX, BG_CAPSULE, BG_DRUM, BG_HERTZ_HISTORY, BG_HERTZ_TSUJI, BG_MESH, BG_NO_ROLLING,
    BG_PLANE, BG_POSITION, BG_ROLLING_SDS, BG_SPHERE, bg_capacity, bg_config, bg_counts, bg_digest,
    bg_fault, bg_grain, bg_group, bg_law, bg_obstacle, bg_policy, bg_world,
};

const GRAINS: u32 = 9;

fn sized<T>() -> u32 {
    size_of::<T>() as u32
}

fn done(status: i32) {
    assert_eq!(status, BG_OK);
}

fn law(kind: u32, rolls: bool) -> bg_law {
    bg_law {
        size: sized::<bg_law>(),
        kind,
        kn: 2e4,
        kt: 2.4e4,
        gamma_n: 50.0,
        gamma_t: 50.0,
        mu: 0.5,
        rolling: if rolls { BG_ROLLING_SDS } else { BG_NO_ROLLING },
        reserved: 0,
        rolling_k: 100.0,
        rolling_gamma: 1.0,
        rolling_mu: 0.2,
    }
}

fn grain(k: u32) -> bg_grain {
    let of = f64::from;
    bg_grain {
        size: sized::<bg_grain>(),
        id: k + 1,
        group: k % 2,
        reserved: 0,
        position: [1.0 + of(k % 3), 1.0 + of(k / 3), 0.5],
        radius: 0.5,
        mass: 0.5,
        velocity: [0.1, 0.0, 0.0],
        spin: [0.0; 3],
    }
}

/// A floor, and bodies of many shapes if they are wanted.
fn add_obstacles(world: *mut bg_world, many: bool) {
    let mut number = 0;
    let body = |kind: u32, point: [f64; 3]| bg_obstacle {
        size: sized::<bg_obstacle>(),
        kind,
        point,
        direction: [0.0, 0.0, 1.0],
        radius: 0.4,
        half: [0.3; 3],
        ..bg_obstacle::default()
    };
    done(bg_add_obstacle(
        world,
        &body(BG_PLANE, [0.0; 3]),
        &mut number,
    ));
    if many {
        let free = |kind, point| bg_obstacle {
            inverse_mass: 2.0,
            is_free: 1,
            integrates: 7,
            spins: 1,
            inertia: [0.1; 3],
            ..body(kind, point)
        };
        let drum = bg_obstacle {
            radius: 5.0,
            half: [5.0, 0.0, 0.0],
            ..body(BG_DRUM, [3.0, 3.0, 4.5])
        };
        let others = [
            free(BG_SPHERE, [1.5, 1.5, 1.6]),
            free(BG_BOX, [4.5, 4.5, 1.4]),
            body(BG_CAPSULE, [4.5, 1.5, 2.0]),
            drum,
        ];
        for one in others {
            done(bg_add_obstacle(world, &one, &mut number));
        }
        let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].map(|x: f64| x + 0.1);
        let corners: Vec<f64> = (0..3)
            .flat_map(|k| corners.map(|x| x + 0.3 * f64::from(k)))
            .collect();
        let mesh = body(BG_MESH, [3.2, 3.2, 0.6]);
        done(bg_add_mesh(world, &mesh, corners.as_ptr(), 3, &mut number));
    }
}

/// A world of one material on a floor, or of two with resistance to rolling among bodies of many shapes, after a few
/// steps.
fn made(many: bool) -> Vec<u64> {
    let capacity = bg_capacity {
        size: sized::<bg_capacity>(),
        grains: GRAINS + 3,
        pairs: 60,
        candidates: 90,
        obstacle_contacts: 60,
        cells: 8,
        obstacles: if many { 7 } else { 2 },
        groups: 3,
        facets: if many { 4 } else { 0 },
        materials: if many { 2 } else { 0 },
    };
    let kind = if many {
        BG_HERTZ_TSUJI
    } else {
        BG_HERTZ_HISTORY
    };
    let config = bg_config {
        size: sized::<bg_config>(),
        periodic: if many { 0 } else { 0b011 },
        lo: [0.0, 0.0, -1.0],
        hi: [6.0, 6.0, 9.0],
        dt: 1e-3,
        skin: 0.1,
        outer_skin: 0.2,
        law: law(kind, many),
    };
    let size = bg_size(&capacity);
    let (mut memory, mut world, mut number) = (vec![0u64; size / 8], null_mut(), 0);
    let block = memory.as_mut_ptr().cast();
    done(bg_init(block, size, &capacity, &config, &mut world));
    for material in 0..2 {
        let group = bg_group {
            size: sized::<bg_group>(),
            integrates: 7,
            spins: 1,
            infinite_mass: 0,
            gravity: [0.0, 0.0, -1.0],
            material: if many { material } else { 0 },
            reserved: 0,
        };
        done(bg_add_group(world, &group, &mut number));
    }
    add_obstacles(world, many);
    let grains: Vec<bg_grain> = (0..GRAINS).map(grain).collect();
    done(bg_insert(world, grains.as_ptr(), grains.len()));
    done(bg_set_policy(world, &policy()));
    done(bg_start(world));
    done(bg_step(world, 5));
    memory
}

fn policy() -> bg_policy {
    bg_policy {
        size: sized::<bg_policy>(),
        takes_out: 1,
        drains: 1,
        reserved: 0,
        point: [0.0, 0.0, -0.5],
        normal: [0.0, 0.0, 1.0],
    }
}

/// Numbers that are as good as random: a linear congruence, whose high bits are taken.
struct Draws(u64);

impl Draws {
    fn below(&mut self, most: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005);
        self.0 = self.0.wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % most as u64) as usize
    }
}

/// Calls of all kinds; what they return does not matter.
fn calls(world: *mut bg_world, saved: &[u8], first: usize) {
    let (v, ids) = ([0.0, 0.1, 0.0], [2, 5]);
    let mut out = vec![0.0f64; 3 * GRAINS as usize];
    let new = bg_grain {
        position: [3.0, 3.0, 7.0],
        ..grain(40)
    };
    let mut needed = 0;
    let mut bytes = vec![0u8; 1 << 14];
    for k in 0..12 {
        match (first + k) % 12 {
            0 => bg_step(world, 3),
            1 => digest(world),
            2 => bg_read(world, BG_POSITION, out.as_mut_ptr().cast(), 0, 0, 2),
            3 => bg_insert(world, &new, 1),
            4 => bg_remove(world, ids.as_ptr(), ids.len()),
            5 => bg_regroup(world, ids.as_ptr(), ids.len(), 1),
            6 => bg_nudge(world, 3, v.as_ptr(), v.as_ptr()),
            7 => bg_drive(world, 0, v.as_ptr()),
            8 => look(world),
            9 => match bg_save_size(world, &mut needed) {
                BG_OK => bg_save(world, bytes.as_mut_ptr().cast(), bytes.len()),
                wrong => wrong,
            },
            10 => bg_start(world),
            _ => bg_load(world, saved.as_ptr().cast(), saved.len()),
        };
        bg_push(world, 1, v.as_ptr(), v.as_ptr());
        bg_set_pair_law(world, 0, 1, &law(BG_HERTZ_TSUJI, true));
    }
}

fn digest(world: *mut bg_world) -> i32 {
    let mut digest = bg_digest {
        size: sized::<bg_digest>(),
        ..bg_digest::default()
    };
    bg_get_digest(world, &mut digest)
}

fn look(world: *mut bg_world) -> i32 {
    let mut counts = bg_counts {
        size: sized::<bg_counts>(),
        ..bg_counts::default()
    };
    let mut fault = bg_fault {
        size: sized::<bg_fault>(),
        ..bg_fault::default()
    };
    let mut body = bg_obstacle {
        size: sized::<bg_obstacle>(),
        ..bg_obstacle::default()
    };
    (0..7).for_each(|k| {
        bg_get_obstacle(world, k, &mut body);
    });
    bg_get_counts(world, &mut counts) | bg_get_fault(world, &mut fault)
}

/// Flips so many bytes, each in a block of its own, and calls all functions with it; half of the bytes are among the
/// first thousand, where what is not a row of numbers begins.
fn flip(count: usize) {
    let blocks = [made(false), made(true)];
    let saved = blocks.each_ref().map(|block| {
        let (mut block, mut needed) = (block.clone(), 0);
        let world = block.as_mut_ptr().cast();
        done(bg_save_size(world, &mut needed));
        let mut bytes = vec![0u8; needed];
        done(bg_save(world, bytes.as_mut_ptr().cast(), needed));
        bytes
    });
    let mut draws = Draws(1);
    for k in 0..count {
        let which = k % 2;
        let mut block = blocks[which].clone();
        let most = if k % 4 < 2 { 1000 } else { 8 * block.len() };
        let (at, first) = (draws.below(most), draws.below(12));
        // A bit, or any other byte.
        let change = match draws.below(2) {
            0 => 1 << draws.below(8),
            _ => 1 + draws.below(255) as u64,
        };
        println!("flip {k}: block {which}, byte {at}, {change:#x}, call {first}");
        block[at / 8] ^= change << (8 * (at % 8));
        calls(block.as_mut_ptr().cast(), &saved[which], first);
    }
}

/// Set for the process that flips.
const FLIPS: &str = "BITGRAIN_FLIPS";

#[test]
fn no_byte_of_a_block_makes_a_call_crash_or_hang() {
    if std::env::var_os(FLIPS).is_some() {
        return flip(4000);
    }
    let folder = tempfile::tempdir().unwrap();
    let told = folder.path().join("told");
    let name = "blocks::no_byte_of_a_block_makes_a_call_crash_or_hang";
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", name, "--nocapture"])
        .env(FLIPS, "1")
        .stdout(File::create(&told).unwrap())
        .spawn()
        .unwrap();
    let began = Instant::now();
    let mut status = None;
    while status.is_none() && began.elapsed() < Duration::from_secs(100) {
        std::thread::sleep(Duration::from_millis(20));
        status = child.try_wait().unwrap();
    }
    // One that hangs.
    let _ = child.kill();
    let _ = child.wait();
    let told = std::fs::read_to_string(&told).unwrap();
    let last = told.lines().rfind(|line| line.starts_with("flip"));
    let last = last.unwrap_or_default();
    let status = status.unwrap_or_else(|| panic!("it hangs at {last}"));
    assert!(status.success(), "{status} at {last}");
    assert!(last.starts_with("flip 3999"), "{last}");
}
