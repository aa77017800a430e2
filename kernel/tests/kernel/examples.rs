//! The examples run to their ends; what they assert is in them.

#[path = "../../examples/drop_a_ball.rs"]
mod drop_a_ball;
#[path = "../../examples/own_contact_law.rs"]
mod own_contact_law;
#[path = "../../examples/static_firmware_world.rs"]
mod static_firmware_world;
#[path = "../../examples/threaded_host.rs"]
mod threaded_host;

#[test]
fn examples_run() {
    drop_a_ball::main().unwrap();
    own_contact_law::main().unwrap();
    static_firmware_world::main().unwrap();
    threaded_host::main().unwrap();
}
