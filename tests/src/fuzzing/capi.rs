//! The C library called in any order, with null pointers, impossible numbers and a block that is damaged now and then.
//! Memory is its own to the byte, so that a sanitizer sees what goes beyond.

use std::ffi::c_void;
use std::ptr::{null, null_mut};

use bitgrain_capi::grains::{bg_insert, bg_nudge, bg_regroup, bg_remove};
use bitgrain_capi::laws::bg_set_pair_law;
use bitgrain_capi::obstacles::{
    bg_add_mesh, bg_add_obstacle, bg_drive, bg_drive_to, bg_get_obstacle, bg_push, bg_turn,
};
use bitgrain_capi::rows::bg_read;
use bitgrain_capi::saved::{bg_load, bg_save, bg_save_size};
use bitgrain_capi::setup::{
    bg_add_group, bg_get_counts, bg_get_fault, bg_init, bg_set_policy, bg_set_skins, bg_size,
};
use bitgrain_capi::status::{BG_NOT_STARTED, BG_OK};
use bitgrain_capi::steps::{bg_get_digest, bg_start, bg_step};
use bitgrain_capi::types::{
    BG_MESH, bg_capacity, bg_config, bg_counts, bg_digest, bg_fault, bg_grain, bg_group, bg_law,
    bg_obstacle, bg_policy, bg_world,
};

use super::bytes::Bytes;

fn sized<T>() -> u32 {
    size_of::<T>() as u32
}

/// Whether a step was done.
pub fn capi(data: &[u8]) -> bool {
    let mut bytes = Bytes(data);
    let capacity = bg_capacity {
        size: sized::<bg_capacity>(),
        grains: u32::from(bytes.byte() % 8),
        pairs: u32::from(bytes.byte() % 40),
        candidates: u32::from(bytes.byte() % 40),
        obstacle_contacts: u32::from(bytes.byte() % 20),
        cells: u32::from(bytes.byte() % 20),
        obstacles: u32::from(bytes.byte() % 4),
        groups: u32::from(bytes.byte() % 4),
        facets: 6,
        // As many as the others leave, and now and then none.
        materials: u32::from(data.len() as u8 % 4),
    };
    let size = bg_size(&capacity);
    let mut memory = vec![0u64; size / 8];
    let mut world: *mut bg_world = null_mut();
    let config = config(&mut bytes);
    let made = bg_init(
        memory.as_mut_ptr().cast(),
        size,
        &capacity,
        &config,
        &mut world,
    );
    if made != BG_OK {
        assert_eq!(bg_step(world, 1), bitgrain_capi::status::BG_NULL);
        return false;
    }
    let mut stepped = false;
    for _ in 0..60 {
        if bytes.0.is_empty() {
            break;
        }
        stepped |= call(&mut bytes, world);
        if bytes.byte() == 7 {
            // The block is moved: it holds no place.
            let mut other = memory.clone();
            memory.fill(0);
            std::mem::swap(&mut memory, &mut other);
            world = memory.as_mut_ptr().cast();
        }
    }
    stepped
}

fn config(bytes: &mut Bytes) -> bg_config {
    let tsuji = bytes.below(2) as u32;
    let edges = [bytes.scale(-1.0, 1.0), bytes.scale(0.0, 1.0), 10.0];
    let open = bytes.below(3) == 0;
    bg_config {
        size: sized::<bg_config>(),
        periodic: if open { 0 } else { u32::from(bytes.byte() % 8) },
        lo: [0.0; 3],
        hi: if open { [0.0; 3] } else { edges },
        dt: bytes.scale(-4.0, -2.0),
        skin: bytes.between(-0.01, 1.0),
        outer_skin: bytes.between(0.0, 1.0),
        law: bg_law {
            size: sized::<bg_law>(),
            kind: tsuji + 1,
            kn: bytes.scale(2.0, 6.0),
            kt: bytes.scale(2.0, 6.0),
            gamma_n: bytes.zero_or_scale(0.0, 3.0),
            gamma_t: bytes.zero_or_scale(0.0, 3.0),
            mu: bytes.between(0.0, 1.0),
            rolling: 0,
            reserved: 0,
            rolling_k: 0.0,
            rolling_gamma: 0.0,
            rolling_mu: 0.0,
        },
    }
}

