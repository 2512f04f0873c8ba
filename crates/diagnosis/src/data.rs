//! Phase 1, data: recordings filtered and differentiated alike, the rigid model along them, scales and noise.

pub mod channels;
pub mod known;
pub mod measure;
pub mod motion;
pub mod noise;
pub mod rigid;
pub mod signal;
