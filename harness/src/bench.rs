//! The speed of this machine on a settled bed, in grain-steps per second.

use std::path::Path;
use std::time::Instant;

use bitgrain_kernel::{Domain, Group, Obstacle};
use serde::Serialize;

use crate::bed;
use crate::case::refuse;
use crate::error::{Error, Result};
use crate::lammps::{Atom, read_data};
use crate::law::LawSpec;
use crate::order::spatial_order;
use crate::progress::Progress;
use crate::scenario;
use crate::sim::{Grain, Sim, hex, sphere_mass};

/// Steps before the clock starts.
const WARM_UP: u64 = 500;

/// Data files: atoms of this type are the intruder, driven at speed 1 along x.
const INTRUDER_TYPE: u32 = 2;
/// Data files: atoms of this type are the frozen base.
const FROZEN_TYPE: u32 = 3;

/// What a bench measured.
#[derive(Clone, Debug, Serialize)]
pub struct Speed {
    /// Which bed.
    pub bed: String,
    /// Grains, the intruder not counted.
    pub grains: usize,
    /// Steps timed, after 500 that were not.
    pub steps: u64,
    /// Threads, each stepping a copy of the bed.
    pub threads: usize,
    /// Seconds that the steps took.
    pub seconds: f64,
    /// Grains times steps of all copies over the seconds.
    pub grain_steps_per_s: f64,
    /// Touching contacts over grains, at the end.
    pub contacts_per_grain: f64,
    /// Listed pairs over grains, at the end.
    pub listed_pairs_per_grain: f64,
    /// Searches while the clock ran.
    pub rebuilds: u64,
    /// Bytes that one copy holds over its grains.
    pub bytes_per_grain: f64,
    /// Digest of the final state: the same on every machine.
    pub digest: String,
}

/// The soft contact parameters of the shared beds: K_n = 2e5 and gamma_n / K_n^0.6 as Kumar 2018.
pub fn soft_law() -> LawSpec {
    let gamma = 50000.0 * libm::pow(2e5 / 2e8, 0.6);
    LawSpec::HertzHistory {
        kn: 2e5,
        kt: 1.225 * 2e5,
        gamma_n: gamma,
        gamma_t: gamma,
        mu: 0.5,
    }
}

/// Time step that goes with [`soft_law`].
pub const SOFT_TIME_STEP: f64 = 1.5e-4;

/// A bed from a LAMMPS data file (type 2 the intruder at V = 1 along x, type 3 frozen, the rest
/// free under gravity 1), numbered in spatial order, not yet started.
///
/// # Errors
/// [`Error::Input`] where the file cannot be read, holds no free grain, an impossible box, or grains
/// too small or light for [`SOFT_TIME_STEP`].
pub fn read_bed(path: &Path) -> Result<Sim> {
    let data = read_data(path)?;
    let place = path.display().to_string();
    let (balls, atoms): (Vec<&Atom>, Vec<&Atom>) =
        data.atoms.iter().partition(|a| a.kind == INTRUDER_TYPE);
    if !atoms.iter().any(|a| a.kind != FROZEN_TYPE) {
        return Err(Error::input(
            place,
            "holds no grain of a type other than 2 and 3",
        ));
    }
    let wrong = |what: String| Error::input(place.clone(), what);
    let [x, y, z] = data.hi;
    // Beds are cut close; grains that fly up must not leave the box.
    let height = z - data.lo[2];
    let hi = [x, y, z + 4.0 * height];
    let domain = Domain::new(data.lo, hi, [true, true, false]).map_err(|f| wrong(f.to_string()))?;
    let obstacles = balls.iter().map(|a| {
        let mut center = a.position;
        domain.wrap(&mut center, &mut [0; 3]);
        Obstacle {
            velocity: [1.0, 0.0, 0.0],
            inverse_mass: 1.0 / sphere_mass(a.diameter, a.density),
            ..Obstacle::sphere(center, 0.5 * a.diameter)
        }
    });
    let points: Vec<[f64; 4]> = atoms
        .iter()
        .map(|a| [a.position[0], a.position[1], a.position[2], 0.0])
        .collect();
    let width = atoms.iter().map(|a| a.diameter).sum::<f64>() / atoms.len() as f64;
    let grains: Vec<Grain> = spatial_order(&points, width)
        .into_iter()
        .enumerate()
        .map(|(k, from)| {
            let a = atoms[from];
            let frozen = a.kind == FROZEN_TYPE;
            let mut position = a.position;
            domain.wrap(&mut position, &mut [0; 3]);
            Grain {
                id: k as u32 + 1,
                group: if frozen { bed::FROZEN } else { bed::FREE },
                diameter: a.diameter,
                density: a.density,
                position,
                velocity: if frozen { [0.0; 3] } else { a.velocity },
                spin: if frozen { [0.0; 3] } else { a.spin },
            }
        })
        .collect();
    let sizes = atoms.iter().map(|a| (0.5 * a.diameter, a.density));
    let checked = soft_law().check_time_step(SOFT_TIME_STEP, sizes);
    checked.map_err(|p| wrong(format!("the time step {p}")))?;
    let law = soft_law()
        .build()
        .map_err(|(key, p)| wrong(format!("law.{key} {p}")))?;
    let groups = vec![Group::free([0.0, 0.0, -1.0]), Group::frozen()];
    Ok(Sim::new(
        law,
        domain,
        SOFT_TIME_STEP,
        groups,
        &grains,
        obstacles.collect(),
    ))
}

