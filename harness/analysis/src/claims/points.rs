//! Runs that differ only by their seed, taken together.

use super::place::Place;
use crate::analysis::Value;
use bitgrain_lab::scenario::{BedPlan, LidPlan};
use bitgrain_lab::summary::{DragSummary, Flow, Rig, Summary};
use bitgrain_sim::block_averaging::Mean;

/// Least speed of the far grains over the speed asked for in a bed that follows its base.
pub const FAR_FIELD_LEAST: f64 = 0.95;
/// Least travel of a window in grain diameters: of the paper's 40 cylinder diameters, 132 grain diameters
/// at D/d = 3.3, a little less than half (Guillard 2014, section III A).
pub const TRAVEL_LEAST: f64 = 60.0;
/// The least; NaN if one is not a number, which is worse than any.
pub(super) fn least(values: impl Iterator<Item = f64>) -> f64 {
    let less = |a: f64, x: f64| if x < a || x.is_nan() { x } else { a };
    values.fold(f64::INFINITY, less)
}

/// Effective depth over D from which a lift counts as saturated without a plateau.
pub(super) const DEEP: f64 = 16.0;
/// Fewest seeds of every point whose lift is reported.
pub(super) const SEEDS: usize = 2;

/// How an effective depth is made (Guillard 2014, section III A).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Way {
    /// (i): the bed is as deep as that; there is no lid.
    Own,
    /// (ii): a lid on a bed with weight.
    Lid,
    /// (iii): a lid on a bed without weight, so that there is no pressure gradient.
    LidAlone,
}

impl Way {
    /// All three, in the order of the paper.
    pub const ALL: [Way; 3] = [Way::Own, Way::Lid, Way::LidAlone];

    /// Its number and what it is.
    pub fn name(self) -> &'static str {
        match self {
            Way::Own => "(i) the bed's own depth",
            Way::Lid => "(ii) lid, with pressure gradient",
            Way::LidAlone => "(iii) lid, without pressure gradient",
        }
    }

    /// Whether pressure grows with depth.
    pub fn has_gradient(self) -> bool {
        self != Way::LidAlone
    }
}

/// One quantity over the runs of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Mean over the runs, each counted once.
    pub mean: f64,
    /// Standard deviation over the runs; none of one run.
    pub deviation: Option<f64>,
    /// Least of the runs.
    pub least: f64,
    /// Largest of the runs.
    pub most: f64,
    /// Standard error of the mean: deviation over the root of the number of runs, but never below
    /// what the runs' own block errors give, because the deviation of few runs may come out small by
    /// chance; of one run its block error.
    pub error: f64,
}

impl From<Spread> for Value {
    fn from(spread: Spread) -> Self {
        Value::new(spread.mean, spread.error)
    }
}

impl Spread {
    /// Of the values of some runs, each with its block error; NaN of none.
    pub fn of(values: &[(f64, f64)]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().map(|v| v.0).sum::<f64>() / n;
        let square = values.iter().map(|v| (v.0 - mean) * (v.0 - mean));
        let deviation = (values.len() > 1).then(|| (square.sum::<f64>() / (n - 1.0)).sqrt());
        let own = values.iter().map(|v| v.1 * v.1).sum::<f64>().sqrt() / n;
        let over = deviation.map_or(own, |s| s / n.sqrt());
        let end = |better: fn(f64, f64) -> bool| {
            let pick = |a: f64, v: &(f64, f64)| if better(v.0, a) { v.0 } else { a };
            values
                .first()
                .map_or(f64::NAN, |v| values.iter().fold(v.0, pick))
        };
        Self {
            mean,
            deviation,
            least: end(|a, b| a < b),
            most: end(|a, b| a > b),
            error: if own > over { own } else { over },
        }
    }

    /// Half the length of an error bar: the deviation over runs, or the block error of a single one.
    pub fn bar(&self) -> f64 {
        self.deviation.unwrap_or(self.error)
    }
}

