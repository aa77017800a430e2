//! Small worlds whose digests are published: a machine that reproduces them keeps the bit contract.
//!
//! Between them they hold every law, obstacle and kind of group. They are written down here and read
//! from nowhere, and all of them fit, one at a time, into one [`Room`]. Where grains begin is worked out by the
//! compiler: to run the worlds in fixed point takes no floating-point operation.

mod worlds;

pub use worlds::{GRAINS, Room};

use crate::blake3::Hasher;
use crate::contact::{
    HertzHistory, HertzTsuji, Law, PairLaws, Rolling, RollingResistance, RollingSpring,
};
use crate::digest::state::digest;
use crate::error::Error;
use crate::math::real::Real;
use crate::step::{start, step};

/// Steps between two lines.
pub const EVERY: u64 = 50;

/// Bytes of a line as text.
pub const LINE: usize = 100;

/// The state that a world has reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// The number type, as `f64`.
    pub real: &'static str,
    /// The world.
    pub world: &'static str,
    /// Steps done.
    pub step: u64,
    /// Digest of the whole state.
    pub digest: [u8; 32],
}

impl Line {
    /// `f64 collapse-hertz_history        50 DIGEST` and a line feed: the same bytes everywhere.
    pub fn text(&self) -> [u8; LINE] {
        let mut out = [b' '; LINE];
        let mut put = |at: usize, byte: u8| {
            if let Some(slot) = out.get_mut(at) {
                *slot = byte;
            }
        };
        for (k, byte) in self.real.bytes().enumerate() {
            put(k, byte);
        }
        let after = if self.real.len() > 3 {
            self.real.len() + 1
        } else {
            4
        };
        for (k, byte) in self.world.bytes().enumerate() {
            put(after + k, byte);
        }
        let mut left = self.step;
        for k in 0..6 {
            if left > 0 || k == 0 {
                put(33 - k, b'0' + (left % 10) as u8);
            }
            left /= 10;
        }
        for (k, byte) in self.digest.iter().enumerate() {
            put(35 + 2 * k, hexadecimal(byte >> 4));
            put(36 + 2 * k, hexadecimal(byte & 15));
        }
        put(LINE - 1, b'\n');
        out
    }
}

/// The line that ends a list: the hash of all lines above it, as text.
pub fn last(all: &Hasher) -> Line {
    Line {
        real: "all",
        world: "lines above",
        step: 0,
        digest: all.finish(),
    }
}

/// The digit of a number below 16.
fn hexadecimal(four_bits: u8) -> u8 {
    if four_bits < 10 {
        b'0' + four_bits
    } else {
        b'a' + four_bits - 10
    }
}

/// The worlds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum World {
    /// Eighteen grains of every kind fall on a row of frozen ones, a row of free ones and a row that
    /// is carried, over a floor, past a ball and a bar that move.
    CollapseHistory,
    /// The same under the other law.
    CollapseTsuji,
    /// A bed on a frozen layer comes to rest; then a ball is dragged through it.
    Bed,
    /// A base and a heavy lid are carried past a bar, grains without weight between them, under a
    /// ceiling.
    Rig,
    /// The first of two materials, each pair with another resistance to rolling.
    Materials,
}

/// The law of a stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StageLaw {
    /// [`history`] with this damping (1 / (time length)).
    History(f64),
    /// [`tsuji`].
    Tsuji,
    /// [`materials`].
    Materials,
}

/// A stage of a world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage {
    /// Up to this step.
    pub last: u64,
    /// Under this law.
    pub law: StageLaw,
    /// What the first obstacle's speed along x becomes, if it changes.
    pub speed: Option<f64>,
}

impl World {
    /// In the order in which they are run.
    pub const ALL: [Self; 5] = [
        Self::CollapseHistory,
        Self::CollapseTsuji,
        Self::Bed,
        Self::Rig,
        Self::Materials,
    ];

    /// What a line calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::CollapseHistory => "collapse-hertz_history",
            Self::CollapseTsuji => "collapse-hertz_tsuji",
            Self::Bed => "bed",
            Self::Rig => "rig",
            Self::Materials => "materials-rolling",
        }
    }

    /// Its stages, one after the other.
    pub fn stages(self) -> &'static [Stage] {
        const fn stage(last: u64, law: StageLaw, speed: Option<f64>) -> Stage {
            Stage { last, law, speed }
        }
        use StageLaw::{History, Materials, Tsuji};
        match self {
            Self::CollapseHistory => const { &[stage(600, History(50.0), None)] },
            Self::CollapseTsuji => const { &[stage(600, Tsuji, None)] },
            // Damped at first, the bed is at rest before the ball sets off.
            Self::Bed => {
                const {
                    &[
                        stage(800, History(300.0), None),
                        stage(1300, History(50.0), Some(1.0)),
                    ]
                }
            }
            Self::Rig => const { &[stage(800, Tsuji, None)] },
            Self::Materials => const { &[stage(600, Materials, None)] },
        }
    }

    /// Makes it in `room`, whatever was there; not yet started.
    ///
    /// # Errors
    /// None, since [`Room`] is large enough for every world.
    // Inlined, what it keeps on the stack would stay there through the steps.
    #[inline(never)]
    pub fn lay<R: Real>(self, room: &mut Room<R>) -> Result<(), Error> {
        match self {
            Self::CollapseHistory | Self::CollapseTsuji => worlds::collapse(room, 0),
            Self::Materials => worlds::collapse(room, 1),
            Self::Bed => worlds::bed(room),
            Self::Rig => worlds::rig(room),
        }
    }
}

