//! Drag against Froude number: three regimes and where they meet (Kumar 2018, sections III A and III C).

use serde::{Deserialize, Serialize};

use super::exponents::{distinct, near};
use super::yields::PLATEAU_MU;
use super::{Curve, Finding, Material, Value, Yield, path};
use crate::fit::joint::{Shape, joint};
use crate::fit::offset_power::offset_power;
use crate::fit::regimes::{First, RegimeFits, Regimes, regime_fits, regimes, scaled_regimes};
use crate::fit::{Datum, Fit, Refusal};

/// The paper's crossovers: from the first regime to the line, and to the quadratic.
pub const CROSSOVERS: [f64; 2] = [1.0, 5.0];

/// Least ratio of the speeds below the first crossover that are compared: that of Fr = 0.5 and 0.8, over which Table I
/// rises by a tenth. Nearer ones would differ by less than a bound of half of that, whatever the law.
const LEVER: f64 = 1.6;

/// Part by which the paper's crossovers may be off: they are whole numbers that it calls approximate.
const APPROXIMATE: f64 = 0.1;

/// The findings of one curve.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Speeds {
    /// The slowest run against the fastest below Fr = 1.
    pub flatness: Finding<Flatness>,
    /// Each regime alone, between the paper's crossovers.
    pub alone: RegimeFits,
    /// `a + b Fr^c` below Fr = 1.3 (Kumar 2018, Table I), without friction.
    pub first: Option<Finding<Fit>>,
    /// All three, with the crossovers found.
    pub regimes: Finding<Regimes>,
}

/// How flat the drag is below Fr = 1.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Flatness {
    /// The Froude numbers compared.
    pub froude: [f64; 2],
    /// Drag of the faster over that of the slower.
    pub ratio: Value,
}

/// Which mean of the drag a finding rests on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reading {
    /// That of the averaging window, which leaves the start-up out.
    Cut,
    /// That of the whole travel, as Kumar 2018 averages (Fig. 4).
    Uncut,
    /// Without the start-up, over a path that is the same for all.
    CutOnPath,
    /// The whole of that path.
    UncutOnPath,
}

impl Reading {
    /// All of them.
    pub const ALL: [Reading; 4] = [
        Reading::Cut,
        Reading::Uncut,
        Reading::CutOnPath,
        Reading::UncutOnPath,
    ];

    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Reading::Cut => "start-up left out",
            Reading::Uncut => "nothing cut",
            Reading::CutOnPath => "start-up left out, one path for all",
            Reading::UncutOnPath => "nothing cut, one path for all",
        }
    }
}

/// What drags read in one way say of the second regime and the third.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Growth {
    /// Which mean the drags are.
    pub reading: Reading,
    /// `F = F_Y (1 + A max(Fr - 1, 0)^p)` up to Fr = 5, with a yield force F_Y of each curve that is fitted with A and
    /// p: a line has the exponent 1 (Kumar 2018, section III A; that it joins the yield force at Fr = 1 is assumption
    /// (ii) of section IV).
    pub second: Finding<Fit>,
    /// Eq. 9, fitted in the same way: a line from Fr = 1 to 5 and a parabola `a + b Fr^2` above, joined. r is the mean
    /// slope of that from 5 to 10 over the line's: 1.5 at equal slopes, of which the paper says nothing.
    pub third: Finding<Fit>,
}

/// Curves of a material at one depth, each over its yield force.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pooled {
    /// The grains.
    pub material: Material,
    /// The depth asked for that has the most runs: drags of shallow intruders do not fall on one another (Kumar 2018,
    /// section III H), and are not pooled over depths.
    pub depth_asked: f64,
    /// Runs of these curves.
    pub runs: usize,
    /// All three regimes, with the crossovers found; each curve over a yield force that is fitted with them.
    pub regimes: Finding<Regimes>,
    /// The force of each curve that this divides by, by its diameter; its drag at its lowest speed if no regimes were
    /// found.
    pub scales: Vec<(f64, f64)>,
    /// Whole mean diameters of the path that is the same for all; none if a run does not say how its drag went.
    pub path: Option<usize>,
    /// The second regime and the third with friction, by what mean the drags are.
    pub growth: Vec<Growth>,
}

impl Pooled {
    /// What drags read in this way say.
    pub fn growth(&self, reading: Reading) -> Option<&Growth> {
        self.growth.iter().find(|growth| growth.reading == reading)
    }
}

fn first_of(mu: f64) -> First {
    if mu >= PLATEAU_MU {
        First::Flat
    } else {
        First::Power
    }
}

