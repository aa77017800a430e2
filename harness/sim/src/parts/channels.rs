//! Ranks that are threads of one process: what runs on ranks is tested and tried with them, without MPI.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use super::ranks::{Carrier, Message, Ranks};
use super::service::{dismiss, serve};
use crate::threads::builder;

/// Messages between threads.
#[derive(Debug)]
pub struct Channels {
    rank: usize,
    to: Vec<Sender<(usize, Message)>>,
    from: Receiver<(usize, Message)>,
}

impl Channels {
    /// The carriers of so many ranks, in order.
    pub fn between(ranks: usize) -> Vec<Self> {
        let (to, from): (Vec<_>, Vec<_>) = (0..ranks).map(|_| channel()).unzip();
        let carrier = |(rank, from)| Self {
            rank,
            to: to.clone(),
            from,
        };
        from.into_iter().enumerate().map(carrier).collect()
    }
}

impl Carrier for Channels {
    fn rank(&self) -> usize {
        self.rank
    }

    fn ranks(&self) -> usize {
        self.to.len()
    }

    fn carry(&mut self, out: Vec<(usize, Message)>, arrived: &mut dyn FnMut(usize, Message)) {
        for (to, message) in out {
            // Who is gone needs no message; who waits for an answer says so.
            let _ = self.to[to].send((self.rank, message));
        }
        while let Ok((from, message)) = self.from.try_recv() {
            arrived(from, message);
        }
    }

    fn give_up(&mut self, why: &str) -> ! {
        panic!("{why}")
    }
}

/// Does a job as the first of these ranks; the others are threads that serve it until it is done.
pub fn on_ranks<T>(mut ranks: Vec<Arc<Ranks>>, job: impl FnOnce(&Arc<Ranks>) -> T) -> T {
    let others = ranks.split_off(1);
    let first = &ranks[0];
    thread::scope(|scope| {
        for other in others {
            let started = builder().spawn_scoped(scope, move || serve(&other));
            started.expect("a thread for each rank");
        }
        // Also if the job panics: else the others would wait for ever.
        let _dismissal = Dismissal(first);
        job(first)
    })
}

struct Dismissal<'r>(&'r Ranks);

impl Drop for Dismissal<'_> {
    fn drop(&mut self) {
        dismiss(self.0);
    }
}

#[cfg(test)]
mod tests {

    use bitgrain_kernel::contact::HertzHistory;
    use bitgrain_kernel::{Domain, Group, Obstacle};

    use super::*;
    use crate::law::AnyLaw;
    use crate::parts::{Cutting, Sharing};
    use crate::simulation::{Grain, Simulation};

    /// A plane under 40 grains that lie in it unlike deep.
    fn lain() -> Simulation {
        let law = HertzHistory {
            kn: 1e5,
            kt: 1e5,
            gamma_n: 500.0,
            gamma_t: 500.0,
            mu: 0.5,
        };
        let domain = Domain::new([0.0; 3], [50.0, 4.0, 4.0], [true, false, false]).expect("a box");
        let grain = |id: u32| Grain {
            id,
            group: 0,
            diameter: 1.0,
            density: 1.0,
            position: [
                1.2 * f64::from(id),
                2.0,
                0.5 - 1e-3 * f64::from(id * id % 37),
            ],
            velocity: [0.3, 0.0, 0.0],
            spin: [0.0; 3],
        };
        let grains: Vec<Grain> = (1..=40).map(grain).collect();
        let plane = Obstacle::plane([0.0; 3], [0.0, 0.0, 1.0]);
        let groups = vec![Group::free([0.0, 0.0, -1.0])];
        let law = AnyLaw::HertzHistory(law);
        let mut sim = Simulation::new(law, domain, 1e-4, groups, &grains, vec![plane]);
        sim.start().expect("a sound bed");
        sim
    }

    /// The force on an obstacle is summed by grain, whichever rank has it: an order by rank has other bits here.
    #[test]
    fn an_obstacle_is_pushed_grain_by_grain_whatever_rank_has_it() {
        let mut plain = lain();
        plain.steps(20).unwrap();
        for count in [2, 3, 5] {
            let carriers = Channels::between(count).into_iter();
            let joined = |carrier| Ranks::new(Box::new(carrier), Sharing::default());
            on_ranks(carriers.map(joined).collect(), |first| {
                let mut sim = lain();
                sim.stepping.divide_always();
                sim.stepping.cutting = Cutting::Scattered(3);
                sim.stepping.ranks = Some(Arc::clone(first));
                sim.steps(20).unwrap();
                assert_eq!(sim.stepping.parts(), count);
                assert_eq!(sim.obstacles[0].force, plain.obstacles[0].force);
                assert_eq!(sim.obstacles[0].torque, plain.obstacles[0].torque);
            });
        }
    }
}
