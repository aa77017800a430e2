//! The block of memory of a world: a header, the arrays of a lent store, and a mark at the end.
//!
//! What C promises, and what is checked here, is written at each `unsafe`.

use core::mem::offset_of;
use core::ptr::{addr_of, addr_of_mut};

use bitgrain_kernel::contact::{
    HertzHistory, HertzTsuji, Rolling, RollingResistance, RollingSpring,
};
use bitgrain_kernel::{Capacity, Facet, Flag, Group, Head, LentStore, Memory, Obstacle};

use crate::BG_ABI_VERSION;
use crate::status::{
    BG_BUSY, BG_FOREIGN, BG_MISALIGNED, BG_NULL, BG_OK, BG_TOO_SMALL, Done, fault,
};
use crate::types::{bg_capacity, bg_fault, bg_world};

/// A block begins at a multiple of so many bytes; `malloc` sees to that.
pub const BG_ALIGNMENT: u32 = 8;

/// How a block begins: `bitgrain` in ASCII, then 0 to 9 backwards.
const MAGIC: u64 = u64::from_le_bytes(*b"bitgrain");

/// The contact law of a world: numbers alone, so that no bytes of a block make it impossible.
#[derive(Clone, Copy)]
#[repr(C)]
pub(crate) struct Law {
    /// `BG_HERTZ_HISTORY` or `BG_HERTZ_TSUJI`.
    pub kind: u32,
    /// With other numbers for each pair of so many materials, or with resistance to rolling: those of the table. 0 for
    /// one material.
    pub materials: u32,
    /// Those of one material.
    pub numbers: [f64; 5],
}

/// What a table holds of a pair: its five numbers are those of either law.
pub(crate) type Row = Rolling<f64, HertzHistory<f64>>;

/// So many pairs have so many materials.
pub(crate) fn pairs_of(materials: u32) -> usize {
    let count = materials as usize;
    count * (count + 1) / 2
}

/// A table as one of the other law.
pub(crate) fn as_tsuji(table: &[Row]) -> &[Rolling<f64, HertzTsuji<f64>>] {
    // SAFETY: both laws are five numbers in the layout of C, and so are what holds them.
    unsafe { core::slice::from_raw_parts(table.as_ptr().cast(), table.len()) }
}

/// What stands at the beginning of a block.
#[repr(C)]
pub(crate) struct Header {
    magic: u64,
    abi: u32,
    /// 1 within a step, when callbacks may run.
    busy: u32,
    bytes: u64,
    capacity: bg_capacity,
    law: Law,
    fault: bg_fault,
    /// Steps of the last call that stepped.
    stepped: u64,
    departed: u64,
    /// Triangles in use.
    facets: u64,
    head: Head<f64>,
}

/// Sums of force and torque on an obstacle over the last steps.
pub(crate) type Sums = [f64; 6];

/// Where the arrays of a block begin, and its length.
struct Layout {
    numbers: usize,
    sums: usize,
    obstacles: usize,
    facets: usize,
    table: usize,
    groups: usize,
    words: usize,
    images: usize,
    group: usize,
    mark: usize,
    bytes: usize,
}

/// Words of a contact that a law with resistance to rolling keeps.
const WORDS: usize = <Row as bitgrain_kernel::contact::Law<f64>>::MEMORY;

/// Most materials.
const MATERIALS_MAX: u32 = if cfg!(feature = "materials") { 32 } else { 0 };

/// The kernel's capacity.
pub(crate) fn capacity_of(capacity: &bg_capacity) -> Capacity {
    Capacity {
        grains: capacity.grains as usize,
        pairs: capacity.pairs as usize,
        candidates: capacity.candidates as usize,
        obstacle_contacts: capacity.obstacle_contacts as usize,
        cells: capacity.cells as usize,
        obstacles: capacity.obstacles as usize,
        groups: capacity.groups as usize,
        memory: match capacity.materials {
            0 => 0,
            _ => WORDS,
        },
    }
}

impl Layout {
    /// `None` if no address space holds it, or without cells.
    fn of(capacity: &bg_capacity) -> Option<Self> {
        if capacity.materials > MATERIALS_MAX {
            return None;
        }
        let room = capacity_of(capacity);
        let mut end = size_of::<Header>();
        // Parts of 8-byte alignment first; the others are not padded.
        let mut next = |count: usize, size: usize| {
            let begin = end;
            end = count.checked_mul(size)?.checked_add(begin)?;
            Some(begin)
        };
        let numbers = next(room.numbers()?, size_of::<f64>())?;
        let sums = next(room.obstacles, size_of::<Sums>())?;
        let obstacles = next(room.obstacles, size_of::<Obstacle<f64>>())?;
        let facets = next(capacity.facets as usize, size_of::<Facet<f64>>())?;
        let table = next(pairs_of(capacity.materials), size_of::<Row>())?;
        let groups = next(room.groups, size_of::<Group<f64>>())?;
        let words = next(room.words()?, size_of::<u32>())?;
        let images = next(room.grains, size_of::<[i32; 3]>())?;
        let group = next(room.grains, 1)?;
        let mark = next(0, 0)?.checked_next_multiple_of(8)?;
        let bytes = mark.checked_add(8)?;
        let possible = room.cells > 0 && room.groups <= 256 && isize::try_from(bytes).is_ok();
        possible.then_some(Self {
            numbers,
            sums,
            obstacles,
            facets,
            table,
            groups,
            words,
            images,
            group,
            mark,
            bytes,
        })
    }
}

