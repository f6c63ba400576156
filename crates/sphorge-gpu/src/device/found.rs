//! What GPUs there are, and what is in the way of others.

use super::{cuda, graphics, host};

/// Through what a GPU is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interface {
    /// NVIDIA's own.
    Cuda,
    /// On Linux and Windows.
    Vulkan,
    /// On macOS.
    Metal,
    /// On Windows.
    Direct3d12,
    /// None: the processor executes kernels itself.
    Host,
}

impl std::fmt::Display for Interface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Cuda => "CUDA",
            Self::Vulkan => "Vulkan",
            Self::Metal => "Metal",
            Self::Direct3d12 => "Direct3D 12",
            Self::Host => "interpreter",
        })
    }
}

/// Memory of a GPU, bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Memory {
    /// All of it.
    pub total: u64,
    /// What nobody has taken, where that is known.
    pub free: Option<u64>,
}

/// A GPU, or what stands for one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found {
    /// As its driver calls it.
    pub name: String,
    /// Through what it is reached.
    pub interface: Interface,
    /// Its driver, with the version.
    pub driver: String,
    /// Whether it is a program on the processor: kernels are checked on it, but nothing is faster.
    pub is_software: bool,
    /// Largest buffer, bytes.
    pub largest_buffer: u64,
    /// Its memory, where its driver says.
    pub memory: Option<Memory>,
}

impl Found {
    /// Whether every word, whatever its case, is one of the name or of the interface.
    fn is_called(&self, words: &str) -> bool {
        let text = format!("{} {}", self.name, self.interface).to_lowercase();
        words.to_lowercase().split_whitespace().all(|word| text.contains(word))
    }

    /// Name and interface.
    pub fn title(&self) -> String {
        format!("{} by {}", self.name, self.interface)
    }
}

/// Why no GPU is reached through an interface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Missing {
    /// The interface.
    pub interface: Interface,
    /// What is not there.
    pub why: String,
    /// What helps.
    pub cure: String,
}

/// Everything that was looked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Survey {
    /// Every GPU that is reached, once for each interface, the one that is taken without being asked for first.
    pub cards: Vec<Found>,
    /// What is in the way of others.
    pub missing: Vec<Missing>,
}

/// A GPU that can be opened.
pub(super) enum Candidate {
    Cuda(cuda::Candidate),
    Graphics(Box<wgpu::Adapter>, Found),
    Host(Found),
}

impl Candidate {
    pub(super) fn found(&self) -> &Found {
        match self {
            Self::Cuda(candidate) => &candidate.found,
            Self::Graphics(_, found) | Self::Host(found) => found,
        }
    }
}

/// What can be opened, and what cannot. NVIDIA's GPUs come first, by their own interface, and what runs on the processor last.
pub(super) fn candidates() -> (Vec<Candidate>, Vec<Missing>) {
    let (mut candidates, mut missing) = (Vec::new(), Vec::new());
    match cuda::candidates() {
        Ok(cards) => candidates.extend(cards.into_iter().map(Candidate::Cuda)),
        Err(why) => missing.push(why),
    }
    let by_graphics: Vec<_> = graphics::adapters()
        .into_iter()
        .map(|adapter| {
            let found = graphics::found(&adapter);
            Candidate::Graphics(Box::new(adapter), found)
        })
        .collect();
    missing.extend(missing_graphics(by_graphics.iter().map(Candidate::found)));
    candidates.extend(by_graphics);
    (candidates, missing)
}

/// Why there is no GPU by the interface of graphics of this system, and nothing that stands for one.
fn why_there_is_none() -> String {
    #[cfg(target_os = "linux")]
    return super::vulkan::what_is_missing();
    #[cfg(not(target_os = "linux"))]
    "no driver is installed".to_owned()
}

/// What is in the way of GPUs by the interface of graphics of this system.
fn missing_graphics<'a>(mut found: impl Iterator<Item = &'a Found>) -> Option<Missing> {
    let mut software = None;
    let is_card = found.any(|card| {
        if card.is_software {
            software = Some(card.name.clone());
        }
        !card.is_software
    });
    if is_card {
        return None;
    }
    let (interface, cure) = if cfg!(target_os = "macos") {
        (Interface::Metal, "use a Mac with a graphics card")
    } else if cfg!(windows) {
        (Interface::Direct3d12, "install the driver of the card")
    } else {
        (
            Interface::Vulkan,
            "install the driver of the card: `mesa-vulkan-drivers` for AMD and Intel (the user must be in the group \
             `render`), for NVIDIA the driver with its Vulkan part and, in a container, what it needs (`libglvnd0`, \
             `libx11-6`, `libxext6`); and `libvulkan1`. Libraries outside the system's folders are found by \
             `LD_LIBRARY_PATH`, and VK_LOADER_DEBUG=all shows what the loader tries",
        )
    };
    let why = software.map_or_else(why_there_is_none, |name| {
        format!("there is only a software renderer, {name}, which runs on the processor")
    });
    Some(Missing { interface, why, cure: cure.to_owned() })
}

