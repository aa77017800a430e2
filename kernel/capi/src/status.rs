//! Numbers of errors, and their texts.

use core::ffi::c_char;

use bitgrain_kernel::Error;

use crate::types::bg_fault;

/// All is well.
pub const BG_OK: i32 = 0;
/// A warning, and no error: the time step is above a fifth of the Rayleigh time, or a tenth of a collision.
pub const BG_LONG_TIME_STEP: i32 = -1;
/// The edges of the box are not finite or not in order.
pub const BG_BAD_DOMAIN: i32 = 1;
/// A periodic axis is not longer than twice the largest contact distance.
pub const BG_PERIOD_TOO_SHORT: i32 = 2;
/// There is no room for an obstacle or a group.
pub const BG_BAD_STORAGE: i32 = 3;
/// Ids do not ascend, or one is taken.
pub const BG_BAD_ORDER: i32 = 4;
/// A grain's group, radius or mass is impossible.
pub const BG_BAD_GRAIN: i32 = 5;
/// An obstacle is impossible in this box.
pub const BG_BAD_OBSTACLE: i32 = 6;
/// Time step or skin is not positive and finite.
pub const BG_BAD_TIME_STEP: i32 = 7;
/// The machine's arithmetic is not that of the bit contract.
pub const BG_ARITHMETIC: i32 = 8;
/// A carried grain moves too little in a step.
pub const BG_TOO_SLOW: i32 = 9;
/// An obstacle moves too little in a step.
pub const BG_OBSTACLE_TOO_SLOW: i32 = 10;
/// Gravity moves grains too little in a step.
pub const BG_GRAVITY_TOO_WEAK: i32 = 11;
/// A saved contact fits no bodies near each other.
pub const BG_BAD_CONTACT_HISTORY: i32 = 12;
/// Bytes are no saved world as it was written.
pub const BG_BAD_SAVE: i32 = 13;
/// A saved world of another layout, arithmetic or number type.
pub const BG_OTHER_VERSION: i32 = 14;
/// The world's triangles are not those that a mesh was made of.
pub const BG_OTHER_FACETS: i32 = 15;
/// A group or an obstacle is of a material that the law does not know.
pub const BG_UNKNOWN_MATERIAL: i32 = 16;
/// The law resists rolling, or has several materials, and `bg_capacity.materials` has no room for that.
pub const BG_LAW_MISFIT: i32 = 17;
/// There are more obstacles than 4,096.
pub const BG_TOO_MANY_OBSTACLES: i32 = 18;
/// The list of pairs is full; nothing was changed.
pub const BG_PAIR_LIST_FULL: i32 = 20;
/// The list of candidates is full; nothing was changed.
pub const BG_OUTER_LIST_FULL: i32 = 21;
/// The list of obstacle contacts is full; nothing was changed.
pub const BG_OBSTACLE_CONTACTS_FULL: i32 = 22;
/// The buffer for a saved world is too short; nothing was written.
pub const BG_BUFFER_TOO_SHORT: i32 = 23;
/// There is no room for so many grains; nothing was changed.
pub const BG_GRAINS_FULL: i32 = 24;
/// The state of a grain is not finite.
pub const BG_NOT_FINITE: i32 = 32;
/// The state of an obstacle is not finite.
pub const BG_OBSTACLE_NOT_FINITE: i32 = 33;
/// An obstacle would move more than the smallest radius in a step.
pub const BG_OBSTACLE_TOO_FAST: i32 = 34;
/// A grain would move more than its radius in a step.
pub const BG_TOO_FAST: i32 = 35;
/// A grain left the box.
pub const BG_ESCAPED: i32 = 36;
/// Two grains overlap by more than a quarter of the smaller diameter.
pub const BG_OVERLAP_TOO_DEEP: i32 = 37;
/// A grain and an obstacle do.
pub const BG_OBSTACLE_TOO_DEEP: i32 = 38;
/// The world was not started, or a fault stopped it in the middle of a step and it has no state.
pub const BG_NOT_STARTED: i32 = 50;
/// Memory of the world was written to between two steps.
pub const BG_EDITED: i32 = 51;
/// There is no such grain.
pub const BG_NO_GRAIN: i32 = 52;
/// There is no grain with this id.
pub const BG_UNKNOWN_GRAIN: i32 = 53;
/// A pointer is null.
pub const BG_NULL: i32 = 100;
/// A block does not begin at a multiple of `BG_ALIGNMENT` bytes.
pub const BG_MISALIGNED: i32 = 101;
/// A block is smaller than `bg_size` says, or a capacity cannot be had.
pub const BG_TOO_SMALL: i32 = 102;
/// A block holds no world: another library's, one of another version, or damaged.
pub const BG_FOREIGN: i32 = 103;
/// A structure's `size` is none that this library knows.
pub const BG_BAD_SIZE: i32 = 104;
/// The world is within a step: a callback called it.
pub const BG_BUSY: i32 = 105;
/// An argument names nothing: a kind, a field, a number of an obstacle.
pub const BG_BAD_ARGUMENT: i32 = 106;

