//! The contact law of a world: of one material, or a table of those of each pair of several.

use bitgrain_kernel::contact::{
    HertzHistory, HertzTsuji, Law as Contacts, PairLaws, Rolling, RollingResistance, RollingSpring,
};

use crate::arguments::{give, take};
use crate::block::{Law, Parts, Row, as_tsuji, with};
use crate::setup::code;
use crate::status::{
    BG_BAD_ARGUMENT, BG_BAD_LAW, BG_BAD_SIZE, BG_FOREIGN, BG_LAW_MISFIT, Done, fault,
};
use crate::types::{
    BG_HERTZ_HISTORY, BG_HERTZ_TSUJI, BG_NO_ROLLING, BG_ROLLING_EPSD2, BG_ROLLING_SDS, bg_fault,
    bg_law, bg_world,
};

/// What a table holds of a pair with this law, if it makes sense.
pub(crate) fn row_of(law: &bg_law) -> Result<Row, bg_fault> {
    if law.size as usize != size_of::<bg_law>() {
        return Err(fault(BG_BAD_SIZE));
    }
    let others = [
        law.kt,
        law.gamma_n,
        law.gamma_t,
        law.mu,
        law.rolling_k,
        law.rolling_gamma,
        law.rolling_mu,
    ];
    let is_sound = |number: &f64| *number >= 0.0 && number.is_finite();
    if !(law.kn > 0.0 && law.kn.is_finite() && others.iter().all(is_sound)) {
        return Err(fault(BG_BAD_LAW));
    }
    let spring = match law.rolling {
        BG_NO_ROLLING => None,
        BG_ROLLING_SDS => Some(RollingSpring::Sds),
        BG_ROLLING_EPSD2 => Some(RollingSpring::Epsd2),
        _ => return Err(fault(BG_BAD_ARGUMENT)),
    };
    let own = |spring| RollingResistance {
        spring,
        k: law.rolling_k,
        gamma: law.rolling_gamma,
        mu: law.rolling_mu,
    };
    Ok(Rolling {
        law: HertzHistory {
            kn: law.kn,
            kt: law.kt,
            gamma_n: law.gamma_n,
            gamma_t: law.gamma_t,
            mu: law.mu,
        },
        resistance: spring.map_or(RollingResistance::NONE, own),
    })
}

/// A law of this kind with the numbers of one material, without resistance to rolling.
pub(crate) fn law_of(kind: u32, row: &Row) -> Result<Law, bg_fault> {
    let HertzHistory {
        kn,
        kt,
        gamma_n,
        gamma_t,
        mu,
    } = row.law;
    let law = Law {
        kind,
        materials: 0,
        numbers: [kn, kt, gamma_n, gamma_t, mu],
    };
    match kind {
        BG_HERTZ_HISTORY | BG_HERTZ_TSUJI => Ok(law),
        _ => Err(fault(BG_BAD_ARGUMENT)),
    }
}

/// A law of this kind whose numbers are those of the table, of so many materials, which begins with this row.
pub(crate) fn table_of(kind: u32, materials: u32, first: &Row) -> Result<Law, bg_fault> {
    let materials = material(materials)?.into();
    let law = law_of(kind, first)?;
    Ok(Law { materials, ..law })
}

/// A number of a material.
pub(crate) fn material(number: u32) -> Result<u8, bg_fault> {
    u8::try_from(number).map_err(|_| fault(BG_BAD_ARGUMENT))
}

/// The kind of a law, and how many materials its table is of; none of a law of one.
pub(crate) fn kind_of(law: &Law) -> (u32, Option<u8>) {
    let materials = u8::try_from(law.materials).ok();
    (law.kind, materials.filter(|count| *count > 0))
}

