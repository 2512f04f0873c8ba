//! Forms without a name: what is none of the catalogue's effects is not to be given to the nearest.

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
