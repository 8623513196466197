//! raylab
fn main() {}