/// Looks for GPUs.
pub fn find() -> Survey {
    let (candidates, missing) = candidates();
    Survey { cards: candidates.iter().map(|candidate| candidate.found().clone()).collect(), missing }
}

/// Of GPUs that are alike to the first, which stands at `first` among all, the place of the one of a number, from the first again where there are fewer.
fn alike(all: &[&Found], first: usize, number: usize) -> usize {
    let like = |card: &&Found| card.interface == all[first].interface && card.is_software == all[first].is_software;
    let places: Vec<usize> = (first..all.len()).filter(|k| like(&all[*k])).collect();
    places[number % places.len()]
}

/// The first that is called so, or the first of all; or, of those that are called so and alike, the one of a number. The processor only where
/// it is asked for by its name, and then no driver is looked for.
///
/// # Errors
/// What was looked for and the way out.
pub(super) fn find_called(asked: Option<&str>, number: usize) -> Result<Candidate, (String, String)> {
    if host::is_called(asked) {
        return Ok(Candidate::Host(host::found()));
    }
    let (candidates, missing) = candidates();
    choose(asked, number, candidates, &missing)
}

fn choose(
    asked: Option<&str>,
    number: usize,
    candidates: Vec<Candidate>,
    missing: &[Missing],
) -> Result<Candidate, (String, String)> {
    let names: Vec<_> = candidates.iter().map(|candidate| candidate.found().title()).collect();
    let is_asked = |candidate: &Candidate| asked.is_none_or(|words| candidate.found().is_called(words));
    let mut called: Vec<Candidate> = candidates.into_iter().filter(is_asked).collect();
    if !called.is_empty() {
        let place = alike(&called.iter().map(Candidate::found).collect::<Vec<_>>(), 0, number);
        return Ok(called.swap_remove(place));
    }
    let in_the_way = missing.iter().map(|of| format!("{}: {} ({})", of.interface, of.why, of.cure));
    let in_the_way = in_the_way.collect::<Vec<_>>().join("; ");
    Err(match asked {
        Some(words) if !names.is_empty() => {
            let others = if in_the_way.is_empty() { String::new() } else { format!("; not available: {in_the_way}") };
            (format!("no graphics card matches `{words}`"), format!("available: {}{others}", names.join(", ")))
        }
        _ => ("no usable graphics card was found".to_owned(), in_the_way),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn card(name: &str, interface: Interface, is_software: bool) -> Found {
        Found { name: name.to_owned(), interface, driver: String::new(), is_software, largest_buffer: 0, memory: None }
    }

    #[test]
    fn a_device_matches_words_of_its_name_and_interface() {
        let card = card("NVIDIA H100 80GB HBM3", Interface::Cuda, false);
        for words in ["nvidia", "H100", "cuda", "CUDA h100", "80gb hbm3", ""] {
            assert!(card.is_called(words), "{words}");
        }
        for words in ["vulkan", "cuda radeon", "h200"] {
            assert!(!card.is_called(words), "{words}");
        }
    }

    #[test]
    fn ranks_take_identical_devices_in_order() {
        let all = [
            card("H200", Interface::Cuda, false),
            card("H200", Interface::Cuda, false),
            card("H200", Interface::Vulkan, false),
            card("llvmpipe", Interface::Vulkan, true),
        ];
        let all: Vec<&Found> = all.iter().collect();
        assert_eq!([0, 1, 2, 3].map(|number| alike(&all, 0, number)), [0, 1, 0, 1]);
        assert_eq!([0, 1].map(|number| alike(&all, 2, number)), [2, 2]);
        assert_eq!(alike(&all, 3, 5), 3);
    }

    #[test]
    fn a_software_renderer_is_used_only_without_a_device() {
        let software = card("llvmpipe", Interface::Vulkan, true);
        let missing = missing_graphics([&software].into_iter()).unwrap();
        assert!(missing.why.contains("llvmpipe") && missing.why.contains("software"), "{missing:?}");
        let real = card("Radeon", Interface::Vulkan, false);
        assert_eq!(missing_graphics([&real, &software].into_iter()), None);
        assert!(!missing_graphics([].into_iter()).unwrap().why.is_empty());
    }
}
