//! Everything measured, as it is written.

use super::released::Released;
use crate::plug_flow::PlugFlow;
use crate::scenario::CheckedScenario;
use crate::tank::HalfTurn;
use bitgrain_sim::block_averaging::Mean;
use bitgrain_sim::coarse_graining::Load;
use bitgrain_sim::energy_budget::EnergyRow;
use bitgrain_sim::units::Units;
use serde::{Deserialize, Serialize};

/// Overlap over the mean diameter up to which a contact is narrow: at a twentieth the contact of two equal grains is
/// 0.45 of their radius wide, and Hertz's law takes it for narrow (Johnson, Contact Mechanics, section 4.2).
pub const LARGE_OVERLAP: f64 = 0.05;

/// Everything measured, in the units the scenario names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Summary<S = CheckedScenario> {
    /// Version of the program that wrote it.
    pub version: String,
    /// Version of the kernel's arithmetic.
    pub bits_version: u32,
    /// Name of the scenario.
    pub scenario: String,
    /// Scalings of the numbers: quantity and unit.
    pub units: Units,
    /// Every input, defaults written out.
    pub inputs: S,
    /// How the standard errors were found.
    pub standard_error_method: String,
    /// The settled beds, one for each depth asked for.
    pub beds: Vec<BedSummary>,
    /// The drags, by bed and then speed.
    pub runs: Vec<DragSummary>,
}

/// One settled bed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BedSummary {
    /// Name, also of its files.
    pub name: String,
    /// Grains, frozen ones included, the intruder not.
    pub grains: usize,
    /// Frozen base grains among them.
    pub frozen: usize,
    /// Steps from the first grain's release to the settled bed.
    pub steps: u64,
    /// Height of the free surface: median over columns of 2 d of the highest grain top.
    pub surface: f64,
    /// Depth of the intruder's centre below the surface.
    pub depth: f64,
    /// Solid fraction from z = 1 d to 2 d below the surface, intruder left out.
    pub packing_fraction: f64,
    /// Mean number of contacts of a free grain below the surface layer.
    pub coordination_number: f64,
    /// Deepest overlap over the mean diameter.
    pub overlap_max: f64,
    /// Kinetic energy per free grain over a grain's mean weight times the mean diameter.
    pub kinetic_energy_over_weight_d: f64,
    /// Weight of the free grains.
    pub weight: f64,
    /// Upward force of base, planes and intruder on the free grains.
    pub support: f64,
    /// Digest of the settled state, in hex.
    pub digest: String,
    /// The last link of its chain of digests.
    #[serde(default)]
    pub chain: String,
    /// Of a bed that flows or is in a tank: its intruder, its lid and the pressure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rig: Option<Rig>,
}

/// The further numbers of a bed that flows or is in a tank.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rig {
    /// Seed of its pouring.
    pub seed: u64,
    /// Diameter D of the intruder.
    pub diameter: f64,
    /// Length L of the cylinder, the box along y, or of the bar; of a sphere its diameter.
    pub length: f64,
    /// Whether the bed below the lid has weight.
    pub pressure_gradient: bool,
    /// Grains of the lid; 0 without one.
    pub lid_grains: usize,
    /// Mass density of the lid's grains; 0 without one.
    pub lid_density: f64,
    /// Bulk density rho = phi rho_g of the settled bed.
    pub bulk_density: f64,
    /// Effective depth h + (pi d/6)(rho_lid/rho), without h if there is no pressure gradient.
    pub effective_depth: f64,
    /// Weight above the height of the intruder's centre over the area of the bed.
    pub pressure: f64,
    /// Upward force on the resting intruder over its buoyancy: the part of the bed it carries, negative.
    pub reaction_over_buoyancy: f64,
}