/// Bytes that a world of this capacity takes; `None` if it cannot be.
pub(crate) fn bytes(capacity: &bg_capacity) -> Option<usize> {
    Layout::of(capacity).map(|layout| layout.bytes)
}

/// The parts of a block, borrowed for a call.
pub(crate) struct Parts<'a> {
    pub store: LentStore<'a, f64>,
    pub law: &'a mut Law,
    /// The laws of all pairs of materials.
    pub table: &'a mut [Row],
    pub sums: &'a mut [Sums],
    pub stepped: &'a mut u64,
    pub departed: &'a mut u64,
    /// Triangles that are not in use, and how many are.
    pub facets: (&'a mut [Facet<f64>], &'a mut u64),
    fault: &'a mut bg_fault,
    /// Not borrowed: a callback that calls the world again reads it.
    busy: *mut u32,
}

impl Parts<'_> {
    /// Does something within which callbacks run: calls of the same world are refused until it is done.
    pub fn locked<T>(&mut self, what: impl FnOnce(&mut Self) -> T) -> T {
        // SAFETY: `busy` points into the block that this value borrows, and no reference to it exists.
        unsafe { self.busy.write_volatile(1) };
        let done = what(self);
        // SAFETY: as above.
        unsafe { self.busy.write_volatile(0) };
        done
    }
}

/// Makes a block of `bytes` bytes an empty world.
pub(crate) fn init(
    memory: *mut u8,
    bytes: usize,
    capacity: &bg_capacity,
    (law, row): (Law, Row),
    head: Head<f64>,
) -> Result<*mut bg_world, bg_fault> {
    let layout = Layout::of(capacity).ok_or(fault(BG_TOO_SMALL))?;
    if memory.is_null() {
        return Err(fault(BG_NULL));
    }
    if !memory.addr().is_multiple_of(BG_ALIGNMENT as usize) {
        return Err(fault(BG_MISALIGNED));
    }
    if bytes < layout.bytes {
        return Err(fault(BG_TOO_SMALL));
    }
    let header = memory.cast::<Header>();
    // SAFETY: the caller lends `bytes` bytes, at least as many as the layout has, aligned as its first parts need, and
    // every offset is within them and a multiple of its part's alignment. Zeros are valid numbers; what is not made of
    // numbers alone is written entry by entry.
    unsafe {
        memory.write_bytes(0, layout.bytes);
        header.write(Header {
            magic: MAGIC,
            abi: BG_ABI_VERSION,
            busy: 0,
            bytes: layout.bytes as u64,
            capacity: *capacity,
            law,
            fault: fault(BG_OK),
            stepped: 0,
            departed: 0,
            facets: 0,
            head,
        });
        let obstacles = memory.add(layout.obstacles).cast::<Obstacle<f64>>();
        for k in 0..capacity.obstacles as usize {
            obstacles.add(k).write(Obstacle::sphere([0.0; 3], 0.0));
        }
        let table = memory.add(layout.table).cast::<Row>();
        for k in 0..pairs_of(capacity.materials) {
            table.add(k).write(row);
        }
        let groups = memory.add(layout.groups).cast::<Group<f64>>();
        for k in 0..capacity.groups as usize {
            groups.add(k).write(Group::frozen());
        }
        memory.add(layout.mark).cast::<u64>().write(!MAGIC);
    }
    Ok(memory.cast())
}

