//! Puts the board's memory map where the linker script of `cortex-m-rt` looks for it.

use std::path::Path;

fn main() {
    let out = std::env::var("OUT_DIR").expect("cargo names a folder");
    std::fs::copy("memory.x", Path::new(&out).join("memory.x")).expect("it can be copied");
    println!("cargo:rustc-link-search={out}");
    println!("cargo:rustc-link-arg=-Tlink.x");
    println!("cargo:rerun-if-changed=memory.x");
    println!("cargo:rerun-if-changed=build.rs");
}
