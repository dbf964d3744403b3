//! Tests of the panel, by keys and by the mouse in a window without a screen.

mod drawing;
mod opened;
mod screen;
mod turning;
