//! Spheres that were dropped: how deep they came to rest, and the force that stopped them.
//!
//! Depths are those of the sphere's lowest point below the free surface. Katsuragi and Durian (2007) write the force of
//! the bed on a sphere at depth z and speed v as `F = k z + (m/d_1) v^2`: friction, which grows with the depth, and
//! inertia. Uehara et al. (2003) find the depth `0.14 (rho_s/rho)^(1/2) D^(2/3) H^(1/3)/mu` after a drop through the
//! total height H, that of the free fall and the depth together, rho the bulk density and mu the tangent of the angle
//! of repose.

use super::runs::FreeRun;
use crate::fit::linear::{Column, columns};
use crate::fit::power::power;
use crate::fit::{Datum, Exact, Fit, Refusal};
use bitgrain_lab::scenario::Release;
use bitgrain_lab::summary::Summary;

/// Error over the value that depths are given in fits: below their scatter, from which errors then come.
const NOMINAL: f64 = 1e-3;

/// Fewest drops that the errors of the force law take: they come from leaving out one after the other.
const DROPS_MIN: usize = 3;

/// Factor of Uehara's law (Uehara et al. 2003, eq. 1).
pub const UEHARA: f64 = 0.14;

/// A drop.
#[derive(Clone, Debug, PartialEq)]
pub struct Drop {
    /// Name of its run.
    pub name: String,
    /// Diameter of the sphere.
    pub diameter: f64,
    /// Height of its lowest point above the free surface at the beginning of the fall.
    pub height: f64,
    /// Depth of its lowest point at the end.
    pub depth: f64,
    /// Speed of the fall at the height of the free surface.
    pub speed: f64,
    /// Time since which it rests; none if it moved at the end.
    pub rest: Option<f64>,
    /// The force while it went down for the first time, in the order of time.
    pub stops: Vec<Stop>,
}

impl Drop {
    /// Total height that it fell through.
    pub fn total(&self) -> f64 {
        self.height + self.depth
    }
}

/// What a row of the series says of the force that stops a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Depth of its lowest point in the middle of the row.
    pub depth: f64,
    /// Speed downward then.
    pub speed: f64,
    /// Mean upward force over the row.
    pub force: f64,
}

/// The drops of a run directory.
pub fn drops(summary: &Summary, runs: &[FreeRun<'_>]) -> Vec<Drop> {
    let dropped = runs
        .iter()
        .filter(|run| matches!(run.release, Release::Dropped { .. }));
    let one = |free: &FreeRun<'_>| {
        let (diameter, gravity) = (free.run.diameter, summary.inputs.gravity);
        let height = free.released.fallen_from(diameter, gravity);
        Drop {
            name: free.run.name.clone(),
            diameter,
            height,
            depth: free.released.penetration(diameter),
            speed: (2.0 * gravity * height).sqrt(),
            rest: free.released.rest,
            stops: stops(free),
        }
    };
    dropped.map(one).collect()
}

/// The rows from below the surface to the first rest.
fn stops(free: &FreeRun<'_>) -> Vec<Stop> {
    let lowest = free.released.surface + 0.5 * free.run.diameter;
    let mut stops = Vec::new();
    for pair in free.rows.windows(2) {
        let (Some(before), Some(after)) = (pair[0].body, pair[1].body) else {
            continue;
        };
        if after.velocity[2] >= 0.0 {
            break;
        }
        let stop = Stop {
            depth: lowest - 0.5 * (before.place[2] + after.place[2]),
            speed: -0.5 * (before.velocity[2] + after.velocity[2]),
            force: pair[1].force_mean[1],
        };
        if stop.depth > 0.0 {
            stops.push(stop);
        }
    }
    stops
}

/// Depths against total heights as `A H^p`.
///
/// # Errors
/// Why there is no such fit.
pub fn depth_power(drops: &[Drop]) -> Result<Fit, Refusal> {
    power(&depths(drops, |drop| drop.total()), "total height")
}

/// Depths against total heights as `A H^(1/3)`.
///
/// # Errors
/// Why there is no such fit.
pub fn depth_cube_root(drops: &[Drop]) -> Result<Fit, Refusal> {
    let root = Column {
        name: "A",
        values: drops.iter().map(|drop| libm::cbrt(drop.total())).collect(),
    };
    let data = depths(drops, |drop| drop.total());
    columns(&data, "A H^(1/3)", &[root], Exact::Refused)
}

fn depths(drops: &[Drop], x: impl Fn(&Drop) -> f64) -> Vec<Datum> {
    let datum = |drop: &Drop| Datum {
        x: x(drop),
        y: drop.depth,
        error: NOMINAL * drop.depth.abs(),
    };
    drops.iter().map(datum).collect()
}

/// The friction coefficient with which Uehara's law has this factor `A` of `A H^(1/3)`: `0.14 sqrt(r) D^(2/3)/A`, r the
/// density of the sphere over the bulk density of the bed.
pub fn friction_of_depths(factor: f64, diameter: f64, ratio: f64) -> f64 {
    let root = libm::cbrt(diameter);
    UEHARA * ratio.sqrt() * root * root / factor
}

