//! The program `sphorge`.

use std::process::ExitCode;

#[global_allocator]
static MEMORY: sphorge_cli::OrEnd = sphorge_cli::OrEnd;

fn main() -> ExitCode {
    // Where the system does not tell, by its name.
    let program = std::env::current_exe().map_or_else(|_| "sphorge".into(), Into::into);
    ExitCode::from(sphorge_cli::execute(std::env::args_os().collect(), &[program]))
}
