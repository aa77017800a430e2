//! A bar in a tank, at a size of seconds.

/// A bar that turns once in a tank of 1,400 grains.
pub const TANK: &str = r#"
name = "tank"
units = "reduced"
seed = 3

[bed]
box = [13.0, 13.0, 15.0]
container = "tank"
grains = 1400
pouring = "in_turn"
settled = 1e-5

[law]
kind = "hertz_history"
kn = 2e5
kt = 2.45e5
gamma_n = 792.44659623055669
gamma_t = 792.44659623055669
mu = 0.5

[intruder]
shape = "bar"
diameter = 1.5
length = 4.0
depth = 4.0
speed = 0.5

[drag]
dt = 5e-4
distance = 12.5664
discard = 2.0
own_wake = true

[measure]
every = 50
energy = true
snapshots = 0
"#;
