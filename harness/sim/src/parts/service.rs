//! What rank 0 has done by the other ranks, and how they do it.

use std::sync::Arc;

use bitgrain_kernel::{LossPolicy, Obstacle, Row};
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::{Deserialize, Serialize};

use super::crew::Crew;
use super::helpers::Helpers;
use super::part::{Errand, Part};
use super::post::Post;
use super::ranks::{Message, Ranks};
use super::report::{PartContacts, Report};
use super::seed::Seed;
use crate::law::AnyLaw;
use crate::memory;
use crate::notes::{Notebook, Watch};
use crate::owned_world::OwnedWorld;
use crate::threads::STACK;

/// An order of rank 0.
#[derive(Serialize, Deserialize)]
enum Order {
    /// Parts of a world begin: its name, where the parts of each rank begin, those of the rank.
    Enter(u32, Vec<usize>, AnyLaw, Vec<Seed>),
    /// They go their way, and report.
    Go(u32, Departure),
    /// They tell their contacts.
    Contacts(u32),
    /// The world is gone.
    Leave(u32),
    /// The rank tells the most memory it held.
    Peak,
    /// All is done.
    End,
}

/// What is told to all parts before they go.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Departure {
    pub errand: Errand,
    /// Whether they begin before a search.
    pub searches: bool,
    pub step: u64,
    pub obstacles: Vec<Obstacle<f64>>,
    pub policy: LossPolicy<f64>,
    pub skins: [f64; 2],
    /// What the host wants to know of each step.
    pub watch: Option<Watch>,
}

impl Departure {
    /// Makes the parts of a crew ready to go.
    pub fn prepare(&self, crew: &Crew) {
        for part in &mut crew.parts() {
            part.notes = self.watch.as_ref().map(Notebook::new);
            part.world.clock.step = self.step;
            part.world.obstacles.clone_from(&self.obstacles);
            part.world.policy = self.policy;
            [part.world.skin, part.world.outer_skin] = self.skins;
        }
        crew.depart(&self.errand, self.searches);
    }
}

/// The parts of a world that are elsewhere, for rank 0.
pub(super) struct Elsewhere {
    ranks: Arc<Ranks>,
    name: u32,
    firsts: Vec<usize>,
    /// Places of the own grains of each part, of this rank none.
    places: Vec<Vec<u32>>,
}

impl Elsewhere {
    /// Shares so many parts out among ranks, and sends those of others there. Returns what stays.
    pub fn share_out(ranks: &Arc<Ranks>, law: &AnyLaw, mut seeds: Vec<Seed>) -> (Self, Vec<Seed>) {
        let (count, used) = (seeds.len(), ranks.count().min(seeds.len()));
        let firsts: Vec<usize> = (0..=used).map(|rank| rank * count / used).collect();
        let name = ranks.name();
        let mut places = vec![Vec::new(); count];
        for (number, seed) in seeds.iter().enumerate().skip(firsts[1]) {
            places[number] = seed.places().to_vec();
        }
        // One after the other: all orders together are as large as the world.
        for rank in (1..used).rev() {
            let theirs = seeds.split_off(firsts[rank]);
            let order = packed(&Order::Enter(name, firsts.clone(), law.clone(), theirs));
            ranks.order(vec![(rank, order)]);
        }
        let elsewhere = Self {
            ranks: Arc::clone(ranks),
            name,
            firsts,
            places,
        };
        (elsewhere, seeds)
    }

    /// The post of the parts that stay.
    pub fn post(&self) -> Post {
        Post::new(Arc::clone(&self.ranks), self.name, self.firsts.clone())
    }

    fn order(&self, order: &Order) {
        order_all(&self.ranks, self.firsts.len() - 1, order);
    }

    /// Sends the parts elsewhere off.
    pub fn depart(&self, departure: &Departure) {
        self.order(&Order::Go(self.name, departure.clone()));
    }

    /// Waits for what they report, and brings their rows home.
    pub fn reports(&self, home: &mut OwnedWorld<f64>) -> Vec<Report> {
        let mut all = Vec::new();
        for rank in 1..self.firsts.len() - 1 {
            let reply = self.ranks.reply_of(rank);
            let opened = postcard::take_from_bytes::<Vec<Report>>(&reply);
            let (reports, mut rows) = opened.expect("ranks are of one build");
            all.extend(reports);
            for number in self.firsts[rank]..self.firsts[rank + 1] {
                rows = unload(rows, &self.places[number], home);
            }
        }
        all
    }

    /// The contacts of the parts elsewhere, part by part.
    pub fn contacts(&self) -> Vec<PartContacts> {
        self.order(&Order::Contacts(self.name));
        let mut all = Vec::new();
        for rank in 1..self.firsts.len() - 1 {
            let reply = self.ranks.reply_of(rank);
            let told = postcard::from_bytes::<Vec<PartContacts>>(&reply);
            all.extend(told.expect("ranks are of one build"));
        }
        all
    }
}

impl Drop for Elsewhere {
    fn drop(&mut self) {
        self.order(&Order::Leave(self.name));
    }
}

fn packed(order: &Order) -> Message {
    postcard::to_allocvec(order).expect("it is data")
}

/// Gives all other ranks below this one the same order.
fn order_all(ranks: &Ranks, end: usize, order: &Order) {
    let message = packed(order);
    ranks.order((1..end).map(|rank| (rank, message.clone())).collect());
}

