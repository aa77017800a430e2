//! What claims on Kumar 2018 are measured from: the curves of one material, and numbers found on them.

use super::book::Claim;
use crate::analysis::{Analysis, Curve, Finding, NearField, Pooled, Scaling, Speeds, Value, Yield};
use crate::fit::Fit;

/// Friction coefficient of most of the paper.
pub(super) const MU: f64 = 0.5;

pub(super) fn parameter(fit: &Fit, name: &str) -> Result<Value, String> {
    let found = fit.parameter(name).map(Value::from);
    found.ok_or_else(|| format!("the fit has no {name}"))
}

pub(super) fn found<T>(finding: &Finding<T>) -> Result<&T, String> {
    match finding {
        Finding::Found(found) => Ok(found),
        Finding::Refused(why) => Err(why.to_string()),
    }
}

/// The material that most of a paper is about: of the friction asked for, that with the most curves.
pub(super) struct Of<'a> {
    pub(super) analysis: &'a Analysis,
    /// What is measured, which says how several numbers become one.
    pub(super) claim: &'a Claim,
}

impl<'a> Of<'a> {
    /// The yield force of the same intruder in grains of another friction.
    pub(super) fn yield_at(&self, mu: f64, like: &Curve) -> Option<Value> {
        let same = |c: &Curve| {
            (c.material.mu - mu).abs() < 1e-9
                && c.material.kn == like.material.kn
                && c.material.gamma_n == like.material.gamma_n
                && c.diameter == like.diameter
                && (c.depth_asked - like.depth_asked).abs() < 1e-6
        };
        let found = self.curves().find(|(c, ..)| same(c));
        found.and_then(|(_, _, own)| own.force.found().copied())
    }

    pub(super) fn curves(&self) -> impl Iterator<Item = (&'a Curve, &'a Speeds, &'a Yield)> {
        let a = self.analysis;
        let all = a.curves.iter().zip(&a.speeds).zip(&a.yields);
        all.map(|((curve, speeds), own)| (curve, speeds, own))
    }

    pub(super) fn most<T>(
        &self,
        list: &'a [T],
        mu: f64,
        of: impl Fn(&T) -> (crate::analysis::Material, usize),
    ) -> Result<&'a T, String> {
        let own = list.iter().filter(|x| (of(x).0.mu - mu).abs() < 1e-9);
        let most = own.reduce(|a, b| if of(b).1 > of(a).1 { b } else { a });
        most.ok_or_else(|| format!("no run has mu = {mu}"))
    }

    pub(super) fn pooled(&self, mu: f64) -> Result<&'a Pooled, String> {
        self.most(&self.analysis.pooled, mu, |p| (p.material, p.runs))
    }

    pub(super) fn near_field(&self, mu: f64) -> Result<&'a NearField, String> {
        self.most(&self.analysis.near_field, mu, |a| {
            (a.material, a.floating.len())
        })
    }

    pub(super) fn scaling(&self, mu: f64) -> Result<&'a Scaling, String> {
        self.most(&self.analysis.scaling, mu, |s| {
            (s.material, s.phi.len() + s.alpha.len())
        })
    }
}

pub(super) fn name(curve: &Curve) -> String {
    format!(
        "mu = {}, D = {}, h = {:.1}",
        curve.material.mu, curve.diameter, curve.depth
    )
}
