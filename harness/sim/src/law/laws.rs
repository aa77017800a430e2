//! All contact laws: a new one is added here.

use std::sync::Arc;

use bitgrain_kernel::contact::{
    ContactMemory, HertzHistory, HertzTsuji, Law, Materials, Rolling, RollingResistance,
};
use serde::{Deserialize, Serialize};

use super::hertz_history::HertzHistoryParameters;
use super::hertz_tsuji::HertzTsujiParameters;
use super::pairs::Pairs;
use super::parameters::{LawParameters, Springs, Sprung, Wrong, WrongKey};
use super::rolling::RollingSpec;

/// A contact law with the parameters its paper gives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum LawSpec {
    /// Kumar 2018, eqs. 1 and 2.
    HertzHistory(HertzHistoryParameters),
    /// Guillard 2014, eq. A1 and Table I.
    HertzTsuji(HertzTsujiParameters),
}

/// A contact law with the numbers that it computes with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AnyLaw {
    /// Kumar 2018, eqs. 1 and 2.
    HertzHistory(HertzHistory<f64>),
    /// Guillard 2014, eq. A1.
    HertzTsuji(HertzTsuji<f64>),
    /// The first with other numbers for each pair of materials.
    HertzHistoryPairs(Arc<Pairs<HertzHistory<f64>>>),
    /// The second likewise.
    HertzTsujiPairs(Arc<Pairs<HertzTsuji<f64>>>),
    /// The first with resistance to rolling, for each pair of materials, or for the only one.
    HertzHistoryRolling(Arc<Pairs<Rolling<f64, HertzHistory<f64>>>>),
    /// The second likewise.
    HertzTsujiRolling(Arc<Pairs<Rolling<f64, HertzTsuji<f64>>>>),
}

/// The law of one material with resistance to rolling.
fn one<L: Copy>(law: L, rolling: RollingResistance<f64>) -> Arc<Pairs<Rolling<f64, L>>> {
    let law = Rolling {
        law,
        resistance: rolling,
    };
    Arc::new(Pairs::new(1, vec![law]).expect("one material, one law"))
}

/// Something to do with a law, whichever it is: it is compiled for each.
pub trait WithLaw {
    /// What it returns.
    type Output;
    /// Does it.
    fn run<L: Law<f64> + Sprung>(self, law: &L) -> Self::Output;
}

impl LawSpec {
    /// What is known of the law beside its forces.
    pub fn parameters(&self) -> &dyn LawParameters {
        match self {
            LawSpec::HertzHistory(parameters) => parameters,
            LawSpec::HertzTsuji(parameters) => parameters,
        }
    }

    /// The law as it is computed.
    ///
    /// # Errors
    /// The key and what was expected of it.
    pub fn build(&self) -> Result<AnyLaw, WrongKey> {
        let own = |(key, problem): Wrong| (key.to_owned(), problem);
        let rolling = self.rolling().map(|rolling| rolling.build()).transpose()?;
        Ok(match self {
            LawSpec::HertzHistory(parameters) => {
                let law = parameters.build().map_err(own)?;
                match rolling {
                    None => AnyLaw::HertzHistory(law),
                    Some(rolling) => AnyLaw::HertzHistoryRolling(one(law, rolling)),
                }
            }
            LawSpec::HertzTsuji(parameters) => {
                let law = parameters.build().map_err(own)?;
                match rolling {
                    None => AnyLaw::HertzTsuji(law),
                    Some(rolling) => AnyLaw::HertzTsujiRolling(one(law, rolling)),
                }
            }
        })
    }

    /// What resists rolling, if anything does.
    pub fn rolling(&self) -> Option<RollingSpec> {
        match self {
            LawSpec::HertzHistory(parameters) => parameters.rolling,
            LawSpec::HertzTsuji(parameters) => parameters.rolling,
        }
    }

    /// The law with damping strong enough to take the last motion out of a bed that has fallen, in steps of `dt`,
    /// grains of diameter `d`; the forces at rest are the law's own.
    #[must_use]
    pub fn quenching(&self, dt: f64, d: f64) -> Self {
        match self {
            LawSpec::HertzHistory(parameters) => LawSpec::HertzHistory(parameters.quenching(dt, d)),
            LawSpec::HertzTsuji(parameters) => LawSpec::HertzTsuji(parameters.quenching()),
        }
    }