/// Runs that differ only by their seed.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// How the effective depth is made.
    pub way: Way,
    /// Places of its runs in the summary.
    pub runs: Vec<usize>,
    /// Effective depth that the plan asks for; with lids of a given density the one that they made.
    pub asked: f64,
    /// Effective depth h~, mean over the runs.
    pub effective_depth: f64,
    /// Where the axis lies.
    pub place: Place,
    /// Pressure rho g h~, mean over the runs.
    pub pressure: f64,
    /// Weight above the axis over the area of the box, mean over the runs.
    pub weight: f64,
    /// Drag over D L.
    pub drag: Spread,
    /// Drag over D L and rho g h~: C_d as the paper has it (Guillard 2014, eq. 2).
    pub drag_over_depth: Spread,
    /// Drag over D L and the weight above the axis over the area of the box.
    pub drag_over_weight: Spread,
    /// Drag over D L and the vertical stress at the cylinder's axis: the weight above it over the area of
    /// the box, which is the stress just above the cylinder, and half of what the lift adds below it.
    pub drag_over_pressure: Spread,
    /// Lift over buoyancy.
    pub lift: Spread,
    /// Least speed of the far grains over the speed asked for.
    pub far_field: f64,
    /// Least travel of a window in mean grain diameters.
    pub travel: f64,
    /// Whether the block errors of drag, and of lift, converged in every run.
    pub converged: [bool; 2],
}

/// Points of one cylinder at one speed, and at one place if there are lids.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Diameter D.
    pub diameter: f64,
    /// Height of the axis above the floor, if lids lie on beds with the axis there: base and surface may make a lift of
    /// their own, so points at other heights are no points of the same curve. Without lids the place of the axis is
    /// what makes the depth, and all places are one curve.
    pub axis: Option<f64>,
    /// D over the mean diameter d of the grains.
    pub over_grain: f64,
    /// Speed of the bed past the cylinder.
    pub speed: f64,
    /// By way, and then by effective depth.
    pub points: Vec<Point>,
}

impl Group {
    /// Points with a pressure gradient, or those without one, by effective depth.
    pub fn with_gradient(&self, gradient: bool) -> Vec<&Point> {
        let fits = |p: &&Point| p.way.has_gradient() == gradient;
        let mut points: Vec<&Point> = self.points.iter().filter(fits).collect();
        points.sort_by(|a, b| a.effective_depth.total_cmp(&b.effective_depth));
        points
    }

    /// Fewest runs of a point, over seeds.
    pub fn seeds(points: &[&Point]) -> usize {
        points.iter().map(|p| p.runs.len()).min().unwrap_or(0)
    }
}

/// A run of a flowing bed with what belongs to it.
pub(super) struct Passage<'a> {
    place: usize,
    run: &'a DragSummary,
    flow: &'a Flow,
    rig: &'a Rig,
}

/// A way, what is asked for except the seed, and the runs that are alike in both.
type Kind<'a> = (Way, (f64, Option<LidPlan>), Vec<Passage<'a>>);

/// Height of the axis of a planned bed, if lids lie on beds of this cylinder with the axis there.
fn lidded(plans: &[BedPlan], own: &BedPlan) -> Option<f64> {
    let same = |plan: &&BedPlan| plan.diameter == own.diameter && plan.center == own.center;
    let mut there = plans.iter().filter(same);
    there
        .any(|plan| plan.lid.is_some())
        .then_some(own.center[2])
}

