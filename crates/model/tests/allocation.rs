//! Forward kinematics and Jacobians do not touch the heap.

use denavit_model::nalgebra::{Point3, Vector6};
use denavit_model::{CompiledChain, Pose, examples};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::hint::black_box;

/// The system's allocator, counting what each thread asks of it.
struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

#[expect(unsafe_code, reason = "an allocator can be counted only by standing in for it")]
// SAFETY: every call is handed on unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: as promised by the caller.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, place: *mut u8, layout: Layout) {
        // SAFETY: as promised by the caller.
        unsafe { System.dealloc(place, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations(mut work: impl FnMut()) -> usize {
    let before = ALLOCATIONS.get();
    work();
    ALLOCATIONS.get() - before
}

#[test]
fn the_count_counts() {
    assert_eq!(allocations(|| drop(black_box(vec![0u8; 100]))), 1);
}

#[test]
fn kinematics_do_not_allocate() {
    for chain in examples::all() {
        let n = chain.coordinates().len();
        let compiled = CompiledChain::new(&chain);
        let q = vec![0.3; 50 * n];
        let (mut poses, mut tips) = (vec![Pose::identity(); 50], vec![Point3::origin(); 50]);
        let mut columns = vec![Vector6::zeros(); n];
        let mut motions = vec![Pose::identity(); chain.joints().len()];
        let none = |name: &str, work: &mut dyn FnMut()| {
            assert_eq!(allocations(work), 0, "{name} of {}", chain.name());
        };
        none("Chain::fk", &mut || _ = black_box(chain.fk(&q)));
        none("Chain::fk_into", &mut || _ = chain.fk_into(&q, &mut motions));
        none("Chain::tip_jacobian_into", &mut || _ = chain.tip_jacobian_into(&q, &mut columns));
        none("CompiledChain::fk", &mut || _ = black_box(compiled.fk(&q)));
        none("CompiledChain::space_jacobian_into", &mut || _ = compiled.space_jacobian_into(&q, &mut columns));
        none("CompiledChain::tip_jacobian_into", &mut || _ = compiled.tip_jacobian_into(&q, &mut columns));
        none("CompiledChain::poses_into", &mut || compiled.poses_into(&q, &mut poses));
        none("CompiledChain::tips_into", &mut || compiled.tips_into(&q, &mut tips));
    }
}
