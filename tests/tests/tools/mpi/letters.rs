//! What ranks tell each other in a step, counted.

use std::fs;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use bitgrain::bench;
use bitgrain::parts::{Carrier, Channels, Message, Ranks, Sharing, on_ranks};
use bitgrain::simulation::Simulation;
use bitgrain_tests::golden;

/// Letters that a rank has sent, and their bytes.
#[derive(Default)]
struct Sent {
    letters: AtomicU64,
    bytes: AtomicU64,
}

/// A carrier that counts letters between parts; orders and replies are few.
struct Counting {
    channels: Channels,
    sent: Arc<Sent>,
}

impl Carrier for Counting {
    fn rank(&self) -> usize {
        self.channels.rank()
    }

    fn ranks(&self) -> usize {
        self.channels.ranks()
    }

    fn carry(&mut self, out: Vec<(usize, Message)>, arrived: &mut dyn FnMut(usize, Message)) {
        // A letter ends with 0.
        for (_, message) in out.iter().filter(|(_, message)| message.last() == Some(&0)) {
            self.sent.letters.fetch_add(1, Ordering::Relaxed);
            let bytes = message.len() as u64;
            self.sent.bytes.fetch_add(bytes, Ordering::Relaxed);
        }
        self.channels.carry(out, arrived);
    }

    fn give_up(&mut self, why: &str) -> ! {
        self.channels.give_up(why)
    }
}

/// Steps that are counted, after those that put the parts on their way.
const COUNTED: u64 = 100;

/// Letters of a step by the ranks, and kilobytes, of all and of the rank that sends most.
fn counted(begin: &Simulation, count: usize) -> String {
    let sent: Vec<Arc<Sent>> = (0..count).map(|_| Arc::default()).collect();
    let carriers = Channels::between(count).into_iter().zip(&sent);
    let carriers = carriers.map(|(channels, sent)| Counting {
        channels,
        sent: Arc::clone(sent),
    });
    let ranks = carriers.map(|carrier| Ranks::new(Box::new(carrier), Sharing::default()));
    let so_far = || -> Vec<[u64; 2]> {
        let of = |sent: &Arc<Sent>| [&sent.letters, &sent.bytes].map(|n| n.load(Ordering::Relaxed));
        sent.iter().map(of).collect()
    };
    on_ranks(ranks.collect(), |first| {
        let mut sim = begin.clone();
        sim.stepping.tunes = false;
        sim.stepping.ranks = Some(Arc::clone(first));
        sim.steps(20).unwrap();
        let before = so_far();
        let (searches, ..) = sim.list_counts();
        sim.steps(COUNTED).unwrap();
        let (now, ..) = sim.list_counts();
        let after = so_far();
        let of = |k: usize| before.iter().zip(&after).map(move |(a, b)| b[k] - a[k]);
        let letters = of(0).sum::<u64>();
        let [all, most] = [of(1).sum::<u64>(), of(1).max().unwrap()];
        let step = |bytes: u64| bytes as f64 / (1000 * COUNTED) as f64;
        format!(
            "{},{count},{},{:.2},{:.1},{:.1}\n",
            sim.count(),
            now - searches,
            letters as f64 / COUNTED as f64,
            step(all),
            step(most)
        )
    })
}

/// Counted at a million grains, as the guide says.
#[test]
#[ignore = "a million grains on 16 ranks: `.ci/run ranks-all`"]
fn messages_and_bytes_of_a_step() {
    let one = bench::read_bed(&golden("peers/bed200.data")).unwrap();
    let mut table = String::from("grains,ranks,searches,letters,kilobytes,kilobytes_of_one\n");
    for tiles in [16, 71] {
        let mut bed = bench::tiled(&one, tiles).unwrap();
        bed.start().unwrap();
        for count in [2, 4, 8, 16] {
            table += &counted(&bed, count);
        }
    }
    print!("{table}");
    let file = golden("ranks.csv");
    if std::env::var("INSTA_UPDATE").is_ok_and(|asked| asked == "always") {
        fs::write(&file, &table).unwrap();
    }
    assert_eq!(table, fs::read_to_string(file).unwrap());
}
