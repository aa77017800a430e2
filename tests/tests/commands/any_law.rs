//! Laws of all kinds, drawn.

use bitgrain::case::CaseLaw;
use bitgrain::law::{
    Elasticity, HertzHistoryPair, HertzHistoryParameters, HertzHistoryTable, HertzTsujiPair,
    HertzTsujiParameters, HertzTsujiTable, LawSpec, LawTable,
};
use proptest::prelude::*;

fn law() -> impl Strategy<Value = LawSpec> {
    let history = (
        1e-3..1e9f64,
        0.0..1e9f64,
        0.0..1e6f64,
        0.0..1e6f64,
        0.0..2.0f64,
    );
    let tsuji = (1e-3..1e9f64, -0.9..0.5f64, 1e-3..1.0f64, 0.0..2.0f64);
    prop_oneof![
        history.prop_map(|(kn, kt, gamma_n, gamma_t, mu)| LawSpec::HertzHistory(
            HertzHistoryParameters {
                kn,
                kt,
                gamma_n,
                gamma_t,
                mu,
                rolling: None,
            }
        )),
        tsuji.prop_map(|(young, poisson, restitution, mu)| LawSpec::HertzTsuji(
            HertzTsujiParameters {
                young,
                poisson,
                restitution,
                mu,
                rolling: None,
            }
        )),
    ]
}

/// A law with the numbers of one material, or of two.
pub fn case_law() -> impl Strategy<Value = CaseLaw> {
    let pairs = || {
        [["glass", "glass"], ["steel", "glass"], ["steel", "steel"]]
            .map(|pair| pair.map(str::to_owned))
    };
    (law(), law(), any::<bool>()).prop_map(move |(one, two, several)| match (one, two) {
        (LawSpec::HertzTsuji(a), LawSpec::HertzTsuji(b)) if several => {
            let elasticity = |of: HertzTsujiParameters| Elasticity {
                young: of.young,
                poisson: of.poisson,
            };
            let table = HertzTsujiTable {
                materials: [("glass", a), ("steel", b)]
                    .map(|(name, of)| (name.into(), elasticity(of)))
                    .into(),
                pairs: pairs()
                    .map(|between| HertzTsujiPair {
                        between,
                        restitution: b.restitution,
                        mu: a.mu,
                        rolling: None,
                    })
                    .into(),
            };
            LawTable::HertzTsuji(table).into()
        }
        (LawSpec::HertzHistory(a), _) if several => {
            let pair = |between| HertzHistoryPair {
                between,
                kn: a.kn,
                kt: a.kt,
                gamma_n: a.gamma_n,
                gamma_t: a.gamma_t,
                mu: a.mu,
                rolling: None,
            };
            let table = HertzHistoryTable {
                materials: None,
                pairs: pairs().map(pair).into(),
            };
            LawTable::HertzHistory(table).into()
        }
        _ => one.into(),
    })
}
