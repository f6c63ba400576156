//! No step allocates once buffers have grown.

use sphorge::{deck::load_text, engine::Simulation};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is handed to the system allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
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
