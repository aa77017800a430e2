//! What hosts do between steps: edits, losses, saved worlds, lent memory.

use bitgrain_kernel::{
    Capacity, Departure, Domain, Error as KernelError, Facet, Group, Head, LentStore, LossPolicy,
    Memory, NewGrain, Obstacle, Real, Saved, StretchList, World, insert, nudge, regroup, remove,
    save, save_size, take_out,
};

use crate::state::Few;

type Ended = Result<(), KernelError>;

/// Functions over one number type.
pub struct Hosts<R: Real + 'static> {
    nudge: fn(&mut World<'_, R>, usize, [R; 3], [R; 3]) -> Ended,
    insert: fn(&mut World<'_, R>, &[NewGrain<R>]) -> Ended,
    remove: fn(&mut World<'_, R>, &[u32]) -> Ended,
    regroup: fn(&mut World<'_, R>, &[u32], u8) -> Ended,
    take_out: fn(&mut World<'_, R>, &mut dyn FnMut(Departure<R>)) -> Result<usize, KernelError>,
    place_of: fn(&World<'_, R>, u32) -> Option<usize>,
    save: fn(&mut World<'_, R>, &mut [u8]) -> Result<usize, KernelError>,
    save_size: fn(&World<'_, R>) -> usize,
    saved: for<'b> fn(&'b [u8]) -> Result<Saved<'b, R>, KernelError>,
    saved_settings: fn(&Saved<'_, R>) -> (Domain<R>, R, LossPolicy<R>, [usize; 2]),
    saved_groups: fn(&Saved<'_, R>, &mut dyn FnMut(Group<R>)),
    saved_obstacles: fn(&Saved<'_, R>, &mut dyn FnMut(Obstacle<R>)),
    saved_fill: fn(&Saved<'_, R>, &mut World<'_, R>),
    saved_resume: fn(&Saved<'_, R>, &mut World<'_, R>) -> Ended,
    set_policy: fn(&mut Few<R>, LossPolicy<R>),
    saved_facets: fn(&Saved<'_, R>) -> Option<[[R; 3]; 3]>,
    set_facets: fn(&mut Few<R>, &'static [Facet<R>]),
    store_insert: fn(&mut Few<R>, &[NewGrain<R>]) -> Ended,
    store_load: fn(&mut Few<R>, &[u8]) -> Ended,
    for_bed: fn(usize, usize) -> (Capacity, usize, Option<usize>, Option<usize>),
    head: fn(Domain<R>, R, R) -> Head<R>,
    stretches: for<'m> fn(&'m mut [u32], &'m mut [R]) -> StretchList<'m, R>,
    lent: for<'m> fn(Memory<'m, R>, Capacity) -> Result<LentStore<'m, R>, KernelError>,
    lent_sizes: fn(&LentStore<'_, R>) -> (Capacity, usize),
    lent_settings: fn(&mut LentStore<'_, R>, R, LossPolicy<R>),
    lent_group: fn(&mut LentStore<'_, R>, Group<R>) -> Result<u8, KernelError>,
    lent_obstacle: fn(&mut LentStore<'_, R>, Obstacle<R>) -> Result<u32, KernelError>,
    lent_add_grain: fn(&mut LentStore<'_, R>, u32, u8, [R; 3], R, R) -> Ended,
    lent_add: fn(&mut LentStore<'_, R>, &NewGrain<R>) -> Ended,
    lent_insert: fn(&mut LentStore<'_, R>, &[NewGrain<R>]) -> Ended,
    lent_load: fn(&mut LentStore<'_, R>, &[u8]) -> Ended,
    lent_world: for<'m> fn(&'m mut LentStore<'_, R>) -> World<'m, R>,
}

impl<R: Real + 'static> Hosts<R> {
    /// Each of them.
    pub const ALL: Self = Self {
        nudge,
        insert: |world, grains| insert(world, grains.iter().copied()),
        remove,
        regroup,
        take_out: |world, departed| take_out(world, departed),
        place_of: |world, id| world.place_of(id),
        save,
        save_size,
        saved: |bytes| Saved::open(bytes),
        saved_settings: |saved| {
            let sizes = [saved.count(), saved.size()];
            (saved.domain(), saved.dt(), saved.policy(), sizes)
        },
        saved_groups: |saved, of| saved.groups().for_each(of),
        saved_obstacles: |saved, of| saved.obstacles().for_each(of),
        saved_fill: |saved, world| saved.fill(world),
        saved_resume: |saved, world| saved.resume(world),
        set_policy: Few::set_policy,
        saved_facets: |saved| saved.facets().next(),
        set_facets: Few::set_facets,
        store_insert: |store, grains| store.insert(grains.iter().copied()),
        store_load: Few::load,
        for_bed: |grains, obstacles| {
            let capacity = Capacity::for_bed(grains, obstacles);
            let stretches = capacity.stretches();
            (capacity, stretches, capacity.numbers(), capacity.words())
        },
        head: Head::new,
        stretches: |words, numbers| StretchList::new(words, numbers),
        lent: |memory, capacity| LentStore::new(memory, capacity),
        lent_sizes: |store| (store.capacity(), store.count()),
        lent_settings: |store, skin, policy| {
            store.set_skins(skin, skin);
            store.set_policy(policy);
        },
        lent_group: |store, group| store.add_group(group),
        lent_obstacle: |store, obstacle| store.add_obstacle(obstacle),
        lent_add_grain: |store, id, group, x, radius, mass| {
            store.add_grain(id, group, x, radius, mass)
        },
        lent_add: |store, grain| store.add(grain),
        lent_insert: |store, grains| store.insert(grains.iter().copied()),
        lent_load: |store, bytes| store.load(bytes),
        lent_world: |store| store.world(),
    };
}
