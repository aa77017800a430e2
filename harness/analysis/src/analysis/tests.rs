//! A campaign whose laws are known: the analysis must find them again.

use super::*;
use crate::fit::Fit;
use bitgrain_lab::campaign::table::CampaignTable;
use bitgrain_sim::random::{Purpose, uniforms};

/// Relative noise of every drag, and the error that it is given with.
const NOISE: f64 = 0.003;

/// Diameters of travel of each run.
const TRAVEL: usize = 12;

/// A made-up campaign.
struct Made {
    mus: Vec<f64>,
    diameters: Vec<f64>,
    depths: Vec<f64>,
    froudes: Vec<f64>,
    kns: Vec<f64>,
    plug: &'static str,
    /// What drags beyond Fr = 1 are times the law at depths up to 25 d.
    shallow: f64,
}

impl Default for Made {
    fn default() -> Self {
        Self {
            mus: vec![0.0, 0.5],
            diameters: vec![1.0, 2.0, 3.0, 4.0],
            depths: vec![4.0, 8.0, 14.0],
            froudes: vec![
                0.08, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0, 1.5, 2.2, 3.0, 4.0, 5.0, 6.0, 7.0, 8.5,
                10.0,
            ],
            kns: vec![2e5],
            plug: "sound",
            shallow: 1.0,
        }
    }
}

/// phi and alpha of a friction.
fn exponents(mu: f64) -> [f64; 2] {
    if mu < 0.05 { [2.0, 1.0] } else { [1.7, 1.3] }
}

/// Drag over yield force: flat or `1 + 0.5 Fr^0.6`, a line from 1 to 5, then a parabola.
fn dynamic(mu: f64, froude: f64) -> f64 {
    let first = |x: f64| {
        if mu < 0.05 {
            0.5 * libm::pow(x, 0.6)
        } else {
            0.0
        }
    };
    let line = |x: f64| 0.25 * (x.clamp(1.0, 5.0) - 1.0);
    let square = if froude > 5.0 {
        0.1 * (froude * froude - 25.0)
    } else {
        0.0
    };
    1.0 + first(froude.min(1.0)) + line(froude) + square
}

/// A normal number: three times four uniforms.
fn normal(k: u32) -> f64 {
    let four = |part: u32| -> f64 { uniforms::<4>(11, Purpose::Shift, 3 * k + part).iter().sum() };
    four(0) + four(1) + four(2) - 6.0
}

impl Made {
    fn table(&self) -> CampaignTable {
        together(std::slice::from_ref(self))
    }

    fn text(&self) -> String {
        let names = "member,run,status,reason,digest,mu,kn,gamma_n,diameter,diameter_least,diameter_most,\
                     depth_asked,depth,speed,froude,drag,drag_error,plug,plug_ratio,contact_angle,\
                     contact_angle_error,kappa,kappa_error,floating,floating_error,discard,drag_uncut,\
                     drag_uncut_error";
        let travel: String = (1..=TRAVEL).map(|k| format!(",drag_travel_{k}")).collect();
        let mut text = format!("{names}{travel}\n");
        let mut row = 0;
        for &kn in &self.kns {
            for &mu in &self.mus {
                for &d in &self.diameters {
                    for &asked in &self.depths {
                        for &froude in &self.froudes {
                            row += 1;
                            // Beds settle a little off their depth.
                            let h = asked * if mu < 0.05 { 0.88 } else { 1.1 };
                            let [phi, alpha] = exponents(mu);
                            let scale = libm::pow(d + 1.0, phi) * libm::pow(h, alpha);
                            // Softer grains resist more slowly, and alike in a collision.
                            let soft = if froude < 5.0 {
                                libm::pow(kn / 2e5, -0.05)
                            } else {
                                1.0
                            };
                            let off = if asked <= 25.0 && froude > 1.0 {
                                self.shallow
                            } else {
                                1.0
                            };
                            let law = scale * soft * off * dynamic(mu, froude);
                            let drag = law * (1.0 + NOISE * normal(row));
                            let speed = froude * (d + 1.0) / (2.0 * (2.0 * d).sqrt());
                            let angle =
                                -0.15 * libm::pow(froude, 0.38) + std::f64::consts::PI / 2.45;
                            let angle = angle + 0.004 * normal(row + 100_000);
                            let kappa = 0.887 + 0.185 * froude + 0.01 * normal(row + 200_000);
                            let gamma = 5e4 * libm::pow(kn / 2e8, 0.6);
                            text.push_str(&format!(
                                "m,r{row},done,,x,{mu},{kn},{gamma},{d},0.9,1.1,{asked},{h},{speed},{froude},\
                                 {drag},{},{},0.1,{angle},0.004,{kappa},0.01,{},0.001,2.0,{drag},{}",
                                NOISE * drag,
                                self.plug,
                                0.02 * froude,
                                NOISE * drag
                            ));
                            // Errors of so many diameters are those of the drag.
                            let part = NOISE * (TRAVEL as f64).sqrt();
                            for k in 0..TRAVEL {
                                let off = part * normal(300_000 + TRAVEL as u32 * row + k as u32);
                                text.push_str(&format!(",{}", drag * (1.0 + off)));
                            }
                            text.push('\n');
                        }
                    }
                }
            }
        }
        text
    }
}

