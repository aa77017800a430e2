//! What C sees. Every structure begins with its size in bytes, so that later versions can have more fields at the end:
//! set it to `sizeof` before a call.

use core::ffi::c_void;

/// A world in memory that the caller lends: opaque.
pub struct bg_world {
    _private: [u8; 0],
}

/// How many bodies and list entries there is room for: see `bg_capacity_for_bed`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct bg_capacity {
    /// `sizeof(bg_capacity)`.
    pub size: u32,
    /// Grains.
    pub grains: u32,
    /// Pairs of grains in a list.
    pub pairs: u32,
    /// Candidates for that list.
    pub candidates: u32,
    /// Contacts of grains with obstacles in a list.
    pub obstacle_contacts: u32,
    /// Cells of the search, 1 at least.
    pub cells: u32,
    /// Obstacles.
    pub obstacles: u32,
    /// Groups, 256 at most.
    pub groups: u32,
    /// Triangles of all meshes together.
    pub facets: u32,
    /// Materials, 32 at most; 0 for a law of one material that does not resist rolling. With any, each contact takes
    /// 48 bytes more.
    pub materials: u32,
}

/// `bg_law.kind`: Hertz contact with a tangential spring, Kumar 2018, eqs. 1 and 2.
pub const BG_HERTZ_HISTORY: u32 = 1;
/// `bg_law.kind`: Hertz contact with Tsuji damping, Guillard 2014, eq. A1.
pub const BG_HERTZ_TSUJI: u32 = 2;

/// `bg_law.rolling`: nothing resists rolling.
pub const BG_NO_ROLLING: u32 = 0;
/// `bg_law.rolling`: spring, damper and slider, as LAMMPS' `sds`.
pub const BG_ROLLING_SDS: u32 = 1;
/// `bg_law.rolling`: an elastic and plastic spring, as LIGGGHTS' `epsd2`.
pub const BG_ROLLING_EPSD2: u32 = 2;

/// A contact law. All fields behind `mu` may be 0: then nothing resists rolling.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct bg_law {
    /// `sizeof(bg_law)`.
    pub size: u32,
    /// `BG_HERTZ_HISTORY` or `BG_HERTZ_TSUJI`.
    pub kind: u32,
    /// Normal stiffness (pressure).
    pub kn: f64,
    /// Tangential stiffness (pressure).
    pub kt: f64,
    /// Normal damping: `gamma_n` of `HERTZ_HISTORY` (1 / (time length)), `cn` of `HERTZ_TSUJI`.
    pub gamma_n: f64,
    /// Tangential damping: `gamma_t` or `ct`.
    pub gamma_t: f64,
    /// Friction coefficient.
    pub mu: f64,
    /// `BG_NO_ROLLING`, `BG_ROLLING_SDS` or `BG_ROLLING_EPSD2`; the last two need `bg_capacity.materials`, 1 at least.
    pub rolling: u32,
    /// Unused: 0.
    pub reserved: u32,
    /// Stiffness of `ROLLING_SDS` (force / length).
    pub rolling_k: f64,
    /// Damping of `ROLLING_SDS` (force / speed).
    pub rolling_gamma: f64,
    /// Coefficient of rolling friction.
    pub rolling_mu: f64,
}

/// What a world begins as. Any consistent units.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct bg_config {
    /// `sizeof(bg_config)`.
    pub size: u32,
    /// Bits 0, 1, 2: whether x, y, z are periodic.
    pub periodic: u32,
    /// Lower edges of the box (length). Open space if they equal the upper ones.
    pub lo: [f64; 3],
    /// Upper edges (length).
    pub hi: [f64; 3],
    /// Time step.
    pub dt: f64,
    /// How far beyond touching pairs are listed (length): speed only, never a bit.
    pub skin: f64,
    /// How far beyond that they are candidates for the list (length): speed only.
    pub outer_skin: f64,
    /// The contact law.
    pub law: bg_law,
}

/// How the grains of a group move.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct bg_group {
    /// `sizeof(bg_group)`.
    pub size: u32,
    /// Bits 0, 1, 2: whether they answer forces and gravity along x, y, z; elsewhere they keep their velocity.
    pub integrates: u32,
    /// Whether they answer torques: 0 or 1.
    pub spins: u32,
    /// Whether they count as infinitely heavy in a contact: 0 or 1.
    pub infinite_mass: u32,
    /// Acceleration of gravity on them (length / time^2).
    pub gravity: [f64; 3],
    /// Their material, below `bg_capacity.materials`; 0 without any.
    pub material: u32,
    /// Unused: 0.
    pub reserved: u32,
}

