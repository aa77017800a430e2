//! Pouring in turn from inside, and states taken apart and put together again.

use super::settle::{fallen, rest, settle};
use super::survey::energy_per_grain;
use super::*;
use crate::bed::assemble::Member;
use crate::bed::assemble::assemble;
use crate::bed::lattice::Lattice;
use crate::bed::make::buried;
use crate::bed::make::freeze_base;
use crate::bed::make::in_order;
use crate::bed::make::renumbered;
use crate::scenario;
use bitgrain_kernel::ContactForce;
use bitgrain_sim::checkpoint;
use bitgrain_sim::observe;
use bitgrain_sim::observe::INTRUDER;
use bitgrain_sim::observer::Observer;
use bitgrain_sim::simulation::Role;

/// A rig of 490 grains: 18 x 3 on a base, under a lid.
fn rig() -> CheckedScenario {
    rig_with(&[])
}

/// The same with other values.
fn rig_with(more: &[&str]) -> CheckedScenario {
    let sets = [
        "bed.box=[0.027, 0.0045, 0.021]",
        "bed.fill_height=0.012",
        "bed.settled=1e-2",
        "intruder.diameter=0.001",
        "intruder.height=0.006",
        "intruder.speed=0.1",
        "lid.effective_depth=0.03",
        "drag.distance=0.012",
        "measure.every=50",
    ];
    let sets: Vec<String> = sets.iter().chain(more).map(|set| set.to_string()).collect();
    scenario::load("guillard-small", &sets).unwrap()
}

/// The bed of the rig with nothing on it.
fn bare_plan(scenario: &CheckedScenario) -> BedPlan {
    BedPlan {
        lid: None,
        ..scenario.beds()[0].clone()
    }
}

fn from_axis(sim: &Simulation, i: usize) -> [f64; 3] {
    let (x, body) = (sim.position[i], &sim.obstacles[INTRUDER as usize]);
    observe::offset(&sim.domain, body, [x[0], x[1], x[2]])
}

/// The paper's order: a bed up to the cylinder comes to rest without it, the cylinder takes the place of
/// what little stands in it, and the rest falls from above both.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn the_cylinder_comes_into_a_bed_at_rest() {
    let scenario = rig();
    let plan = &bare_plan(&scenario);
    let count = scenario.grain_count(plan.diameter);
    let lowest = plan.center[2] - 0.5 * plan.diameter;
    let lattice = Lattice::new(&scenario, scenario.filling(lowest, 0.0), 0.0, None);
    let mut bed = Pouring::begin(&scenario, plan).unwrap();
    assert_eq!(bed.sim.obstacles.len(), 1, "a floor and no cylinder");
    let (goal, stage) = (fallen(&scenario, lattice.top), &mut Stage::silent());
    let settled = settle(&mut bed, &scenario, plan, &goal, stage, &mut ());
    assert!(settled.unwrap());
    let mut lower = freeze_base(&mut bed.sim, &scenario).unwrap();
    let energy = energy_per_grain(&lower, &scenario.measures());
    assert!(energy < scenario.bed.settled, "{energy}");
    let surface = observe::surface_height(&lower, scenario.mean_diameter());
    let off = (surface - lowest) / scenario.mean_diameter();
    // The packing is not quite the one that plans assume, and the surface rough.
    assert!(
        off.abs() < 1.5,
        "{off} diameters from the cylinder's lowest point"
    );

    let (whole, top) = buried(&mut lower, &scenario, plan, count).unwrap();
    assert_eq!(whole.count(), count);
    assert_eq!(whole.obstacles[INTRUDER as usize].point, plan.center);
    assert_eq!(whole.obstacles[1], lower.obstacles[0]);
    let same = |i: &usize| lower.position.contains(&whole.position[*i]);
    let kept = (0..count).take_while(same).count();
    let gone = lower.count() - kept;
    assert!(gone < lower.count() / 20, "{gone} stood in its place");
    let highest = lower.position.iter().map(|x| x[2] + x[3]);
    let highest = highest.fold(0.0, |a, b| if b > a { b } else { a });
    for i in 0..count {
        let reach = 0.5 * plan.diameter + whole.position[i][3];
        assert!(observe::length(from_axis(&whole, i)) > reach);
        let x = whole.position[i];
        assert_eq!(
            i < kept,
            x[2] - x[3] < highest,
            "new grains fall from above"
        );
    }

    bed.sim = whole;
    bed.enter(Phase::Fill);
    let goal = fallen(&scenario, top);
    settle(&mut bed, &scenario, plan, &goal, stage, &mut ()).unwrap();
    let mut whole = renumbered(&mut bed.sim, &scenario).unwrap();
    assert!(in_order(&whole).eq(0..count), "numbered in spatial order");
    bed.sim = whole.clone();
    bed.sim.law = scenario.quenching_law();
    for phase in [Phase::Quench, Phase::Rest] {
        bed.enter(phase);
        let goal = rest(&scenario, plan, phase == Phase::Quench);
        settle(&mut bed, &scenario, plan, &goal, stage, &mut ()).unwrap();
        bed.sim.law = whole.law.clone();
    }
    whole = bed.sim;
    let mut poured = pour(&scenario, plan, stage).unwrap();
    assert_eq!(whole.digest(), poured.digest(), "that is how it is poured");
}