/// A law between two materials, with resistance to rolling or without.
fn pair_law(bytes: &mut Bytes, world: *mut bg_world) -> i32 {
    let law = bg_law {
        rolling: bytes.below(4) as u32,
        rolling_k: bytes.zero_or_scale(0.0, 4.0),
        rolling_gamma: bytes.zero_or_scale(-3.0, 1.0),
        rolling_mu: bytes.between(0.0, 1.0),
        ..config(bytes).law
    };
    let [a, b] = [0; 2].map(|_| u32::from(bytes.byte() % 5));
    bg_set_pair_law(world, a, b, &law)
}

/// One call; whether it was a step that was done.
fn call(bytes: &mut Bytes, world: *mut bg_world) -> bool {
    let mut number = 0;
    match bytes.below(20) {
        0 => {
            let group = bg_group {
                size: sized::<bg_group>(),
                integrates: u32::from(bytes.byte() % 8),
                spins: bytes.below(2) as u32,
                infinite_mass: bytes.below(2) as u32,
                gravity: bytes.vector(),
                material: u32::from(bytes.byte() % 8 / 6),
                reserved: 0,
            };
            bg_add_group(world, &group, &mut number)
        }
        1 => {
            let body = obstacle(bytes);
            if body.kind != BG_MESH {
                bg_add_obstacle(world, &body, &mut number);
                return false;
            }
            let corners: Vec<f64> = (0..27).map(|_| bytes.between(-2.0, 2.0)).collect();
            let count = bytes.below(4) as u32;
            bg_add_mesh(world, &body, corners.as_ptr(), count, &mut number)
        }
        2 | 3 => {
            let grains: Vec<bg_grain> = (0..bytes.below(4)).map(|_| grain(bytes)).collect();
            bg_insert(world, grains.as_ptr(), grains.len())
        }
        4 => {
            let ids = [bytes.byte(), bytes.byte()].map(|id| u32::from(id % 20));
            bg_remove(world, ids.as_ptr(), bytes.below(3))
        }
        5 => {
            let ids = [bytes.byte(), bytes.byte()].map(|id| u32::from(id % 20));
            let group = u32::from(bytes.byte() % 5) * 70;
            bg_regroup(world, ids.as_ptr(), bytes.below(3), group)
        }
        6 => {
            let (v, w) = (bytes.vector(), bytes.vector());
            bg_nudge(world, u32::from(bytes.byte() % 20), v.as_ptr(), w.as_ptr())
        }
        7 => bg_drive(world, u32::from(bytes.byte() % 4), bytes.vector().as_ptr()),
        8 => bg_start(world),
        9 => read(bytes, world),
        10 => {
            let policy = bg_policy {
                size: sized::<bg_policy>(),
                takes_out: bytes.below(2) as u32,
                drains: bytes.below(2) as u32,
                reserved: 0,
                point: bytes.vector(),
                normal: bytes.vector(),
            };
            bg_set_policy(world, &policy)
        }
        11 => bg_set_skins(world, bytes.between(0.0, 1.0), bytes.between(0.0, 1.0)),
        15 => bg_turn(world, u32::from(bytes.byte() % 4), bytes.vector().as_ptr()),
        17 => {
            let (body, steps) = (u32::from(bytes.byte() % 4), u32::from(bytes.byte()));
            let (point, turn) = (bytes.vector(), turned(bytes));
            bg_drive_to(world, body, point.as_ptr(), turn.as_ptr(), steps)
        }
        16 => {
            let (force, torque) = (bytes.vector(), bytes.vector());
            let body = u32::from(bytes.byte() % 4);
            bg_push(world, body, force.as_ptr(), torque.as_ptr())
        }
        12 => pass(bytes, world),
        13 => nulls(world),
        19 => pair_law(bytes, world),
        14 => look(bytes, world),
        _ => return bg_step(world, bytes.below(20) as u64) == BG_OK,
    };
    false
}