/// A name, type, shape or step that no recording can have: letters, digits, `_ . - /` and steps that do not descend.
pub const BG_BAD_RECORD: i32 = 107;

/// A contact law's stiffness is not positive and finite, or another number of it is negative or not finite.
pub const BG_BAD_LAW: i32 = 108;

/// What the library's functions return.
pub(crate) type Done = Result<(), bg_fault>;

/// A fault that is not the kernel's.
pub(crate) fn fault(code: i32) -> bg_fault {
    bg_fault {
        size: size_of::<bg_fault>() as u32,
        code,
        first: 0,
        second: 0,
        needed: 0,
    }
}

impl From<Error> for bg_fault {
    fn from(error: Error) -> Self {
        let (first, second, needed) = match error {
            Error::BadDomain { axis } | Error::PeriodTooShort { axis } => (u32::from(axis), 0, 0),
            Error::BadOrder { id }
            | Error::BadGrain { id }
            | Error::TooSlow { id }
            | Error::Overflow { id }
            | Error::NotFinite { id }
            | Error::TooFast { id }
            | Error::Escaped { id }
            | Error::UnknownGrain { id } => (id, 0, 0),
            Error::BadObstacle { obstacle, .. }
            | Error::OtherFacets { obstacle }
            | Error::ObstacleTooSlow { obstacle }
            | Error::ObstacleOverflow { obstacle }
            | Error::ObstacleNotFinite { obstacle }
            | Error::ObstacleTooFast { obstacle } => (obstacle, 0, 0),
            Error::GravityTooWeak { group } => (u32::from(group), 0, 0),
            Error::UnknownMaterial { material } => (u32::from(material), 0, 0),
            Error::OverlapTooDeep { i, j } => (i, j, 0),
            Error::ObstacleTooDeep { id, obstacle } => (id, obstacle, 0),
            Error::NoGrain { place } => (place, 0, 0),
            Error::TooManyObstacles { most, .. } => (most, 0, 0),
            Error::PairListFull { needed }
            | Error::OuterListFull { needed }
            | Error::ObstacleContactsFull { needed }
            | Error::BufferTooShort { needed }
            | Error::GrainsFull { needed } => (0, 0, needed as u64),
            _ => (0, 0, 0),
        };
        Self {
            first,
            second,
            needed,
            ..fault(error.code() as i32)
        }
    }
}

/// What a number means, as text that lives as long as the program; for a number that is none too.
#[unsafe(no_mangle)]
pub extern "C" fn bg_strerror(code: i32) -> *const c_char {
    text(code).as_ptr()
}

