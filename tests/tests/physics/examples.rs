//! The examples of the libraries run to their ends; what they assert is in them.

#[path = "../../../harness/sim/examples/from_arrays.rs"]
mod from_arrays;
#[allow(dead_code)]
#[path = "../../../harness/lab/examples/own_observable.rs"]
mod own_observable;

#[test]
#[cfg_attr(debug_assertions, ignore = "pours a bed: seconds in release")]
fn examples_run() {
    from_arrays::main().unwrap();
    let short = [
        "bed.box=[20.0, 13.0, 9.0]",
        "bed.grains=1300",
        "bed.settled=1e-2",
        "intruder.height=2.5",
        "intruder.diameter=2.0",
        "intruder.froude=0.5",
        "drag.dt=4e-4",
        "drag.distance=1.5",
        "drag.discard=0.2",
        "measure.every=5",
    ];
    let rows = own_observable::carried(&short.map(String::from)).unwrap();
    assert!(rows.windows(2).all(|pair| pair[1].0 == pair[0].0 + 5));
    let most = rows.iter().map(|row| row.1).max();
    assert!((1..100).contains(&most.unwrap()), "{most:?}");
}
