//! The post of parts that are all here.

use super::exchange::Exchange;
use super::letter::Letter;

/// All parts are here.
pub(super) enum Post {}

impl Post {
    pub fn send(&self, _: usize, _: &Exchange<Letter>) {
        match *self {}
    }

    pub fn look(&self, _: &Exchange<Letter>) {
        match *self {}
    }

    pub fn expect_answers(&self, _: usize, _: &Exchange<Letter>) {
        match *self {}
    }
}
