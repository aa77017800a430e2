//! Which registers a step uses: with which instructions it is compiled, and so how many contacts it
//! evaluates at once. It has no effect on any bit.

#[cfg(not(test))]
use multiversion::multiversion;
use serde::{Deserialize, Serialize};

/// Work compiled for several instruction sets.
pub(crate) trait Kernel {
    /// What it returns.
    type Output;
    /// Does it. An implementation is `#[inline(always)]`, or it is not compiled for the instructions
    /// of its caller.
    fn run(self) -> Self::Output;
}

/// Sets of instructions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Isa {
    /// What every machine of the target has.
    Plain,
    /// AVX2: four contacts at once.
    Avx2,
    /// AVX-512, of the machines that do not slow down for it: Ice Lake and later.
    Avx512,
}

impl Isa {
    /// Those that this machine has, the plainest first.
    pub fn all() -> Vec<Self> {
        let (avx2, avx512) = detect();
        let here = |registers: &Self| match registers {
            Self::Plain => true,
            Self::Avx2 => avx2,
            Self::Avx512 => avx512,
        };
        let every = [Self::Plain, Self::Avx2, Self::Avx512];
        every.into_iter().filter(here).collect()
    }

    /// The widest that this machine has.
    pub fn best() -> Self {
        match detect() {
            (_, true) => Self::Avx512,
            (true, _) => Self::Avx2,
            _ => Self::Plain,
        }
    }

    /// Does a job; if the machine lacks the instructions, with those it has.
    pub(crate) fn run<J: Kernel>(self, job: J) -> J::Output {
        match self {
            Self::Plain => job.run(),
            #[cfg(not(test))]
            Self::Avx2 => avx2(job),
            #[cfg(not(test))]
            Self::Avx512 => avx512(job),
            #[cfg(test)]
            Self::Avx2 | Self::Avx512 => job.run(),
        }
    }
}

// The tests of this crate are of what steps do, those of `matrix` of all instructions too: here they would have the
// passes of a step compiled twice more.
#[cfg(all(target_arch = "x86_64", not(test)))]
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

#[cfg(any(not(target_arch = "x86_64"), test))]
fn detect() -> (bool, bool) {
    (false, false)
}

#[cfg(not(test))]
#[multiversion(targets("x86_64+avx2"))]
fn avx2<J: Kernel>(job: J) -> J::Output {
    job.run()
}

#[cfg(not(test))]
#[multiversion(targets("x86_64+avx512f+avx512vl"))]
fn avx512<J: Kernel>(job: J) -> J::Output {
    job.run()
}
