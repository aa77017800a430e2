//! Processes that share a world: each has some of its parts. The first one has the whole world too and decides what is
//! done; the others [`serve`](super::serve()) it. What carries messages between them is a [`Carrier`].

use std::collections::VecDeque;
use std::fmt;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// What launchers of MPI programs call the number of processes in the environment of each that they start.
pub const LAUNCHED: [&str; 3] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE"];

/// A program that runs by itself, even if this process is one of several ranks.
pub fn alone(program: &Path) -> Command {
    let mut command = Command::new(program);
    for name in LAUNCHED {
        command.env_remove(name);
    }
    command
}

/// How ranks share worlds: none of it changes a bit.
#[derive(Clone, Copy, Debug)]
pub struct Sharing {
    /// How long a rank may be silent that others wait for; 10 minutes.
    pub patience: Duration,
    /// Fewest grains of a part, if not those of parts on threads.
    pub part_min: Option<usize>,
    /// Whether a machine has more ranks than cores: those that wait let go of their core at once.
    pub crowded: bool,
}

impl Sharing {
    /// Looks in vain, of half a microsecond, after which a waiting thread lets go of its core.
    pub fn looks(&self) -> u32 {
        match self.crowded {
            true => 60,
            false => 4000,
        }
    }

    /// How long this rank waits: the lowest one that waits says so, for all.
    pub fn patience_of(&self, rank: usize) -> Duration {
        self.patience + Duration::from_secs(rank as u64)
    }
}

impl Default for Sharing {
    fn default() -> Self {
        Self {
            patience: Duration::from_secs(600),
            part_min: None,
            crowded: false,
        }
    }
}

/// How long it then sleeps.
const NAP: Duration = Duration::from_micros(50);

/// A message; what it is about stands at its end, where it is put and taken without moving the rest.
pub type Message = Vec<u8>;

/// Carries messages between processes that are numbered from 0. Those of one sender arrive in the order in which they
/// were sent, whole and unchanged.
pub trait Carrier: Send {
    /// The number of this process.
    fn rank(&self) -> usize;

    /// How many processes there are.
    fn ranks(&self) -> usize;

    /// Sends messages to other ranks, and hands over what has arrived, with its sender. It returns once all are on
    /// their way; while it waits for that it goes on handing over what arrives, and gives up on a rank that takes
    /// nothing for too long. It may hand over what arrives in the memory of messages that were sent.
    fn carry(&mut self, out: Vec<(usize, Message)>, arrived: &mut dyn FnMut(usize, Message));

    /// Ends all processes, after this one has said why.
    fn give_up(&mut self, why: &str) -> !;
}

/// This process among those that share a world.
pub struct Ranks {
    rank: usize,
    ranks: usize,
    mail: Mutex<Mail>,
    /// Of the next world that is cut.
    next: AtomicU32,
    sharing: Sharing,
}

/// The carrier, and messages that nobody has asked for yet.
pub(super) struct Mail {
    carrier: Box<dyn Carrier>,
    letters: VecDeque<(u32, Message)>,
    orders: VecDeque<Message>,
    replies: Vec<VecDeque<Message>>,
    /// Messages that were read, whose memory others take.
    pub spare: Vec<Message>,
    /// When something last arrived.
    heard: Instant,
}

/// What a message is.
const LETTER: u8 = 0;
const ORDER: u8 = 1;
const REPLY: u8 = 2;

static JOINED: OnceLock<Arc<Ranks>> = OnceLock::new();

impl Ranks {
    /// The ranks that a carrier joins.
    pub fn new(carrier: Box<dyn Carrier>, sharing: Sharing) -> Arc<Self> {
        let (rank, ranks) = (carrier.rank(), carrier.ranks());
        let mail = Mail {
            carrier,
            letters: VecDeque::new(),
            orders: VecDeque::new(),
            replies: vec![VecDeque::new(); ranks],
            spare: Vec::new(),
            heard: Instant::now(),
        };
        Arc::new(Self {
            rank,
            ranks,
            mail: Mutex::new(mail),
            next: AtomicU32::new(0),
            sharing,
        })
    }

    /// Lets all simulations of this process step on these ranks from now on.
    ///
    /// # Panics
    /// If it was done before.
    pub fn join(self: &Arc<Self>) {
        let joined = JOINED.set(Arc::clone(self));
        assert!(joined.is_ok(), "a process joins once");
    }

    /// Those that this process has joined, if it has.
    pub fn joined() -> Option<Arc<Self>> {
        JOINED.get().cloned()
    }

    /// The number of this process.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// How many processes there are.
    pub fn count(&self) -> usize {
        self.ranks
    }

