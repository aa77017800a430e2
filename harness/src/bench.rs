//! The speed of this machine on a settled bed, in grain-steps per second.

use std::path::Path;
use std::time::Instant;

use bitgrain_kernel::vec3::head;
use bitgrain_kernel::{Domain, Row};
use serde::Serialize;

use bitgrain_lab::bed::{self, import};
use bitgrain_lab::case::refuse;
use bitgrain_lab::progress::Progress;
use bitgrain_lab::scenario;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::export::OBSTACLE_TYPE;
use bitgrain_sim::lammps::read_atoms;
use bitgrain_sim::law::{HertzHistoryParameters, LawSpec};
use bitgrain_sim::memory;
use bitgrain_sim::simulation::{Grain, Simulation, hex, sphere_mass};
use bitgrain_sim::spatial_order::spatial_order;
use bitgrain_sim::threads::{ThreadsError, builder, on_threads};

/// Steps before the clock starts.
const WARM_UP: u64 = 500;

/// What a bench measured.
#[derive(Clone, Debug, Serialize)]
pub struct Speed {
    /// Which bed.
    pub bed: String,
    /// Grains, the intruder not counted.
    pub grains: usize,
    /// Steps timed, after 500 that were not.
    pub steps: u64,
    /// Threads that step it.
    pub threads: usize,
    /// Copies of the bed that were stepped side by side, each on this many threads.
    pub copies: usize,
    /// How often the bed was repeated along x and along y.
    pub tiles: usize,
    /// Seconds that the steps took.
    pub seconds: f64,
    /// Grains times steps of all copies over the seconds.
    pub grain_steps_per_s: f64,
    /// Touching contacts over grains, at the end.
    pub contacts_per_grain: f64,
    /// Listed pairs over grains, at the end.
    pub listed_pairs_per_grain: f64,
    /// Searches for candidates while the clock ran.
    pub rebuilds: u64,
    /// Times that pairs were picked from the candidates meanwhile.
    pub renewals: u64,
    /// How far beyond touching pairs were listed at the end (length).
    pub skin: f64,
    /// Bytes that one copy holds over its grains.
    pub bytes_per_grain: f64,
    /// The most memory that the whole process ever held, over the grains of all copies; if the
    /// system reports it.
    pub peak_bytes_per_grain: Option<f64>,
    /// Digest of the final state: the same on every machine.
    pub digest: String,
}

/// The soft contact parameters of the shared beds: K_n = 2e5 and gamma_n / K_n^0.6 as Kumar 2018.
pub fn soft_law() -> LawSpec {
    let gamma = 50000.0 * libm::pow(2e5 / 2e8, 0.6);
    LawSpec::HertzHistory(HertzHistoryParameters {
        kn: 2e5,
        kt: 1.225 * 2e5,
        gamma_n: gamma,
        gamma_t: gamma,
        mu: 0.5,
        rolling: None,
    })
}

/// Time step that goes with [`soft_law`].
pub const SOFT_TIME_STEP: f64 = 1.5e-4;

/// A bed from a LAMMPS data file (type 2 the intruder at V = 1 along x, type 3 frozen, the rest
/// free under gravity 1), numbered in spatial order, not yet started.
///
/// # Errors
/// [`Error::Input`] if the file cannot be read, holds no free grain, an impossible box, or grains
/// too small or light for [`SOFT_TIME_STEP`].
pub fn read_bed(path: &Path) -> Result<Simulation> {
    let data = read_atoms(path)?;
    let place = path.display().to_string();
    let wrong = |what: String| Error::input(place.clone(), what);
    let law = soft_law()
        .build()
        .map_err(|(key, p)| wrong(format!("law.{key} {p}")))?;
    let (mut sim, _) = import::world(&data, law, SOFT_TIME_STEP, 1.0).map_err(wrong)?;
    for ball in &mut sim.obstacles {
        ball.velocity = [1.0, 0.0, 0.0];
    }
    let grains = data.atoms.iter().filter(|a| a.kind != OBSTACLE_TYPE);
    let sizes = grains.map(|a| (0.5 * a.diameter, a.density));
    let checked = soft_law().check_time_step(SOFT_TIME_STEP, sizes);
    checked.map_err(|p| wrong(format!("the time step {p}")))?;
    Ok(sim)
}

/// What to time.
#[derive(Clone, Copy, Debug)]
pub struct Timing<'a> {
    /// A bed from a file; without one the bed of the quick scenario, poured first.
    pub bed: Option<&'a Path>,
    /// Steps to time.
    pub steps: u64,
    /// Threads that step it.
    pub threads: usize,
    /// Copies to step side by side, each on this many threads.
    pub copies: usize,
    /// How often to repeat the bed along x and along y, without its obstacles.
    pub tiles: usize,
}