/// Regimes of one curve.
pub(super) fn speeds(curve: &Curve) -> Speeds {
    let data: Vec<Datum> = curve.points.iter().map(|p| p.drag.at(p.froude)).collect();
    let [x1, x2] = CROSSOVERS;
    let frictional = curve.material.mu >= PLATEAU_MU;
    let slow: Vec<Datum> = data
        .iter()
        .filter(|d| d.x <= super::yields::EXTRAPOLATED_FROUDE)
        .copied()
        .collect();
    Speeds {
        flatness: flatness(curve),
        alone: regime_fits(&data, x1, x2),
        first: (!frictional).then(|| offset_power(&slow).into()),
        regimes: regimes(&data, first_of(curve.material.mu)).into(),
    }
}

fn flatness(curve: &Curve) -> Finding<Flatness> {
    let slow: Vec<&super::Point> = curve
        .points
        .iter()
        .filter(|p| p.froude <= CROSSOVERS[0])
        .collect();
    match &slow[..] {
        [first, .., last] if last.froude >= LEVER * first.froude => Finding::Found(Flatness {
            froude: [first.froude, last.froude],
            ratio: last.drag.over(first.drag),
        }),
        _ => Finding::refused("a comparison takes two speeds below Fr = 1, a factor of 1.6 apart"),
    }
}

/// Regimes of the curves of a material together.
pub(super) fn pooled(material: Material, curves: &[(&Curve, &Yield)]) -> Pooled {
    let runs = |depth: f64| -> usize {
        let own = curves.iter().filter(|(c, _)| near(c.depth_asked, depth));
        own.map(|(c, _)| c.points.len()).sum()
    };
    let depths = distinct(curves.iter().map(|(c, _)| c.depth_asked));
    let most = depths
        .iter()
        .copied()
        .reduce(|a, b| if runs(b) > runs(a) { b } else { a });
    let depth_asked = most.unwrap_or(0.0);
    let own: Vec<&Curve> = curves
        .iter()
        .map(|(c, _)| *c)
        .filter(|c| near(c.depth_asked, depth_asked))
        .collect();
    let path = path::common(own.iter().flat_map(|c| &c.points));
    let all = data(&own, Reading::Cut, path);
    let regimes = scaled_regimes(&all, first_of(material.mu), forces(&all));
    let scales = match &regimes {
        Ok((_, scales)) => scales.clone(),
        Err(_) => forces(&all),
    };
    let growth = |reading: Reading| {
        let all = data(&own, reading, path);
        // Without friction there is no plateau that a line could join; and not every table has every mean.
        let sound = material.mu >= PLATEAU_MU && all.iter().any(|data| !data.is_empty());
        sound.then(|| Growth {
            reading,
            second: second(&all).into(),
            third: third(&all).into(),
        })
    };
    Pooled {
        material,
        depth_asked,
        runs: own.iter().map(|c| c.points.len()).sum(),
        regimes: regimes.map(|(regimes, _)| regimes).into(),
        scales: own.iter().map(|c| c.diameter).zip(scales).collect(),
        path,
        growth: Reading::ALL.into_iter().filter_map(growth).collect(),
    }
}

/// A drag read in one way, if it can be.
pub(super) fn drag(p: &super::Point, reading: Reading, path: Option<usize>) -> Option<Value> {
    match reading {
        Reading::Cut => Some(p.drag),
        Reading::Uncut => p.uncut,
        Reading::CutOnPath => Some(path::on_path(p, path?)?.cut),
        Reading::UncutOnPath => Some(path::on_path(p, path?)?.uncut),
    }
}

/// The drags of each curve, read in one way; points that cannot be are left out.
fn data(curves: &[&Curve], reading: Reading, path: Option<usize>) -> Vec<Vec<Datum>> {
    let one = |c: &&Curve| -> Vec<Datum> {
        let points = c.points.iter();
        points
            .filter_map(|p| Some(drag(p, reading, path)?.at(p.froude)))
            .collect()
    };
    curves.iter().map(one).collect()
}

/// A first guess of the yield force of each curve: its drag at its lowest speed.
fn forces(curves: &[Vec<Datum>]) -> Vec<f64> {
    let slowest = |data: &Vec<Datum>| data.first().map_or(1.0, |d| d.y);
    curves.iter().map(slowest).collect()
}

/// `F_Y (1 + A (Fr - 1)^p)` through the points up to the second crossover.
fn second(curves: &[Vec<Datum>]) -> Result<Fit, Refusal> {
    let [from, to] = CROSSOVERS;
    let upto = |data: &Vec<Datum>| -> Vec<Datum> {
        let slow = data.iter().filter(|d| d.x <= (1.0 + APPROXIMATE) * to);
        slow.copied().collect()
    };
    let slow: Vec<Vec<Datum>> = curves.iter().map(upto).collect();
    Ok(joint(&slow, Shape::Power { from })?.fit)
}

/// How much steeper the parabola beyond the second crossover is than the line before it.
fn third(curves: &[Vec<Datum>]) -> Result<Fit, Refusal> {
    let [from, at] = CROSSOVERS;
    Ok(joint(curves, Shape::Parabola { from, at })?.fit)
}
