//! The contact laws.

use bitgrain::case::CaseLaw;
use bitgrain::json::parse;
use bitgrain::law::{AnyLaw, HertzHistoryParameters, HertzTsujiParameters, LawSpec, RollingSpec};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::de::DeserializeOwned;

use crate::errors::{input, laboratory};

/// Contacts with Hertz' normal force, a damper and a tangential spring, after Kumar 2018, eqs. 1 and 2; `hertz_history`
/// of scenarios.
///
/// Parameters
/// ----------
/// kn : float
///     Normal stiffness (pressure), positive.
/// kt : float
///     Tangential stiffness (pressure), zero or more.
/// gamma_n, gamma_t : float
///     Normal and tangential damping (1 / (time length)), zero or more.
/// mu : float
///     Friction coefficient, zero or more.
/// rolling : dict, optional
///     Resistance to rolling, as the `rolling` of a case file: ``{"kind": "epsd2", "mu": 0.1}`` or
///     ``{"kind": "sds", "k": stiffness, "gamma": damping, "mu": 0.1}``. None if it is left out.
///
/// Raises
/// ------
/// InputError
///     A parameter is out of its range.
#[pyclass(frozen, module = "bitgrain")]
pub struct HertzHistory(HertzHistoryParameters);

impl HertzHistory {
    fn checked(parameters: HertzHistoryParameters) -> PyResult<Self> {
        built(LawSpec::HertzHistory(parameters))?;
        Ok(Self(parameters))
    }
}

#[pymethods]
impl HertzHistory {
    #[new]
    #[pyo3(signature = (kn, kt, gamma_n, gamma_t, mu, rolling = None))]
    fn new(
        kn: f64,
        kt: f64,
        gamma_n: f64,
        gamma_t: f64,
        mu: f64,
        rolling: Option<Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let rolling = resistance(rolling)?;
        let parameters = HertzHistoryParameters {
            kn,
            kt,
            gamma_n,
            gamma_t,
            mu,
            rolling,
        };
        Self::checked(parameters)
    }

    /// Normal stiffness (pressure).
    #[getter]
    fn kn(&self) -> f64 {
        self.0.kn
    }

    /// Tangential stiffness (pressure).
    #[getter]
    fn kt(&self) -> f64 {
        self.0.kt
    }

    /// Normal damping (1 / (time length)).
    #[getter]
    fn gamma_n(&self) -> f64 {
        self.0.gamma_n
    }

    /// Tangential damping (1 / (time length)).
    #[getter]
    fn gamma_t(&self) -> f64 {
        self.0.gamma_t
    }

    /// Friction coefficient.
    #[getter]
    fn mu(&self) -> f64 {
        self.0.mu
    }

    /// Resistance to rolling, as it was given.
    #[getter]
    fn rolling(&self, py: Python<'_>) -> PyResult<Option<Py<PyAny>>> {
        resistance_as_dict(py, self.0.rolling)
    }

    fn __repr__(&self) -> String {
        let HertzHistoryParameters {
            kn,
            kt,
            gamma_n,
            gamma_t,
            mu,
            ..
        } = self.0;
        let rolling = argument(self.0.rolling);
        format!(
            "HertzHistory(kn={kn:?}, kt={kt:?}, gamma_n={gamma_n:?}, gamma_t={gamma_t:?}, mu={mu:?}{rolling})"
        )
    }
}

/// Contacts with Hertz' normal force, Mindlin's tangential spring and Tsuji's damper, after Guillard 2014, eq. A1 and
/// Table I; `hertz_tsuji` of scenarios.
///
/// Parameters
/// ----------
/// young : float
///     Young's modulus (pressure), positive.
/// poisson : float
///     Poisson's ratio, above -1 and at most 0.5.
/// restitution : float
///     Coefficient of restitution, above 0 and at most 1.
/// mu : float
///     Friction coefficient, zero or more.
/// rolling : dict, optional
///     Resistance to rolling, as the `rolling` of a case file: ``{"kind": "epsd2", "mu": 0.1}`` or
///     ``{"kind": "sds", "k": stiffness, "gamma": damping, "mu": 0.1}``. None if it is left out.
///
/// Raises
/// ------
/// InputError
///     A parameter is out of its range.
#[pyclass(frozen, module = "bitgrain")]
pub struct HertzTsuji(HertzTsujiParameters);

