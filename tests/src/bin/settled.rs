//! Steps a settled bed of 2,500 grains on one thread, with a fixed skin, and prints its digest: the program whose
//! instructions are counted.
//!
//! `settled REGISTERS STEPS`, with `plain` or `avx2`.

use bitgrain::isa::Isa;
use bitgrain::simulation::hex;
use bitgrain_tests::settled_bed;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [registers, steps] = arguments.as_slice() else {
        panic!("settled REGISTERS STEPS");
    };
    let mut sim = settled_bed();
    sim.stepping.registers = match registers.as_str() {
        "plain" => Isa::Plain,
        "avx2" => Isa::Avx2,
        other => panic!("{other} is neither plain nor avx2"),
    };
    sim.stepping.tunes = false;
    sim.steps(steps.parse().expect("a number of steps"))
        .expect("a settled bed");
    println!("{}", hex(&sim.digest().expect("sound arithmetic").whole));
}
