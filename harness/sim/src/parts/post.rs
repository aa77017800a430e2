//! Letters between parts of different ranks: what each rank needs of a letter goes there, and is put on the desk of the
//! part that wrote it as if it had been written here.

use std::ops::Range;
use std::sync::Arc;

use bitgrain_kernel::parts::GhostMotion;
use bitgrain_kernel::phases::Extent;
use serde::{Deserialize, Serialize};

use super::exchange::Exchange;
use super::letter::{Found, Letter, Offer, Told};
use super::ranks::{Mail, Message, Ranks};
use super::share::Share;

/// The post of one world's parts at one rank.
pub(super) struct Post {
    ranks: Arc<Ranks>,
    /// The world.
    pub name: u32,
    /// Where the parts of each rank begin; and where the last ones end.
    firsts: Vec<usize>,
    /// Looks in vain after which a thread lets go of its core.
    pub looks: u32,
}

/// What goes to a rank, before rows.
#[derive(Serialize, Deserialize)]
struct Envelope {
    part: usize,
    content: Content,
}

#[derive(Serialize, Deserialize)]
enum Content {
    /// What was found, the skins, how many rows follow for each part, and what free obstacles are pushed by.
    Found(Found, [f64; 2], Vec<usize>, Vec<Share>),
    /// The extent, the skins, seconds of work, own grains.
    Extent(Option<Extent<f64>>, [f64; 2], f64, usize),
    /// For each part.
    Offers(Vec<Vec<Offer>>),
}

impl Post {
    pub fn new(ranks: Arc<Ranks>, name: u32, firsts: Vec<usize>) -> Self {
        Self {
            looks: ranks.sharing().looks(),
            ranks,
            name,
            firsts,
        }
    }

    /// The parts of a rank.
    pub fn parts(&self, rank: usize) -> Range<usize> {
        self.firsts[rank]..self.firsts[rank + 1]
    }

    /// Ranks that have parts, but for this one.
    fn others(&self) -> impl Iterator<Item = usize> + '_ {
        let own = self.ranks.rank();
        (0..self.firsts.len() - 1).filter(move |rank| *rank != own)
    }

    /// Sends the letter that a part has just written to the other ranks.
    pub fn send(&self, part: usize, letters: &Exchange<Letter>) {
        let mut mail = self.ranks.mail();
        let out = {
            let letter = letters.read(part, part);
            let to = |rank| {
                let paper = mail.spare.pop().unwrap_or_default();
                (rank, self.enveloped(part, &letter, self.parts(rank), paper))
            };
            self.others().map(to).collect()
        };
        mail.send_letters(out);
        self.deliver(&mut mail, letters);
    }

    /// Puts what has arrived on the desks.
    pub fn look(&self, letters: &Exchange<Letter>) {
        if let Some(mut mail) = self.ranks.try_mail() {
            mail.look();
            self.deliver(&mut mail, letters);
        }
    }

    /// Gives up on ranks that have been silent for too long, while a part waits for them.
    pub fn expect_answers(&self, part: usize, letters: &Exchange<Letter>) {
        let late: Vec<usize> = letters.late(part).collect();
        let is_late = |rank: &usize| late.iter().any(|part| self.parts(*rank).contains(part));
        let ranks: Vec<usize> = self.others().filter(is_late).collect();
        if let Some(mut mail) = self.ranks.try_mail() {
            mail.expect(&ranks, self.ranks.patience());
        }
    }

    fn deliver(&self, mail: &mut Mail, letters: &Exchange<Letter>) {
        while let Some(message) = mail.letter(self.name) {
            self.open(&message, letters);
            mail.keep(message);
        }
    }

    /// What the parts of a rank need of a letter, written over an old message.
    fn enveloped(
        &self,
        part: usize,
        letter: &Letter,
        of: Range<usize>,
        mut message: Message,
    ) -> Message {
        let content = match letter.told {
            Told::Found => {
                let rows = letter.rows[of.clone()].iter();
                let lengths = rows.map(Vec::len).collect();
                Content::Found(letter.found, letter.skins, lengths, letter.pushes.clone())
            }
            Told::Extent => {
                Content::Extent(letter.extent, letter.skins, letter.busy, letter.grains)
            }
            Told::Offers => Content::Offers(letter.offers[of.clone()].to_vec()),
        };
        let envelope = Envelope { part, content };
        message.clear();
        message = postcard::to_extend(&envelope, message).expect("it is data");
        if letter.told == Told::Found {
            for rows in &letter.rows[of] {
                message.extend_from_slice(bytemuck::cast_slice(rows));
            }
        }
        message.extend_from_slice(&self.name.to_le_bytes());
        message
    }

    /// Writes a letter from elsewhere on the desk of its part.
    fn open(&self, message: &[u8], letters: &Exchange<Letter>) {
        let opened = postcard::take_from_bytes::<Envelope>(message);
        let (Envelope { part, content }, mut rows) = opened.expect("ranks are of one build");
        let here = self.parts(self.ranks.rank());
        letters.write(part, |letter| match content {
            Content::Found(found, skins, lengths, pushes) => {
                (letter.told, letter.found, letter.skins) = (Told::Found, found, skins);
                letter.pushes = pushes;
                letter
                    .rows
                    .resize_with(self.firsts[self.firsts.len() - 1], Vec::new);
                for (to, length) in letter.rows[here].iter_mut().zip(lengths) {
                    let bytes = length * size_of::<GhostMotion<f64>>();
                    let (own, others) = rows.split_at(bytes);
                    rows = others;
                    to.resize(length, [[0.0; 3]; 3]);
                    bytemuck::cast_slice_mut(to).copy_from_slice(own);
                }
            }
            Content::Extent(extent, skins, busy, grains) => {
                letter.told = Told::Extent;
                (letter.extent, letter.skins) = (extent, skins);
                (letter.busy, letter.grains) = (busy, grains);
            }
            Content::Offers(offers) => {
                letter.told = Told::Offers;
                letter
                    .offers
                    .resize_with(self.firsts[self.firsts.len() - 1], Vec::new);
                for (to, offers) in letter.offers[here].iter_mut().zip(offers) {
                    *to = offers;
                }
            }
        });
    }
}