#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn a_poured_bed_lies_round_its_cylinder() {
    let scenario = rig();
    let plan = &bare_plan(&scenario);
    let sim = pour(&scenario, plan, &mut Stage::silent()).unwrap();
    assert_eq!(sim.count(), scenario.grain_count(plan.diameter));
    let (mut below, mut above) = (0, 0);
    for i in 0..sim.count() {
        let off = from_axis(&sim, i);
        let reach = 0.5 * plan.diameter + sim.position[i][3];
        // What lies above presses a grain in by some microns, parts in a thousand of that.
        assert!(observe::length(off) > 0.995 * reach);
        let beside = off[0].abs() < 0.5 * plan.diameter;
        below += usize::from(beside && off[2] < 0.0);
        above += usize::from(beside && off[2] > 0.0);
    }
    assert!(below > 5 && above > 5, "{below} below and {above} above it");
    let base = (0..sim.count()).filter(|&i| sim.role(i) == Role::Base);
    assert!(base.clone().all(|i| sim.position[i][2] < scenario.bed.base));
    // A layer, loosely filled.
    assert!((18 * 3 / 3..=18 * 3).contains(&base.count()));
}

/// Keeps the digests of the states that it is shown.
#[derive(Default)]
struct Digests(std::collections::BTreeMap<u64, [String; 6]>);

impl Observer for Digests {
    fn wants_step(&self, step: u64) -> bool {
        step.is_multiple_of(500)
    }

    fn on_step(&mut self, step: u64, sim: &mut Simulation, _: &[ContactForce<f64>]) -> Result<()> {
        let parts = sim
            .digest()
            .unwrap()
            .parts()
            .map(|part| bitgrain_sim::simulation::hex(part));
        self.0.insert(step, parts);
        Ok(())
    }
}

/// What an observer sees of a bed is what its chain holds, also if all motion is stopped now and then;
/// and observing changes nothing.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn a_witness_sees_the_states_of_the_chain() {
    let scenario = rig();
    let plan = &bare_plan(&scenario);
    let stage = &mut Stage::silent();
    let mut bed = Pouring::begin(&scenario, plan).unwrap();
    let mut seen = Digests::default();
    assert!(bed.go_on(&scenario, plan, stage, &mut seen).unwrap());
    let mut alone = pour(&scenario, plan, stage).unwrap();
    assert_eq!(bed.sim.digest(), alone.digest());
    let links = &bed.course.chain().links;
    assert!(links.len() > 10);
    // The first is that of the start; when a phase ends the state is rebuilt after the look.
    let same = links
        .iter()
        .filter(|link| seen.0.get(&link.step) == Some(&link.parts));
    assert_eq!(same.count(), links.len() - 1);
}

/// Put together as it was, a state is the same state; in another order and back it is the same again, its
/// springs turned and turned back.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn a_state_put_together_as_it_was_is_the_same() {
    let scenario = rig();
    let plan = &bare_plan(&scenario);
    let mut sim = pour(&scenario, plan, &mut Stage::silent()).unwrap();
    sim.steps(100).unwrap();
    let obstacles = |sim: &Simulation| -> Vec<_> {
        let bodies = sim.obstacles.iter().copied();
        bodies.zip((0..).map(Some)).collect()
    };
    let put = |sim: &mut Simulation, back: bool| {
        let n = sim.count();
        let place = |k: usize| if back { n - 1 - k } else { k };
        let old = |k: usize| Member::Old(place(k), sim.group[place(k)]);
        let members: Vec<Member> = (0..n).map(old).collect();
        let (groups, bodies) = (sim.groups.clone(), obstacles(sim));
        assemble(sim, &members, groups, bodies).unwrap()
    };
    let mut same = put(&mut sim, false);
    let mut turned = put(&mut sim, true);
    assert_ne!(turned.digest(), sim.digest());
    let springs = |sim: &mut Simulation| sim.contact_histories().len();
    assert!(springs(&mut sim) > 800);
    assert_eq!(springs(&mut turned), springs(&mut sim));
    let mut again = put(&mut turned, true);
    let (mut one, mut other) = (sim.clone(), turned);
    one.steps(1).unwrap();
    other.steps(1).unwrap();
    let weight = 9.81 * one.velocity[0][3];
    for (a, b) in one.force.iter().zip(other.force.iter().rev()) {
        for k in 0..3 {
            // The same contacts summed in another order; a spring turned wrongly pushes like a weight.
            assert!((a[k] - b[k]).abs() < 1e-9 * weight, "{a:?} {b:?}");
        }
    }
    for _ in 0..5 {
        assert_eq!(same.digest(), sim.digest());
        assert_eq!(again.digest(), sim.digest());
        for one in [&mut same, &mut again, &mut sim] {
            one.steps(40).unwrap();
        }
    }
}

