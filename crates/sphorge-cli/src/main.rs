//! The program `sphorge`.
fn main() {}
