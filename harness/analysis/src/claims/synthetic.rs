//! Made-up summaries of flowing beds, for tests.

use super::book::{Book, Claim};
use bitgrain_lab::scenario::{self, CheckedScenario};
use bitgrain_lab::summary::{BedSummary, DragSummary, Flow, Rig, Summary};
use bitgrain_sim::block_averaging::{METHOD, Mean};

/// Height of the free surface of every bed, in metres.
pub(crate) const SURFACE: f64 = 0.06;

/// What a made-up summary is to show.
#[derive(Clone, Debug)]
pub(crate) struct Asked {
    /// Heights of the axis above the floor, in metres; the surface is at [`SURFACE`].
    pub heights: Vec<f64>,
    /// Effective depths in metres; a lid with and without a pressure gradient at each.
    pub depths: Vec<f64>,
    /// Seeds of each.
    pub seeds: u64,
    /// Drag over pressure and D L.
    pub drag_coefficient: f64,
    /// Lift over buoyancy with a pressure gradient, by effective depth.
    pub lift: fn(f64) -> f64,
    /// The same without one, by height of the axis above the floor.
    pub lift_without: fn(f64) -> f64,
    /// Standard error of a run's means over the means with a gradient.
    pub error: f64,
    /// Speed of the far grains over that asked for.
    pub far_field: f64,
    /// Travel in grain diameters.
    pub travel: f64,
    /// What is done to every run at the end.
    pub change: fn(&mut Flow),
}

impl Default for Asked {
    fn default() -> Self {
        Self {
            heights: vec![0.03],
            depths: vec![0.04, 0.08, 0.12, 0.16],
            seeds: 2,
            drag_coefficient: 10.0,
            lift: |depth| if depth < 0.06 { 20.0 } else { 30.0 },
            lift_without: |_| 0.1,
            error: 0.02,
            far_field: 0.99,
            travel: 83.4,
            change: |_| (),
        }
    }
}

fn scenario(asked: &Asked) -> CheckedScenario {
    let seeds: Vec<u64> = (1..=asked.seeds).collect();
    let sets = [
        format!("intruder.height={:?}", asked.heights),
        format!("lid.effective_depth={:?}", asked.depths),
        format!("seeds={seeds:?}"),
    ];
    scenario::load("guillard-small", &sets).expect("the shipped scenario takes these values")
}

/// A summary whose runs are what is asked for, seeds one standard error about it.
pub(crate) fn summary(asked: &Asked) -> Summary {
    let inputs = scenario(asked);
    let plans = inputs.beds();
    let beds: Vec<BedSummary> = plans
        .iter()
        .map(|plan| {
            let lid = plan.lid.expect("every depth needs a lid");
            let rig = rig(&inputs, plan.seed, lid.pressure_gradient);
            let depth = SURFACE - plan.center[2];
            bed(&plan.name, rig, lid.effective_depth.unwrap_or(0.0), depth)
        })
        .collect();
    let runs = inputs.drags();
    let runs = runs
        .iter()
        .map(|plan| {
            run(
                asked,
                &inputs,
                &plan.name,
                &beds[plan.bed],
                plan.motion.speed,
            )
        })
        .collect();
    Summary {
        version: "1.2.3".into(),
        bits_version: 9,
        scenario: inputs.name.clone(),
        units: inputs.units(),
        inputs,
        standard_error_method: METHOD.into(),
        beds,
        runs,
    }
}

fn rig(inputs: &CheckedScenario, seed: u64, pressure_gradient: bool) -> Rig {
    Rig {
        seed,
        diameter: 0.00495,
        length: inputs.bed.size[1],
        pressure_gradient,
        lid_grains: 450,
        lid_density: 150_000.0,
        bulk_density: 1500.0,
        effective_depth: 0.0,
        pressure: 0.0,
        reaction_over_buoyancy: -0.5,
    }
}

fn bed(name: &str, mut rig: Rig, effective_depth: f64, depth: f64) -> BedSummary {
    rig.effective_depth = effective_depth;
    rig.pressure = 1500.0 * 9.81 * effective_depth;
    BedSummary {
        name: name.into(),
        grains: 12_345,
        frozen: 450,
        steps: 1_000_000,
        surface: SURFACE,
        depth,
        packing_fraction: 0.6,
        coordination_number: 5.0,
        overlap_max: 0.001,
        kinetic_energy_over_weight_d: 1e-7,
        weight: 1.0,
        support: 1.0,
        chain: String::new(),
        digest: "0123abcd".into(),
        rig: Some(rig),
    }
}

