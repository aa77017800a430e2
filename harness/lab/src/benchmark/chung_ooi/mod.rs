//! Chung and Ooi, Benchmark tests for verifying discrete element modelling codes at particle impact level, Granular
//! Matter 13, 643 (2011): tests 1 to 8, under `hertz_tsuji`.
//!
//! 1. `elastic`, `oblique`, `spinning`: the cases of each test, as [`collision`]s of [`material`]s;
//! 2. [`collision`] runs each, [`rows`] makes a row of it, and the rows are the test's table;
//! 3. [`theory`] and the laws of sliding give checks; the published points, comparisons and charts.

mod collision;
mod elastic;
mod material;
mod oblique;
mod rows;
mod series;
mod spinning;
mod theory;

use bitgrain_sim::error::Result;

use crate::benchmark::comparison::Published;
use crate::benchmark::result::Benchmark;

const PUBLISHED: &str = include_str!("../../../data/chung-ooi.json");

/// What must be known of these numbers: a title and what it means.
const REMARKS: [(&str, &str); 3] = [
    (
        "Contacts that stick",
        "In tests 5, 6 and 8 a contact that sticks for a time leaves the digitised curves, by a tenth of their span \
         on the mean and up to a third. LAMMPS and LIGGGHTS do so with the same law. In test 5 the finite-element \
         points that the paper shows are nearer to our curve. Nothing is fitted.",
    ),
    (
        "Contacts that slide at a restitution of 0.5",
        "The law holds its tangential spring to mu times the normal force; below that a damper adds to it, and as the \
         bodies part the normal force pulls. So in tests 6 and 8 sliding takes a tenth more than the grey line's mu \
         (1 + e) of the normal momentum.",
    ),
    (
        "Levers",
        "The law's levers are the radii less half the overlap. What theory says of spins is corrected for it.",
    ),
];

/// Runs all eight tests.
pub(super) fn run() -> Result<Benchmark> {
    let published: Published = crate::json::parse(PUBLISHED, "data/chung-ooi.json")?;
    let tests = vec![
        elastic::spheres(&published)?,
        elastic::wall(&published)?,
        elastic::restitution()?,
        oblique::angles(&published)?,
        oblique::speeds(&published)?,
        spinning::on_wall(&published)?,
        spinning::alike()?,
        spinning::on_sphere(&published)?,
    ];
    Ok(Benchmark {
        name: "chung-ooi",
        title: "Benchmark of single impacts by Chung and Ooi",
        source: "Y. C. Chung and J. Y. Ooi, Granular Matter 13, 643 (2011)",
        published: published.source,
        remarks: REMARKS.to_vec(),
        tests,
        performance: Vec::new(),
    })
}
