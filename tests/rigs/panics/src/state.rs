//! What is done without a law: worlds, their parts and what they are made of.

use core::fmt;

use crate::hosts::Hosts;
use crate::parts::Parts;
use bitgrain_kernel::blake3::Hasher;
use bitgrain_kernel::conformance::{self, Line, Room};
use bitgrain_kernel::contact::{HertzHistory, HertzTsuji, Materials, PairLaws};
use bitgrain_kernel::contact::{Kept, Rolling};
use bitgrain_kernel::fixed_point::I32F32;
use bitgrain_kernel::phases::{
    ForceCheck, GrainMotion, GrainRange, MotionCheck, MotionPhase, ObstacleContactRange, Sealed,
    begin, check_forces, drift, end, ensure_pair_list, ensure_pair_list_ahead, finish, integrate,
    is_draining, seal,
};
use bitgrain_kernel::record::{self, Chain, Element, Refusal as Unrecorded};
use bitgrain_kernel::scaling::{self, Margin, PRODUCTS, Refusal, Scales};
use bitgrain_kernel::time_step::{ShortestTimes, collision, moduli, rayleigh_time};
use bitgrain_kernel::vec3::{self, Vec3};
use bitgrain_kernel::{
    ArithmeticDefect, Clock, ContactHistory, Digest, Domain, Error as KernelError, Grains, Group,
    KeptContact, MemoryColumns, Obstacle, PairList, Real, Row, Store, World, check_arithmetic,
    digest, memory_columns, resume,
};
use fixed::FixedI64;
use fixed::types::extra::U32;

type Ended = Result<(), KernelError>;
/// A store small enough to be made on a stack.
pub type Few<R> = Store<R, 6, 16, 8, 3>;

/// Functions that need no number type.
pub struct Plain {
    new: fn() -> Hasher,
    word: fn(&mut Hasher, u32),
    hash: fn(&mut Hasher, &[u8; 32]),
    finish: fn(&Hasher) -> [u8; 32],
    finish_with: fn(&mut Hasher, &[u8]) -> [u8; 32],
    parts: fn(&Digest) -> [&[u8; 32]; 6],
    text: fn(&Line) -> [u8; conformance::LINE],
    last: fn(&Hasher) -> Line,
    name: fn(conformance::World) -> &'static str,
    stages: fn(conformance::World) -> &'static [conformance::Stage],
    and_found: fn(ForceCheck, ForceCheck) -> ForceCheck,
    show: fn(&KernelError, &mut dyn fmt::Write) -> fmt::Result,
    code: fn(&KernelError) -> u32,
    show_flaw: fn(&ArithmeticDefect, &mut dyn fmt::Write) -> fmt::Result,
    moduli: fn(f64, f64) -> (f64, f64),
    rayleigh_time: fn((f64, f64), f64, f64) -> f64,
    collision: fn(f64, f64, f64, f64) -> (f64, f64),
    resolves: fn(&ShortestTimes, f64) -> ([f64; 2], bool),
    records: Records,
}

impl Plain {
    /// Each of them.
    pub const ALL: Self = Self {
        new: Hasher::default,
        word: Hasher::word,
        hash: Hasher::hash,
        finish: Hasher::finish,
        finish_with: Hasher::finish_with,
        parts: Digest::parts,
        text: Line::text,
        last: conformance::last,
        name: conformance::World::name,
        stages: conformance::World::stages,
        and_found: ForceCheck::and,
        show: |fault, out| write!(out, "{fault}"),
        code: KernelError::code,
        show_flaw: |flaw, out| write!(out, "{flaw}"),
        moduli,
        rayleigh_time,
        collision,
        resolves: |times, dt| (times.fractions(dt), times.are_resolved_by(dt)),
        records: Records::ALL,
    };
}

type Recorded = Result<record::Line, Unrecorded>;

