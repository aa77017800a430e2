//! Bodies of the fuzz targets: nothing that comes in as bytes may panic or hang, what is sound
//! goes out and comes in again as it was, and every state of a run is finite.
//!
//! Each returns whether the bytes were sound (something was read, or at least one step done), so
//! that the replay of the committed corpus cannot pass by refusing everything.

mod bytes;
mod checkpoint;
mod contact;
mod drawn;
mod hostile;
mod lent;
mod manifest;
mod records;
mod search;
mod texts;
mod world;

use bitgrain::simulation::Simulation;

pub use checkpoint::checkpoint;
pub use contact::contact;
pub use manifest::manifest;
pub use records::{book, campaign, summary, table};
pub use search::search;
pub use texts::{assert_same_bits, case, lammps, scenario, series};
pub use world::world;

fn assert_finite(sim: &Simulation) {
    let rows = [
        &sim.position,
        &sim.velocity,
        &sim.spin,
        &sim.force,
        &sim.torque,
    ];
    for row in rows.into_iter().flatten() {
        assert!(row.iter().all(|x| x.is_finite()), "{row:?}");
    }
    for body in &sim.obstacles {
        let parts = [body.point, body.velocity, body.force, body.torque];
        assert!(parts.iter().flatten().all(|x| x.is_finite()), "{body:?}");
    }
}
