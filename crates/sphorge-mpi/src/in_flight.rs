//! Messages that MPI has on their way, with the memory it reads and writes meanwhile.

use mpi::request::{Request, StaticScope};
use mpi::topology::{Communicator as _, SimpleCommunicator};
use mpi::traits::{Destination, Source};
use sphorge_engine::ranks::Messages;
use std::mem;

/// Bytes of a message at most: MPI counts them in 32 bits.
const LARGEST_MESSAGE: usize = 1 << 30;

/// A message that MPI has not completed yet.
type Open = Request<'static, [u8], StaticScope>;

/// Messages to other processes and from them. The memory is MPI's until the last of them has gone through: it is given back by
/// [`Messages::finish`], or when what MPI has completed to the last message is dropped.
///
/// Dropped earlier, as a panic between beginning and finishing does and nothing else:
///
/// - No memory of any message is freed, not even of those that have gone through: MPI may read and write it as long as the process lives.
/// - Nothing is waited for and nothing called back. What is on its way may arrive or not, here and elsewhere; nobody reads what comes.
/// - The requests stay open. Messages that are begun afterwards keep their order behind these, but MPI must not be finalised: that may wait for good. The
///   process has to end by an abort, which [`Processes`](crate::Processes) does when a panic drops it.
///
/// A panic within [`Messages::advance`] or [`Messages::finish`] ends the process at once: `mpi` does not let go of an open request.
pub(crate) struct InFlight<R = Open> {
    requests: Vec<R>,
    /// What comes from each process.
    from: Vec<Vec<u8>>,
    to: Vec<Vec<u8>>,
}

// SAFETY: a request of MPI may be completed by any thread, and MPI was started so that threads of a process take turns. Nothing is done by a shared
// reference.
unsafe impl Send for InFlight {}
// SAFETY: as above.
unsafe impl Sync for InFlight {}

impl InFlight {
    /// Begins to send `to[r]` to process `r` and to take `lengths[r]` bytes from it; nothing to this process itself.
    pub(crate) fn begin(world: &SimpleCommunicator, to: Vec<Vec<u8>>, lengths: &[usize]) -> Self {
        let own = world.rank() as usize;
        let is_other = |(rank, _): &(usize, &mut Vec<u8>)| *rank != own;
        let from = lengths.iter().enumerate().map(|(rank, &length)| vec![0; if rank == own { 0 } else { length }]);
        let mut begun = Self { requests: Vec::new(), from: from.collect(), to };
        let Self { requests, from, to } = &mut begun;
        for (rank, bytes) in from.iter_mut().enumerate().filter(is_other) {
            // SAFETY: `begun` keeps the memory as it is until the requests are completed.
            for part in unsafe { lent(bytes) }.chunks_mut(LARGEST_MESSAGE) {
                requests.push(world.process_at_rank(rank as i32).immediate_receive_into(StaticScope, part));
            }
        }
        for (rank, bytes) in to.iter_mut().enumerate().filter(is_other) {
            // SAFETY: as above.
            for part in unsafe { lent(bytes) }.chunks(LARGEST_MESSAGE) {
                requests.push(world.process_at_rank(rank as i32).immediate_send(StaticScope, part));
            }
        }
        begun
    }
}

/// The bytes of a vector for as long as it is neither read, changed nor dropped.
///
/// # Safety
/// It must not be until what has the bytes is done with them.
unsafe fn lent(bytes: &mut Vec<u8>) -> &'static mut [u8] {
    // SAFETY: that is asked of the caller; the heap stays where it is if the vector moves.
    unsafe { std::slice::from_raw_parts_mut(bytes.as_mut_ptr(), bytes.len()) }
}

impl Messages for InFlight {
    /// MPI moves long messages while it is called.
    fn advance(&mut self) {
        let requests = mem::take(&mut self.requests);
        self.requests = requests.into_iter().filter_map(|request| request.test().err()).collect();
    }

    fn finish(mut self: Box<Self>) -> Result<Vec<Vec<u8>>, String> {
        mem::take(&mut self.requests).into_iter().for_each(Request::wait_without_status);
        Ok(mem::take(&mut self.from))
    }
}

impl<R> Drop for InFlight<R> {
    fn drop(&mut self) {
        if !self.requests.is_empty() {
            mem::forget((mem::take(&mut self.requests), mem::take(&mut self.from), mem::take(&mut self.to)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    /// A size that nothing else here has.
    const SIZE: usize = 54_321;

    #[test]
    fn memory_of_messages_that_are_dropped_unfinished_stays_with_mpi() {
        let request = Arc::new(());
        let [from, to] = [0, 1].map(|byte| vec![vec![byte; SIZE]]);
        let places = [from[0].as_ptr(), to[0].as_ptr()];
        drop(InFlight { requests: vec![request.clone(); 2], from, to });
        // An open request of MPI that is dropped would panic.
        assert_eq!(Arc::strong_count(&request), 3);
        let later: Vec<Vec<u8>> = (0..64).map(|_| vec![2; SIZE]).collect();
        assert!(later.iter().all(|bytes| !places.contains(&bytes.as_ptr())));
        // SAFETY: nobody has freed or changed it, which is what is tested.
        let bytes = places.map(|place| unsafe { std::slice::from_raw_parts(place, SIZE) });
        assert!(bytes == [[0; SIZE], [1; SIZE]]);
    }
}