impl HertzTsuji {
    fn checked(parameters: HertzTsujiParameters) -> PyResult<Self> {
        built(LawSpec::HertzTsuji(parameters))?;
        Ok(Self(parameters))
    }
}

#[pymethods]
impl HertzTsuji {
    #[new]
    #[pyo3(signature = (young, poisson, restitution, mu, rolling = None))]
    fn new(
        young: f64,
        poisson: f64,
        restitution: f64,
        mu: f64,
        rolling: Option<Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let rolling = resistance(rolling)?;
        let parameters = HertzTsujiParameters {
            young,
            poisson,
            restitution,
            mu,
            rolling,
        };
        Self::checked(parameters)
    }

    /// Young's modulus (pressure).
    #[getter]
    fn young(&self) -> f64 {
        self.0.young
    }

    /// Poisson's ratio.
    #[getter]
    fn poisson(&self) -> f64 {
        self.0.poisson
    }

    /// Coefficient of restitution.
    #[getter]
    fn restitution(&self) -> f64 {
        self.0.restitution
    }

    /// Friction coefficient.
    #[getter]
    fn mu(&self) -> f64 {
        self.0.mu
    }

    /// Resistance to rolling, as it was given.
    #[getter]
    fn rolling(&self, py: Python<'_>) -> PyResult<Option<Py<PyAny>>> {
        resistance_as_dict(py, self.0.rolling)
    }

    fn __repr__(&self) -> String {
        let HertzTsujiParameters {
            young,
            poisson,
            restitution,
            mu,
            ..
        } = self.0;
        let rolling = argument(self.0.rolling);
        format!(
            "HertzTsuji(young={young:?}, poisson={poisson:?}, restitution={restitution:?}, mu={mu:?}{rolling})"
        )
    }
}

/// A law as it is computed.
fn built(law: LawSpec) -> PyResult<AnyLaw> {
    law.build().map_err(|(key, problem)| input(&key, problem))
}

/// What a dict says, as the part of a case file of this name.
fn read<T: DeserializeOwned>(table: &Bound<'_, PyDict>, name: &str) -> PyResult<T> {
    let json = table.py().import("json")?;
    let text: String = json.call_method1("dumps", (table,))?.extract()?;
    parse(&text, name).map_err(|wrong| laboratory(&wrong))
}

/// The resistance to rolling that a dict says.
fn resistance(rolling: Option<Bound<'_, PyDict>>) -> PyResult<Option<RollingSpec>> {
    rolling.map(|table| read(&table, "rolling")).transpose()
}

/// The dict that says a resistance to rolling.
fn resistance_as_dict(py: Python<'_>, rolling: Option<RollingSpec>) -> PyResult<Option<Py<PyAny>>> {
    let Some(rolling) = rolling else {
        return Ok(None);
    };
    let json = py.import("json")?;
    let dict = json.call_method1("loads", (text(rolling),))?;
    Ok(Some(dict.unbind()))
}

/// A resistance to rolling as JSON, which Python reads as a dict too.
fn text(rolling: RollingSpec) -> String {
    serde_json::to_string(&rolling).expect("numbers that were checked")
}

/// The last argument of the expression that makes a law; empty without resistance.
fn argument(rolling: Option<RollingSpec>) -> String {
    rolling.map_or_else(String::new, |rolling| {
        format!(", rolling={}", text(rolling))
    })
}

/// The law that a Python object stands for, and the names of its materials if it has several.
///
/// # Errors
/// `InputError` if it is none.
pub fn law(value: &Bound<'_, PyAny>) -> PyResult<(AnyLaw, Vec<String>)> {
    if let Ok(law) = value.cast::<HertzHistory>() {
        return Ok((built(LawSpec::HertzHistory(law.get().0))?, Vec::new()));
    }
    if let Ok(law) = value.cast::<HertzTsuji>() {
        return Ok((built(LawSpec::HertzTsuji(law.get().0))?, Vec::new()));
    }
    if let Ok(table) = value.cast::<PyDict>() {
        let law: CaseLaw = read(table, "law")?;
        let built = law.build();
        let built = built.map_err(|(key, problem)| input(&format!("law.{key}"), problem))?;
        let names = law.names().into_iter().map(str::to_owned).collect();
        return Ok((built, names));
    }
    let problem = format!(
        "is {}; expected HertzHistory(...), HertzTsuji(...), or a dict as the `law` of a case file",
        value.repr()?
    );
    Err(input("law", problem))
}