/// Made-up campaigns in one table.
fn together(made: &[Made]) -> CampaignTable {
    let mut text = made[0].text();
    for other in &made[1..] {
        let rows = other.text();
        text.push_str(rows.split_once('\n').unwrap().1);
    }
    CampaignTable::parse(&text, "made").unwrap()
}

fn near(fit: &Fit, name: &str, want: f64) {
    let p = fit.parameter(name).unwrap();
    // Four standard errors: one number in sixteen thousand lies outside by chance.
    assert!(
        (p.value - want).abs() < 4.0 * p.error,
        "{name} = {} +- {}, not {want}",
        p.value,
        p.error
    );
}

#[test]
fn known_exponents_and_yield_forces_are_found() {
    let found = analyse(&Made::default().table(), false);
    assert_eq!((found.rows, found.failed, found.sliding), (408, 0, 0));
    assert_eq!(found.curves.len(), 24);
    for (curve, own) in found.curves.iter().zip(&found.yields) {
        let [phi, alpha] = exponents(curve.material.mu);
        let want = libm::pow(curve.diameter + 1.0, phi) * libm::pow(curve.depth, alpha);
        let force = own.force.found().expect("its speeds can carry one");
        assert!(
            (force.value - want).abs() < 4.0 * force.error,
            "{force:?} {want}"
        );
        let method = if curve.material.mu < 0.05 {
            Method::Extrapolated
        } else {
            Method::Plateau
        };
        assert_eq!(own.method, method);
    }
    for scaling in &found.scaling {
        let [phi, alpha] = exponents(scaling.material.mu);
        let both = scaling.both.found().unwrap();
        near(&both.fit, "phi", phi);
        near(&both.fit, "alpha", alpha);
        assert!((both.sum.value - 3.0).abs() < 4.0 * both.sum.error);
        let slow = scaling.slow.found().unwrap();
        near(&slow.fit, "phi", phi);
        near(&slow.fit, "alpha", alpha);
        assert_eq!((scaling.phi.len(), scaling.alpha.len()), (3, 4));
        scaling
            .phi
            .iter()
            .for_each(|e| near(e.fit.found().unwrap(), "p", phi));
        scaling
            .alpha
            .iter()
            .for_each(|e| near(e.fit.found().unwrap(), "p", alpha));
        let mean = scaling.alpha_mean.found().unwrap();
        assert!((mean.value - alpha).abs() < 4.0 * mean.error, "{mean:?}");
        // The remaining spread comes from errors and exponents.
        for collapse in [&scaling.by_size, &scaling.by_depth] {
            let collapse = collapse.found().unwrap();
            assert!(collapse.spread < 3.0 * NOISE, "{}", collapse.spread);
        }
        assert!(scaling.by_depth_deep.found().is_none());
    }
}