/// A bed repeated `tiles` times along x and along y, numbered in spatial order, without obstacles and
/// not yet started.
pub fn tiled(one: &Simulation, tiles: usize) -> Result<Simulation> {
    let (lo, hi) = (one.domain.lo(), one.domain.hi());
    let far = |a: usize| lo[a] + tiles as f64 * (hi[a] - lo[a]);
    let domain = Domain::new(lo, [far(0), far(1), hi[2]], one.domain.periodic());
    let domain = domain.map_err(|fault| Error::input("--tiles", format!("{tiles}: {fault}")))?;
    let n = one.count();
    let position = |k: usize| {
        let (tile, x) = (k / n, one.position[k % n]);
        let across = |a: usize, tile: usize| x[a] + tile as f64 * (hi[a] - lo[a]);
        [across(0, tile % tiles), across(1, tile / tiles), x[2]]
    };
    let place = |k: usize| {
        let [x, y, z] = position(k);
        [x, y, z, 0.0]
    };
    let places: Vec<Row<f64>> = (0..n * tiles * tiles).map(place).collect();
    let order = spatial_order(&places, 1.0);
    drop(places);
    let grain = |(number, k): (usize, usize)| {
        let i = k % n;
        let diameter = 2.0 * one.position[i][3];
        Grain {
            id: number as u32 + 1,
            group: one.group[i],
            diameter,
            density: one.velocity[i][3] / sphere_mass(diameter, 1.0),
            position: position(k),
            velocity: head(one.velocity[i]),
            spin: head(one.spin[i]),
        }
    };
    let sorted: Vec<Grain> = order.into_iter().enumerate().map(grain).collect();
    let groups = one.groups.clone();
    Ok(Simulation::new(
        one.law.clone(),
        domain,
        one.dt,
        groups,
        &sorted,
        Vec::new(),
    ))
}

/// The bed of a file, or that of the scenario quick, and its name.
fn named(place: Option<&Path>, progress: &Progress) -> Result<(String, Simulation)> {
    let Some(path) = place else {
        let quick = scenario::load("quick", &[])?;
        let mut stage = progress.stage("pouring the quick bed", 0);
        let sim = bed::pour(&quick, &quick.beds()[0], &mut stage)?;
        stage.finish();
        return Ok(("quick".to_string(), sim));
    };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let mut sim = read_bed(path)?;
    sim.start()
        .map_err(|fault| refuse(&name, fault, |id| format!("a grain (numbered {id} here)")))?;
    Ok((name.into_owned(), sim))
}

/// Times steps of a bed.
///
/// # Errors
/// A bed that cannot be read, or a run that fails.
pub fn bench(what: &Timing<'_>, progress: &Progress) -> Result<Speed> {
    let Timing {
        steps,
        threads,
        copies,
        tiles,
        ..
    } = *what;
    let (name, mut sim) = named(what.bed, progress)?;
    if tiles > 1 {
        sim = tiled(&sim, tiles)?;
        sim.start().map_err(|fault| Error::run(&name, 0, fault))?;
    }
    let stepped = |sim: &mut Simulation, count| {
        sim.steps(count)
            .map_err(|fault| Error::run(&name, sim.step_count() + 1, fault))
    };
    on_threads(threads, || stepped(&mut sim, WARM_UP))??;
    let ((before, ..), renewals) = (sim.list_counts(), sim.prunes());
    let mut sims: Vec<Simulation> = (1..copies).map(|_| sim.clone()).collect();
    sims.push(sim);
    let stage = progress.stage("stepping", steps);
    let one = |k: usize, sim: &mut Simulation| {
        let mut done = 0;
        while done < steps {
            let some = 500.min(steps - done);
            stepped(sim, some)?;
            done += some;
            if k == 0 {
                stage.at(done, sim.count(), "")?;
            }
        }
        Ok(())
    };
    let began = Instant::now();
    std::thread::scope(|scope| {
        let one = &one;
        let each = sims.iter_mut().enumerate();
        let workers: Vec<_> = each
            .map(|(k, sim)| {
                let work = move || on_threads(threads, || one(k, sim))?;
                builder().spawn_scoped(scope, work)
            })
            .collect();
        let ends = workers.into_iter().map(|started| match started {
            Ok(worker) => worker.join().expect("a worker does not panic"),
            Err(e) => Err(ThreadsError::start(copies, &e).into()),
        });
        ends.collect::<Result<Vec<()>>>()
    })?;
    let seconds = began.elapsed().as_secs_f64();
    stage.finish();
    let sim = &mut sims[0];
    let digest = sim.digest().map_err(|f| Error::run(&name, steps, f))?;
    let (grains, (searches, listed, _)) = (sim.count(), sim.list_counts());
    Ok(Speed {
        bed: name,
        grains,
        steps,
        threads,
        copies,
        tiles,
        seconds,
        grain_steps_per_s: copies as f64 * grains as f64 * steps as f64 / seconds,
        contacts_per_grain: sim.contact_histories().len() as f64 / grains as f64,
        listed_pairs_per_grain: listed as f64 / grains as f64,
        rebuilds: searches - before,
        renewals: sim.prunes() - renewals,
        skin: sim.skin,
        bytes_per_grain: sim.bytes() as f64 / grains as f64,
        peak_bytes_per_grain: memory::peak().map(|peak| peak / (copies * grains) as f64),
        digest: hex(&digest.whole),
    })
}