/// Laid on its highest support, just clear of it, in the middles of squares that tile the box.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn a_lid_is_laid_on_a_lattice() {
    let scenario = rig();
    let plan = &scenario.beds()[0];
    let stage = &mut Stage::silent();
    let mut bare = pour(&scenario, &bare_plan(&scenario), stage).unwrap();
    let laid = lid::covered(&mut bare, &scenario, plan, plan.lid.as_ref().unwrap()).unwrap();
    assert_eq!(laid.groups[usize::from(LID)].gravity, [0.0, 0.0, -9.81]);
    assert_eq!(laid.groups[usize::from(FREE)].gravity, [0.0, 0.0, -9.81]);
    let d = scenario.mean_diameter();
    let lid: Vec<usize> = (0..laid.count())
        .filter(|&i| laid.group[i] == LID)
        .collect();
    assert_eq!((lid.len(), laid.count()), (18 * 3, bare.count() + 18 * 3));
    let mut cells: Vec<[u64; 2]> = Vec::new();
    for &i in &lid {
        let x = laid.position[i];
        let cell = [x[0], x[1]].map(|length| length / d - 0.5);
        assert!(
            cell.iter().all(|c| (c - c.round()).abs() < 1e-9),
            "{cell:?}"
        );
        cells.push(cell.map(|c| c.round() as u64));
        let gap = |k: usize| {
            let y = laid.position[k];
            let off = laid
                .domain
                .separation([x[0], x[1], x[2]], [y[0], y[1], y[2]]);
            observe::length(off) - (x[3] + y[3])
        };
        let bed = (0..laid.count()).filter(|&k| laid.group[k] != LID);
        let least = bed.map(gap).fold(d, |a, b| if b < a { b } else { a });
        // Put down from a thousandth of a diameter, aslant from less.
        assert!(least > 0.0 && least < 1.001e-3 * d, "{least}");
    }
    cells.sort_unstable();
    cells.dedup();
    assert_eq!(cells.len(), 18 * 3, "each square has one");
}

/// Every draw is keyed by seed, purpose and grain: more grains, or grains let go in another order, leave
/// the draws of the others as they are.
#[test]
fn more_grains_or_another_order_leave_the_draws_of_the_others() {
    let scenario = rig();
    let plan = &bare_plan(&scenario);
    let few = Lattice::new(&scenario, 90, 0.0, None).grains(&scenario, plan, 0);
    let more = Lattice::new(&scenario, 140, 0.0, None).grains(&scenario, plan, 0);
    assert_eq!(few, more[..90]);
    // The second filling first, and higher up: sizes and velocities are those of their numbers.
    let later = Lattice::new(&scenario, 50, 0.01, None).grains(&scenario, plan, 90);
    for (one, other) in later.iter().zip(&more[90..]) {
        assert_eq!(one.id, other.id);
        assert_eq!(
            (one.diameter, one.velocity),
            (other.diameter, other.velocity)
        );
    }
    let mut seeded = plan.clone();
    seeded.seed += 1;
    let others = Lattice::new(&scenario, 90, 0.0, None).grains(&scenario, &seeded, 0);
    let differs = |k: usize| others[k].velocity != few[k].velocity;
    assert!((0..90).all(differs));
}

/// Sees no further than to a step.
struct Until(u64);

impl Observer for Until {
    fn last_step(&self) -> u64 {
        self.0
    }
}

/// The packing fraction of the bare bed of a rig, and its state.
fn packing(scenario: &CheckedScenario) -> (f64, Simulation) {
    let mut sim = pour(scenario, &bare_plan(scenario), &mut Stage::silent()).unwrap();
    let found = survey("bed", &scenario.measures(), &mut sim).unwrap();
    (found.packing_fraction, sim)
}

/// Poured slippery a bed is denser, by more than a fiftieth between friction 0.5 and 0.05; it is left under the
/// friction of the law and at rest under it. With the law's own friction it is the same bed to the bit.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_bed_poured_slippery_is_denser() {
    let (rough, mut plain) = packing(&rig());
    let (same, mut alike) = packing(&rig_with(&["bed.pouring_mu=0.5"]));
    assert_eq!((same, alike.digest()), (rough, plain.digest()));
    let scenario = rig_with(&["bed.pouring_mu=0.05", "bed.settled=1e-5"]);
    let (dense, mut sim) = packing(&scenario);
    assert!(dense > rough + 0.02, "{dense} {rough}");
    assert_eq!(sim.law, scenario.contact_law());
    assert!(sim.law != scenario.pouring_law() && sim.law == plain.law);
    still(&mut sim, &scenario);
}

