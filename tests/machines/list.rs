//! Every target: what builds it, what runs it, and where Debian has what that takes.

/// What is asked of a target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expect {
    /// The golden text.
    Same,
    /// Any other text: the negative control.
    Different,
    /// No program at all: the kernel refuses the machine.
    Refused,
}

/// The program that a target runs, by its folder under `tests/rigs`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rig {
    /// A program for Linux, with or without a C library.
    Linux,
    /// A WebAssembly module.
    Wasm,
    /// Firmware.
    CortexM,
}

/// A file, or a command on the path, and the Debian packages that bring it.
pub type Need = (&'static str, &'static str);

/// A machine to try.
pub struct Target {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// The compiler's name for it; empty for this machine, with the compiler of the workspace.
    pub triple: &'static str,
    /// Its program.
    pub rig: Rig,
    /// Optimised or debug.
    pub release: bool,
    /// Features of the program.
    pub features: &'static str,
    /// Flags for the compiler.
    pub flags: &'static str,
    /// The linker, where it is not the compiler's own.
    pub linker: &'static str,
    /// What building it takes beside [`CROSS`], which every triple takes.
    pub needs: &'static [Need],
    /// The command that runs it, with `{}` for the program, and the package that brings it.
    pub run: (&'static [&'static str], &'static str),
    /// What must come of it.
    pub expect: Expect,
}

/// Debian's compiler, which has the sources of `core` for every target, and its linker.
pub const CROSS: &[Need] = &[
    ("/usr/bin/rustc", "rustc-web"),
    ("/usr/bin/cargo", "cargo-web"),
    (
        "/usr/lib/rustlib/src/rust/library/core/Cargo.toml",
        "rust-web-src",
    ),
];

const LLD: Need = ("/usr/bin/rust-lld", "rust-web-llvm lld-22");
const CC: Need = ("cc", "gcc libc6-dev");
const ITSELF: (&[&str], &str) = (&["{}"], "");

/// Programs of 32-bit x86 run on any x86-64, with their own C library, and elsewhere in an emulator.
const RUN_X86: (&[&str], &str) = if cfg!(target_arch = "x86_64") {
    let loader = "/usr/i686-linux-gnu/lib/ld-linux.so.2";
    let library = "/usr/i686-linux-gnu/lib";
    (
        &[loader, "--library-path", library, "{}"],
        "libc6-dev-i386-cross",
    )
} else {
    (
        &["qemu-i386", "-L", "/usr/i686-linux-gnu", "{}"],
        "qemu-user",
    )
};

const NEEDS_X86: &[Need] = &[
    ("i686-linux-gnu-gcc", "gcc-i686-linux-gnu"),
    ("/usr/i686-linux-gnu/lib/libc.so", "libc6-dev-i386-cross"),
];

/// This machine, with the compiler of the workspace.
const HOST: Target = Target {
    name: "host",
    about: "this machine",
    triple: "",
    rig: Rig::Linux,
    release: true,
    features: "",
    flags: "",
    linker: "",
    needs: &[CC],
    run: ITSELF,
    expect: Expect::Same,
};

/// All targets, in the order in which they are reported.
pub static TARGETS: &[Target] = &[
    HOST,
    Target {
        name: "host-debug",
        about: "this machine, not optimised",
        release: false,
        ..HOST
    },
    Target {
        name: "host-native",
        about: "this machine, with every instruction that it has",
        flags: "-C target-cpu=native",
        ..HOST
    },
    Target {
        name: "i686",
        about: "32-bit x86 with SSE2, Linux",
        triple: "i686-unknown-linux-gnu",
        linker: "i686-linux-gnu-gcc",
        needs: NEEDS_X86,
        run: RUN_X86,
        ..HOST
    },
    Target {
        name: "aarch64",
        about: "64-bit ARM, Linux",
        triple: "aarch64-unknown-linux-gnu",
        linker: "aarch64-linux-gnu-gcc",
        needs: &[
            ("aarch64-linux-gnu-gcc", "gcc-aarch64-linux-gnu"),
            (
                "/usr/aarch64-linux-gnu/lib/libc.so",
                "libc6-dev-arm64-cross",
            ),
        ],
        run: (
            &["qemu-aarch64", "-L", "/usr/aarch64-linux-gnu", "{}"],
            "qemu-user",
        ),
        ..HOST
    },
    Target {
        name: "riscv64",
        about: "64-bit RISC-V with a floating-point unit, Linux",
        triple: "riscv64gc-unknown-linux-gnu",
        linker: "riscv64-linux-gnu-gcc",
        needs: &[
            ("riscv64-linux-gnu-gcc", "gcc-riscv64-linux-gnu"),
            (
                "/usr/riscv64-linux-gnu/lib/libc.so",
                "libc6-dev-riscv64-cross",
            ),
        ],
        run: (
            &["qemu-riscv64", "-L", "/usr/riscv64-linux-gnu", "{}"],
            "qemu-user",
        ),
        ..HOST
    },
    Target {
        name: "riscv32",
        about: "32-bit RISC-V without a floating-point unit, free-standing",
        triple: "riscv32imac-unknown-none-elf",
        needs: &[LLD],
        run: (&["qemu-riscv32", "{}"], "qemu-user"),
        ..HOST
    },
    Target {
        name: "s390x",
        about: "IBM Z, big-endian, Linux",
        triple: "s390x-unknown-linux-gnu",
        linker: "s390x-linux-gnu-gcc",
        needs: &[
            ("s390x-linux-gnu-gcc", "gcc-s390x-linux-gnu"),
            ("/usr/s390x-linux-gnu/lib/libc.so", "libc6-dev-s390x-cross"),
        ],
        run: (
            &["qemu-s390x", "-L", "/usr/s390x-linux-gnu", "{}"],
            "qemu-user",
        ),
        ..HOST
    },
    Target {
        name: "wasm",
        about: "WebAssembly",
        triple: "wasm32-unknown-unknown",
        rig: Rig::Wasm,
        needs: &[LLD],
        run: (&["node", "run.mjs", "{}"], "nodejs"),
        ..HOST
    },
    Target {
        name: "cortex-m4f",
        about: "Cortex-M4F firmware, single precision in hardware",
        triple: "thumbv7em-none-eabihf",
        rig: Rig::CortexM,
        needs: &[LLD],
        run: (M4F, "qemu-system-arm"),
        ..HOST
    },
    Target {
        name: "cortex-m0",
        about: "Cortex-M0 firmware, no floating-point unit",
        triple: "thumbv6m-none-eabi",
        rig: Rig::CortexM,
        needs: &[LLD],
        run: (M0, "qemu-system-arm"),
        ..HOST
    },
    Target {
        name: "cortex-m0-fixed",
        about: "the same in fixed point alone, without a floating-point operation",
        triple: "thumbv6m-none-eabi",
        rig: Rig::CortexM,
        features: NO_FLOATS,
        needs: &[LLD],
        run: (M0, "qemu-system-arm"),
        ..HOST
    },
    Target {
        name: "i586-refused",
        about: "32-bit x86 without SSE2, which the kernel refuses",
        triple: "i586-unknown-linux-gnu",
        linker: "i686-linux-gnu-gcc",
        needs: NEEDS_X86,
        run: RUN_X86,
        expect: Expect::Refused,
        ..HOST
    },
    Target {
        name: "i586",
        about: "the same against the kernel's will: the negative control",
        triple: "i586-unknown-linux-gnu",
        flags: "--cfg bitgrain_negative_control",
        linker: "i686-linux-gnu-gcc",
        needs: NEEDS_X86,
        run: RUN_X86,
        expect: Expect::Different,
        ..HOST
    },
];