/// One drag at one speed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DragSummary {
    /// Name, also of its folder.
    pub name: String,
    /// Name of its bed.
    pub bed: String,
    /// Froude number 2 V sqrt(2 D/g)/(D + d).
    pub froude: f64,
    /// Speed of the intruder along x, of a bar that of its ends.
    pub speed: f64,
    /// Diameter of the intruder.
    pub diameter: f64,
    /// Depth of its centre below the free surface.
    pub depth: f64,
    /// Distance travelled.
    pub distance: f64,
    /// Steps of the drag.
    pub steps: u64,
    /// Travel at which averaging began.
    pub window_start: f64,
    /// Travel at which averaging ended.
    pub window_end: f64,
    /// Steps averaged.
    pub window_steps: u64,
    /// Force on the intruder against its motion; on a bar by its torque (Guillard 2014, eq. 1).
    pub drag: Mean,
    /// Upward force on the intruder, without its weight.
    pub lift: Mean,
    /// Force on the intruder along y; on a bar along itself.
    pub side: Mean,
    /// Mean number of grains that touch the intruder.
    pub contacts: Mean,
    /// Contact angle on the intruder (radians, 0 straight ahead), over all contacts of the samples.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact_angle: Option<Mean>,
    /// Contacts of a grain within 2 d of the intruder's surface, over all such grains of the samples.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coordination: Option<Mean>,
    /// The same angle of contacts as they begin, over all that began in the window.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub new_contact_angle: Option<Mean>,
    /// Share of the grains within 2 d of the intruder's surface that have no contact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub floating: Option<Mean>,
    /// Shares of these grains with 0, 1, 2, ... contacts (Kumar 2018, Fig. 7).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub coordination_shares: Vec<f64>,
    /// Normalised coordination number kappa = (Z/n) (D + d)^2 / (2 sqrt(3) d^2), Z `coordination` and n
    /// `contacts` (Kumar 2018, eq. 8).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kappa: Option<f64>,
    /// Its standard error, those of Z and n taken for independent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kappa_error: Option<f64>,
    /// The same within other distances of the intruder's surface, those that were asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reaches: Vec<Reach>,
    /// Free grains that go at half the intruder's speed or faster.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub moving: Option<Mean>,
    /// Speed along x of the layers above the intruder's top over its own: 0 if they stay, 1 if all
    /// slide along as a plug.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drift: Option<Mean>,
    /// Mean drag over all steps, nothing cut.
    pub drag_uncut: f64,
    /// Its standard error, from blocks of the rows of the series; none of fewer than 16 rows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drag_uncut_error: Option<f64>,
    /// Mean drag over each whole mean diameter of travel, from the first, nothing cut: what the cumulative mean of
    /// Kumar 2018, Fig. 4, is the mean of.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub drag_by_travel: Vec<f64>,
    /// Drag over the weight of the bed above the intruder's lowest point. Only friction holds
    /// that part back in a periodic box: the larger the ratio, the more of it slides along.
    pub plug_ratio: f64,
    /// What that ratio says; of a bed that flows it says nothing, for base and lid carry it.
    #[serde(default)]
    pub plug: PlugFlow,
    /// Deepest overlap of grains with each other and with the intruder at any row of the series, over the
    /// mean diameter.
    #[serde(default)]
    pub overlap_max: f64,
    /// Share of the contacts, of grains with each other and with the intruder, whose overlap is beyond
    /// [`LARGE_OVERLAP`] of the mean diameter in the last state; none if nothing touches.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub large_overlaps: Option<f64>,
    /// Where the energy of the drag went, if that was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub energy: Option<EnergyRow>,
    /// The way of an intruder that forces moved. Its speed and distance are measured then: of a drop, the speed is that
    /// of a fall from its height and the distance goes down; of a pull, the speed is the mean over the window.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub released: Option<Released>,
    /// How the bed flowed, and forces over what they scale with.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flow: Option<Flow>,
    /// What was measured of a bar in a tank.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tank: Option<Tank>,
    /// The last link of its chain of digests.
    #[serde(default)]
    pub chain: String,
    /// Digest of the final state, in hex.
    pub digest: String,
    /// Digests of its parts, by name.
    pub digest_parts: Vec<(String, String)>,
}

/// What was measured of the grains within a distance of the intruder's surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reach {
    /// The distance.
    pub reach: f64,
    /// Contacts of a grain, over all such grains of the samples.
    pub coordination: Mean,
    /// Share of them that have none.
    pub floating: Mean,
    /// Normalised coordination number with this coordination; none if nothing touches the intruder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kappa: Option<f64>,
    /// Its standard error.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kappa_error: Option<f64>,
}