/// Drags at 25 d and less are held against those of deeper ones, at each speed.
#[test]
fn shallow_drags_are_held_against_deep_ones() {
    let off = |shallow: f64, depths: &[f64]| {
        let made = Made {
            mus: vec![0.5],
            diameters: vec![4.0],
            depths: depths.to_vec(),
            shallow,
            ..Made::default()
        };
        analyse(&made.table(), false).scaling[0]
            .shallow_off_deep
            .clone()
    };
    for shallow in [1.0, 1.2] {
        let found = off(shallow, &[10.0, 25.0, 45.0, 60.0]);
        let found = found.found().unwrap();
        assert_eq!((found.speeds.len(), found.deviations), (17, 34.0));
        for at in &found.speeds {
            assert_eq!(at.runs, 2);
            let want = if at.froude > 1.0 { shallow - 1.0 } else { 0.0 };
            // Noise, and the error of alpha over a factor of six in depth.
            let apart = (at.spread - want).abs();
            assert!(apart < 6.0 * NOISE, "{shallow} {at:?}");
            assert!(at.expected > NOISE && at.expected < 2.0 * NOISE, "{at:?}");
        }
    }
    for depths in [[5.0, 10.0, 25.0], [30.0, 60.0, 120.0]] {
        let Finding::Refused(why) = off(1.0, &depths) else {
            panic!("{depths:?}");
        };
        assert!(why.0.contains("both down to 25 d and deeper"), "{why}");
    }
}

/// Intruders at one height ask for depths that differ a little by their size: they are at one depth.
#[test]
fn depths_that_nearly_agree_are_one() {
    let at = |diameter: f64, depth: f64| {
        let (diameters, depths) = (vec![diameter], vec![depth]);
        Made {
            diameters,
            depths,
            ..Made::default()
        }
    };
    let depths_of_phi = |step: f64| {
        let made = [at(1.0, 8.0), at(2.0, 8.0 * step), at(4.0, 8.0 / step)];
        let found = analyse(&together(&made), false);
        let phi = found.scaling.iter().map(|scaling| {
            let fits = scaling.phi.iter();
            fits.filter(|one| one.fit.found().is_some()).count()
        });
        let sizes = found.pooled.iter().map(|pooled| pooled.scales.len());
        (phi.collect::<Vec<_>>(), sizes.collect::<Vec<_>>())
    };
    assert_eq!(depths_of_phi(1.004), (vec![1, 1], vec![3, 3]));
    // As far apart as those of D = 1 and 10 d at one height in Kumar's box.
    assert_eq!(depths_of_phi(1.0065), (vec![1, 1], vec![3, 3]));
    assert_eq!(depths_of_phi(1.05), (vec![0, 0], vec![1, 1]));
}

/// A run at V = 0.05 is the slow limit with friction; without friction only one at 0.01 is.
#[test]
fn a_slow_run_is_the_yield_force_sooner_with_friction() {
    let mut made = Made::default();
    made.froudes.insert(0, 0.05);
    let methods = |made: &Made| {
        let found = analyse(&made.table(), false);
        let both = found.curves.iter().zip(&found.yields);
        both.map(|(curve, own)| (curve.material.mu > 0.0, own.method))
            .collect::<Vec<_>>()
    };
    for (rough, method) in methods(&made) {
        let want = if rough {
            Method::SlowRun
        } else {
            Method::Extrapolated
        };
        assert_eq!(method, want);
    }
    made.froudes.insert(0, 0.011);
    assert!(methods(&made).iter().all(|own| own.1 == Method::SlowRun));
}

