//! Phase 4, selection: which of the effects found keep their name, by size, evidence and prediction of held-out recordings.

pub mod final_fit;
pub mod judge;
pub mod naming;
pub mod predict;
pub mod unmounted;
