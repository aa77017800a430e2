//! Computed results: laws, beds, drags and flows against closed forms, reference codes, goldens and themselves.

mod beds;
mod carried;
mod drag;
mod energy;
mod examples;
mod fields;
mod finds;
mod flowing;
mod gauge;
mod guards;
mod knobs;
mod kumar;
mod lammps;
mod matrix;
mod medium;
mod motions;
mod near_field;
mod notes;
mod peers;
mod physics;
mod quick;
mod ranks;
mod rig;
mod store;
