//! A program without a C library says so to the linker by itself; others ask for one here.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let none = std::env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none");
    if !none {
        // The start code calls `main`, which the compiler does not write for a `no_main` program.
        println!("cargo:rustc-link-lib=c");
    }
}