/// How a bed flowed, as it is asked for.
fn flow(asked: &Asked, inputs: &CheckedScenario, bed: &BedSummary, rig: &Rig) -> Flow {
    let sign = if rig.seed % 2 == 1 { 1.0 } else { -1.0 };
    let seeded = if asked.seeds > 1 { sign } else { 0.0 };
    let off = 1.0 + seeded * asked.error;
    let buoyancy = 1500.0 * inputs.gravity * inputs.intruder_volume(rig.diameter);
    let scale = rig.pressure * rig.diameter * rig.length;
    let with = (asked.lift)(rig.effective_depth);
    let without = (asked.lift_without)(SURFACE - bed.depth);
    let lift = match rig.pressure_gradient {
        true => with * off,
        false => without + seeded * asked.error * with,
    };
    let mut flow = Flow {
        pressure_gradient: rig.pressure_gradient,
        packing_fraction: 0.6,
        bulk_density: rig.bulk_density,
        effective_depth: rig.effective_depth,
        pressure: rig.pressure,
        pressure_measured: rig.pressure,
        buoyancy,
        drag_coefficient: asked.drag_coefficient * off,
        drag_coefficient_error: asked.drag_coefficient * asked.error,
        lift_over_buoyancy: lift,
        lift_over_buoyancy_error: with * asked.error,
        far_field: asked.far_field,
        far_field_least: asked.far_field,
        carried_by_base: 0.5,
        carried_by_lid: 0.5,
        inertia: 0.0,
        floating: 0,
        travel: asked.travel,
        drag_halves: [asked.drag_coefficient * off * scale; 2],
        lift_halves: [lift; 2],
        load: None,
        disturbance: None,
    };
    (asked.change)(&mut flow);
    flow
}

fn run(
    asked: &Asked,
    inputs: &CheckedScenario,
    name: &str,
    bed: &BedSummary,
    speed: f64,
) -> DragSummary {
    let rig = bed.rig.clone().expect("the bed flows");
    let flow = flow(asked, inputs, bed, &rig);
    let (scale, buoyancy) = (rig.pressure * rig.diameter * rig.length, flow.buoyancy);
    DragSummary {
        tank: None,
        name: name.into(),
        bed: bed.name.clone(),
        froude: 0.1,
        speed,
        diameter: rig.diameter,
        depth: bed.depth,
        distance: 0.135,
        steps: 7,
        window_start: 0.0099,
        window_end: 0.135,
        window_steps: 5,
        drag: mean(
            flow.drag_coefficient * scale,
            flow.drag_coefficient_error * scale,
        ),
        lift: mean(
            flow.lift_over_buoyancy * buoyancy,
            flow.lift_over_buoyancy_error * buoyancy,
        ),
        side: mean(0.0, 1e-4),
        contacts: mean(7.0, 0.1),
        contact_angle: None,
        new_contact_angle: None,
        floating: None,
        kappa: None,
        kappa_error: None,
        moving: None,
        drift: None,
        coordination: None,
        drag_uncut: 0.5,
        drag_uncut_error: None,
        drag_by_travel: vec![],
        reaches: vec![],
        large_overlaps: None,
        plug_ratio: 0.5,
        plug: bitgrain_lab::plug_flow::PlugFlow::Sound,
        coordination_shares: vec![],
        released: None,
        flow: Some(flow),
        overlap_max: 0.01,
        energy: None,
        chain: String::new(),
        digest: "89ef".into(),
        digest_parts: vec![("grains".into(), "4567".into())],
    }
}

fn mean(mean: f64, standard_error: f64) -> Mean {
    Mean {
        mean,
        standard_error,
        blocks: 32,
        block_length: 400,
        converged: true,
    }
}

/// A claim `a` with these lines.
pub(super) fn claim(lines: &str) -> Claim {
    let text = format!(
        "[[claim]]\nid = \"a\"\npaper = \"p\"\nsource = \"s\"\nstatement = \"t\"\n{lines}\nwhy = \"w\"\n\
         measures = \"m\"\ntested_by = []\n"
    );
    Book::parse(&text, "text").unwrap().claim.remove(0)
}

/// A claim of the book that ships.
pub(super) fn shipped(id: &str) -> Claim {
    let mut claims = Book::shipped().claim.into_iter();
    claims.find(|claim| claim.id == id).unwrap()
}