/// The runs of flowing beds by cylinder, speed and place of the axis under lids, and in each by everything but the
/// seed. Runs whose bed the scenario does not plan are left out.
pub fn groups(summary: &Summary) -> Vec<Group> {
    let plans = summary.inputs.beds();
    let d = summary.inputs.mean_diameter();
    let area = summary.inputs.bed.size[0] * summary.inputs.bed.size[1];
    let mut groups: Vec<(Group, Vec<Kind>)> = Vec::new();
    for (place, run) in summary.runs.iter().enumerate() {
        let plan = plans.iter().find(|plan| plan.name == run.bed);
        let rig = summary.beds.iter().find(|bed| bed.name == run.bed);
        let rig = rig.and_then(|bed| bed.rig.as_ref());
        let (Some(plan), Some(rig), Some(flow)) = (plan, rig, run.flow.as_ref()) else {
            continue;
        };
        let way = match (rig.lid_grains, rig.pressure_gradient) {
            (0, _) => Way::Own,
            (_, true) => Way::Lid,
            (_, false) => Way::LidAlone,
        };
        let axis = lidded(plans, plan);
        let same = |(g, _): &(Group, Vec<Kind>)| {
            (g.diameter, g.speed, g.axis) == (rig.diameter, run.speed, axis)
        };
        let k = groups.iter().position(same).unwrap_or_else(|| {
            let group = Group {
                diameter: rig.diameter,
                axis,
                over_grain: rig.diameter / d,
                speed: run.speed,
                points: Vec::new(),
            };
            groups.push((group, Vec::new()));
            groups.len() - 1
        });
        let passage = Passage {
            place,
            run,
            flow,
            rig,
        };
        let key = (plan.center[2], plan.lid);
        let kinds = &mut groups[k].1;
        match kinds.iter_mut().find(|kind| kind.1 == key) {
            Some(kind) => kind.2.push(passage),
            None => kinds.push((way, key, vec![passage])),
        }
    }
    let whole = |(mut group, kinds): (Group, Vec<Kind>)| {
        let own = |z: f64| summary.inputs.expected_surface(group.diameter) - z;
        let points = kinds.iter().map(|(way, (z, lid), passages)| {
            let asked = lid.map_or(Some(own(*z)), |lid| lid.effective_depth);
            point(*way, asked, *z, area, passages)
        });
        group.points = points.collect();
        let order = |p: &Point| (p.way, p.effective_depth);
        group.points.sort_by(|a, b| {
            let ((way, depth), (other, deep)) = (order(a), order(b));
            way.cmp(&other).then(depth.total_cmp(&deep))
        });
        group
    };
    groups.into_iter().map(whole).collect()
}

/// Vertical stress at the cylinder's axis in a box of this area: the weight above it, which is the stress just above
/// the cylinder, and half of what the lift adds below it.
pub(super) fn axis_stress(run: &DragSummary, flow: &Flow, area: f64) -> f64 {
    flow.pressure_measured + 0.5 * run.lift.mean / area
}

/// The runs of a point with the axis at height `z` in a box of this area.
fn point(way: Way, asked: Option<f64>, z: f64, area: f64, passages: &[Passage]) -> Point {
    let n = passages.len() as f64;
    let mean = |of: fn(&Flow) -> f64| passages.iter().map(|p| of(p.flow)).sum::<f64>() / n;
    let least = |of: fn(&Flow) -> f64| {
        let values: Vec<(f64, f64)> = passages.iter().map(|p| (of(p.flow), 0.0)).collect();
        Spread::of(&values).least
    };
    let drag_over = |scale: &dyn Fn(&Passage) -> f64| {
        let over = |p: &Passage| scaled(&p.run.drag, scale(p) * p.rig.diameter * p.rig.length);
        Spread::of(&passages.iter().map(over).collect::<Vec<_>>())
    };
    let stress = |p: &Passage| axis_stress(p.run, p.flow, area);
    let lift = |p: &Passage| (p.flow.lift_over_buoyancy, p.flow.lift_over_buoyancy_error);
    let effective_depth = mean(|f| f.effective_depth);
    let depth = passages.iter().map(|p| p.run.depth).sum::<f64>() / n;
    Point {
        way,
        runs: passages.iter().map(|p| p.place).collect(),
        asked: asked.unwrap_or(effective_depth),
        effective_depth,
        place: Place {
            floor: z,
            surface: depth,
        },
        pressure: mean(|f| f.pressure),
        weight: mean(|f| f.pressure_measured),
        drag: drag_over(&|_| 1.0),
        drag_over_depth: drag_over(&|p| p.flow.pressure),
        drag_over_weight: drag_over(&|p| p.flow.pressure_measured),
        drag_over_pressure: drag_over(&stress),
        lift: Spread::of(&passages.iter().map(lift).collect::<Vec<_>>()),
        far_field: least(|f| f.far_field),
        travel: least(|f| f.travel),
        converged: [
            passages.iter().all(|p| p.run.drag.converged),
            passages.iter().all(|p| p.run.lift.converged),
        ],
    }
}

