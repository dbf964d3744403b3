//! Tests of the panel by keys and mouse, without a display.

mod drawing;
mod opened;
mod screen;
mod turning;
