//! Judgements: results of other programs against the reference of their scene: their errors, their
//! order, the method that they agree with, and the usual mistakes.

mod constant;
mod fit;
mod grid;
pub mod judgement;
pub mod picture;
pub mod plain;
mod rows;
mod scheme;
mod search;
pub mod summary;
pub mod trial;
pub mod truth;
pub mod value;
pub mod words;

pub use value::{JudgeOptions, StatesOf, Verdict, judge_states};
