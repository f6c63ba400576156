//! No step allocates once buffers have grown, and the engine holds the bytes it says it holds.

use sphorge::{deck::load_text, engine::Simulation};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);
/// Bytes that are allocated now.
static HELD: AtomicUsize = AtomicUsize::new(0);
/// What is counted is that of all threads: one test at a time.
static ALONE: Mutex<()> = Mutex::new(());

// SAFETY: every call is handed to the system allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        HELD.fetch_add(layout.size(), Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        HELD.fetch_add(size, Ordering::Relaxed);
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: as above.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A second block that touches the first, and heat that flows in both and into the air.
const CONTACT_AND_HEAT: &str = r#"
[[body]]
name = "other"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm", "10 mm"], max = ["10 mm", "10 mm", "16 mm"] } }
velocity = ["0.1 m/s", "0 m/s", "0 m/s"]

[thermal]
boundary = [{ name = "air", convection = { coefficient = "500 W/(m^2 K)", ambient = "500 K" } }]
"#;

/// Artificial stress, XSPH, density filter, a symmetry plane and periodic ends; the block vibrates gently, so that rows of the
/// neighbour list keep their lengths.
const DECK: &str = r#"
title = "A block that vibrates"
dimensions = "3d"
method = "updated-lagrangian"

[particles]
spacing = "1 mm"

[numerics]
xsph = 0.5
artificial-stress = { epsilon = 0.3, exponent = 4 }
mls-interval = 10

[time]
end = "1 s"

[periodic]
y = ["0 mm", "10 mm"]

[[symmetry]]
axis = "x"
at = "0 mm"
side = "positive"

[[body]]
name = "block"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm", "0 mm"], max = ["10 mm", "10 mm", "10 mm"] } }
velocity = ["0.1 m/s", "0 m/s", "0 m/s"]
"#;

#[test]
fn steps_do_not_allocate() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let meeting = format!("contact = \"penalty\"\n{DECK}{CONTACT_AND_HEAT}");
    for (search, deck) in [("every-step", DECK), ("skin", DECK), ("every-step", &meeting), ("skin", &meeting)] {
        let setup = load_text("test", deck, &[("search".to_owned(), search.to_owned())]).expect("the deck is right");
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads");
        pool.install(|| {
            let mut simulation = Simulation::new(setup.model, setup.particles);
            // Past a sorting of the particles, which comes every 64 searches.
            for _ in 0..140 {
                simulation.step(None).expect("a sound step");
            }
            let before = ALLOCATIONS.load(Ordering::Relaxed);
            for _ in 0..70 {
                simulation.step(None).expect("a sound step");
            }
            assert_eq!(ALLOCATIONS.load(Ordering::Relaxed) - before, 0, "{search}");
        });
    }
}

/// A block that is struck, by the default method.
const STRUCK: &str = r#"
title = "A block that is struck"
dimensions = "3d"

[particles]
spacing = "0.5 mm"

[time]
end = "1 s"

[[body]]
name = "block"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm", "0 mm"], max = ["10 mm", "10 mm", "10 mm"] } }

[[body]]
name = "other"
material = "armco-iron"
shape = { box = { min = ["0 mm", "0 mm", "10 mm"], max = ["10 mm", "10 mm", "16 mm"] } }
velocity = ["0 m/s", "0 m/s", "-20 m/s"]
"#;

#[test]
fn the_engine_holds_the_bytes_it_says() {
    let _alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
    let fine = |deck: &str| deck.replace("spacing = \"1 mm\"", "spacing = \"0.5 mm\"");
    let meeting = fine(&format!("contact = \"penalty\"\n{DECK}{CONTACT_AND_HEAT}"));
    let adaptive = fine(&format!("search = \"adaptive\"\n{DECK}"));
    let frozen = fine(
        &format!("search = {{ total-lagrangian = {{ form = \"frozen\" }} }}\n{DECK}").replace("mls-interval = 10", ""),
    );
    for (name, deck) in [
        ("plain", &fine(DECK)),
        ("contact and heat", &meeting),
        ("adaptive", &adaptive),
        ("frozen", &frozen),
        ("default", &STRUCK.to_owned()),
    ] {
        let setup = load_text("test", deck, &[]).unwrap_or_else(|report| panic!("{name}: {report:?}"));
        let particles = setup.particles.len();
        let before = HELD.load(Ordering::Relaxed) - setup.particles.bytes();
        let mut simulation = Simulation::new(setup.model, setup.particles);
        for _ in 0..3 {
            simulation.step(None).expect("a sound step");
        }
        let (held, said) = (HELD.load(Ordering::Relaxed) - before, simulation.memory_bytes() as usize);
        println!("{name}: {particles} particles, {held} bytes held, {said} said");
        assert!(said <= held && 0.995 * (held as f64) < said as f64, "{name}: {held} bytes held, {said} said");
    }
}
