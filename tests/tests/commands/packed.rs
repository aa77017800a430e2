//! The contact block of a release binary, disassembled: its square roots and divisions are packed, so
//! that a change which loses the wide registers is seen although it changes no bit. Compilers leave
//! loops over single contacts beside the wide ones; that those do not run is seen in the
//! counts of `instructions.rs`.
#![cfg(all(target_arch = "x86_64", target_os = "linux", not(debug_assertions)))]

use std::path::Path;
use std::process::Command;

use object::{Object, ObjectSymbol};

use crate::PROGRAM;

/// Start and end of every function whose name holds this.
fn functions(name: &str) -> Vec<(u64, u64)> {
    let bytes = std::fs::read(PROGRAM).unwrap();
    let program = object::File::parse(bytes.as_slice()).unwrap();
    let named = program
        .symbols()
        .filter(|s| s.name().is_ok_and(|n| n.contains(name)));
    named
        .map(|s| (s.address(), s.address() + s.size()))
        .collect()
}

/// The instructions between two addresses, as text.
fn disassembled((from, to): (u64, u64)) -> Vec<String> {
    let out = Command::new("objdump")
        .args(["-d", "--no-show-raw-insn"])
        .args([
            format!("--start-address={from}"),
            format!("--stop-address={to}"),
        ])
        .arg(Path::new(PROGRAM))
        .output()
        .expect("objdump, of the binutils that a linker comes with");
    assert!(out.status.success());
    let text = String::from_utf8(out.stdout).unwrap();
    let lines = text.lines().filter_map(|line| line.split_once(":\t"));
    lines
        .map(|(_, instruction)| instruction.to_string())
        .collect()
}

/// How many instructions begin with one of these words and use such a register.
fn count(code: &[String], words: &[&str], register: &str) -> usize {
    let is = |line: &&String| {
        let word = line.split_whitespace().next().unwrap_or("");
        words.contains(&word) && line.contains(register)
    };
    code.iter().filter(is).count()
}

/// Blocks of both laws, in functions of this name: packed roots and divisions in each.
fn check(name: &str, packed: [&str; 2], register: &str) {
    let functions = functions(name);
    assert!(!functions.is_empty(), "no function {name} in the binary");
    let mut blocks = 0;
    for at in functions {
        let code = disassembled(at);
        let roots = count(&code, &packed[..1], register);
        let divisions = count(&code, &packed[1..], register);
        // hertz_history takes 3 roots and 4 divisions of a contact, hertz_tsuji 4 and 4. Kicks and
        // obstacles, a body at a time, are other functions.
        if roots >= 3 && divisions >= 4 {
            blocks += 1;
        }
    }
    assert!(
        blocks >= 2,
        "{name}: {blocks} blocks with packed roots and divisions"
    );
}

#[test]
fn the_contact_block_is_packed() {
    check("avx2_avx2_version", ["vsqrtpd", "vdivpd"], "ymm");
    check("avx512_avx512", ["vsqrtpd", "vdivpd"], "zmm");
}
