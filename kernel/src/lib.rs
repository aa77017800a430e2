//! The physics of one step of a granular (discrete-element) simulation, with the same bits
//! everywhere.
//!
//! The state after step `n` is a pure function of the state at step 0: it does not depend on the
//! compiler, the instruction set, debug or release, the neighbour skin or the moments at which
//! anything was searched or measured. A step uses correctly rounded `+ - * /` and square root only,
//! and every sum has one written order.
//!
//! # A tour, from the bottom up
//!
//! * [`Real`] is the number type, `f64`, `f32` or fixed point, with the few operations a step may use;
//!   [`vec3`] writes its sums out.
//! * [`Domain`] is the box and its periods. [`Grains`] are rows of four words that the caller owns;
//!   a [`Group`] says how grains move. An [`Obstacle`] is a rigid body that pushes grains; it moves as prescribed or
//!   freely ([`Motion`]), and the force on it is a result.
//! * A [`contact::Law`] turns how two bodies touch into a force: [`contact::HertzHistory`] (Kumar 2018) or
//!   [`contact::HertzTsuji`] (Guillard 2014).
//! * A [`PairList`] lists who may touch and keeps the tangential springs of those who do. The search that
//!   fills them runs when it must, and when that is has no effect on any result.
//! * [`World`] gathers all of that, borrowed. [`start`] evaluates the forces, [`step()`] goes on by
//!   one time step, [`resume`] goes on from a saved state.
//! * [`digest()`] hashes a state, part by part. [`BITS_VERSION`] names the arithmetic. [`record`] chains digests of any
//!   arrays, for a host that records more than a state.
//! * [`time_step`] says how long the waves and the collisions are that a time step must resolve.
//! * [`conformance`] holds small worlds with published digests: run them on a new target,
//!   and see whether it keeps the contract. [`check_arithmetic`] tests what a host often gets wrong, and
//!   every world calls it as it starts and after each stretch of steps.
//!
//! A host with threads makes a step of its [`phases`], on [`parts`] of a world.
//!
//! # What it does not do
//!
//! It allocates nothing, reads no clock, prints nothing and holds no `unsafe`; it indexes and
//! divides only with checks, so that no input makes it panic: a library of every public function,
//! and the firmware among the tests, are searched for panics that can be reached. It makes no beds,
//! reads no files and fits nothing: that is the harness's work.
//!
//! # A ball dropped on a floor
//!
//! ```
//! use bitgrain_kernel::{Domain, Group, Obstacle, Store, contact::HertzHistory, start, step};
//!
//! // Units in which density, diameter and gravity are 1; 1 grain, 4 pairs, 1 touch, 1 obstacle and group.
//! let mut store = Store::<f64, 1, 4, 1, 1>::new(Domain::open(), 1e-4, 0.1);
//! let law = HertzHistory { kn: 2e5, kt: 2.45e5, gamma_n: 792.0, gamma_t: 792.0, mu: 0.5 };
//! store.add_group(Group::free([0.0, 0.0, -1.0])).unwrap();
//! store.add_obstacle(Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0])).unwrap();
//! store.add_grain(1, 0, [0.0, 0.0, 1.0], 0.5, 0.5236).unwrap();
//!
//! let mut world = store.world();
//! start(&mut world, &law).unwrap();
//! for _ in 0..200_000 {
//!     step(&mut world, &law).unwrap();
//! }
//! // It rests, and the floor carries its weight.
//! assert!(world.grains.velocity[0][2].abs() < 1e-6);
//! assert!((world.obstacles[0].force[2] + 0.5236).abs() < 1e-6);
//! ```
#![no_std]
#![forbid(unsafe_code)]

#[cfg(any(feature = "std", test))]
extern crate std;

// The negative control of the tests on other targets switches this off and must get other digests.
#[cfg(all(
    target_arch = "x86",
    not(target_feature = "sse2"),
    not(bitgrain_negative_control)
))]
compile_error!("x87 arithmetic rounds twice, so its bits differ: build for a target with SSE2");

pub mod blake3;
mod clock;
pub mod conformance;
pub mod contact;
mod digest;
mod edit;
mod error;
mod external;
mod forces;
mod fp_environment;
mod integrate;
mod math;
mod neighbors;
mod obstacle_defect;
mod owners;
pub mod parts;
pub mod phases;
mod saved;
mod state;
mod step;
pub mod time_step;
mod world;

pub use digest::BITS_VERSION;
pub use digest::record;
pub use digest::state::{Digest, PARTS, digest};
pub use edit::{NewGrains, insert, nudge, regroup, remove, take_out};
pub use error::{ArithmeticDefect, Error};
pub use forces::accumulate::{ContactForce, Partner};
pub use fp_environment::check_arithmetic;
pub use math::real::Real;
pub use math::rows::Row;
pub use math::vec3;
#[cfg(feature = "fixed")]
pub use math::{fixed_point, scaling};
pub use neighbors::cell_list::CellList;
pub use neighbors::memory::{MemoryColumns, memory_columns};
pub use neighbors::outer_list::OuterList;
pub use neighbors::pair_list::{
    ContactHistory, KeptContact, OBSTACLES_MAX, PairList, TOUCHING, obstacle_of, surface_of,
};
pub use neighbors::stretch::{NEIGHBORS, STRETCH, StretchList};
pub use obstacle_defect::ObstacleDefect;
pub use owners::capacity::Capacity;
pub use owners::flags::Flag;
pub use owners::lent::{Head, LentStore, Memory};
pub use owners::store::Store;
pub use saved::{Saved, save, save_size};
pub use state::domain::Domain;
pub use state::facet::Facet;
pub use state::grains::{GrainState, Grains, Group, NewGrain};
pub use state::losses::{Cause, Departure, Drain, LossPolicy};
pub use state::mesh::{FACETS_MAX, arrange};
pub use state::motion::{FreeMotion, Motion};
pub use state::obstacle::{Meeting, Obstacle};
pub use state::shape::Shape;
pub use state::turning::{Orientation, to_body, to_world};
pub use step::{resume, start, start_watched, step, step_summed, step_watched, step_with};
pub use world::{Clock, World};
