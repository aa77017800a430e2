//! Which registers a step uses: how many contacts it evaluates at once, and with which instructions.
//! It has no effect on any bit.

use multiversion::multiversion;

/// Work compiled for several instruction sets, `W` contacts at once.
pub(crate) trait Job {
    /// What it returns.
    type Output;
    /// Does it. An implementation is `#[inline(always)]`, or it is not compiled for the instructions
    /// of its caller.
    fn run<const W: usize>(self) -> Self::Output;
}

/// Lanes and instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Registers {
    /// One lane, with what every machine of the target has.
    One,
    /// Four lanes, with what every machine of the target has.
    Four,
    /// Four lanes in AVX2.
    Avx2,
    /// Eight lanes in AVX-512, of the machines that do not slow down for it: Ice Lake and later.
    Avx512,
}

impl Registers {
    /// Those that this machine has, the plainest first.
    pub fn all() -> Vec<Self> {
        let (avx2, avx512) = detect();
        let here = |registers: &Self| match registers {
            Self::One | Self::Four => true,
            Self::Avx2 => avx2,
            Self::Avx512 => avx512,
        };
        let every = [Self::One, Self::Four, Self::Avx2, Self::Avx512];
        every.into_iter().filter(here).collect()
    }

    /// The fastest that this machine has. Eight lanes are not: rows of pairs are shorter.
    pub fn best() -> Self {
        if detect().0 { Self::Avx2 } else { Self::Four }
    }

    /// Does a job; where the machine lacks the instructions, with those it has.
    pub(crate) fn run<J: Job>(self, job: J) -> J::Output {
        match self {
            Self::One => job.run::<1>(),
            Self::Four => job.run::<4>(),
            Self::Avx2 => avx2(job),
            Self::Avx512 => avx512(job),
        }
    }
}

#[cfg(target_arch = "x86_64")]
fn detect() -> (bool, bool) {
    let avx2 = std::is_x86_feature_detected!("avx2");
    // Machines with all of it do not slow down for it.
    let wide =
        std::is_x86_feature_detected!("avx512f") && std::is_x86_feature_detected!("avx512vl");
    let late = std::is_x86_feature_detected!("avx512vbmi2")
        && std::is_x86_feature_detected!("avx512bitalg")
        && std::is_x86_feature_detected!("gfni")
        && std::is_x86_feature_detected!("vaes");
    (avx2, wide && late)
}

#[cfg(not(target_arch = "x86_64"))]
fn detect() -> (bool, bool) {
    (false, false)
}

#[multiversion(targets("x86_64+avx2"))]
fn avx2<J: Job>(job: J) -> J::Output {
    job.run::<4>()
}

#[multiversion(targets("x86_64+avx512f+avx512vl"))]
fn avx512<J: Job>(job: J) -> J::Output {
    job.run::<8>()
}
