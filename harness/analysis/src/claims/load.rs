//! What runs say together of the load on the cylinder (Guillard 2014, section IV and appendix B).

use super::fits::same_depth;
use super::points::DEEP;
use super::points::{Group, Point, Spread, axis_stress};
use crate::analysis::Value;
use crate::fit::linear::line;
use crate::fit::{Datum, Fit};
use bitgrain_lab::summary::Summary;
use bitgrain_sim::coarse_graining::load::{Load, POINTS, Sum, odd, theta};

/// Least error of a stress over the largest of its curve: where hardly a grain touches, eight parts give no
/// error.
const LEAST_ERROR: f64 = 0.05;

/// The load of one run over the pressure there: the vertical stress at the cylinder's axis, as the drag is compared.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RunLoad {
    pub seed: u64,
    /// That pressure over rho g D.
    pub pressure: f64,
    pub normal: Vec<Value>,
}

/// The load of the runs of a point, mean over its seeds; every curve by angle, as [`theta`] has it, over the
/// pressure P_0 at the cylinder's axis.
#[derive(Clone, Debug, PartialEq)]
pub struct PointLoad {
    /// Effective depth over D, mean over the seeds.
    pub depth: f64,
    /// P_0 over rho g D, mean over the seeds: nearly the same.
    pub pressure: f64,
    /// The one that the plan asks for, over D.
    pub asked: f64,
    /// Whether the bed has weight below the lid.
    pub gradient: bool,
    pub(super) runs: Vec<RunLoad>,
    /// Normal stress.
    pub normal: Vec<Value>,
    /// Tangential stress.
    pub tangential: Vec<Value>,
    /// The force without the contacts' normal forces, over the whole.
    pub tangential_part: Value,
    /// What eq. 4 would make of the load: lift over buoyancy.
    pub simple_lift: Value,
    /// Drag over P_0 D L of the normal forces.
    pub drag: Value,
    /// Their lift over the same.
    pub normal_lift: Value,
    /// Mean lift over buoyancy, of all steps.
    pub lift: Value,
}

/// Loads of all points of a group whose runs have them, with a pressure gradient and then without, by effective
/// depth.
pub fn loads(summary: &Summary, group: &Group) -> Vec<PointLoad> {
    let points = [true, false].map(|gradient| group.with_gradient(gradient));
    let all = points.into_iter().flatten();
    all.filter_map(|p| point_load(summary, group, p)).collect()
}

/// The load of the runs of a point; `None` if one of them has none.
pub(super) fn point_load(summary: &Summary, group: &Group, point: &Point) -> Option<PointLoad> {
    let inputs = &summary.inputs;
    let area = inputs.bed.size[0] * inputs.bed.size[1];
    let runs = point.runs.iter().map(|&k| {
        let run = &summary.runs[k];
        let flow = run.flow.as_ref()?;
        let bed = summary.beds.iter().find(|bed| bed.name == run.bed)?;
        let seed = bed.rig.as_ref()?.seed;
        let pressure = axis_stress(run, flow, area);
        let over = pressure / (flow.bulk_density * inputs.gravity * group.diameter);
        Some((seed, pressure, over, flow.load.as_ref()?))
    });
    let runs: Vec<(u64, f64, f64, &Load)> = runs.collect::<Option<_>>()?;
    let curve = |k: usize, of: fn(&Load) -> (&[f64], &[f64])| -> Vec<Value> {
        let (_, pressure, _, load) = runs[k];
        let (stress, error) = of(load);
        let floor = LEAST_ERROR * most(error.iter().copied());
        let own = stress.iter().zip(error);
        own.map(|(s, e)| Value::new(*s, if *e > floor { *e } else { floor }).divided(pressure))
            .collect()
    };
    let mean = |of: fn(&Load) -> (&[f64], &[f64])| -> Vec<Value> {
        let all: Vec<Vec<Value>> = (0..runs.len()).map(|k| curve(k, of)).collect();
        over_seeds(&all)
    };
    let number = |of: &dyn Fn(&Sum, f64) -> f64| -> Value {
        let own = runs
            .iter()
            .map(|(_, pressure, _, load)| load.mean(|sum| of(sum, *pressure)));
        Spread::of(&own.collect::<Vec<_>>()).into()
    };
    let single = |k: usize| RunLoad {
        seed: runs[k].0,
        pressure: runs[k].2,
        normal: curve(k, |l| (&l.normal, &l.normal_error)),
    };
    let pressure = runs.iter().map(|run| run.2).sum::<f64>() / runs.len() as f64;
    Some(PointLoad {
        pressure,
        depth: point.effective_depth / group.diameter,
        asked: point.asked / group.diameter,
        gradient: point.way.has_gradient(),
        runs: (0..runs.len()).map(single).collect(),
        normal: mean(|l| (&l.normal, &l.normal_error)),
        tangential: mean(|l| (&l.tangential, &l.tangential_error)),
        tangential_part: number(&|sum, _| sum.tangential_part()),
        simple_lift: number(&|sum, p| sum.simple_lift() / p),
        drag: number(&|sum, p| sum.normal_drag / p),
        normal_lift: number(&|sum, p| sum.normal_lift / p),
        lift: point.lift.into(),
    })
}