    /// The law with another friction coefficient.
    #[must_use]
    pub fn with_mu(&self, mu: f64) -> Self {
        match self {
            LawSpec::HertzHistory(own) => {
                LawSpec::HertzHistory(HertzHistoryParameters { mu, ..*own })
            }
            LawSpec::HertzTsuji(own) => LawSpec::HertzTsuji(HertzTsujiParameters { mu, ..*own }),
        }
    }

    /// Friction coefficient.
    pub fn mu(&self) -> f64 {
        self.parameters().mu()
    }

    /// What files call the law.
    pub fn kind(&self) -> String {
        let kind = self.table().remove("kind");
        kind.and_then(|kind| kind.as_str().map(str::to_owned))
            .unwrap_or_default()
    }

    /// The number of a key, as files name it; `None` if the law has none of the name.
    pub fn value(&self, key: &str) -> Option<f64> {
        self.table().get(key)?.as_f64()
    }

    fn table(&self) -> serde_json::Map<String, serde_json::Value> {
        match serde_json::to_value(self) {
            Ok(serde_json::Value::Object(table)) => table,
            _ => serde_json::Map::new(),
        }
    }

    /// Normal stiffness as a pressure: `F_n = K_n sqrt(R delta) delta`; NaN if [`LawSpec::build`]
    /// refuses the law.
    pub fn normal_stiffness(&self) -> f64 {
        self.build().map_or(f64::NAN, |law| law.springs([0; 2]).kn)
    }
}

impl AnyLaw {
    /// Does something with the law.
    #[inline]
    pub fn with<W: WithLaw>(&self, what: W) -> W::Output {
        match self {
            AnyLaw::HertzHistory(law) => what.run(law),
            AnyLaw::HertzTsuji(law) => what.run(law),
            AnyLaw::HertzHistoryPairs(laws) => what.run(&laws.lend()),
            AnyLaw::HertzTsujiPairs(laws) => what.run(&laws.lend()),
            AnyLaw::HertzHistoryRolling(laws) => what.run(&laws.lend()),
            AnyLaw::HertzTsujiRolling(laws) => what.run(&laws.lend()),
        }
    }

    /// How many materials it has numbers of.
    pub fn materials(&self) -> u8 {
        match self {
            AnyLaw::HertzHistory(_) | AnyLaw::HertzTsuji(_) => 1,
            AnyLaw::HertzHistoryPairs(laws) => laws.materials(),
            AnyLaw::HertzTsujiPairs(laws) => laws.materials(),
            AnyLaw::HertzHistoryRolling(laws) => laws.materials(),
            AnyLaw::HertzTsujiRolling(laws) => laws.materials(),
        }
    }

    /// How many words of a contact it keeps beside the tangential spring.
    pub fn words(&self) -> usize {
        struct Words;
        impl WithLaw for Words {
            type Output = usize;
            fn run<L: Law<f64> + Sprung>(self, _: &L) -> usize {
                L::MEMORY
            }
        }
        self.with(Words)
    }

    /// The words of a contact as its partner keeps them.
    pub fn seen_by_partner(&self, memory: ContactMemory<f64>) -> ContactMemory<f64> {
        struct Seen(ContactMemory<f64>);
        impl WithLaw for Seen {
            type Output = ContactMemory<f64>;
            fn run<L: Law<f64> + Sprung>(self, law: &L) -> ContactMemory<f64> {
                law.seen_by_partner(self.0)
            }
        }
        self.with(Seen(memory))
    }

    /// The springs of contacts between two materials.
    pub fn springs(&self, materials: Materials) -> Springs {
        struct Between(Materials);
        impl WithLaw for Between {
            type Output = Springs;
            fn run<L: Law<f64> + Sprung>(self, law: &L) -> Springs {
                law.springs(self.0)
            }
        }
        self.with(Between(materials))
    }
}