/// Density of the sphere over the bulk density of the first bed; NaN if either is unknown.
pub fn density_ratio(summary: &Summary) -> f64 {
    let packing = summary
        .beds
        .first()
        .map_or(f64::NAN, |bed| bed.packing_fraction);
    let bulk = packing * summary.inputs.bed.density;
    summary.inputs.intruder.density.unwrap_or(f64::NAN) / bulk
}

/// The law of the force that stops spheres, `F = k z + (m/d_1) v^2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceLaw {
    /// Force over depth, and its standard error.
    pub k: [f64; 2],
    /// Inertia: force over the square of the speed, and its standard error.
    pub inertia: [f64; 2],
    /// The length d_1: the mass over that, and its standard error.
    pub length: [f64; 2],
    /// Root mean square of what the rows have beside the law (force).
    pub residual: f64,
    /// Root mean square of the force itself.
    pub force: f64,
    /// Rows that it is fitted to.
    pub rows: usize,
    /// Mass of the sphere.
    pub mass: f64,
}

/// Fits the force law to all rows of all drops of one sphere by least squares, every row alike. Rows of one drop are
/// not independent: errors are those of the jackknife over drops.
///
/// # Errors
/// Why there is none.
pub fn force_law(drops: &[Drop], mass: f64) -> Result<ForceLaw, Refusal> {
    let with_rows: Vec<&Drop> = drops.iter().filter(|drop| !drop.stops.is_empty()).collect();
    if with_rows.len() < DROPS_MIN {
        let why = format!(
            "the errors of the force law take {DROPS_MIN} drops or more into the bed; there are {}",
            with_rows.len()
        );
        return Err(Refusal(why));
    }
    let all: Vec<Stop> = stops_but(&with_rows, None);
    let (whole, residuals) = solved(&all)?;
    let n = with_rows.len();
    let parts = (0..n).map(|k| Ok(solved(&stops_but(&with_rows, Some(k)))?.0));
    let parts: Vec<[f64; 2]> = parts.collect::<Result<_, Refusal>>()?;
    let mean_square = |values: &mut dyn Iterator<Item = f64>| {
        (values.map(|x| x * x).sum::<f64>() / all.len() as f64).sqrt()
    };
    let length = |part: &[f64; 2]| mass / part[1];
    Ok(ForceLaw {
        k: [whole[0], jackknife(parts.iter().map(|part| part[0]))],
        inertia: [whole[1], jackknife(parts.iter().map(|part| part[1]))],
        length: [length(&whole), jackknife(parts.iter().map(length))],
        residual: mean_square(&mut residuals.into_iter()),
        force: mean_square(&mut all.iter().map(|stop| stop.force)),
        rows: all.len(),
        mass,
    })
}

/// The rows of all drops but one.
fn stops_but(drops: &[&Drop], left_out: Option<usize>) -> Vec<Stop> {
    let kept = drops
        .iter()
        .enumerate()
        .filter(|(k, _)| Some(*k) != left_out);
    kept.flat_map(|(_, drop)| drop.stops.iter().copied())
        .collect()
}

/// `k` and `m/d_1` by least squares, and what the rows have beside them.
fn solved(stops: &[Stop]) -> Result<([f64; 2], Vec<f64>), Refusal> {
    let datum = |stop: &Stop| Datum {
        x: stop.depth,
        y: stop.force,
        error: 1.0,
    };
    let data: Vec<Datum> = stops.iter().map(datum).collect();
    let depth = Column {
        name: "k",
        values: stops.iter().map(|stop| stop.depth).collect(),
    };
    let square = Column {
        name: "m/d_1",
        values: stops.iter().map(|stop| stop.speed * stop.speed).collect(),
    };
    let model = "k z + (m/d_1) v^2";
    let fit = columns(&data, model, &[depth, square], Exact::Refused)?;
    let [k, inertia] = [0, 1].map(|at| fit.parameters[at].value);
    Ok(([k, inertia], fit.residuals))
}

/// Standard error of a number from its values with one part left out after the other.
fn jackknife(values: impl Iterator<Item = f64> + Clone) -> f64 {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    let squares: f64 = values.map(|x| (x - mean) * (x - mean)).sum();
    ((n - 1.0) / n * squares).sqrt()
}

impl ForceLaw {
    /// Force at a depth and a speed.
    pub fn at(&self, depth: f64, speed: f64) -> f64 {
        self.k[0] * depth + self.inertia[0] * speed * speed
    }

    /// Square of the speed at a depth, of a sphere that meets the surface with this speed: the closed form of
    /// `m dv/dt = m g - F`, `v^2 = (v_0^2 - a) exp(-2 z/d_1) + a + b z` with `b = -k d_1/m` and `a = (g - b/2) d_1`.
    pub fn square_at(&self, depth: f64, speed: f64, gravity: f64) -> f64 {
        let d1 = self.length[0];
        let b = -self.k[0] * d1 / self.mass;
        let a = (gravity - 0.5 * b) * d1;
        (speed * speed - a) * libm::exp(-2.0 * depth / d1) + a + b * depth
    }