    /// How they share worlds.
    pub fn sharing(&self) -> Sharing {
        self.sharing
    }

    /// A name for a world that is cut.
    pub(super) fn name(&self) -> u32 {
        self.next.fetch_add(1, Ordering::Relaxed)
    }

    pub(super) fn mail(&self) -> MutexGuard<'_, Mail> {
        self.mail.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The mail, if no other thread has it.
    pub(super) fn try_mail(&self) -> Option<MutexGuard<'_, Mail>> {
        self.mail.try_lock().ok()
    }

    /// Sends an order to ranks.
    pub(super) fn order(&self, orders: Vec<(usize, Message)>) {
        self.mail().send(ORDER, orders);
    }

    /// Answers rank 0.
    pub(super) fn reply(&self, reply: Message) {
        self.mail().send(REPLY, vec![(0, reply)]);
    }

    /// The next order of rank 0; it may take as long as it likes.
    pub(super) fn next_order(&self) -> Message {
        self.await_mail(|mail| mail.orders.pop_front(), |_| ())
    }

    /// The next reply of a rank.
    pub(super) fn reply_of(&self, rank: usize) -> Message {
        self.await_mail(
            |mail| mail.replies[rank].pop_front(),
            |mail| mail.expect(&[rank], self.patience()),
        )
    }

    fn await_mail(
        &self,
        take: impl Fn(&mut Mail) -> Option<Message>,
        wait: impl Fn(&mut Mail),
    ) -> Message {
        let mut looks = 0;
        self.mail().heard = Instant::now();
        loop {
            let mut mail = self.mail();
            if let Some(message) = take(&mut mail) {
                return message;
            }
            mail.look();
            wait(&mut mail);
            drop(mail);
            looks += 1;
            if looks > self.sharing.looks() {
                std::thread::sleep(NAP);
            }
        }
    }

    /// How long a rank may be silent.
    pub(super) fn patience(&self) -> Duration {
        self.sharing.patience_of(self.rank)
    }

    /// Ends all ranks, after this one has said why.
    pub fn give_up(&self, why: &str) -> ! {
        self.mail().carrier.give_up(why)
    }
}

impl Mail {
    /// Sends messages of one kind, and takes in what arrives.
    pub fn send(&mut self, kind: u8, messages: Vec<(usize, Message)>) {
        let signed = |(to, mut message): (usize, Message)| {
            message.push(kind);
            (to, message)
        };
        self.carry(messages.into_iter().map(signed).collect());
    }

    /// Sends letters of parts, which end with the name of their world.
    pub fn send_letters(&mut self, letters: Vec<(usize, Message)>) {
        self.send(LETTER, letters);
    }

    /// Takes in what has arrived.
    pub fn look(&mut self) {
        self.carry(Vec::new());
    }

    fn carry(&mut self, out: Vec<(usize, Message)>) {
        let Self {
            carrier,
            letters,
            orders,
            replies,
            heard,
            ..
        } = self;
        carrier.carry(out, &mut |from, mut message| {
            *heard = Instant::now();
            match message.pop() {
                Some(LETTER) => {
                    let end = message.len() - size_of::<u32>();
                    let name = message[end..].try_into().expect("four bytes");
                    message.truncate(end);
                    letters.push_back((u32::from_le_bytes(name), message));
                }
                Some(ORDER) => orders.push_back(message),
                _ => replies[from].push_back(message),
            }
        });
    }

    /// Keeps the memory of a letter that was read; one for each rank is enough.
    pub fn keep(&mut self, letter: Message) {
        if self.spare.len() < self.replies.len() {
            self.spare.push(letter);
        }
    }

    /// The next letter between the parts of a world.
    pub fn letter(&mut self, world: u32) -> Option<Message> {
        let place = self.letters.iter().position(|(of, _)| *of == world)?;
        self.letters.remove(place).map(|(_, letter)| letter)
    }

    /// Gives up if nothing was heard for so long while these ranks are waited for.
    pub fn expect(&mut self, ranks: &[usize], patience: Duration) {
        let silent = self.heard.elapsed();
        if silent > patience && !ranks.is_empty() {
            self.carrier.give_up(&silence(ranks, silent));
        }
    }
}

/// Why a rank gives up after others were silent for so long.
pub fn silence(ranks: &[usize], lasting: Duration) -> String {
    let names: Vec<String> = ranks.iter().map(|rank| format!("rank {rank}")).collect();
    format!(
        "{} did not answer for {} s; what was saved last is good: see whether its machine is well, and run again",
        names.join(", "),
        lasting.as_secs()
    )
}

impl fmt::Debug for Ranks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "rank {} of {}", self.rank, self.ranks)
    }
}
