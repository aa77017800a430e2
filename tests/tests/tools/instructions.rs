//! Instructions of 200 steps, counted by valgrind, against `golden/instructions.csv`: a step that became
//! slower is seen although clocks are noisy.
#![cfg(all(target_arch = "x86_64", target_os = "linux", not(debug_assertions)))]

use std::process::Command;

use bitgrain_tests::golden;

/// Instructions of a whole program, and what it printed.
fn count(registers: &str, steps: u64) -> (u64, String) {
    let out = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .args([env!("CARGO_BIN_EXE_settled"), registers, &steps.to_string()])
        .output()
        .expect("valgrind, of the package of that name");
    let told = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "{told}");
    let count = told.lines().find_map(|line| line.split_once("Collected :"));
    let (_, count) = count.expect("a number of instructions");
    let count = count.trim().parse().expect("a number of instructions");
    (count, String::from_utf8_lossy(&out.stdout).into_owned())
}

/// The numbers of a golden row are what was counted, less and more a twentieth.
#[test]
#[ignore = "takes valgrind"]
fn a_step_takes_as_many_instructions_as_before() {
    let text = std::fs::read_to_string(golden("instructions.csv")).unwrap();
    let mut wrong = Vec::new();
    let mut digests = Vec::new();
    for row in text.lines().skip(1) {
        let fields: Vec<&str> = row.split(',').collect();
        let [registers, least, most] = fields.as_slice() else {
            panic!("{row}");
        };
        if *registers == "avx2" && !std::is_x86_feature_detected!("avx2") {
            println!("this machine has no AVX2");
            continue;
        }
        let (few, _) = count(registers, 20);
        let (many, digest) = count(registers, 220);
        digests.push(digest);
        let steps = many - few;
        println!("{registers}: {steps} instructions in 200 steps");
        let (least, most): (u64, u64) = (least.parse().unwrap(), most.parse().unwrap());
        if steps < least || steps > most {
            let (low, high) = (steps - steps / 20, steps + steps / 20);
            wrong.push(format!(
                "{steps} instructions, not {least} to {most}; `{registers},{low},{high}` would hold them"
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(
        digests.windows(2).all(|two| two[0] == two[1]),
        "{digests:?}"
    );
}