/// The largest of the values, at least 0.
fn most(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |a, x| if x > a { x } else { a })
}

/// The largest normal stress of all.
pub fn highest(loads: &[&PointLoad]) -> f64 {
    let all = loads.iter().flat_map(|l| &l.normal);
    most(all.map(|v| v.value))
}

/// Curves of several seeds as one: of each angle the mean.
fn over_seeds(curves: &[Vec<Value>]) -> Vec<Value> {
    let at = |m: usize| {
        let values = curves.iter().map(|c| (c[m].value, c[m].error));
        Spread::of(&values.collect::<Vec<_>>()).into()
    };
    (0..POINTS).map(at).collect()
}

/// Loads with and without a gradient at one effective depth, as it was asked for.
pub fn pairs(loads: &[PointLoad]) -> Vec<(&PointLoad, &PointLoad)> {
    let (with, without): (Vec<_>, Vec<_>) = loads.iter().partition(|l| l.gradient);
    let partner = |a: &'_ PointLoad| {
        let mut near = without.iter().copied();
        near.find(|b| same_depth(a.asked, b.asked))
    };
    let with = with.into_iter();
    with.filter_map(|a| Some((a, partner(a)?))).collect()
}

/// `(sigma_n - sigma_n without gradient)/(rho g D)` by angle (Guillard 2014, Fig. 12), the stress without gradient
/// brought to the pressure of the one with it, in proportion. Runs of one seed share a bed: they are compared seed
/// by seed if there are such.
pub fn difference(pair: &(&PointLoad, &PointLoad)) -> Vec<Value> {
    let (with, without) = pair;
    let less = |a: &[Value], b: &[Value], pressure: f64| -> Vec<Value> {
        let each = a.iter().zip(b).map(|(a, b)| a.less(*b).times(pressure));
        each.collect()
    };
    let own = |run: &RunLoad| {
        let other = without.runs.iter().find(|other| other.seed == run.seed)?;
        Some(less(&run.normal, &other.normal, run.pressure))
    };
    let curves: Vec<Vec<Value>> = with.runs.iter().filter_map(own).collect();
    match curves.is_empty() {
        true => less(&with.normal, &without.normal, with.pressure),
        false => over_seeds(&curves),
    }
}

/// The odd part of a load with gradient, over rho g D: a second estimate of what [`difference`] has of one.
pub fn odd_part(load: &PointLoad) -> Vec<Value> {
    let stress: Vec<f64> = load
        .normal
        .iter()
        .map(|v| v.value * load.pressure)
        .collect();
    let both = |m: usize| {
        let [a, b] = [m, POINTS - 1 - m].map(|m| load.normal[m].error * load.pressure);
        0.5 * (a * a + b * b).sqrt()
    };
    let all = odd(&stress).into_iter().enumerate();
    all.map(|(m, x)| Value::new(x, both(m))).collect()
}

/// What eq. 4 says of that difference, from a load without gradient: `s sin(theta)/2`.
pub fn equation_4(without: &PointLoad) -> Vec<f64> {
    let all = without.normal.iter().enumerate();
    all.map(|(m, s)| 0.5 * s.value * libm::sin(theta(m)))
        .collect()
}

/// Appendix B: at each angle the normal stress with a gradient over rho g D as a line in P_0 over the same, of depths
/// from 16 D on.
/// Its slope `b` is the part in proportion to the pressure, its intercept `a` that in proportion to the gradient.
///
/// # Errors
/// What is missing, or why a line is refused.
pub fn split(loads: &[PointLoad]) -> Result<Vec<Fit>, String> {
    let deep = deep(loads)?;
    let at = |m: usize| {
        let own = deep
            .iter()
            .map(|l| l.normal[m].times(l.pressure).at(l.pressure));
        line(&own.collect::<Vec<Datum>>()).map_err(|why| format!("theta = {:.2}: {why}", theta(m)))
    };
    (0..POINTS).map(at).collect()
}

/// Whether a load is from 16 D on, to a twentieth.
pub(super) fn is_deep(load: &PointLoad) -> bool {
    super::fits::is_deep(load.asked)
}

/// Loads with a gradient that are.
pub(super) fn deep(loads: &[PointLoad]) -> Result<Vec<&PointLoad>, String> {
    let with = loads.iter().filter(|l| l.gradient);
    let deep: Vec<&PointLoad> = with.filter(|l| is_deep(l)).collect();
    match deep.len() {
        3.. => Ok(deep),
        _ => Err(format!(
            "splitting a load takes three effective depths of {DEEP} D or more with a pressure gradient"
        )),
    }
}