#[test]
fn known_regimes_and_laws_are_found() {
    let found = analyse(&Made::default().table(), false);
    let rough = &found.pooled[1];
    // Those at one of three depths.
    assert_eq!((rough.material.mu, rough.runs), (0.5, 68));
    let regimes = rough.regimes.found().unwrap();
    let holds = |c: &crate::fit::regimes::Crossover, x: f64| {
        c.low.is_none_or(|low| low <= x) && c.high.is_none_or(|high| high >= x)
    };
    assert!(regimes.needed);
    assert!(
        holds(&regimes.first, 1.0) && holds(&regimes.second, 5.0),
        "{regimes:?}"
    );
    assert_eq!(rough.growth.len(), 4);
    for growth in &rough.growth {
        near(growth.second.found().unwrap(), "p", 1.0);
    }
    // The parabola rises from 50 to 100 of 0.1 x^2 above the line of slope 0.25: by 7.5 from 5 to 10, the line by 1.25.
    let r = rough.growth[0]
        .third
        .found()
        .unwrap()
        .parameter("r")
        .unwrap();
    assert!(r.value > 4.0, "{r:?}");
    for near_field in &found.near_field {
        let law = near_field.contacts.law.found().unwrap();
        near(law, "Y1", -0.15);
        near(law, "Y2", 0.38);
        near(law, "Y3", 2.45);
        let line = near_field.kappa.found().unwrap();
        near(line, "a", 0.887);
        near(line, "b", 0.185);
        for offset in near_field
            .contacts
            .offsets
            .iter()
            .chain(&near_field.kappa_offsets)
        {
            assert!(
                offset.residual.value.abs() < 4.0 * offset.residual.error,
                "{offset:?}"
            );
        }
        assert!(
            near_field
                .floating
                .iter()
                .all(|f| f.fastest.value > f.slowest.value && f.falls == 0)
        );
    }
}

#[test]
fn what_the_table_cannot_carry_is_refused_in_words() {
    let few = Made {
        diameters: vec![2.0, 3.0],
        depths: vec![8.0],
        froudes: vec![2.0, 3.0],
        ..Made::default()
    };
    let found = analyse(&few.table(), false);
    let text = describe(&found);
    for sentence in [
        "no run is below Fr = 1",
        "takes two speeds below Fr = 1, a factor of 1.6 apart",
        "takes the exponent phi, which was not found",
    ] {
        assert!(text.contains(sentence), "{sentence}:\n{text}");
    }
    let short = Made {
        diameters: vec![2.0, 2.5, 3.0],
        ..Made::default()
    };
    let found = analyse(&short.table(), false);
    let phi = &found.scaling[1].phi[0].fit;
    assert!(
        matches!(phi, Finding::Refused(why) if why.to_string().contains("0.3 decades")),
        "{phi:?}"
    );
}

#[test]
fn sliding_beds_count_only_where_they_are_asked_for() {
    let made = Made {
        plug: "slides",
        ..Made::default()
    };
    let found = analyse(&made.table(), false);
    assert_eq!((found.sliding, found.curves.len()), (408, 0));
    assert_eq!(analyse(&made.table(), true).curves.len(), 24);
}

#[test]
fn stiffness_and_findings_are_told() {
    let at = |kn: f64, depth: f64| Made {
        mus: vec![0.5],
        diameters: vec![2.0],
        depths: vec![depth],
        kns: vec![kn],
        ..Made::default()
    };
    // Two materials at one height: the least depth that several intruders asked for stands for the depth of each.
    let found = analyse(&together(&[at(2e5, 8.0), at(2e7, 8.02)]), false);
    let [group] = &found.stiffness[..] else {
        panic!("{:?}", found.stiffness);
    };
    assert_eq!((&group.what[..], group.levels.len()), ("kn", 2));
    let slow = group.levels[1].slow.over(group.levels[0].slow);
    // 100^-0.05.
    assert!(
        (slow.value - 0.794_328).abs() < 4.0 * slow.error,
        "{slow:?}"
    );
    let fast = group.levels[1].fast.unwrap();
    assert!((fast.value - 1.0).abs() < 4.0 * fast.error, "{fast:?}");
    // JSON holds all of it, to ten digits.
    let text = text(&found);
    let read: Analysis = serde_json::from_str(&text).unwrap();
    assert_eq!(super::text(&read), text);
    let (a, b) = (
        found.yields[0].force.found().unwrap(),
        read.yields[0].force.found().unwrap(),
    );
    assert!((a.value / b.value - 1.0).abs() < 1e-9);
}
