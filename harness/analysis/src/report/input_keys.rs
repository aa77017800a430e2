//! The keys of a scenario, in the order of the page: what each counts and means.

/// What a number of the scenario counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// No number, or one without a unit.
    Bare,
    Length,
    Time,
    Speed,
    Force,
    Acceleration,
    Density,
    /// Stiffnesses and moduli.
    Pressure,
    /// Damping per mass and square root of area: 1 / (length time).
    Damping,
}

/// A table of the scenario, its name in words, and its keys in the order of the page: key, what
/// it counts, meaning as markup.
pub(super) type Group = (
    &'static str,
    &'static str,
    &'static [(&'static str, Kind, &'static str)],
);

pub(super) const GROUPS: [Group; 7] = [
    (
        "",
        "The experiment",
        &[
            ("name", Kind::Bare, "of the scenario and its folder"),
            ("units", Kind::Bare, "system in which all inputs are given"),
            ("seed", Kind::Bare, "of every random number"),
            ("seeds", Kind::Bare, "several: each has its own beds"),
            ("gravity", Kind::Acceleration, "along &minus;z"),
        ],
    ),
    (
        "bed",
        "The bed",
        &[
            (
                "file",
                Kind::Bare,
                "LAMMPS file that the bed comes from, instead of pouring",
            ),
            ("hash", Kind::Bare, "BLAKE3 of that file&rsquo;s text"),
            (
                "box",
                Kind::Length,
                "size along x and y, periodic unless it is a tank, and the height that the bed may fill",
            ),
            ("container", Kind::Bare, "what holds the bed at its sides"),
            ("grains", Kind::Bare, "how many, the intruder not counted"),
            (
                "fill_height",
                Kind::Length,
                "height to fill at a packing fraction of 0.6; gives the number of grains",
            ),
            (
                "diameters",
                Kind::Length,
                "of the grains, uniform between the two",
            ),
            ("density", Kind::Density, "of a grain"),
            (
                "base",
                Kind::Length,
                "grains that settle with their centres below this height are frozen",
            ),
            (
                "floor",
                Kind::Bare,
                "whether a plane at z = 0 lies under the base",
            ),
            (
                "pouring",
                Kind::Bare,
                "<code>at_once</code>, or <code>in_turn</code>: up to the intruder first, then over it",
            ),
            (
                "pouring_mu",
                Kind::Bare,
                "friction coefficient while the bed is poured; from its last rest on it is &mu; of the law",
            ),
            (
                "settled",
                Kind::Bare,
                "the bed is at rest when its kinetic energy per grain, over the mean weight times \
                 d, is below this",
            ),
        ],
    ),
    (
        "law",
        "The contact law",
        &[
            (
                "kind",
                Kind::Bare,
                "<code>hertz_history</code>: Kumar 2018, eqs. 1 and 2; <code>hertz_tsuji</code>: \
                 Guillard 2014, eq. A1",
            ),
            ("kn", Kind::Pressure, "normal stiffness K<sub>n</sub>"),
            ("kt", Kind::Pressure, "tangential stiffness K<sub>t</sub>"),
            (
                "gamma_n",
                Kind::Damping,
                "normal damping &gamma;<sub>n</sub>",
            ),
            (
                "gamma_t",
                Kind::Damping,
                "tangential damping &gamma;<sub>t</sub>",
            ),
            ("young", Kind::Pressure, "Young&rsquo;s modulus E"),
            ("poisson", Kind::Bare, "Poisson&rsquo;s ratio &nu;"),
            ("restitution", Kind::Bare, "coefficient of restitution e"),
            ("mu", Kind::Bare, "friction coefficient &mu;"),
        ],
    ),
    (
        "intruder",
        "The intruder",
        &[
            (
                "shape",
                Kind::Bare,
                "a sphere, a cylinder along y, as long as the box is wide, or a bar in a tank",
            ),
            ("diameter", Kind::Length, "D of the sphere"),
            ("length", Kind::Length, "L of the bar"),
            (
                "density",
                Kind::Density,
                "as it enters the effective mass of its contacts",
            ),
            (
                "height",
                Kind::Length,
                "of its centre above z = 0; a bed for each value",
            ),
            (
                "depth",
                Kind::Length,
                "of its centre below the surface expected at a packing fraction of 0.6; a bed for \
                 each value",
            ),
            ("speed", Kind::Speed, "V along x; a run for each value"),
            (
                "froude",
                Kind::Bare,
                "Froude number 2 V &radic;(2 D/g)/(D + d); a run for each value",
            ),
            (
                "motion",
                Kind::Bare,
                "what moves it: dragged, dropped, pulled, floating",
            ),
            (
                "drop_height",
                Kind::Length,
                "of its lowest point above the free surface; a run for each value",
            ),
            ("force", Kind::Force, "along x; a run for each value"),
            ("rises", Kind::Bare, "whether it is free along z too"),
            ("spins", Kind::Bare, "whether it spins freely"),
        ],
    ),
    (
        "lid",
        "The lid",
        &[
            (
                "effective_depth",
                Kind::Length,
                "h + (&pi; d/6)(&rho;<sub>lid</sub>/&rho;) of the intruder&rsquo;s centre; a bed for \
                 each value",
            ),
            (
                "density",
                Kind::Density,
                "of the lid&rsquo;s grains, instead",
            ),
            (
                "pressure_gradient",
                Kind::Bare,
                "whether the bed below the lid has weight: with, without, or a bed of each kind",
            ),
        ],
    ),
    (
        "drag",
        "The drag",
        &[
            ("dt", Kind::Time, "time step, also of the pouring"),
            (
                "moves",
                Kind::Bare,
                "the intruder, or the bed, carried past it by base and lid",
            ),
            (
                "distance",
                Kind::Length,
                "travel: one for all speeds, or one for each",
            ),
            (
                "duration",
                Kind::Time,
                "after which drops or pulls end: one for all, or one for each",
            ),
            (
                "own_wake",
                Kind::Bare,
                "whether the travel may be longer than the box, into the intruder&rsquo;s own wake",
            ),
            ("discard", Kind::Length, "travel left out of the means"),
            (
                "history",
                Kind::Bare,
                "tangential springs of the settled bed as the drag begins: kept, or empty as in a \
                 LAMMPS run from a file",
            ),
        ],
    ),
    (
        "measure",
        "Output",
        &[
            (
                "every",
                Kind::Bare,
                "steps between rows of the force series",
            ),
            ("torque", Kind::Bare, "whether the series holds the torque"),
            (
                "contacts",
                Kind::Bare,
                "whether the series holds the number of contacts, their mean angle and the \
                 coordination number near the intruder",
            ),
            ("snapshots", Kind::Bare, "snapshots of each drag"),
            (
                "energy",
                Kind::Bare,
                "whether the energy of each drag is accounted for",
            ),
            ("gzip", Kind::Bare, "whether LAMMPS files are packed"),
            (
                "checkpoints",
                Kind::Bare,
                "checkpoints kept of each drag, between which it can be verified",
            ),
            (
                "digest_every",
                Kind::Bare,
                "steps between links of each drag&rsquo;s chain of digests",
            ),
            (
                "reaches",
                Kind::Length,
                "distances from the intruder within which coordination numbers are measured, besides 2 d",
            ),
            (
                "fields.grid",
                Kind::Bare,
                "points along x, y and z at which fields are averaged",
            ),
            (
                "fields.window",
                Kind::Length,
                "radius of the spherical averaging windows",
            ),
            (
                "fields.every",
                Kind::Bare,
                "steps between samples of the fields",
            ),
        ],
    ),
];
