//! What a run looks like: everything that its database holds, figures of it, and a page.

mod data;
pub mod figures;
pub mod page;
mod watch;

pub use data::RunData;
pub use watch::{Watched, watch};