fn text(code: i32) -> &'static core::ffi::CStr {
    match code {
        BG_OK => c"all is well",
        BG_LONG_TIME_STEP => {
            c"a warning: the time step is above a fifth of the Rayleigh time, or a tenth of a collision"
        }
        BG_BAD_DOMAIN => c"the edges of the box are not finite or not in order",
        BG_PERIOD_TOO_SHORT => {
            c"a periodic axis is not longer than twice the largest contact distance: a grain could touch two images \
               of one body"
        }
        BG_BAD_STORAGE => c"there is no room for another obstacle or group",
        BG_BAD_ORDER => c"grain ids do not ascend, or one of them is taken",
        BG_BAD_GRAIN => c"a grain's group is none, or its radius or mass is not positive (bg_get_fault: its id)",
        BG_BAD_OBSTACLE => {
            c"an obstacle is impossible: its centre is outside the box, it is larger than the box, a wall across a \
               period, endless and askew or tilted, free without mass or inertia, or a size of it is not positive \
               (bg_get_fault: its number)"
        }
        BG_BAD_TIME_STEP => c"time step or skin is not positive and finite",
        BG_ARITHMETIC => c"this machine's arithmetic would change the bits",
        BG_TOO_SLOW => c"a grain is carried too slowly for its numbers",
        BG_OBSTACLE_TOO_SLOW => c"an obstacle moves too slowly for its numbers",
        BG_GRAVITY_TOO_WEAK => c"grains of a group fall too slowly for their numbers",
        BG_BAD_CONTACT_HISTORY => c"a saved contact fits no bodies near each other",
        BG_BAD_SAVE => c"these bytes are no saved world as it was written",
        BG_OTHER_VERSION => c"a saved world of another layout, arithmetic or number type",
        BG_OTHER_FACETS => c"the world's triangles are not those that a mesh was made of",
        BG_UNKNOWN_MATERIAL => c"a group or an obstacle is of a material beyond bg_capacity.materials",
        BG_LAW_MISFIT => {
            c"a law of several materials, or one that resists rolling, needs bg_capacity.materials (1 to 32)"
        }
        BG_TOO_MANY_OBSTACLES => c"there are more obstacles than 4,096, the most that a world can have",
        BG_PAIR_LIST_FULL => c"the list of pairs is full",
        BG_OUTER_LIST_FULL => c"the list of candidates is full",
        BG_OBSTACLE_CONTACTS_FULL => c"the list of obstacle contacts is full",
        BG_BUFFER_TOO_SHORT => c"the buffer is too short for the saved world",
        BG_GRAINS_FULL => c"there is no room for so many grains",
        BG_NOT_FINITE => c"the state of a grain is not finite",
        BG_OBSTACLE_NOT_FINITE => c"the state of an obstacle is not finite",
        BG_OBSTACLE_TOO_FAST => {
            c"an obstacle would move more than the smallest grain radius in one step"
        }
        BG_TOO_FAST => c"a grain would move more than its own radius in one step",
        BG_ESCAPED => c"a grain left the box",
        BG_OVERLAP_TOO_DEEP => c"two grains overlap by more than a quarter of the smaller diameter",
        BG_OBSTACLE_TOO_DEEP => {
            c"a grain overlaps an obstacle by more than a quarter of the smaller diameter"
        }
        BG_NOT_STARTED => {
            c"the world was not started, or a fault stopped it in the middle of a step and it has no state"
        }
        BG_EDITED => c"the world's memory was written to between two steps",
        BG_NO_GRAIN => c"there is no such grain",
        BG_UNKNOWN_GRAIN => c"there is no grain with this id",
        BG_NULL => c"a pointer is null",
        BG_MISALIGNED => c"the memory of a world must begin at a multiple of BG_ALIGNMENT bytes",
        BG_TOO_SMALL => c"the memory is smaller than bg_size says, or the capacity is impossible",
        BG_FOREIGN => c"this memory holds no world of this library and version, or is damaged",
        BG_BAD_SIZE => c"a structure (or its .law) has a size that this library does not know: set .size to sizeof",
        BG_BUSY => c"the world is within a step",
        BG_BAD_ARGUMENT => c"a kind, a field or a number names nothing: a law's .kind, an obstacle's number",
        BG_BAD_LAW => {
            c"a contact law's kn must be positive, and kt, gamma_n, gamma_t and mu zero or more"
        }
        BG_BAD_RECORD => c"an array has a name, type, shape or step that no recording can have",
        _ => c"no error has this number",
    }
}
