//! Pages and texts: of made-up diagnoses, and of blocks.

mod blocks;
mod made_up;
mod page;
mod terminal;