/// The command that runs a program on an emulated board, and ends as the program says.
const fn board(machine: &'static str) -> [&'static str; 12] {
    [
        "qemu-system-arm",
        "-M",
        machine,
        "-nographic",
        "-monitor",
        "none",
        "-serial",
        "none",
        "-semihosting-config",
        "enable=on,target=native",
        "-kernel",
        "{}",
    ]
}

/// An MPS2 board with its Cortex-M4F.
const M4F: &[&str] = &board("mps2-an386");

/// A micro:bit with its Cortex-M0, and 32 kB of RAM, as the larger nRF51 has.
const M0: &[&str] = &[
    "qemu-system-arm",
    "-M",
    "microbit",
    "-global",
    "nrf51-soc.sram-size=32768",
    "-nographic",
    "-monitor",
    "none",
    "-serial",
    "none",
    "-semihosting-config",
    "enable=on,target=native",
    "-kernel",
    "{}",
];

/// The feature of firmware that computes in fixed point alone.
const NO_FLOATS: &str = "no-floats";

impl Target {
    /// Whether it computes in fixed point alone.
    pub fn has_no_floats(&self) -> bool {
        self.features == NO_FLOATS
    }

    /// Whether a board runs it, so that its size counts.
    pub fn is_firmware(&self) -> bool {
        self.rig == Rig::CortexM
    }

    /// Every file and command that it takes.
    pub fn all_needs(&self) -> Vec<Need> {
        let cross = if self.triple.is_empty() { &[] } else { CROSS };
        let runs = self.run.0.first().copied().filter(|first| *first != "{}");
        let runs = runs.filter(|_| self.expect != Expect::Refused);
        let runs = runs.map(|first| (first, self.run.1));
        let needs = cross.iter().chain(self.needs).copied();
        needs.chain(runs).collect()
    }

    /// The Debian packages that bring all it takes, each once.
    pub fn packages(&self) -> Vec<&'static str> {
        packages(&self.all_needs())
    }
}

/// The packages of these needs, each once and in order.
pub fn packages(needs: &[Need]) -> Vec<&'static str> {
    let mut names: Vec<&str> = Vec::new();
    for name in needs.iter().flat_map(|need| need.1.split(' ')) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// The target of this name.
///
/// # Errors
/// A message that names all targets, the likeliest first.
pub fn find(name: &str) -> Result<&'static Target, String> {
    if let Some(found) = TARGETS.iter().find(|target| target.name == name) {
        return Ok(found);
    }
    let mut names: Vec<&str> = TARGETS.iter().map(|target| target.name).collect();
    names.sort_by_key(|known| strsim::damerau_levenshtein(known, name));
    Err(format!(
        "unknown target `{name}`; there are {}",
        names.join(", ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_told_apart() {
        for target in TARGETS {
            assert!(std::ptr::eq(find(target.name).unwrap(), target));
            assert!(!target.about.is_empty() && !target.packages().is_empty());
        }
    }

    #[test]
    fn an_unknown_name_is_answered_with_the_nearest() {
        let told = find("cortex-m4").err().unwrap();
        assert!(told.contains("`cortex-m4`; there are cortex-m4f, cortex-m0,"));
        assert!(TARGETS.iter().all(|target| told.contains(target.name)));
    }

    #[test]
    fn a_build_that_must_fail_needs_no_emulator() {
        let packages = find("s390x").unwrap().packages();
        let all =
            "rustc-web cargo-web rust-web-src gcc-s390x-linux-gnu libc6-dev-s390x-cross qemu-user";
        assert_eq!(packages.join(" "), all);
        assert_eq!(find("host").unwrap().packages(), ["gcc", "libc6-dev"]);
        let needs = |name| find(name).unwrap().all_needs().len();
        assert_eq!(needs("i586-refused") + 1, needs("i586"));
    }
}