/// Ends the service of all other ranks.
pub fn dismiss(ranks: &Ranks) {
    order_all(ranks, ranks.count(), &Order::End);
}

/// The most bytes that each rank held, as far as its system tells.
pub fn peaks(ranks: &Ranks) -> Vec<Option<f64>> {
    order_all(ranks, ranks.count(), &Order::Peak);
    let told = |rank| {
        let told = postcard::from_bytes(&ranks.reply_of(rank));
        told.expect("ranks are of one build")
    };
    let others = (1..ranks.count()).map(told);
    [memory::peak()].into_iter().chain(others).collect()
}

/// Parts of a world that this rank has.
struct Served {
    name: u32,
    crew: Arc<Crew>,
    helpers: Arc<Helpers>,
    pool: Option<ThreadPool>,
}

/// Does what rank 0 orders, until it needs no more.
pub fn serve(ranks: &Arc<Ranks>) {
    let mut all: Vec<Served> = Vec::new();
    loop {
        let order = ranks.next_order();
        let order = postcard::from_bytes::<Order>(&order).expect("ranks are of one build");
        match order {
            Order::Enter(name, firsts, law, seeds) => {
                all.push(Served::enter(ranks, (name, firsts), &law, seeds));
            }
            Order::Go(name, departure) => {
                if let Some(served) = all.iter().find(|served| served.name == name) {
                    ranks.reply(served.go(&departure));
                }
            }
            Order::Contacts(name) => {
                if let Some(served) = all.iter().find(|served| served.name == name) {
                    let mut parts = served.crew.parts();
                    let told: Vec<_> = parts.iter_mut().map(|part| part.contacts()).collect();
                    ranks.reply(postcard::to_allocvec(&told).expect("it is data"));
                }
            }
            Order::Leave(name) => all.retain(|served| served.name != name),
            Order::Peak => {
                ranks.reply(postcard::to_allocvec(&memory::peak()).expect("it is data"));
            }
            Order::End => return,
        }
    }
}

impl Served {
    fn enter(
        ranks: &Arc<Ranks>,
        (name, firsts): (u32, Vec<usize>),
        law: &AnyLaw,
        seeds: Vec<Seed>,
    ) -> Self {
        let count = firsts[firsts.len() - 1];
        let first = firsts[ranks.rank()];
        let numbered = (first..).zip(seeds);
        let parts = numbered.map(|(number, seed)| seed.grow(number, count, &Errand::none(law)));
        let parts: Vec<Part> = parts.collect();
        let pool = (parts.len() > 1).then(|| {
            let pool = ThreadPoolBuilder::new().num_threads(parts.len());
            pool.stack_size(STACK).build().unwrap_or_else(|e| {
                ranks.give_up(&format!("{} threads cannot be started: {e}", parts.len()))
            })
        });
        let post = Post::new(Arc::clone(ranks), name, firsts);
        Self {
            name,
            crew: Arc::new(Crew::new(parts, first, count, Some(post))),
            helpers: Arc::default(),
            pool,
        }
    }

    /// Goes the way of its parts; what they report, and their rows.
    fn go(&self, departure: &Departure) -> Message {
        departure.prepare(&self.crew);
        let work = || {
            self.helpers.ask(&self.crew);
            self.crew
                .work(rayon::current_thread_index().unwrap_or_default());
            self.helpers.dismiss();
        };
        match &self.pool {
            Some(pool) => pool.install(work),
            None => work(),
        }
        let mut parts = self.crew.parts();
        let reports: Vec<Report> = parts.iter_mut().map(|part| part.report()).collect();
        let mut message = postcard::to_allocvec(&reports).expect("it is data");
        for part in &parts {
            load(&part.world, &mut message);
        }
        message
    }
}

/// Appends the rows of own grains: one kind of rows after the other.
fn load(world: &OwnedWorld<f64>, message: &mut Message) {
    let rows = [
        &world.position,
        &world.velocity,
        &world.spin,
        &world.force,
        &world.torque,
    ];
    for rows in rows {
        for run in world.owned.chunks_exact(2) {
            let own = &rows[run[0] as usize..run[1] as usize];
            message.extend_from_slice(bytemuck::cast_slice(own));
        }
    }
    for run in world.owned.chunks_exact(2) {
        let own = &world.image[run[0] as usize..run[1] as usize];
        message.extend_from_slice(bytemuck::cast_slice(own));
    }
}

/// Puts the rows of the grains at these places home, and returns what follows them.
fn unload<'b>(mut bytes: &'b [u8], places: &[u32], home: &mut OwnedWorld<f64>) -> &'b [u8] {
    let rows = [
        &mut home.position,
        &mut home.velocity,
        &mut home.spin,
        &mut home.force,
        &mut home.torque,
    ];
    for rows in rows {
        let (own, others) = bytes.split_at(places.len() * size_of::<Row<f64>>());
        for (place, row) in places.iter().zip(own.chunks_exact(size_of::<Row<f64>>())) {
            rows[*place as usize] = bytemuck::pod_read_unaligned(row);
        }
        bytes = others;
    }
    let (own, others) = bytes.split_at(places.len() * size_of::<[i32; 3]>());
    for (place, image) in places.iter().zip(own.chunks_exact(size_of::<[i32; 3]>())) {
        home.image[*place as usize] = bytemuck::pod_read_unaligned(image);
    }
    others
}
