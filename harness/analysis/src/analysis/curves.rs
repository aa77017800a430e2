//! The rows of a campaign's table as curves: drag against speed, everything else the same.

use serde::{Deserialize, Serialize};

use super::Value;
use super::beds::over_beds;
use super::point::{ErrorOf, Point, Within};
use bitgrain_lab::campaign::columns::{DRAG_BY_TRAVEL, MOST_CONTACTS};
use bitgrain_lab::campaign::table::CampaignTable;
use bitgrain_lab::plug_flow::PlugFlow;

/// Least D/d of an intruder with enough contacts for a law: the paper's smallest scatters too.
const LEAST_DIAMETER: f64 = 2.0;

/// Depths asked for that differ by less than this share are one: beds settle by more than that off what was asked.
pub(super) const SAME_DEPTH: f64 = 0.02;

/// What the columns of kappa within a distance begin with.
const KAPPA_WITHIN: &str = "kappa_within_";

/// The material of the grains.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Stiffness K_n; 0 under a law that has none.
    pub kn: f64,
    /// Damping gamma_n; 0 under a law that has none.
    pub gamma_n: f64,
    /// Friction coefficient.
    pub mu: f64,
}

/// Runs that differ by their speed, and by their seed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Curve {
    /// The grains.
    pub material: Material,
    /// Diameter D of the intruder.
    pub diameter: f64,
    /// Mean diameter d of the grains.
    pub mean_diameter: f64,
    /// Depth that was asked for.
    pub depth_asked: f64,
    /// Depth as measured, mean over the runs.
    pub depth: f64,
    /// By Froude number: at each the mean over the beds.
    pub points: Vec<Point>,
    /// Each run, in the same order.
    pub runs: Vec<Point>,
}

impl Curve {
    /// Effective diameter D + d.
    pub fn effective_diameter(&self) -> f64 {
        self.diameter + self.mean_diameter
    }

    /// Whether its intruder has enough contacts for a law of the near field.
    pub fn is_wide(&self) -> bool {
        self.diameter >= LEAST_DIAMETER * self.mean_diameter
    }

    /// What a force at its depth would be at another, if it grew with a power of the depth.
    pub fn brought_to(&self, depth: f64, alpha: f64, force: Value) -> Value {
        let to = libm::pow(depth / self.depth, alpha);
        Value::new(force.value * to, force.error * to)
    }

    /// `(D + d)^phi h^alpha`.
    pub fn scale(&self, [phi, alpha]: [f64; 2]) -> f64 {
        libm::pow(self.effective_diameter(), phi) * libm::pow(self.depth, alpha)
    }
}

/// What a table holds.
pub(super) struct Read {
    pub curves: Vec<Curve>,
    pub failed: usize,
    pub sliding: usize,
}

/// Reads the curves of a table, by material, diameter and depth.
pub(super) fn read(table: &CampaignTable, plugs: bool) -> Read {
    let mut curves: Vec<Curve> = Vec::new();
    let (mut failed, mut sliding) = (0, 0);
    for row in 0..table.len() {
        if table.text(row, "status") != "done" {
            failed += 1;
            continue;
        }
        if table.text(row, "plug") == PlugFlow::Slides.word() {
            sliding += 1;
            if !plugs {
                continue;
            }
        }
        let Some(point) = point(table, row) else {
            failed += 1;
            continue;
        };
        let real = |column| table.real(row, column).unwrap_or(0.0);
        let material = Material {
            kn: real("kn"),
            gamma_n: real("gamma_n"),
            mu: real("mu"),
        };
        let diameter = real("diameter");
        let asked = real("depth_asked");
        let same = |c: &&mut Curve| {
            c.material == material
                && c.diameter == diameter
                && (c.depth_asked - asked).abs() <= 1e-6 * asked
        };
        match curves.iter_mut().find(same) {
            Some(curve) => curve.runs.push(point),
            None => curves.push(Curve {
                material,
                diameter,
                mean_diameter: 0.5 * (real("diameter_least") + real("diameter_most")),
                depth_asked: asked,
                depth: 0.0,
                points: Vec::new(),
                runs: vec![point],
            }),
        }
    }
    for curve in &mut curves {
        curve.runs.sort_by(|a, b| a.froude.total_cmp(&b.froude));
        curve.points = over_beds(&curve.runs);
        let depths = curve.points.iter().map(|p| p.depth).sum::<f64>();
        curve.depth = depths / curve.points.len() as f64;
    }
    join_depths(&mut curves);
    let key = |c: &Curve| {
        [
            c.material.kn,
            c.material.gamma_n,
            c.material.mu,
            c.diameter,
            c.depth_asked,
        ]
    };
    curves.sort_by(|a, b| {
        let pairs = key(a).into_iter().zip(key(b));
        pairs.fold(std::cmp::Ordering::Equal, |order, (a, b)| {
            order.then(a.total_cmp(&b))
        })
    });
    Read {
        curves,
        failed,
        sliding,
    }
}

