//! The processes that `mpirun` or a scheduler started together, joined by MPI: they carry the messages between the
//! parts of a world.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::time::{Duration, Instant};

use bitgrain_kernel::BITS_VERSION;
use bitgrain_lab::selftest::selftest;
use bitgrain_sim::disk::read;
use bitgrain_sim::format::bytes;
use bitgrain_sim::parts::{Carrier, Message, Ranks, Sharing, dismiss, peaks, serve, silence};
use mpi::request::{Request, scope};
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, CommunicatorCollectives, Destination, Equivalence, Source};
use mpi::{Rank, Threading};

/// How long a sender that waits sleeps after looks in vain.
const NAP: Duration = Duration::from_micros(50);

/// Bytes of a message up to which its memory is used again: as many as letters have, and seldom orders.
const SPARED: usize = 1 << 24;

/// Exit status if ranks are not alike.
const UNLIKE: u8 = 3;

/// What must be the same on all ranks, and what a difference says.
const ALIKE: [&str; 4] = [
    "does not compute by the bit contract: `bitgrain selftest` there says more",
    "runs another version of bitgrain",
    "was built otherwise: all ranks must run the same file",
    "was called with other arguments",
];

/// Messages by MPI.
struct Mpi {
    rank: usize,
    ranks: usize,
    sharing: Sharing,
    /// Messages that were sent, in whose memory others arrive.
    spare: Vec<Message>,
}

impl Carrier for Mpi {
    fn rank(&self) -> usize {
        self.rank
    }

    fn ranks(&self) -> usize {
        self.ranks
    }