/// How a bed flowed past its intruder (Guillard 2014, section III B).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flow {
    /// Whether the bed below the lid had weight.
    pub pressure_gradient: bool,
    /// Solid fraction phi, mean over the window.
    pub packing_fraction: f64,
    /// Bulk density rho = phi rho_g.
    pub bulk_density: f64,
    /// Effective depth with that density.
    pub effective_depth: f64,
    /// Pressure rho g h~ at the intruder's centre.
    pub pressure: f64,
    /// Weight above the height of the intruder's centre over the area of the box, mean over the
    /// window: the pressure as it is measured.
    pub pressure_measured: f64,
    /// rho g pi D^2 L/4.
    pub buoyancy: f64,
    /// Drag over rho g h~ D L.
    pub drag_coefficient: f64,
    /// Its standard error.
    pub drag_coefficient_error: f64,
    /// Lift over buoyancy.
    pub lift_over_buoyancy: f64,
    /// Its standard error.
    pub lift_over_buoyancy_error: f64,
    /// Speed of the far grains past the intruder over the speed asked for, from displacements.
    pub far_field: f64,
    /// The same in the layer of the bed where it is least.
    pub far_field_least: f64,
    /// Drag carried by base and planes, over the drag of the same steps.
    pub carried_by_base: f64,
    /// Drag carried by the lid, over the same.
    pub carried_by_lid: f64,
    /// What changed the bed's momentum, over the same: the three make 1 with the drag.
    pub inertia: f64,
    /// Most free grains above the lid at any time.
    pub floating: u64,
    /// Travel of the window in mean grain diameters.
    pub travel: f64,
    /// Drag over the first and the second half of the window.
    pub drag_halves: [f64; 2],
    /// Lift over buoyancy over them.
    pub lift_halves: [f64; 2],
    /// Stress on the cylinder by angle, mean over the samples of the fields, if these were asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub load: Option<Load>,
    /// How far the bed is disturbed above the intruder's centre and below it, over D^2: the integral of the
    /// speed relative to the far grains at the same height, over that of the motion.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub disturbance: Option<[f64; 2]>,
}

/// How a bar turned in a tank (Guillard 2014, section II). Forces are means of the window, which ends before the bar
/// meets its own wake.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tank {
    /// Inner diameter of the tank.
    pub diameter: f64,
    /// Length L of the bar.
    pub length: f64,
    /// Rate Omega of the turning (radians over time).
    pub turning_rate: f64,
    /// Turns of the whole drag.
    pub turns: f64,
    /// Omega^2 R/g at the wall: the size of the forces that a turning tank has and one at rest lacks.
    pub centrifugal: f64,
    /// Bulk density rho = phi rho_g of the settled bed.
    pub bulk_density: f64,
    /// Pressure rho g h at the bar's axis.
    pub pressure: f64,
    /// rho g pi D^2 L/4.
    pub buoyancy: f64,
    /// C_d: drag over rho g h D L (eq. 2).
    pub drag_coefficient: f64,
    /// Its standard error.
    pub drag_coefficient_error: f64,
    /// Lift over buoyancy.
    pub lift_over_buoyancy: f64,
    /// Its standard error.
    pub lift_over_buoyancy_error: f64,
    /// Sum of the forces against the motion of each half, over the drag of eq. 1; none without a sample.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direct: Option<f64>,
    /// Drag and lift of each half turn, of the first from the window's beginning.
    pub half_turns: Vec<HalfTurn>,
}

/// One drag with all that belongs to it: `summary.json` of its own folder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DragRecord<S = CheckedScenario> {
    /// Version of the program that wrote it.
    pub version: String,
    /// Version of the kernel's arithmetic.
    pub bits_version: u32,
    /// Scalings of the numbers: quantity and unit.
    pub units: Units,
    /// Every input, defaults written out.
    pub inputs: S,
    /// How the standard errors were found.
    pub standard_error_method: String,
    /// The settled bed it was dragged through.
    pub bed: BedSummary,
    /// What was measured.
    pub run: DragSummary,
}

impl DragRecord {
    /// The summary of its scenario, without beds and drags.
    pub(super) fn whole(&self) -> Summary {
        Summary {
            version: self.version.clone(),
            bits_version: self.bits_version,
            scenario: self.inputs.name.clone(),
            units: self.units.clone(),
            inputs: self.inputs.clone(),
            standard_error_method: self.standard_error_method.clone(),
            beds: Vec::new(),
            runs: Vec::new(),
        }
    }
}