/// Depths asked for that are one get the least of them, in each material: at one height above the floor a thicker
/// intruder asks for another depth.
fn join_depths(curves: &mut [Curve]) {
    curves.sort_by(|a, b| a.depth_asked.total_cmp(&b.depth_asked));
    for k in 1..curves.len() {
        let (before, rest) = curves.split_at_mut(k);
        let curve = &mut rest[0];
        // The next shallower one has the least depth of those that it is one with.
        let own = before.iter().rfind(|c| c.material == curve.material);
        if let Some(least) = own.map(|c| c.depth_asked)
            && curve.depth_asked - least < SAME_DEPTH * least
        {
            curve.depth_asked = least;
        }
    }
}

/// A row; `None` if it has no drag.
fn point(table: &CampaignTable, row: usize) -> Option<Point> {
    let value = |column: &str| {
        let value = table.real(row, column)?;
        let error = table.real(row, &format!("{column}_error"))?;
        // An error below zero is none.
        (error >= 0.0).then_some(Value { value, error })
    };
    let length = 0.5 * (table.real(row, "diameter_least")? + table.real(row, "diameter_most")?);
    let by_travel = (1..).map_while(|k| table.real(row, &format!("{DRAG_BY_TRAVEL}{k}")));
    let shares = (0..=MOST_CONTACTS).map(|k| table.real(row, &format!("coordination_{k}")));
    Some(Point {
        name: format!("{}/{}", table.text(row, "member"), table.text(row, "run")),
        digest: table.text(row, "digest").into(),
        speed: table.real(row, "speed")?,
        froude: table.real(row, "froude")?,
        depth: table.real(row, "depth")?,
        beds: 1,
        error_of: ErrorOf::Blocks,
        drag: value("drag")?,
        uncut: value("drag_uncut"),
        by_travel: by_travel.collect(),
        discard: table.real(row, "discard").unwrap_or(0.0) / length,
        plug_ratio: table.real(row, "plug_ratio")?,
        angle: value("contact_angle"),
        new_angle: value("new_contact_angle"),
        kappa: value("kappa"),
        within: within(table, row, value),
        floating: value("floating"),
        moving: value("moving"),
        drift: value("drift"),
        coordination: shares.collect::<Option<_>>().unwrap_or_default(),
    })
}

/// The distances that a row was measured within, by the names of its columns.
fn within(table: &CampaignTable, row: usize, value: impl Fn(&str) -> Option<Value>) -> Vec<Within> {
    let reaches = table
        .columns()
        .filter_map(|name| name.strip_prefix(KAPPA_WITHIN)?.parse().ok());
    let one = |reach: f64| {
        let of = |name: &str| value(&format!("{name}_within_{reach}"));
        table.real(row, &format!("{KAPPA_WITHIN}{reach}"))?;
        Some(Within {
            reach,
            coordination: of("coordination")?,
            floating: of("floating")?,
            kappa: of("kappa")?,
        })
    };
    reaches.filter_map(one).collect()
}

/// The materials of some curves, each once.
pub(super) fn materials(curves: &[Curve]) -> Vec<Material> {
    let mut all: Vec<Material> = Vec::new();
    for curve in curves {
        if !all.contains(&curve.material) {
            all.push(curve.material);
        }
    }
    all
}
