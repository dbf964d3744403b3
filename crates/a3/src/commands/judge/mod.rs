//! `a3 judge`: results of other programs against the reference of their scene: their errors, their
//! order, the method that they agree with, and the usual mistakes.

mod command;
mod constant;
mod finding;
mod fit;
mod grid;
mod judgement;
mod pace;
mod picture;
mod plain;
mod quantity;
mod rows;
mod scheme;
mod search;
mod summary;
mod trial;
mod truth;
mod value;
mod words;

pub use command::run;
pub use value::{JudgeOptions, StatesOf, Verdict, judge_states};
