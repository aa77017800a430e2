//! The kernel's own tests, by what they look at.

mod common {
    pub mod cases;
    pub mod crowd;
    pub mod part;
    pub mod parts;
    pub mod slow_bodies;
    pub mod slow_mesh;
    pub mod slow_world;
    pub mod sticky;
}

mod canary;
mod comings;
mod edits;
mod examples;
#[cfg(feature = "fixed")]
mod fixed_point;
#[cfg(feature = "fixed")]
mod fixed_worlds;
mod heavy;
mod hosts;
mod images;
mod keeping;
mod materials;
mod meshes;
mod oracle;
mod parts;
mod reference;
mod resolution;
mod saved;
#[cfg(feature = "fixed")]
mod scaling;
mod search;
mod store;
mod stretches;
mod sums;
mod time_steps;
