//! The program as its users run it: commands, their messages, their files, and the documents about them.

mod against;
mod bisect;
mod campaigns;
mod channels;
mod claims;
mod cli;
mod corpus;
mod damage;
mod documents;
mod errors;
mod export;
mod figures;
mod foreign;
mod forged;
mod memory;
mod notices;
mod packed;
mod parsers;
mod resume;
mod safety;
mod sweep;
mod tidy;
mod verify;