fn obstacle(bytes: &mut Bytes) -> bg_obstacle {
    bg_obstacle {
        size: sized::<bg_obstacle>(),
        kind: bytes.below(8) as u32,
        point: bytes.vector(),
        direction: bytes.vector(),
        radius: bytes.scale(-1.0, 1.0),
        inverse_mass: bytes.zero_or_scale(-1.0, 1.0),
        velocity: bytes.vector(),
        force: [0.0; 3],
        torque: [0.0; 3],
        mean_force: [0.0; 3],
        mean_torque: [0.0; 3],
        half: [0; 3].map(|_| bytes.scale(-1.0, 1.0)),
        orientation: turned(bytes),
        angular_velocity: bytes.vector(),
        curved: bytes.below(2) as u32,
        is_free: bytes.below(2) as u32,
        integrates: u32::from(bytes.byte() % 8),
        spins: bytes.below(2) as u32,
        inertia: [0; 3].map(|_| bytes.zero_or_scale(-1.0, 1.0)),
        gravity: bytes.vector(),
        applied_force: bytes.vector(),
        applied_torque: bytes.vector(),
        material: u32::from(bytes.byte() % 8 / 6),
        reserved: 0,
    }
}

/// No orientation, one, or four numbers.
fn turned(bytes: &mut Bytes) -> [f64; 4] {
    match bytes.below(4) {
        0 => [0.0; 4],
        1 => [0.6, 0.0, -0.8, 0.0],
        2 => [0.5, 0.5, -0.5, 0.5],
        _ => [0; 4].map(|_| bytes.scale(-1.0, 1.0)),
    }
}

fn grain(bytes: &mut Bytes) -> bg_grain {
    bg_grain {
        size: sized::<bg_grain>(),
        id: u32::from(bytes.byte() % 20),
        group: u32::from(bytes.byte() % 4),
        reserved: 0,
        position: bytes.vector().map(|x| 4.0 * x),
        radius: bytes.scale(-1.0, 0.0),
        mass: bytes.scale(-1.0, 0.0),
        velocity: bytes.vector(),
        spin: bytes.vector(),
    }
}

fn read(bytes: &mut Bytes, world: *mut bg_world) -> i32 {
    let (field, stride) = (u32::from(bytes.byte() % 12), bytes.below(40));
    let (first, count) = (bytes.below(9), bytes.below(9));
    // As long as it may be, and not a byte more.
    let width = [4, 1, 24, 8, 24, 8, 24, 24, 24, 12, 0, 0][field as usize];
    let each = if stride == 0 { width } else { stride };
    let length = if count == 0 {
        0
    } else {
        (count - 1) * each + width
    };
    let mut out = vec![0u8; length];
    bg_read(
        world,
        field,
        out.as_mut_ptr().cast::<c_void>(),
        stride,
        first,
        count,
    )
}

/// Saves a world and loads it again, changed or not.
fn pass(bytes: &mut Bytes, world: *mut bg_world) -> i32 {
    let mut needed = 0;
    let sized = bg_save_size(world, &mut needed);
    if sized != BG_OK {
        return sized;
    }
    let mut saved = vec![0u8; needed];
    let done = bg_save(world, saved.as_mut_ptr().cast(), needed);
    if done != BG_OK {
        return done;
    }
    let at = usize::from(u16::from_le_bytes([bytes.byte(), bytes.byte()])) % needed;
    let flip = bytes.byte() & 1;
    saved[at] ^= flip;
    let loaded = bg_load(world, saved.as_ptr().cast(), needed);
    assert!(flip == 0 || loaded != BG_OK, "byte {at}");
    loaded
}

/// None of these may crash.
fn nulls(world: *mut bg_world) -> i32 {
    bg_add_group(world, null(), null_mut());
    bg_insert(world, null(), 1);
    bg_remove(world, null(), 1);
    bg_nudge(world, 0, null(), null());
    bg_read(world, 2, null_mut(), 0, 0, 1);
    bg_load(world, null(), 9);
    bg_get_digest(world, null_mut());
    bg_get_counts(null_mut(), null_mut())
}

fn look(bytes: &mut Bytes, world: *mut bg_world) -> i32 {
    let mut digest = bg_digest {
        size: sized::<bg_digest>(),
        ..bg_digest::default()
    };
    let mut counts = bg_counts {
        size: sized::<bg_counts>(),
        ..bg_counts::default()
    };
    let mut fault = bg_fault {
        size: sized::<bg_fault>(),
        ..bg_fault::default()
    };
    // A world that a fault has stopped has no state.
    let read = bg_get_digest(world, &mut digest);
    assert!(matches!(read, BG_OK | BG_NOT_STARTED), "{read}");
    assert_eq!(bg_get_counts(world, &mut counts), BG_OK);
    assert_eq!(bg_get_fault(world, &mut fault), BG_OK);
    let mut body = obstacle(bytes);
    bg_get_obstacle(world, u32::from(bytes.byte() % 4), &mut body)
}