/// `bg_obstacle.kind`: a ball about `point`.
pub const BG_SPHERE: u32 = 0;
/// `bg_obstacle.kind`: an endless round bar through `point` along `direction`.
pub const BG_CYLINDER: u32 = 1;
/// `bg_obstacle.kind`: a flat wall through `point`; `direction` points to the grains.
pub const BG_PLANE: u32 = 2;
/// `bg_obstacle.kind`: a round bar about `point` along `direction`, of half the length `half[0]`, with flat ends.
pub const BG_FINITE_CYLINDER: u32 = 3;
/// `bg_obstacle.kind`: a round bar with half balls as ends, about `point` along `direction`; `half[0]` from its centre
/// to theirs.
pub const BG_CAPSULE: u32 = 4;
/// `bg_obstacle.kind`: a box about `point`; `half` of its edges.
pub const BG_BOX: u32 = 5;
/// `bg_obstacle.kind`: the inside of a round tank about `point` along `direction`, of half the length `half[0]`.
pub const BG_DRUM: u32 = 6;
/// `bg_obstacle.kind`: triangles, which `bg_add_mesh` adds.
pub const BG_MESH: u32 = 7;

/// A rigid body. All fields behind `mean_torque` may be 0: then it has the axes of the world and moves as prescribed.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct bg_obstacle {
    /// `sizeof(bg_obstacle)`.
    pub size: u32,
    /// `BG_SPHERE`, `BG_CYLINDER`, `BG_PLANE`, `BG_FINITE_CYLINDER`, `BG_CAPSULE`, `BG_BOX`, `BG_DRUM` or
    /// `BG_MESH`.
    pub kind: u32,
    /// Centre, or a point of the axis or of the wall (length).
    pub point: [f64; 3],
    /// Of a bar, a tank or a wall, in its own axes, of any length but zero.
    pub direction: [f64; 3],
    /// Radius of a ball, bar or tank; of a mesh the distance of its farthest corner (length).
    pub radius: f64,
    /// 1 / mass as it enters contacts; 0 is infinitely heavy.
    pub inverse_mass: f64,
    /// Velocity (length / time).
    pub velocity: [f64; 3],
    /// Force of the grains on it in the last step.
    pub force: [f64; 3],
    /// Torque of that about `point`.
    pub torque: [f64; 3],
    /// Mean force over the steps of the last `bg_step` or `bg_step_apply`, summed in their order.
    pub mean_force: [f64; 3],
    /// Mean torque likewise.
    pub mean_torque: [f64; 3],
    /// Half of its length, or of its edges (length); see `kind`.
    pub half: [f64; 3],
    /// Unit quaternion (w, x, y, z) from its own axes to those of the world; all 0 is that of no turn.
    pub orientation: [f64; 4],
    /// Angular velocity in the axes of the world (radians / time).
    pub angular_velocity: [f64; 3],
    /// Whether curvature counts (0 or 1) that is not a ball's: `1/r + 1/(2 R)` on a bar, `1/r - 1/(2 R)` in a tank.
    pub curved: u32,
    /// Whether forces move it (0 or 1): then `inverse_mass` and `inertia` are above 0.
    pub is_free: u32,
    /// Bits 0, 1, 2 if it answers forces along x, y, z; along the others its velocity stays.
    pub integrates: u32,
    /// Whether it answers torques: 0 or 1.
    pub spins: u32,
    /// Moments of inertia about its own axes (mass length^2).
    pub inertia: [f64; 3],
    /// Acceleration of gravity on it (length / time^2).
    pub gravity: [f64; 3],
    /// Force of the host on its point, besides.
    pub applied_force: [f64; 3],
    /// Torque of the host.
    pub applied_torque: [f64; 3],
    /// Its material, as of a group.
    pub material: u32,
    /// Unused: 0.
    pub reserved: u32,
}

/// A grain that comes into a world.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct bg_grain {
    /// `sizeof(bg_grain)`.
    pub size: u32,
    /// Its name; ids ascend.
    pub id: u32,
    /// Number of its group.
    pub group: u32,
    /// Unused: 0.
    pub reserved: u32,
    /// Centre (length), inside the box.
    pub position: [f64; 3],
    /// Radius (length), positive.
    pub radius: f64,
    /// Mass, positive.
    pub mass: f64,
    /// Velocity (length / time).
    pub velocity: [f64; 3],
    /// Angular velocity (radians / time).
    pub spin: [f64; 3],
}

/// What becomes of grains that leave; without one they stop the world.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct bg_policy {
    /// `sizeof(bg_policy)`.
    pub size: u32,
    /// Whether grains beyond a closed edge, or too deep in another body, are taken out: 0 or 1.
    pub takes_out: u32,
    /// Whether grains behind the plane below are taken out: 0 or 1.
    pub drains: u32,
    /// Unused: 0.
    pub reserved: u32,
    /// A point of the plane (length).
    pub point: [f64; 3],
    /// Its normal, of any length, to the side where grains stay.
    pub normal: [f64; 3],
}

