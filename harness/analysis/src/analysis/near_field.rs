//! The near field of the intruder: contact angle, coordination, grains without contacts (Kumar 2018,
//! section III B).

use serde::{Deserialize, Serialize};

use super::exponents::distinct;
use super::{Curve, Finding, Material, Point, Value, Yield};
use crate::fit::linear::{constant, line};
use crate::fit::offset_power::angle_law;
use crate::fit::{Datum, Fit};

/// One reading of the contact angle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contacts {
    /// `Y1 Fr^Y2 + pi/Y3` (Kumar 2018, eq. 7).
    pub law: Finding<Fit>,
    /// Angle at Fr = 10, mean over the runs there.
    pub at_ten: Finding<Fit>,
    /// How far each diameter lies off the law, or off the mean at equal speeds.
    pub offsets: Vec<Offset>,
}

/// One diameter against the others.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Offset {
    /// Diameter D.
    pub diameter: f64,
    /// Mean residual of its points.
    pub residual: Value,
}

/// Share of near grains without contacts of one curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Floating {
    /// Diameter of the intruder.
    pub diameter: f64,
    /// Its depth.
    pub depth_asked: f64,
    /// At the lowest Froude number.
    pub slowest: Value,
    /// At the highest.
    pub fastest: Value,
    /// How often the share falls from one speed to the next by more than two errors.
    pub falls: usize,
}

/// Kappa of the grains within one distance of the intruder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KappaWithin {
    /// The distance from its surface, in mean diameters: the paper does not give its own.
    pub reach: f64,
    /// `kappa = a + b Fr` (Kumar 2018, Fig. 8).
    pub line: Finding<Fit>,
    /// The same up to Fr = 5: beyond, grains behind the intruder float.
    pub slow: Finding<Fit>,
    /// Least and largest share of grains without contacts at the highest Froude number.
    pub floating: [f64; 2],
}

/// The near field in one material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NearField {
    /// The grains.
    pub material: Material,
    /// Angle over all contacts.
    pub contacts: Contacts,
    /// Angle of contacts as they begin.
    pub new_contacts: Contacts,
    /// `kappa = a + b Fr` (Kumar 2018, Fig. 8).
    pub kappa: Finding<Fit>,
    /// The same within other distances.
    pub within: Vec<KappaWithin>,
    /// How far each diameter lies off that line.
    pub kappa_offsets: Vec<Offset>,
    /// Grains without contacts.
    pub floating: Vec<Floating>,
}

/// Froude number up to which kappa is fitted a second time: the paper's second crossover, and a tenth more.
const SLOW: f64 = 5.5;

type Reading = fn(&Point) -> Option<Value>;

/// Points of all curves with intruders wide enough, and the diameter of each.
fn data(curves: &[(&Curve, &Yield)], of: Reading) -> (Vec<Datum>, Vec<f64>) {
    let wide = curves.iter().filter(|(c, _)| c.is_wide());
    let mut all: Vec<(Datum, f64)> = Vec::new();
    for (curve, _) in wide {
        for p in &curve.points {
            if let Some(v) = of(p).filter(|v| v.error > 0.0) {
                all.push((v.at(p.froude), curve.diameter));
            }
        }
    }
    all.into_iter().unzip()
}

/// Weighted mean residual of each diameter, with errors that include the scatter.
fn offsets(data: &[Datum], diameters: &[f64], fit: &Fit) -> Vec<Offset> {
    let mut kinds: Vec<f64> = diameters.to_vec();
    kinds.sort_by(f64::total_cmp);
    kinds.dedup();
    let mut out = Vec::new();
    for diameter in kinds {
        let own = data.iter().zip(diameters).zip(&fit.residuals);
        let own: Vec<Datum> = own
            .filter(|((_, d), _)| **d == diameter)
            .map(|((datum, _), residual)| Datum {
                y: *residual,
                ..*datum
            })
            .collect();
        if let Ok(mean) = constant(&own) {
            let residual = Value::from(&mean.parameters[0]);
            out.push(Offset { diameter, residual });
        }
    }
    out
}

fn contacts(curves: &[(&Curve, &Yield)], of: Reading) -> Contacts {
    let (data, diameters) = data(curves, of);
    let law = angle_law(&data);
    let ten: Vec<Datum> = data
        .iter()
        .filter(|d| (d.x - 10.0).abs() < 0.01)
        .copied()
        .collect();
    Contacts {
        offsets: law
            .as_ref()
            .map_or(vec![], |fit| offsets(&data, &diameters, fit)),
        law: law.into(),
        at_ten: constant(&ten).into(),
    }
}

/// All readings of one material.
pub(super) fn near_field(material: Material, curves: &[(&Curve, &Yield)]) -> NearField {
    let (kappas, diameters) = data(curves, |p| p.kappa);
    let kappa = line(&kappas);
    NearField {
        material,
        contacts: contacts(curves, |p| p.angle),
        new_contacts: contacts(curves, |p| p.new_angle),
        kappa_offsets: kappa
            .as_ref()
            .map_or(vec![], |fit| offsets(&kappas, &diameters, fit)),
        kappa: kappa.into(),
        within: within(curves),
        floating: curves
            .iter()
            .filter_map(|(curve, _)| floating(curve))
            .collect(),
    }
}

/// Kappa at each distance that any of the points has.
fn within(curves: &[(&Curve, &Yield)]) -> Vec<KappaWithin> {
    let wide: Vec<&Curve> = curves
        .iter()
        .map(|(c, _)| *c)
        .filter(|c| c.is_wide())
        .collect();
    let all = wide.iter().flat_map(|c| &c.points).flat_map(|p| &p.within);
    let at = |reach: f64| {
        let of = |p: &Point| p.within.iter().find(|w| w.reach == reach).copied();
        let points = wide.iter().flat_map(|c| &c.points);
        let kappas: Vec<Datum> = points
            .filter_map(|p| Some(of(p)?.kappa.at(p.froude)))
            .collect();
        let slow: Vec<Datum> = kappas.iter().filter(|d| d.x <= SLOW).copied().collect();
        let last = wide
            .iter()
            .filter_map(|c| Some(of(c.points.last()?)?.floating.value));
        KappaWithin {
            reach,
            line: line(&kappas).into(),
            slow: line(&slow).into(),
            floating: [last.clone().fold(1.0, f64::min), last.fold(0.0, f64::max)],
        }
    };
    distinct(all.map(|w| w.reach)).into_iter().map(at).collect()
}

fn floating(curve: &Curve) -> Option<Floating> {
    let shares: Vec<Value> = curve.points.iter().filter_map(|p| p.floating).collect();
    let (first, last) = (shares.first()?, shares.last()?);
    if shares.len() < 2 {
        return None;
    }
    let falls = shares.windows(2).filter(|pair| {
        let fall = pair[1].less(pair[0]);
        fall.value < -2.0 * fall.error
    });
    Some(Floating {
        diameter: curve.diameter,
        depth_asked: curve.depth_asked,
        slowest: *first,
        fastest: *last,
        falls: falls.count(),
    })
}