/// Runs every world in `room`, shows a line at step 0 and every [`EVERY`] steps, and takes the same
/// lines, as text, into `all`.
///
/// # Errors
/// What stops a world. On a machine that keeps the contract, nothing does.
pub fn run<R: Real>(
    room: &mut Room<R>,
    all: &mut Hasher,
    mut show: impl FnMut(&Line),
) -> Result<(), Error> {
    for one in World::ALL {
        let mut tell = |step: u64, digest: [u8; 32]| {
            let line = Line {
                real: R::NAME,
                world: one.name(),
                step,
                digest,
            };
            for four in line.text().as_chunks().0 {
                all.word(u32::from_le_bytes(*four));
            }
            show(&line);
        };
        one.lay(room)?;
        for stage in one.stages() {
            if let (Some(speed), Some(body)) = (stage.speed, room.world().obstacles.first_mut()) {
                body.velocity[0] = R::from_f64(speed);
            }
            match stage.law {
                StageLaw::History(gamma) => follow(room, &history(gamma), stage.last, &mut tell)?,
                StageLaw::Tsuji => follow(room, &tsuji(), stage.last, &mut tell)?,
                StageLaw::Materials => {
                    let laws = materials();
                    let table = PairLaws::new(MATERIALS, &laws).ok_or(Error::BadStorage)?;
                    follow(room, &table, stage.last, &mut tell)?;
                }
            }
        }
    }
    Ok(())
}

/// Goes on to step `last`, reporting the digest of step 0 and of every [`EVERY`]th.
#[inline(never)]
fn follow<R: Real, L: Law<R>>(
    room: &mut Room<R>,
    law: &L,
    last: u64,
    tell: &mut dyn FnMut(u64, [u8; 32]),
) -> Result<(), Error> {
    let mut world = room.world();
    if world.clock.step == 0 {
        start(&mut world, law)?;
        tell(0, digest(&world)?.whole);
    }
    while world.clock.step < last {
        step(&mut world, law)?;
        if world.clock.step.is_multiple_of(EVERY) {
            tell(world.clock.step, digest(&world)?.whole);
        }
    }
    Ok(())
}

/// The law of a stage with damping.
pub fn history<R: Real>(gamma: f64) -> HertzHistory<R> {
    let [kn, kt, gamma, mu] = [2e3, 2.45e3, gamma, 0.5].map(R::from_f64);
    HertzHistory {
        kn,
        kt,
        gamma_n: gamma,
        gamma_t: gamma,
        mu,
    }
}

/// How many materials [`materials`] has.
pub const MATERIALS: u8 = 2;

/// The law of two materials for [`PairLaws`]: grains of the first resist rolling on each other by `sds`, on the second
/// by `epsd2`, and those of the second do not; all with the numbers of [`tsuji`], but for a stiffer, less rough pair.
pub fn materials<R: Real>() -> [Rolling<R, HertzTsuji<R>>; 3] {
    let law = tsuji();
    let [k, gamma, little, much, mu] = [60.0, 0.25, 0.0625, 0.125, 0.25].map(R::from_f64);
    let resistance = |spring, mu| RollingResistance {
        spring,
        k,
        gamma,
        mu,
    };
    let other = HertzTsuji {
        kn: law.kn + law.kn * R::HALF,
        mu,
        ..law
    };
    [
        Rolling {
            law,
            resistance: resistance(RollingSpring::Sds, little),
        },
        Rolling {
            law: other,
            resistance: resistance(RollingSpring::Epsd2, much),
        },
        Rolling {
            law,
            resistance: RollingResistance::NONE,
        },
    ]
}

/// The law of a stage without damping of its own: [`HertzTsuji::new`] of 4e3, 0.3, 0.6 and 0.5.
pub fn tsuji<R: Real>() -> HertzTsuji<R> {
    let [kn, kt, cn, ct, mu] = TSUJI.map(R::from_f64);
    HertzTsuji { kn, kt, cn, ct, mu }
}

const TSUJI: [f64; 5] = [
    2930.4029304029305,
    3619.9095022624433,
    19.426962128624698,
    17.629680864713972,
    0.5,
];
