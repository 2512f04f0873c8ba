//! Unmodelled forms, which prevent that an effect outside the catalogue is attributed to the most similar one in it.

mod history;
mod other_position;
mod other_speed;
mod own_position;
mod periodic;
mod product;
mod time;

pub use history::History;
pub use other_position::OtherPosition;
pub use other_speed::OtherSpeed;
pub use own_position::OwnPosition;
pub use periodic::{Periodic, columns as periodic_columns};
pub use product::Product;
pub use time::Time;