/// Recordings of any arrays.
pub struct Records {
    new: fn() -> Chain,
    add: fn(&mut Chain, u64, &str, Element, &[usize], &[u8]) -> Recorded,
    add_digest: fn(&mut Chain, u64, &str, Element, &[usize], &[u8; 32]) -> Recorded,
    link: fn(&Chain) -> &[u8; 32],
    at: fn(u64, [u8; 32]) -> (Chain, u64),
    end: fn(&Chain) -> record::Line,
    text: fn(&record::Line) -> &str,
    length: fn(Element, &[usize]) -> Result<usize, Unrecorded>,
    check: fn(Element, &[usize], &[u8]) -> Result<(), Unrecorded>,
    element: fn(&str) -> Option<Element>,
    name: fn(Element) -> (&'static str, usize),
    show: fn(&Unrecorded, &mut dyn fmt::Write) -> fmt::Result,
}

impl Records {
    const ALL: Self = Self {
        new: Chain::new,
        add: Chain::add,
        add_digest: Chain::add_digest,
        link: Chain::link,
        end: Chain::end,
        at: |step, link| (Chain::at(step, link), Chain::at(step, link).step()),
        text: record::Line::text,
        length: record::length,
        check: record::check,
        element: Element::of,
        name: |element| (element.name(), element.size()),
        show: |refusal, out| write!(out, "{refusal}"),
    };
}

/// Functions over one number type.
pub struct State<R: Real + 'static> {
    resume: fn(&mut World<'_, R>, &[ContactHistory<R>]) -> Ended,
    resume_any: fn(&mut World<'_, R>, &mut dyn Iterator<Item = KeptContact<R>>) -> Ended,
    begin: fn(&mut World<'_, R>, Sealed) -> Ended,
    end: fn(&mut World<'_, R>, Sealed) -> Ended,
    ensure_pair_list_ahead: fn(&mut World<'_, R>) -> Ended,
    ensure_pair_list: fn(&mut World<'_, R>) -> Ended,
    drift: fn(&mut World<'_, R>, MotionCheck<R>) -> Ended,
    finish: fn(&mut World<'_, R>, MotionCheck<R>) -> Ended,
    check_forces: fn(&mut World<'_, R>, ForceCheck) -> Ended,
    is_draining: fn(&World<'_, R>) -> bool,
    pass: fn(&mut GrainMotion<'_, R>, MotionPhase) -> MotionCheck<R>,
    and: fn(MotionCheck<R>, MotionCheck<R>) -> MotionCheck<R>,
    seal: fn(&GrainMotion<'_, R>, usize) -> Sealed,
    and_sealed: fn(Sealed, Sealed) -> Sealed,
    digest: fn(&World<'_, R>) -> Result<Digest, KernelError>,
    contact_histories: fn(&World<'_, R>, &mut dyn FnMut(ContactHistory<R>)),
    kept_contacts: fn(&World<'_, R>, &mut dyn FnMut(KeptContact<R>)),
    kept: fn(&KeptContact<R>) -> (Kept<R>, bool),
    words: fn(&PairList<'_, R>) -> usize,
    memory_columns: for<'m> fn([&'m mut [R]; 3]) -> MemoryColumns<'m, R>,
    reach: fn(&mut Clock<R>, R) -> R,
    radius_min: fn(&Clock<R>) -> R,
    listed_pairs: fn(&World<'_, R>, &mut dyn FnMut((u32, u32))),
    moving: for<'w> fn(&'w mut World<'_, R>) -> GrainMotion<'w, R>,
    pushing:
        for<'w> fn(&'w mut World<'_, R>, R) -> (GrainRange<'w, R>, ObstacleContactRange<'w, R>),
    split_moving: for<'w> fn(GrainMotion<'w, R>, usize) -> (GrainMotion<'w, R>, GrainMotion<'w, R>),
    stretch: for<'w> fn(&'w mut GrainMotion<'_, R>, usize, usize) -> GrainMotion<'w, R>,
    count: fn(&GrainMotion<'_, R>) -> usize,
    grains: fn(&Grains<'_, R>) -> usize,
    clock: fn(&Clock<R>) -> ([u64; 3], [usize; 4], bool),
    stop: fn(&mut Clock<R>),
    pieces: Pieces<R>,
    store: Stores<R>,
    hosts: Hosts<R>,
    parts: Parts<R>,
}

impl<R: Real + 'static> State<R> {
    /// Each of them.
    pub const ALL: Self = Self {
        resume: |world, histories| resume(world, histories.iter().copied()),
        resume_any: |world, histories| resume(world, histories),
        begin,
        end,
        ensure_pair_list_ahead,
        ensure_pair_list,
        drift,
        finish,
        check_forces,
        is_draining,
        pass: integrate,
        and: MotionCheck::and,
        seal,
        and_sealed: Sealed::and,
        digest,
        contact_histories: |world, show| world.contact_histories().for_each(show),
        kept_contacts: |world, show| world.kept_contacts().for_each(show),
        kept: |contact| (contact.kept(), contact.kept().is_any()),
        words: |list| list.words(),
        memory_columns: |columns| memory_columns(columns),
        reach: |clock, reach| {
            clock.set_reach(reach);
            clock.reach()
        },
        radius_min: |clock| clock.radius_min(),
        listed_pairs: |world, show| world.listed_pairs().for_each(show),
        moving: |world| world.grain_motion(),
        pushing: |world, dt| world.force_ranges(dt),
        split_moving: |grains, at| grains.split(at),
        stretch: |grains, begin, end| grains.stretch(begin, end),
        count: |grains| grains.count(),
        grains: |grains| grains.count(),
        clock: |clock| {
            let listed = [
                clock.listed(),
                clock.listed_touching(),
                clock.obstacle_contacts(),
                clock.count(),
            ];
            (
                [clock.outer_list_rebuilds(), clock.prunes(), clock.picked()],
                listed,
                clock.rests() || clock.has_begun() || clock.is_losing() || clock.has_state(),
            )
        },
        stop: |clock| clock.stop(),
        pieces: Pieces::ALL,
        store: Stores::ALL,
        hosts: Hosts::ALL,
        parts: Parts::ALL,
    };
}

/// What a world is made of.
pub struct Pieces<R: Real> {
    check_arithmetic: fn() -> Ended,
    domain: fn(Vec3<R>, Vec3<R>, [bool; 3]) -> Result<Domain<R>, KernelError>,
    open: fn() -> Domain<R>,
    edges: fn(&Domain<R>) -> (Vec3<R>, Vec3<R>, [bool; 3]),
    separation: fn(&Domain<R>, Vec3<R>, Vec3<R>) -> Vec3<R>,
    wrap: fn(&Domain<R>, &mut Vec3<R>, &mut [i32; 3]) -> bool,
    groups: fn(Vec3<R>) -> [Group<R>; 4],
    of_material: fn(Group<R>, u8) -> Group<R>,
    materials: fn() -> [Rolling<R, HertzTsuji<R>>; 3],
    tsuji: fn(f64, f64, f64, f64) -> HertzTsuji<R>,
    between: fn([[f64; 2]; 2], f64, f64) -> HertzTsuji<R>,
    table: fn(u8, &'static [HertzTsuji<R>]) -> Option<PairLaws<'static, HertzTsuji<R>>>,
    law: fn(&PairLaws<'static, HertzTsuji<R>>, Materials) -> HertzTsuji<R>,
    pairs: fn(u8, usize) -> Option<Materials>,
    laws: fn(f64) -> (HertzHistory<R>, HertzTsuji<R>),
    vectors: fn(Vec3<R>, Vec3<R>, R, bool) -> [Vec3<R>; 5],
    numbers: fn(Row<R>, f64) -> ([R; 4], f64, usize, bool, (u32, Option<u32>)),
}

impl<R: Real> Pieces<R> {
    const ALL: Self = Self {
        check_arithmetic: check_arithmetic::<R>,
        domain: Domain::new,
        open: Domain::open,
        edges: |domain| (domain.lo(), domain.hi(), domain.periodic()),
        separation: Domain::separation,
        wrap: Domain::wrap,
        groups: |gravity| {
            [
                Group::free(gravity),
                Group::frozen(),
                Group::prescribed_velocity(),
                Group::free_along_z(gravity),
            ]
        },
        of_material: Group::of_material,
        materials: conformance::materials,
        tsuji: HertzTsuji::new,
        between: HertzTsuji::between,
        table: |materials, laws| PairLaws::new(materials, laws),
        law: |table, pair| *table.of(pair),
        pairs: |materials, place| PairLaws::<()>::pairs(materials).nth(place),
        laws: |gamma| (conformance::history(gamma), conformance::tsuji()),
        vectors: |a, b, by, first| {
            [
                vec3::add(a, b),
                vec3::sub(a, b),
                vec3::scale(a, by),
                vec3::cross(a, b),
                vec3::either(first, a, b),
            ]
        },
        numbers: |row, value| {
            let [x, y, z] = vec3::head(row);
            let root = vec3::dot([x, y, z], [z, x, y]).sqrt();
            (
                [x, root, R::from_f64(value), R::from_words(7, Some(9))],
                y.to_f64(),
                z.to_index(),
                x.is_finite(),
                y.to_words(),
            )
        },
    };
}

/// Storage of fixed capacity, and the reference worlds in it.
pub struct Stores<R: Real> {
    vacant: fn() -> Few<R>,
    new: fn(Domain<R>, R, R) -> Few<R>,
    clear: fn(&mut Few<R>, Domain<R>, R, R),
    set_skin: fn(&mut Few<R>, R),
    set_outer_skin: fn(&mut Few<R>, R),
    add_group: fn(&mut Few<R>, Group<R>) -> Result<u8, Group<R>>,
    add_obstacle: fn(&mut Few<R>, Obstacle<R>) -> Result<(), Obstacle<R>>,
    add_grain: fn(&mut Few<R>, u32, u8, Vec3<R>, R, R) -> Ended,
    world: for<'s> fn(&'s mut Few<R>) -> World<'s, R>,
    lay: fn(conformance::World, &mut Room<R>) -> Ended,
    run: fn(&mut Room<R>, &mut Hasher, &mut dyn FnMut(&Line)) -> Ended,
}

impl<R: Real> Stores<R> {
    const ALL: Self = Self {
        vacant: Few::vacant,
        new: Store::new,
        clear: Store::clear,
        set_skin: Store::set_skin,
        set_outer_skin: Store::set_outer_skin,
        add_group: Store::add_group,
        add_obstacle: Store::add_obstacle,
        add_grain: Store::add_grain,
        world: Store::world,
        lay: conformance::World::lay,
        run: |room, all, show| conformance::run(room, all, show),
    };
}

/// What is known of the fixed-point types.
pub struct Fixed {
    from_bits: fn(i64) -> I32F32,
    to_bits: fn(I32F32) -> i64,
    new: fn(f64) -> I32F32,
    into: fn(FixedI64<U32>) -> I32F32,
    out: fn(I32F32) -> Option<FixedI64<U32>>,
    margins: fn(&Scales) -> [Margin; PRODUCTS],
    check: fn(&Scales) -> Result<[Margin; PRODUCTS], Refusal>,
}

impl Fixed {
    /// Each of its functions.
    pub const ALL: Self = Self {
        from_bits: I32F32::from_bits,
        to_bits: I32F32::to_bits,
        new: I32F32::new,
        into: I32F32::from,
        out: |x| x.into(),
        margins: scaling::margins::<I32F32>,
        check: scaling::check::<I32F32>,
    };
}
