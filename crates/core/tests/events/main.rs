//! Tests of events within a step: motions that begin or end, contacts and tears.

#[path = "../common/mod.rs"]
mod common;

mod carried;
mod dying;
mod frames;
mod jumps;
mod known_times;
mod orders;
mod outflows;
mod rebounds;
mod releases;
mod resting;
mod ropes;
mod seams;
mod tears;
mod thin;
mod touches;
mod turntable;
