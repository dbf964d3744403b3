//! Tests of the panel by keys and mouse, without a display.

mod drawing;
mod leaving_out;
mod measuring;
mod screen;
mod turning;
