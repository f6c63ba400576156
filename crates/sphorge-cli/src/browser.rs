//! Opening the browser of whoever sits at this machine.

use std::{
    env,
    process::{Command, Stdio},
};

/// Opens an address in the browser.
///
/// # Errors
/// Why there is none, in words.
pub(crate) fn open(address: &str) -> Result<(), &'static str> {
    if cfg!(all(unix, not(target_os = "macos"))) && !has_screen() {
        return Err("there is no screen here");
    }
    let mut command = opener();
    command.arg(address).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    // It may be a browser that stays: nobody waits for it.
    command.spawn().map(drop).map_err(|_| "no program was found that opens it")
}

fn has_screen() -> bool {
    ["BROWSER", "DISPLAY", "WAYLAND_DISPLAY"]
        .iter()
        .any(|name| env::var_os(name).is_some_and(|value| !value.is_empty()))
}

fn opener() -> Command {
    if let Some(own) = env::var_os("BROWSER").filter(|own| !own.is_empty()) {
        return Command::new(own);
    }
    if cfg!(target_os = "windows") {
        let mut command = Command::new("rundll32");
        command.arg("url.dll,FileProtocolHandler");
        return command;
    }
    Command::new(if cfg!(target_os = "macos") { "open" } else { "xdg-open" })
}