/// Looks at a block and borrows its parts.
fn open<'a>(world: *mut bg_world) -> Result<Parts<'a>, bg_fault> {
    let memory = world.cast::<u8>();
    if memory.is_null() {
        return Err(fault(BG_NULL));
    }
    if !memory.addr().is_multiple_of(BG_ALIGNMENT as usize) {
        return Err(fault(BG_MISALIGNED));
    }
    let header = memory.cast::<Header>();
    // SAFETY: the caller says that this is a block, of a header's size at least; these fields are whole numbers, for
    // which any bits are valid, and no reference to them is made.
    let (magic, abi, busy, size, capacity) = unsafe {
        (
            addr_of!((*header).magic).read(),
            addr_of!((*header).abi).read(),
            addr_of!((*header).busy).read_volatile(),
            addr_of!((*header).bytes).read(),
            addr_of!((*header).capacity).read(),
        )
    };
    if magic != MAGIC || abi != BG_ABI_VERSION {
        return Err(fault(BG_FOREIGN));
    }
    if busy != 0 {
        return Err(fault(BG_BUSY));
    }
    let layout = Layout::of(&capacity).filter(|layout| layout.bytes as u64 == size);
    let layout = layout.ok_or(fault(BG_FOREIGN))?;
    // SAFETY: a header with this mark and a size that fits its capacity was written by `init`, so that the block is as
    // long as the layout says.
    let mark = unsafe { memory.add(layout.mark).cast::<u64>().read() };
    if mark != !MAGIC {
        return Err(fault(BG_FOREIGN));
    }
    // SAFETY: the arrays lie within the block, as above.
    if !unsafe { is_sound(memory, &layout, &capacity) } {
        return Err(fault(BG_FOREIGN));
    }
    let room = capacity_of(&capacity);
    let none = fault(BG_FOREIGN);
    let (numbers, words) = (room.numbers().ok_or(none)?, room.words().ok_or(none)?);
    // SAFETY: the parts do not overlap, lie within the block, are aligned and were initialised by `init`, and no byte
    // of them is one that a value cannot have; the caller uses a world from one thread at a time, and a callback cannot
    // come here, because the world is busy then. So these are the only references until the call returns.
    let (memory, parts) = unsafe {
        let used = &mut *addr_of_mut!((*header).facets);
        let facets = slice_mut(memory, layout.facets, capacity.facets as usize);
        let (facets, free) = facets
            .split_at_mut_checked(*used as usize)
            .unwrap_or_default();
        let memory = Memory {
            head: &mut *addr_of_mut!((*header).head),
            numbers: slice_mut(memory, layout.numbers, numbers),
            words: slice_mut(memory, layout.words, words),
            images: slice_mut(memory, layout.images, room.grains),
            group: slice_mut(memory, layout.group, room.grains),
            groups: slice_mut(memory, layout.groups, room.groups),
            obstacles: slice_mut(memory, layout.obstacles, room.obstacles),
            facets,
        };
        let parts = (
            &mut *addr_of_mut!((*header).law),
            slice_mut(world.cast(), layout.table, pairs_of(capacity.materials)),
            slice_mut(world.cast(), layout.sums, room.obstacles),
            &mut *addr_of_mut!((*header).stepped),
            &mut *addr_of_mut!((*header).departed),
            &mut *addr_of_mut!((*header).fault),
            (free, used),
        );
        (memory, parts)
    };
    let (law, table, sums, stepped, departed, last, facets) = parts;
    Ok(Parts {
        store: LentStore::new(memory, room).map_err(|_| fault(BG_FOREIGN))?,
        law,
        table,
        sums,
        stepped,
        departed,
        facets,
        fault: last,
        // SAFETY: within the header.
        busy: unsafe { addr_of_mut!((*header).busy) },
    })
}

/// An obstacle.
type Body = Obstacle<f64>;

/// Where in a row the model of its resistance to rolling stands.
const SPRING: Flag = (
    offset_of!(Row, resistance) + offset_of!(RollingResistance<f64>, spring),
    RollingSpring::Epsd2 as u8,
);

/// Whether the values of a block can be, whatever was written to it: all flags are those of some value.
///
/// # Safety
/// The memory is a block of this layout.
unsafe fn is_sound(memory: *const u8, layout: &Layout, capacity: &bg_capacity) -> bool {
    let flag = |at: usize| {
        // SAFETY: within the block, by the places below; any byte is a number.
        unsafe { memory.add(at).read() }
    };
    let are_flags = |at: usize, flags: &[Flag]| flags.iter().all(|f| flag(at + f.0) <= f.1);
    let each = |first: usize, size: usize, count: usize| (0..count).map(move |k| first + k * size);
    let mut bodies = each(
        layout.obstacles,
        size_of::<Body>(),
        capacity.obstacles as usize,
    );
    let mut groups = each(
        layout.groups,
        size_of::<Group<f64>>(),
        capacity.groups as usize,
    );
    let mut rows = each(layout.table, size_of::<Row>(), pairs_of(capacity.materials));
    let [.., moves] = Body::FLAGS;
    are_flags(offset_of!(Header, head), &Head::<f64>::FLAGS)
        && groups.all(|at| are_flags(at, &Group::<f64>::FLAGS))
        && rows.all(|at| are_flags(at, &[SPRING]))
        && bodies.all(|at| {
            let is_free = || flag(at + moves.0) == moves.1;
            are_flags(at, &Body::FLAGS) && (!is_free() || are_flags(at, &Body::FREE_FLAGS))
        })
}

/// # Safety
/// From `offset` on there are `count` initialised entries, aligned, with no other reference to them.
unsafe fn slice_mut<'a, T>(memory: *mut u8, offset: usize, count: usize) -> &'a mut [T] {
    // SAFETY: as above.
    unsafe { core::slice::from_raw_parts_mut(memory.add(offset).cast(), count) }
}

/// Does something with a world, and keeps the fault that comes of it.
pub(crate) fn with(world: *mut bg_world, what: impl FnOnce(&mut Parts<'_>) -> Done) -> i32 {
    let mut parts = match open(world) {
        Ok(parts) => parts,
        Err(fault) => return fault.code,
    };
    match what(&mut parts) {
        Ok(()) => BG_OK,
        Err(fault) => {
            *parts.fault = fault;
            fault.code
        }
    }
}

/// The last fault of a world.
pub(crate) fn last_fault(world: *mut bg_world) -> Result<bg_fault, bg_fault> {
    open(world).map(|parts| *parts.fault)
}