/// Times `steps` steps of a bed, on `threads` copies side by side.
///
/// # Errors
/// A bed that cannot be read, or a run that goes wrong.
pub fn bench(bed: Option<&Path>, steps: u64, threads: usize, progress: &Progress) -> Result<Speed> {
    let (name, mut sim) = match bed {
        Some(path) => {
            let name = path
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into_owned();
            let mut sim = read_bed(path)?;
            sim.start().map_err(|fault| {
                refuse(&name, fault, |id| format!("a grain (numbered {id} here)"))
            })?;
            (name, sim)
        }
        None => {
            let quick = scenario::load("quick", &[])?;
            let plan = &quick.beds()[0];
            let mut stage = progress.stage("pouring the quick bed", 0);
            let sim = bed::pour(&quick, plan, &mut stage)?;
            stage.finish();
            ("quick".to_string(), sim)
        }
    };
    let stepped = |sim: &mut Sim, count| {
        sim.steps(count)
            .map_err(|fault| Error::run(&name, sim.step_count() + 1, fault))
    };
    stepped(&mut sim, WARM_UP)?;
    let (before, ..) = sim.search_counts();
    let mut copies = vec![sim; threads];
    let began = Instant::now();
    let stage = progress.stage("stepping", steps);
    std::thread::scope(|scope| {
        let (stepped, stage) = (&stepped, &stage);
        let workers: Vec<_> = copies
            .iter_mut()
            .enumerate()
            .map(|(k, sim)| {
                scope.spawn(move || {
                    let mut done = 0;
                    while done < steps {
                        let some = 500.min(steps - done);
                        stepped(sim, some)?;
                        done += some;
                        if k == 0 {
                            stage.at(done, String::new());
                        }
                    }
                    Ok(())
                })
            })
            .collect();
        let ends = workers
            .into_iter()
            .map(|w| w.join().expect("a worker does not panic"));
        ends.collect::<Result<Vec<()>>>()
    })?;
    let seconds = began.elapsed().as_secs_f64();
    stage.finish();
    let sim = &mut copies[0];
    let grains = sim.count();
    let (searches, listed, _) = sim.search_counts();
    Ok(Speed {
        bed: name,
        grains,
        steps,
        threads,
        seconds,
        grain_steps_per_s: threads as f64 * grains as f64 * steps as f64 / seconds,
        contacts_per_grain: sim.bonds().len() as f64 / grains as f64,
        listed_pairs_per_grain: listed as f64 / grains as f64,
        rebuilds: searches - before,
        bytes_per_grain: sim.bytes() as f64 / grains as f64,
        digest: hex(&sim.digest().whole),
    })
}
