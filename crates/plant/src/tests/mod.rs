//! The laws a plant keeps, and how far from them it may drift.

mod closed_loop;
mod dynamics;
mod friction;
mod stick_slip;
mod swing;
