//! The physical laws that a plant obeys, with the largest allowed errors.

mod closed_loop;
mod dynamics;
mod friction;
mod stick_slip;
mod swing;
