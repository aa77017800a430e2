//! Who may touch: cells, the outer list that is made from them, and the pair list that is pruned from that, by
//! stretches of grains.

pub(crate) mod cell_list;
pub(crate) mod extent;
mod grid;
pub(crate) mod memory;
pub(crate) mod outer_list;
pub(crate) mod pair_list;
pub(crate) mod prune;
pub(crate) mod stretch;
