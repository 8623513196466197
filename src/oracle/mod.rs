//! Truth on the given `f32` numbers: what a ray really hits.
