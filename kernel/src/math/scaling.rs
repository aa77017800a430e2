//! Whether a fixed-point type holds a world: each product of a step beside the largest number and the spacing of the
//! type, worked out before the world is made.

use core::fmt;

use crate::math::fixed_point::{FixedPoint, I24F40, I32F32, I40F24};
use crate::math::real::Real;

/// How large the numbers of a world are, in its own units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Normal stiffness of the law, as [`crate::contact::HertzHistory::kn`] or [`crate::contact::HertzTsuji::kn`]
    /// (pressure).
    pub normal_stiffness: f64,
    /// Tangential stiffness likewise (pressure).
    pub tangential_stiffness: f64,
    /// Damping times mass, the larger of both directions (mass / (time length)): `m gamma`.
    pub damping: f64,
    /// Smallest and largest radius of a grain (length).
    pub radius: [f64; 2],
    /// Smallest and largest mass of a grain.
    pub mass: [f64; 2],
    /// Largest overlap of two bodies (length); a hundredth of a radius in most worlds.
    pub overlap: f64,
    /// Largest speed (length / time).
    pub speed: f64,
    /// Time step.
    pub dt: f64,
    /// Largest coordinate (length).
    pub extent: f64,
}

/// A product of a step in a type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margin {
    /// What is multiplied, in the symbols of the laws.
    pub product: &'static str,
    /// Its size in this world.
    pub size: f64,
    /// Bits between it and the largest number of the type; below zero it overflows.
    pub above: i32,
    /// Bits between it and the spacing of the type: its digits.
    pub below: i32,
}

/// How many products are looked at.
pub const PRODUCTS: usize = 9;

/// Fewest bits that a product must have above it, for what is larger than it was said to be.
pub const ABOVE: i32 = 1;
/// Fewest bits of a product: eight are half a per cent.
pub const BELOW: i32 = 8;

/// A product that a type does not hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refusal {
    /// The type.
    pub kind: &'static str,
    /// The product.
    pub margin: Margin,
    /// A type that would do, if there is one.
    pub instead: Option<&'static str>,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Margin {
            product,
            size,
            above,
            below,
        } = self.margin;
        let kind = self.kind;
        if above < ABOVE {
            write!(f, "{product} is {size:.1e}, too large for {kind}")?;
        } else {
            write!(
                f,
                "{product} is {size:.1e}, which has {below} bits in {kind} and needs {BELOW}"
            )?;
        }
        match self.instead {
            Some(other) => write!(f, "; {other} would do"),
            None => write!(
                f,
                "; no type would do: take units in which the grains' diameter, their mass and gravity are near 1"
            ),
        }
    }
}

impl core::error::Error for Refusal {}

/// The products of a step with these scales, in the type `R`. Of sizes that differ between grains the one
/// nearer to a limit counts.
pub fn margins<R: FixedPoint>(scales: &Scales) -> [Margin; PRODUCTS] {
    let s = scales;
    let ([r, big_r], [m, big_m]) = (s.radius, s.mass);
    let contact = libm::sqrt(big_r * s.overlap);
    // Spring and damper of the tangential part.
    let q = s.tangential_stiffness * s.overlap + s.damping * s.speed;
    let pull = q * contact;
    let inertia = |m: f64, r: f64| 1.0 / (0.4 * m * r * r);
    [
        large::<R>("x", s.extent),
        digits::<R>("v dt", s.speed * s.dt),
        large::<R>("v v", s.speed * s.speed),
        digits::<R>("R delta", 0.5 * r * s.overlap),
        large::<R>("k delta^1.5", s.normal_stiffness * s.overlap * contact),
        large::<R>("q q", if q > pull { q * q } else { pull * pull }),
        large::<R>("1/I", inertia(m, r)),
        digits::<R>("1/I of the largest grain", inertia(big_m, big_r)),
        digits::<R>("1/m of the largest grain", 1.0 / big_m),
    ]
}

/// The margins of all products, if the type `R` holds them.
///
/// # Errors
/// The first product that overflows, or has fewer than [`BELOW`] bits.
pub fn check<R: FixedPoint>(scales: &Scales) -> Result<[Margin; PRODUCTS], Refusal> {
    let all = margins::<R>(scales);
    let Some(margin) = first_refused(&all) else {
        return Ok(all);
    };
    let holds = |all: [Margin; PRODUCTS], name| first_refused(&all).is_none().then_some(name);
    let instead = holds(margins::<I32F32>(scales), I32F32::NAME)
        .or_else(|| holds(margins::<I40F24>(scales), I40F24::NAME))
        .or_else(|| holds(margins::<I24F40>(scales), I24F40::NAME));
    Err(Refusal {
        kind: R::NAME,
        margin,
        instead,
    })
}

fn first_refused(all: &[Margin; PRODUCTS]) -> Option<Margin> {
    let refused = |m: &&Margin| m.above < ABOVE || m.below < BELOW;
    all.iter().find(refused).copied()
}

/// A product that must not overflow; of a small one nothing is lost that counts.
fn large<R: FixedPoint>(product: &'static str, size: f64) -> Margin {
    let margin = digits::<R>(product, size);
    let below = if margin.below < BELOW {
        BELOW
    } else {
        margin.below
    };
    Margin { below, ..margin }
}

/// A product that must not overflow and needs its digits.
fn digits<R: FixedPoint>(product: &'static str, size: f64) -> Margin {
    let power = exponent(size);
    Margin {
        product,
        size,
        above: 62 - R::PLACES as i32 - power,
        below: power + R::PLACES as i32,
    }
}

/// The power of two at or below a number; far beyond all types for what is no number above zero.
fn exponent(x: f64) -> i32 {
    let bits = x.to_bits();
    match x > 0.0 && x.is_finite() {
        true => (bits >> 52) as i32 - 1023,
        false if x == 0.0 => -1023,
        false => 1024,
    }
}