/// Something to do with the law of a world.
pub(crate) trait WithLaw {
    /// Does it.
    fn run(self, parts: &mut Parts<'_>, law: &impl Contacts<f64>) -> Done;
}

/// Does something with a world and its law, whichever it is: it is compiled for each.
pub(crate) fn with_law(parts: &mut Parts<'_>, what: impl WithLaw) -> Done {
    let [kn, kt, gamma_n, gamma_t, mu] = parts.law.numbers;
    match kind_of(parts.law) {
        (BG_HERTZ_HISTORY, None) => {
            let law = HertzHistory {
                kn,
                kt,
                gamma_n,
                gamma_t,
                mu,
            };
            what.run(parts, &law)
        }
        (BG_HERTZ_TSUJI, None) => {
            let (cn, ct) = (gamma_n, gamma_t);
            what.run(parts, &HertzTsuji { kn, kt, cn, ct, mu })
        }
        (BG_HERTZ_HISTORY, Some(materials)) => {
            tabled(parts, |table| PairLaws::new(materials, table), what)
        }
        (BG_HERTZ_TSUJI, Some(materials)) => tabled(
            parts,
            |table| PairLaws::new(materials, as_tsuji(table)),
            what,
        ),
        _ => Err(fault(BG_FOREIGN)),
    }
}

/// The same with the law that the table makes; without the feature there is none.
fn tabled<'a, L: Contacts<f64> + 'a>(
    parts: &mut Parts<'a>,
    law: impl FnOnce(&'a [Row]) -> Option<PairLaws<'a, L>>,
    what: impl WithLaw,
) -> Done {
    if !cfg!(feature = "materials") {
        return Err(fault(BG_LAW_MISFIT));
    }
    // The parts are borrowed for one call, and this is the last that it does with the table.
    let table = core::mem::take(&mut parts.table);
    match law(table) {
        Some(law) => what.run(parts, &law),
        None => Err(fault(BG_LAW_MISFIT)),
    }
}

/// Sets the law between two materials, in either order, from now on. `law` is of the kind of the world's; at first all
/// pairs have that of `bg_config`. Materials are numbered from 0, below `bg_capacity.materials`.
#[unsafe(no_mangle)]
pub extern "C" fn bg_set_pair_law(world: *mut bg_world, a: u32, b: u32, law: *const bg_law) -> i32 {
    with(world, |parts| {
        let law = take(law)?;
        let row = row_of(&law)?;
        let (kind, materials) = kind_of(parts.law);
        let Some(count) = materials else {
            return Err(fault(BG_LAW_MISFIT));
        };
        let pair = [material(a)?, material(b)?];
        let [low, high] = if a < b { pair } else { [pair[1], pair[0]] };
        let place = PairLaws::<()>::pairs(count).position(|other| other == [low, high]);
        let entry = place.and_then(|place| parts.table.get_mut(place));
        match (entry, law.kind == kind) {
            (Some(entry), true) => {
                *entry = row;
                Ok(())
            }
            _ => Err(fault(BG_BAD_ARGUMENT)),
        }
    })
}

/// Sets `out` to the law of Guillard 2014 from Young's modulus (pressure), Poisson's ratio (-1 to 0.5), the coefficient
/// of restitution (0 to 1, 0 excluded) and the friction coefficient.
#[unsafe(no_mangle)]
pub extern "C" fn bg_law_hertz_tsuji(
    young: f64,
    poisson: f64,
    restitution: f64,
    mu: f64,
    out: *mut bg_law,
) -> i32 {
    code(give(
        out,
        for_c(&HertzTsuji::new(young, poisson, restitution, mu)),
    ))
}

/// The same between two materials, each with Young's modulus and Poisson's ratio in `a` and `b`: for
/// `bg_set_pair_law`.
#[unsafe(no_mangle)]
pub extern "C" fn bg_law_hertz_tsuji_between(
    a: *const f64,
    b: *const f64,
    restitution: f64,
    mu: f64,
    out: *mut bg_law,
) -> i32 {
    let make = || {
        let two = |from| {
            let numbers = crate::arguments::lent(from, 2)?;
            numbers.try_into().map_err(|_| fault(BG_BAD_ARGUMENT))
        };
        let both: [[f64; 2]; 2] = [two(a)?, two(b)?];
        give(out, for_c(&HertzTsuji::between(both, restitution, mu)))
    };
    code(make())
}

/// A law as C sees it.
fn for_c(law: &HertzTsuji<f64>) -> bg_law {
    bg_law {
        size: size_of::<bg_law>() as u32,
        kind: BG_HERTZ_TSUJI,
        kn: law.kn,
        kt: law.kt,
        gamma_n: law.cn,
        gamma_t: law.ct,
        mu: law.mu,
        rolling: BG_NO_ROLLING,
        reserved: 0,
        rolling_k: 0.0,
        rolling_gamma: 0.0,
        rolling_mu: 0.0,
    }
}
