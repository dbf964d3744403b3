//! Judgements: results of other programs against the reference of their scene: their errors, their
//! order, the method that they agree with, and the usual mistakes.

mod constant;
mod grid;
pub mod judgement;
pub mod picture;
mod plain;
mod rows;
mod scheme;
mod search;
pub mod trial;
pub mod value;
pub mod words;

pub use value::{JudgeOptions, StatesOf, Verdict, judge_states};
