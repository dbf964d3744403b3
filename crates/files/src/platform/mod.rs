//! What the program has and a page has not: a disk, a terminal, and signals.

pub mod bar;
pub mod fault;
pub mod interrupt;
pub mod output;
mod read;
pub mod terminal;

pub use read::{read, read_checkpoint};