/// `bg_departure.cause`: beyond a closed edge.
pub const BG_CAUSE_ESCAPED: u32 = 1;
/// `bg_departure.cause`: behind the plane of the policy.
pub const BG_CAUSE_DRAINED: u32 = 2;
/// `bg_departure.cause`: too deep in the obstacle `partner`.
pub const BG_CAUSE_OBSTACLE_TOO_DEEP: u32 = 3;
/// `bg_departure.cause`: too deep in the grain with the id `partner`.
pub const BG_CAUSE_OVERLAP_TOO_DEEP: u32 = 4;

/// A grain that leaves.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct bg_departure {
    /// `sizeof(bg_departure)`.
    pub size: u32,
    /// Its id.
    pub id: u32,
    /// Why: one of `BG_CAUSE_...`.
    pub cause: u32,
    /// The other body, by cause.
    pub partner: u32,
    /// Steps done when it left.
    pub step: u64,
    /// Where it was (length).
    pub position: [f64; 3],
    /// Its velocity (length / time).
    pub velocity: [f64; 3],
    /// Radius (length).
    pub radius: f64,
    /// Mass.
    pub mass: f64,
}

/// The last error of a world.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct bg_fault {
    /// `sizeof(bg_fault)`.
    pub size: u32,
    /// Its number.
    pub code: i32,
    /// The grain's id, the obstacle, the group or the axis that it names; of two the first.
    pub first: u32,
    /// The other grain or the obstacle.
    pub second: u32,
    /// Entries, grains or bytes that would have been enough.
    pub needed: u64,
}

/// How much there is of everything.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct bg_counts {
    /// `sizeof(bg_counts)`.
    pub size: u32,
    /// Grains.
    pub grains: u32,
    /// Obstacles.
    pub obstacles: u32,
    /// Groups.
    pub groups: u32,
    /// Steps done.
    pub step: u64,
    /// Grains that were taken out since `bg_init` or `bg_load`.
    pub departed: u64,
}

/// A recording as it grows: see `bg_record_begin`. All of it is plain data, and it may be copied.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct bg_recording {
    /// `sizeof(bg_recording)`.
    pub size: u32,
    /// Unused: 0.
    pub reserved: u32,
    /// The step of the last array.
    pub step: u64,
    /// The link of the last line.
    pub link: [u8; 32],
}

/// Bytes that are enough for each text of a recording, with the zero at its end.
pub const BG_LINE: u32 = 512;

/// BLAKE3 hashes of a state and of its parts.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default)]
pub struct bg_digest {
    /// `sizeof(bg_digest)`.
    pub size: u32,
    /// Of all parts.
    pub whole: [u8; 32],
    /// Ids, positions, radii and crossings of periodic axes.
    pub positions: [u8; 32],
    /// Velocities and masses.
    pub velocities: [u8; 32],
    /// Angular velocities.
    pub spins: [u8; 32],
    /// Tangential springs.
    pub histories: [u8; 32],
    /// Forces and torques on grains.
    pub forces: [u8; 32],
    /// Obstacles.
    pub obstacles: [u8; 32],
}

/// Gives the force and the torque on a grain besides those of its contacts, both zero when it is called. The rows are
/// copies: position x, y, z and radius; velocity x, y, z and mass; angular velocity. It may call no function with the
/// same world.
pub type bg_apply = Option<
    unsafe extern "C" fn(
        user: *mut c_void,
        id: u32,
        position_radius: *const f64,
        velocity_mass: *const f64,
        spin: *const f64,
        force: *mut f64,
        torque: *mut f64,
    ),
>;

/// Is told of a grain that leaves. It may call no function with the same world.
pub type bg_departed =
    Option<unsafe extern "C" fn(user: *mut c_void, departure: *const bg_departure)>;

/// `bg_read`: ids, `uint32_t`.
pub const BG_ID: u32 = 0;
/// `bg_read`: numbers of groups, `uint8_t`.
pub const BG_GROUP: u32 = 1;
/// `bg_read`: positions, 3 `double`.
pub const BG_POSITION: u32 = 2;
/// `bg_read`: radii, `double`.
pub const BG_RADIUS: u32 = 3;
/// `bg_read`: velocities, 3 `double`.
pub const BG_VELOCITY: u32 = 4;
/// `bg_read`: masses, `double`.
pub const BG_MASS: u32 = 5;
/// `bg_read`: angular velocities, 3 `double`.
pub const BG_SPIN: u32 = 6;
/// `bg_read`: forces of the last step, 3 `double`.
pub const BG_FORCE: u32 = 7;
/// `bg_read`: torques of the last step, 3 `double`.
pub const BG_TORQUE: u32 = 8;
/// `bg_read`: crossings of the periodic axes, 3 `int32_t`.
pub const BG_IMAGE: u32 = 9;
