//! The machine a measurement was made on.

use serde::Serialize;
use std::{collections::BTreeSet, fmt, fs, thread};

/// What a speed depends on beside the program.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Machine {
    /// Processor as it names itself; empty where the system does not tell.
    pub processor: String,
    /// Processors the program may use, hyper-threads counted.
    pub logical_processors: usize,
    /// Cores of all sockets; `None` where the system does not tell.
    pub cores: Option<usize>,
    /// Vector instructions the processor has.
    pub vector_instructions: Vec<&'static str>,
}

impl Machine {
    /// The machine the program runs on.
    pub fn here() -> Self {
        let information = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let (processor, cores) = parse(&information);
        Self {
            processor,
            logical_processors: thread::available_parallelism().map_or(1, |n| n.get()),
            cores,
            vector_instructions: vector_instructions(),
        }
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let processor = if self.processor.is_empty() { "an unnamed processor" } else { &self.processor };
        write!(f, "{processor}, {} logical processors", self.logical_processors)?;
        if let Some(cores) = self.cores {
            write!(f, ", {cores} cores")?;
        }
        write!(f, " ({})", self.vector_instructions.join(", "))
    }
}

/// Model name and number of distinct (socket, core) pairs.
fn parse(information: &str) -> (String, Option<usize>) {
    let mut model = String::new();
    let mut cores = BTreeSet::new();
    let mut socket = "";
    for line in information.lines() {
        let Some((key, value)) = line.split_once(':') else { continue };
        match key.trim() {
            "model name" => model = value.trim().to_owned(),
            "physical id" => socket = value.trim(),
            "core id" => {
                cores.insert((socket, value.trim()));
            }
            _ => {}
        }
    }
    (model, (!cores.is_empty()).then_some(cores.len()))
}

#[cfg(target_arch = "x86_64")]
fn vector_instructions() -> Vec<&'static str> {
    let mut found = vec!["SSE2"];
    if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
        found.push("AVX2+FMA");
    }
    if is_x86_feature_detected!("avx512f") {
        found.push("AVX-512");
    }
    found
}

#[cfg(target_arch = "aarch64")]
fn vector_instructions() -> Vec<&'static str> {
    vec!["NEON"]
}

#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
fn vector_instructions() -> Vec<&'static str> {
    Vec::new()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hyper_threads_of_a_core_count_once() {
        let thread =
            |socket, core| format!("model name\t: Some CPU @ 2 GHz\nphysical id\t: {socket}\ncore id\t\t: {core}\n\n");
        let text: String = [(0, 0), (0, 1), (0, 0), (0, 1), (1, 0), (1, 1)].map(|(s, c)| thread(s, c)).concat();
        assert_eq!(parse(&text), ("Some CPU @ 2 GHz".to_owned(), Some(4)));
        assert_eq!(parse(""), (String::new(), None));
    }
}
