//! Does this machine keep the bit contract? The kernel's reference worlds, run here by every way of
//! stepping and compared with their published digests.

use std::sync::Arc;

use bitgrain_kernel::blake3::Hasher;
use bitgrain_kernel::conformance::{self, EVERY, Line, Room, StageLaw, World};
use bitgrain_kernel::{BITS_VERSION, Error as KernelError, Real, check_arithmetic};

use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::isa::Isa;
use bitgrain_sim::law::Pairs;
use bitgrain_sim::simulation::{AnyLaw, Simulation};
use bitgrain_sim::threads::on_threads;

/// The published lines, one for each digest.
const PUBLISHED: &str = include_str!("../data/reference.txt");

/// Threads beside one: enough that every part has a neighbour on either side.
const THREADS: usize = 3;

/// Runs everything and returns the message; `show` gets each line as it comes.
///
/// # Errors
/// [`Error::Contract`] with the first digest that differs, or what is wrong with the arithmetic.
pub fn selftest(show: impl FnMut(&str) -> Result<()>) -> Result<()> {
    against(PUBLISHED, show)
}

fn against(published: &str, mut show: impl FnMut(&str) -> Result<()>) -> Result<()> {
    let broken = |what: &str, fault: KernelError| Error::Contract {
        problem: format!("{what}: {fault}"),
    };
    check_arithmetic::<f64>().map_err(|fault| broken("double precision", fault))?;
    check_arithmetic::<f32>().map_err(|fault| broken("single precision", fault))?;
    show("arithmetic            rounds to nearest, keeps subnormal numbers, fuses no operations")?;

    let mut all = Hasher::new();
    let mut lines = by_the_kernel::<f64>(&mut all).map_err(|fault| broken("the kernel", fault))?;
    let double = lines.len();
    lines.extend(by_the_kernel::<f32>(&mut all).map_err(|fault| broken("the kernel", fault))?);
    lines.push(conformance::last(&all));
    compare("the kernel", &lines, published, &mut show)?;

    for registers in Isa::all() {
        for threads in [1, THREADS] {
            let name = format!("{registers:?}, {threads} thread(s)");
            let lines = on_threads(threads, || by_parts(registers, threads))?;
            let lines = lines.map_err(|fault| broken(&name, fault))?;
            if lines.len() != double {
                let problem = format!("{name}: {} digests, not {double}", lines.len());
                return Err(Error::Contract { problem });
            }
            compare(&name, &lines, published, &mut show)?;
        }
    }
    let whole = bitgrain_sim::simulation::hex(&all.finish());
    show(&format!(
        "\nThis machine keeps the bit contract: BITS_VERSION {BITS_VERSION}, reference digest {whole}"
    ))
}

/// The lines as the kernel's own step gives them.
fn by_the_kernel<R: Real>(all: &mut Hasher) -> std::result::Result<Vec<Line>, KernelError> {
    let mut room = Box::new(Room::<R>::vacant());
    let mut lines = Vec::new();
    conformance::run(&mut room, all, |line| lines.push(*line))?;
    Ok(lines)
}

/// The lines in double precision as a simulation gives them, on the threads round this call.
fn by_parts(registers: Isa, threads: usize) -> std::result::Result<Vec<Line>, KernelError> {
    let mut room = Box::new(Room::<f64>::vacant());
    let mut lines = Vec::new();
    for one in World::ALL {
        one.lay(&mut room)?;
        let mut sim = taken(&mut room);
        sim.stepping.registers = registers;
        // Thirty grains are few, but every thread must have some.
        sim.stepping.divide_always();
        for stage in one.stages() {
            if let (Some(speed), Some(body)) = (stage.speed, sim.obstacles.first_mut()) {
                body.velocity[0] = speed;
            }
            sim.law = law_of(stage.law);
            let mut tell = |sim: &mut Simulation| -> std::result::Result<(), KernelError> {
                lines.push(Line {
                    real: f64::NAME,
                    world: one.name(),
                    step: sim.step_count(),
                    digest: sim.digest()?.whole,
                });
                Ok(())
            };
            if sim.step_count() == 0 {
                sim.start()?;
                tell(&mut sim)?;
            }
            while sim.step_count() < stage.last {
                sim.steps(EVERY)?;
                debug_assert_eq!(sim.stepping.parts(), threads, "every thread has a part");
                tell(&mut sim)?;
            }
        }
    }
    Ok(lines)
}

/// The law of a stage.
fn law_of(stage: StageLaw) -> AnyLaw {
    match stage {
        StageLaw::History(gamma) => AnyLaw::HertzHistory(conformance::history(gamma)),
        StageLaw::Tsuji => AnyLaw::HertzTsuji(conformance::tsuji()),
        StageLaw::Materials => {
            let laws = conformance::materials().to_vec();
            let table = Pairs::new(conformance::MATERIALS, laws);
            AnyLaw::HertzTsujiRolling(Arc::new(table.expect("one law for each pair")))
        }
    }
}

/// The world of a room as a simulation.
fn taken(room: &mut Room<f64>) -> Simulation {
    let world = room.world();
    let law = AnyLaw::HertzTsuji(conformance::tsuji());
    let (groups, obstacles) = (world.grains.groups.to_vec(), world.obstacles.to_vec());
    let mut sim = Simulation::new(law, *world.domain, world.dt, groups, &[], obstacles);
    let g = &world.grains;
    (sim.id, sim.group) = (g.id.to_vec(), g.group.to_vec());
    (sim.position, sim.velocity) = (g.position.to_vec(), g.velocity.to_vec());
    (sim.spin, sim.image) = (g.spin.to_vec(), g.image.to_vec());
    (sim.force, sim.torque) = (g.force.to_vec(), g.torque.to_vec());
    sim.choose_skin();
    sim.fit_storage();
    sim
}

/// Compares lines with the published ones of the same worlds and steps.
fn compare(
    name: &str,
    lines: &[Line],
    published: &str,
    show: &mut impl FnMut(&str) -> Result<()>,
) -> Result<()> {
    for line in lines {
        let text = line.text();
        let ours = String::from_utf8_lossy(&text);
        let (place, digest) = ours.trim_end().split_at(35);
        let theirs = published.lines().find_map(|line| line.strip_prefix(place));
        if theirs != Some(digest) {
            let expected = theirs.unwrap_or("nothing");
            return Err(Error::Contract {
                problem: format!(
                    "{name}: at `{}` the digest is {digest}, published is {expected}",
                    place.trim_end()
                ),
            });
        }
    }
    show(&format!("{name:<22}{} digests as published", lines.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn this_machine_keeps_the_contract() {
        let mut told = String::new();
        let show = |line: &str| {
            told.push_str(line);
            Ok(())
        };
        selftest(show).unwrap();
        assert!(told.contains("keeps the bit contract") && told.contains("Plain, 3 thread(s)"));
    }

    #[test]
    fn a_digest_that_differs_is_told() {
        // The digest of the rig in double precision at step 400.
        let begin = PUBLISHED.find("rig                        400").unwrap();
        let digit = begin + 31;
        let mut other = PUBLISHED.to_string();
        let changed = if &other[digit..=digit] == "0" {
            "1"
        } else {
            "0"
        };
        other.replace_range(digit..=digit, changed);
        let told = against(&other, |_| Ok(())).unwrap_err().to_string();
        assert!(
            told.contains("the kernel: at `f64 rig") && told.contains("400`"),
            "{told}"
        );
    }
}
