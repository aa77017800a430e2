//! Numbers that must be finite whatever was done.

use bitgrain::simulation::Simulation;

pub(super) fn assert_finite(sim: &Simulation) {
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