/// Poured rough a bed under a slippery law gives way before it counts as settled, not as the drag begins.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_bed_poured_rough_is_at_rest_under_its_law() {
    let scenario = rig_with(&["law.mu=0.1", "bed.pouring_mu=0.5", "bed.settled=1e-5"]);
    let (_, mut sim) = packing(&scenario);
    assert_eq!(sim.law, scenario.contact_law());
    still(&mut sim, &scenario);
}

/// Under the law that it is left with a bed moves no more than it did when it counted as settled.
fn still(sim: &mut Simulation, scenario: &CheckedScenario) {
    let before = sim.position.clone();
    for _ in 0..10 {
        sim.steps(100).unwrap();
        let energy = energy_per_grain(sim, &scenario.measures());
        // Rattlers go on; a bed that gives way has some 60 times as much.
        assert!(energy < 10.0 * scenario.bed.settled, "{energy}");
    }
    let d = scenario.mean_diameter();
    for (a, b) in before.iter().zip(&sim.position) {
        let moved = (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max);
        // 1,000 steps, a fall of a third of a grain; a rattler rolls on at the speed that the bound allows.
        assert!(moved < 0.1 * d, "{moved}");
    }
}

/// Stopped in any phase, saved and read back, a bed poured with another friction ends in the same bits.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_bed_poured_slippery_goes_on_to_the_same_bits() {
    let scenario = rig_with(&["bed.pouring_mu=0.05"]);
    let plan = &bare_plan(&scenario);
    let stage = &mut Stage::silent();
    let mut whole = pour(&scenario, plan, stage).unwrap();
    let mut bed = Pouring::begin(&scenario, plan).unwrap();
    let mut phases = Vec::new();
    let mut stop = 0;
    while !bed.go_on(&scenario, plan, stage, &mut Until(stop)).unwrap() {
        let law = match bed.course.phase {
            Phase::Fall | Phase::Fill => scenario.pouring_law(),
            Phase::Quench => scenario.pouring_quenching_law(),
            Phase::Rest | Phase::Settled => scenario.contact_law(),
        };
        assert_eq!(bed.sim.law, law);
        phases.push(bed.course.phase);
        let bytes = checkpoint::pack(&mut bed.sim, &bed.course.note()).unwrap();
        let (sim, note) = checkpoint::unpack(&bytes, "saved").unwrap();
        bed = Pouring::of(sim, &note, &scenario, plan).unwrap();
        stop += 500;
    }
    phases.dedup();
    let all = [Phase::Fall, Phase::Fill, Phase::Quench, Phase::Rest];
    assert_eq!(phases, all);
    assert_eq!(bed.sim.digest(), whole.digest());
    // Saved by another friction it is another recipe's.
    let bytes = checkpoint::pack(&mut bed.sim, &bed.course.note()).unwrap();
    let (sim, note) = checkpoint::unpack(&bytes, "saved").unwrap();
    let other = rig_with(&["bed.pouring_mu=0.06"]);
    assert!(Pouring::of(sim, &note, &other, plan).is_err());
}

/// Beds of grains that roll with resistance on a bare floor come to rest. Nothing takes the spin of a grain about the
/// normal of its only contact, and that of this bed is a dozen times what may be left.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours a small bed: seconds in release")]
fn a_bed_in_which_grains_twist_comes_to_rest() {
    for rolling in [
        "{ kind = 'sds', k = 60.0, gamma = 0.3, mu = 0.3 }",
        "{ kind = 'epsd2', mu = 0.3 }",
    ] {
        let sets = [
            "seed=5",
            "bed.box=[6.0, 5.0, 8.0]",
            "bed.grains=155",
            "bed.base=0.0",
            "bed.settled=1e-6",
            "law.kn=1e4",
            "law.kt=1.2e4",
            "law.gamma_n=140.0",
            "law.gamma_t=140.0",
            "intruder.diameter=1.0",
            "intruder.height=2.6",
            "intruder.speed=1.0",
            "drag.dt=2e-3",
            "drag.distance=3.0",
            "measure.every=5",
        ];
        let mut sets: Vec<String> = sets.map(String::from).to_vec();
        sets.push(format!("law.rolling={rolling}"));
        let scenario = scenario::load("quick", &sets).unwrap();
        let plan = &scenario.beds()[0];
        let sim = pour(&scenario, plan, &mut Stage::silent()).unwrap();
        let energy = energy_per_grain(&sim, &scenario.measures());
        assert!(energy < 1e-6, "{rolling}: {energy}");
    }
}
