//! The post of parts that are all here.

use std::convert::Infallible;

use super::exchange::Exchange;
use super::letter::Letter;

/// All parts are here.
pub(super) struct Post {
    pub looks: u32,
    nowhere: Infallible,
}

impl Post {
    pub fn send(&self, _: usize, _: &Exchange<Letter>) {
        match self.nowhere {}
    }

    pub fn look(&self, _: &Exchange<Letter>) {
        match self.nowhere {}
    }

    pub fn expect_answers(&self, _: usize, _: &Exchange<Letter>) {
        match self.nowhere {}
    }
}
