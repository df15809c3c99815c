//! What a run looks like: everything that its database holds, figures of it, and a page.

mod data;

pub use data::RunData;