fn scaled(value: &Mean, by: f64) -> (f64, f64) {
    (value.mean / by, value.standard_error / by.abs())
}

#[cfg(test)]
mod tests {
    use super::super::synthetic::{self, Asked};
    use super::*;

    #[test]
    fn an_error_is_that_of_the_seeds_but_never_below_the_blocks() {
        let far = Spread::of(&[(1.0, 0.1), (3.0, 0.1)]);
        assert_eq!((far.mean, far.least, far.most), (2.0, 1.0, 3.0));
        assert!((far.deviation.unwrap() - 2f64.sqrt()).abs() < 1e-12);
        assert!((far.error - 1.0).abs() < 1e-12);
        let near = Spread::of(&[(2.0, 0.3), (2.0, 0.4)]);
        assert!((near.error - 0.25).abs() < 1e-12, "{near:?}");
        let one = Spread::of(&[(2.0, 0.3)]);
        assert_eq!((one.deviation, one.error, one.bar()), (None, 0.3, 0.3));
        assert!(Spread::of(&[]).mean.is_nan());
    }

    #[test]
    fn seeds_make_one_point_and_everything_else_makes_several() {
        let asked = Asked {
            seeds: 3,
            ..Asked::default()
        };
        let groups = groups(&synthetic::summary(&asked));
        assert_eq!(groups.len(), 1);
        let group = &groups[0];
        assert!((group.over_grain - 3.3).abs() < 1e-9);
        assert!(group.points.iter().all(|p| p.runs.len() == 3));
        let ways: Vec<Way> = group.points.iter().map(|p| p.way).collect();
        let lids = asked.depths.len();
        assert_eq!(ways[..lids], vec![Way::Lid; lids]);
        assert_eq!(ways[lids..], vec![Way::LidAlone; lids]);
        let deep = group.with_gradient(true);
        assert!(deep.is_sorted_by(|a, b| a.effective_depth < b.effective_depth));
        // The axis lies in the middle of a bed of 0.06 m.
        assert!(deep.iter().all(|p| p.place.is_middle(group.diameter)));
        // Drag is ten times the pressure there, and seeds scatter about it.
        let point = deep[0];
        assert!((point.drag.mean / point.pressure - 10.0).abs() < 0.2);
        assert!(point.drag.least < point.drag.mean && point.drag.mean < point.drag.most);
    }

    /// Under lids each place of the axis is a group of its own; without lids places are depths of one group.
    #[test]
    fn places_of_the_axis_are_not_pooled() {
        let asked = Asked {
            heights: vec![0.024, 0.03],
            ..Asked::default()
        };
        let mut summary = synthetic::summary(&asked);
        let lids = groups(&summary);
        let axes: Vec<Option<f64>> = lids.iter().map(|g| g.axis).collect();
        assert_eq!(axes, [Some(0.024), Some(0.03)]);
        for group in &lids {
            assert_eq!(group.points.len(), 2 * asked.depths.len());
            let place = Place {
                floor: group.axis.unwrap(),
                surface: synthetic::SURFACE - group.axis.unwrap(),
            };
            for point in &group.points {
                assert_eq!(point.runs.len(), 2);
                assert!((point.place.above_middle() - place.above_middle()).abs() < 1e-12);
            }
        }
        assert!(!lids[0].points[0].place.is_middle(lids[0].diameter));
        // The same beds without their lids: of each place one.
        summary.inputs = summary.inputs.changed(|inputs| inputs.lid = None).unwrap();
        let names: Vec<String> = summary
            .inputs
            .beds()
            .iter()
            .map(|b| b.name.clone())
            .collect();
        summary.beds.retain(|bed| names.contains(&bed.name));
        summary.runs.retain(|run| names.contains(&run.bed));
        for bed in &mut summary.beds {
            bed.rig.as_mut().unwrap().lid_grains = 0;
        }
        let bare = groups(&summary);
        assert_eq!((bare.len(), bare[0].axis), (1, None));
        assert_eq!(bare[0].points.len(), 2);
    }
}
