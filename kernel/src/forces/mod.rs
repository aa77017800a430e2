//! Forces of contacts, added up in one written order.

pub(crate) mod accumulate;
pub(crate) mod force_check;
pub(crate) mod mesh_histories;
pub(crate) mod obstacle_contacts;
pub(crate) mod stretch_range;