    /// Depth at which such a sphere stops; `None` if it does not within a million times d_1.
    pub fn stops_at(&self, speed: f64, gravity: f64) -> Option<f64> {
        let goes_on = |depth: f64| self.square_at(depth, speed, gravity) > 0.0;
        let mut most = self.length[0];
        let far = 1e6 * most;
        while goes_on(most) {
            most *= 2.0;
            if most.is_nan() || most > far {
                return None;
            }
        }
        let mut least = 0.0;
        for _ in 0..60 {
            let middle = 0.5 * (least + most);
            match goes_on(middle) {
                true => least = middle,
                false => most = middle,
            }
        }
        Some(most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: ForceLaw = ForceLaw {
        k: [20.0, 1.0],
        inertia: [7.0, 1.0],
        length: [4.0, 1.0],
        residual: 0.0,
        force: 0.0,
        rows: 0,
        mass: 28.0,
    };

    /// Falls by the law from the surface at this speed, in steps that are far shorter than anything: a row every so
    /// many of them.
    fn fallen(speed: f64) -> Drop {
        let (mut z, mut v, dt) = (0.0, speed, 1e-5);
        let mut stops = Vec::new();
        for k in 0.. {
            let a = 1.0 - LAW.at(z, v) / LAW.mass;
            if v + a * dt <= 0.0 {
                break;
            }
            let (before, force) = ((z, v), LAW.at(z, v));
            v += a * dt;
            z += 0.5 * (before.1 + v) * dt;
            if k % 500 == 250 {
                stops.push(Stop {
                    depth: 0.5 * (before.0 + z),
                    speed: 0.5 * (before.1 + v),
                    force,
                });
            }
        }
        Drop {
            name: "run".into(),
            diameter: 3.0,
            height: 0.5 * speed * speed,
            depth: z,
            speed,
            rest: None,
            stops,
        }
    }

    /// The closed form is what the motion is, and the fit finds the law that made the rows.
    #[test]
    fn the_law_that_stops_a_sphere_is_found_again() {
        let drops: Vec<Drop> = [1.0, 3.0, 6.0, 8.0].map(fallen).into();
        for drop in &drops {
            let depth = LAW.stops_at(drop.speed, 1.0).unwrap();
            // Of first order in steps of 1e-5 over times of about 1.
            assert!(
                (depth / drop.depth - 1.0).abs() < 1e-4,
                "{depth} {}",
                drop.depth
            );
        }
        let law = force_law(&drops, LAW.mass).unwrap();
        for (found, made) in [
            (law.k, LAW.k),
            (law.inertia, LAW.inertia),
            (law.length, LAW.length),
        ] {
            // Rows hold the force at one end of their step.
            assert!((found[0] / made[0] - 1.0).abs() < 1e-4, "{law:?}");
            assert!(found[1] < 1e-3 * made[0], "{law:?}");
        }
        assert!(law.residual < 1e-3 * law.force);
        assert!(force_law(&drops[..2], LAW.mass).is_err());
    }

    #[test]
    fn depths_of_the_cube_root_are_found_again() {
        let drop = |height: f64| {
            // Total height and depth by A = 0.9.
            let mut depth = 1.0;
            for _ in 0..100 {
                depth = 0.9 * libm::cbrt(height + depth);
            }
            Drop {
                depth,
                height,
                ..fallen(1.0)
            }
        };
        let drops: Vec<Drop> = [0.5, 2.0, 8.0, 32.0].map(drop).into();
        let power = depth_power(&drops).unwrap();
        assert!((power.parameters[1].value - 1.0 / 3.0).abs() < 1e-9);
        let root = depth_cube_root(&drops).unwrap();
        assert!((root.parameters[0].value - 0.9).abs() < 1e-9);
        let mu = friction_of_depths(0.9, 3.0, 3.3);
        assert!((UEHARA * 3.3f64.sqrt() * libm::pow(3.0, 2.0 / 3.0) / mu - 0.9).abs() < 1e-12);
    }

    #[test]
    fn the_jackknife_of_a_mean_is_its_standard_error() {
        let data = [1.0, 4.0, 2.0, 7.0];
        let mean = |left: usize| {
            let kept = data.iter().enumerate().filter(|(k, _)| *k != left);
            kept.map(|(_, x)| x).sum::<f64>() / 3.0
        };
        let found = jackknife((0..4).map(mean));
        let m: f64 = data.iter().sum::<f64>() / 4.0;
        let variance: f64 = data.iter().map(|x| (x - m) * (x - m)).sum::<f64>() / 3.0;
        assert!((found - (variance / 4.0).sqrt()).abs() < 1e-12);
    }
}
