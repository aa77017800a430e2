//! The contact laws.

use bitgrain::case::CaseLaw;
use bitgrain::json::parse;
use bitgrain::law::{AnyLaw, HertzHistoryParameters, HertzTsujiParameters};
use pyo3::prelude::*;
use pyo3::types::PyDict;

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
///
/// Raises
/// ------
/// InputError
///     A parameter is out of its range.
#[pyclass(frozen, module = "bitgrain")]
pub struct HertzHistory(HertzHistoryParameters);

#[pymethods]
impl HertzHistory {
    #[new]
    fn new(kn: f64, kt: f64, gamma_n: f64, gamma_t: f64, mu: f64) -> PyResult<Self> {
        let parameters = HertzHistoryParameters {
            kn,
            kt,
            gamma_n,
            gamma_t,
            mu, rolling: None, };
        parameters
            .build()
            .map_err(|(key, problem)| input(key, problem))?;
        Ok(Self(parameters))
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

    fn __repr__(&self) -> String {
        let HertzHistoryParameters {
            kn,
            kt,
            gamma_n,
            gamma_t,
            mu, .. } = self.0;
        format!(
            "HertzHistory(kn={kn:?}, kt={kt:?}, gamma_n={gamma_n:?}, gamma_t={gamma_t:?}, mu={mu:?})"
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
///
/// Raises
/// ------
/// InputError
///     A parameter is out of its range.
#[pyclass(frozen, module = "bitgrain")]
pub struct HertzTsuji(HertzTsujiParameters);

#[pymethods]
impl HertzTsuji {
    #[new]
    fn new(young: f64, poisson: f64, restitution: f64, mu: f64) -> PyResult<Self> {
        let parameters = HertzTsujiParameters {
            young,
            poisson,
            restitution,
            mu, rolling: None, };
        parameters
            .build()
            .map_err(|(key, problem)| input(key, problem))?;
        Ok(Self(parameters))
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

    fn __repr__(&self) -> String {
        let HertzTsujiParameters {
            young,
            poisson,
            restitution,
            mu, .. } = self.0;
        format!(
            "HertzTsuji(young={young:?}, poisson={poisson:?}, restitution={restitution:?}, mu={mu:?})"
        )
    }
}

/// The law that a Python object stands for, and the names of its materials if it has several.
///
/// # Errors
/// `InputError` if it is none.
pub fn law(value: &Bound<'_, PyAny>) -> PyResult<(AnyLaw, Vec<String>)> {
    let wrong = |(key, problem): (&str, String)| input(key, problem);
    if let Ok(law) = value.cast::<HertzHistory>() {
        let law = law.get().0.build().map_err(wrong)?;
        return Ok((AnyLaw::HertzHistory(law), Vec::new()));
    }
    if let Ok(law) = value.cast::<HertzTsuji>() {
        let law = law.get().0.build().map_err(wrong)?;
        return Ok((AnyLaw::HertzTsuji(law), Vec::new()));
    }
    if let Ok(table) = value.cast::<PyDict>() {
        let json = value.py().import("json")?;
        let text: String = json.call_method1("dumps", (table,))?.extract()?;
        let law: CaseLaw = parse(&text, "law").map_err(|wrong| laboratory(&wrong))?;
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