    fn carry(&mut self, out: Vec<(usize, Message)>, arrived: &mut dyn FnMut(usize, Message)) {
        let world = SimpleCommunicator::world();
        // Most looks send nothing, and there are many in a step.
        if out.is_empty() {
            return receive(&world, &mut self.spare, arrived);
        }
        if let Some((to, message)) = out
            .iter()
            .find(|(_, message)| Rank::try_from(message.len()).is_err())
        {
            self.give_up(&format!(
                "a message of {} bytes to rank {to} is longer than MPI takes: use more ranks",
                message.len()
            ));
        }
        let spare = &mut self.spare;
        let (rank, sharing) = (self.rank, self.sharing);
        scope(|scope| {
            let mut sends: Vec<(usize, Request<'_, [u8], _>)> = Vec::new();
            for (to, message) in &out {
                let process = world.process_at_rank(*to as Rank);
                sends.push((*to, process.immediate_send(scope, &message[..])));
            }
            let mut looks = 0;
            let began = Instant::now();
            loop {
                receive(&world, spare, arrived);
                let waiting = sends.into_iter();
                let waiting = waiting.filter_map(|(to, send)| Some((to, send.test().err()?)));
                sends = waiting.collect();
                if sends.is_empty() {
                    return;
                }
                looks += 1;
                if looks > sharing.looks() {
                    std::thread::sleep(NAP);
                    if began.elapsed() > sharing.patience_of(rank) {
                        let silent: Vec<usize> = sends.iter().map(|(to, _)| *to).collect();
                        give_up(rank, &silence(&silent, began.elapsed()));
                    }
                }
            }
        });
        let short = out.into_iter().map(|(_, message)| message);
        let short = short.filter(|message| message.len() <= SPARED);
        self.spare
            .extend(short.take(self.ranks.saturating_sub(self.spare.len())));
    }

    fn give_up(&mut self, why: &str) -> ! {
        give_up(self.rank, why)
    }
}

/// Ends all processes, after this one has said why.
fn give_up(rank: usize, why: &str) -> ! {
    eprintln!("bitgrain: rank {rank}: {why}");
    SimpleCommunicator::world().abort(i32::from(UNLIKE))
}

/// Hands over what has arrived.
fn receive(
    world: &SimpleCommunicator,
    spare: &mut Vec<Message>,
    arrived: &mut dyn FnMut(usize, Message),
) {
    while let Some((message, status)) = world.any_process().immediate_matched_probe() {
        let length = status.count(u8::equivalent_datatype());
        let mut bytes = spare.pop().unwrap_or_default();
        bytes.resize(usize::try_from(length).unwrap_or_default(), 0);
        message.matched_receive_into(&mut bytes[..]);
        arrived(
            usize::try_from(status.source_rank()).unwrap_or_default(),
            bytes,
        );
    }
}

/// Does the work on the first of the processes that were started together; the others do parts of its steps. Returns
/// the exit status.
pub fn together(work: impl FnOnce() -> u8) -> u8 {
    let Some((universe, level)) = mpi::initialize_with_threading(Threading::Serialized) else {
        eprintln!("bitgrain: MPI cannot be started");
        return 1;
    };
    let world = universe.world();
    let (rank, ranks) = (world.rank() as usize, world.size() as usize);
    if level < Threading::Serialized {
        if rank == 0 {
            eprintln!(
                "bitgrain: this MPI lets only one thread of a process call it; expected MPI_THREAD_SERIALIZED"
            );
        }
        return 1;
    }
    if let Some(problem) = unlike(&world) {
        if rank == 0 {
            eprintln!("bitgrain: {problem}");
        }
        return UNLIKE;
    }
    let told = |name: &str| std::env::var(name).ok()?.parse::<u64>().ok();
    // Open MPI says whether ranks have cores; of MPICH's it is counted.
    let cores = bitgrain_sim::threads::processors();
    let crowded = told("OMPI_MCA_mpi_oversubscribe").map(|is| is == 1);
    let beside = told("MPI_LOCALNRANKS").is_some_and(|ranks| ranks > cores as u64);
    let mut sharing = Sharing {
        part_min: told("BITGRAIN_PART_MIN").map(|grains| grains as usize),
        crowded: crowded.unwrap_or(beside),
        ..Sharing::default()
    };
    if let Some(seconds) = told("BITGRAIN_PATIENCE") {
        sharing.patience = Duration::from_secs(seconds);
    }
    let carrier = Mpi {
        rank,
        ranks,
        sharing,
        spare: Vec::new(),
    };
    let joined = Ranks::new(Box::new(carrier), sharing);
    if rank > 0 {
        // The first rank decides when all is done, and saves what it has if it is asked to stop.
        let _ = ctrlc::set_handler(|| ());
        serve(&joined);
        return 0;
    }
    joined.join();
    let status = work();
    if status == 0 {
        let told = peaks(&joined).into_iter().enumerate();
        let told = told.filter_map(|(rank, peak)| Some(format!("rank {rank} {}", bytes(peak?))));
        let told: Vec<String> = told.collect();
        eprintln!("most memory held: {}", told.join(", "));
    }
    dismiss(&joined);
    // MPI ends with this.
    drop(universe);
    status
}

/// What the ranks that are not like the first have, if there are any.
fn unlike(world: &SimpleCommunicator) -> Option<String> {
    let own = fingerprint();
    let mut all = vec![0u64; own.len() * world.size() as usize];
    world.all_gather_into(&own[..], &mut all[..]);
    // The first rank's, if its machine keeps the contract.
    let mut good = all[..own.len()].to_vec();
    good[0] = 1;
    let mut problems = Vec::new();
    for (rank, found) in all.chunks_exact(own.len()).enumerate() {
        let differs = found.iter().zip(&good).position(|(a, b)| a != b);
        problems.extend(differs.map(|k| format!("rank {rank} {}", ALIKE[k])));
    }
    (!problems.is_empty()).then(|| problems.join("; "))
}

/// Whether the machine keeps the contract, version, file and arguments.
fn fingerprint() -> [u64; 4] {
    let version = format!("{} {BITS_VERSION}", env!("CARGO_PKG_VERSION"));
    let file = std::env::current_exe()
        .ok()
        .and_then(|path| read(&path).ok());
    let words: Vec<_> = std::env::args_os().skip(1).collect();
    [
        u64::from(selftest(|_| Ok(())).is_ok()),
        hashed(&version),
        hashed(&file.unwrap_or_default()),
        hashed(&words),
    ]
}

/// Only compared among processes that run now.
fn hashed(what: &impl Hash) -> u64 {
    let mut hasher = DefaultHasher::new();
    what.hash(&mut hasher);
    hasher.finish()
}
