//! Threads that share the parts of a world, with stalls; `tests/rigs/orders` has them in model checkers.

mod stalls;
