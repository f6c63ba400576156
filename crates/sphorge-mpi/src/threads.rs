//! Ranks that are threads of one process.

use sphorge_engine::ranks::{Communicator, Messages};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};

/// One of several ranks, each in a thread of its own.
#[derive(Debug)]
struct Thread {
    rank: usize,
    to: Vec<Sender<Vec<u8>>>,
    from: Vec<Arc<Mutex<Receiver<Vec<u8>>>>>,
}

/// Communicators of as many ranks, one for each thread. A rank whose communicator is dropped is lost to the others.
pub fn threads(size: usize) -> Vec<Arc<dyn Communicator>> {
    let mut to: Vec<Vec<Sender<_>>> = (0..size).map(|_| Vec::new()).collect();
    let mut from: Vec<Vec<Arc<Mutex<Receiver<_>>>>> = (0..size).map(|_| Vec::new()).collect();
    for sender in &mut to {
        for receiver in &mut from {
            let (send, receive) = channel();
            sender.push(send);
            receiver.push(Arc::new(Mutex::new(receive)));
        }
    }
    let ranks = to.into_iter().zip(from).enumerate();
    ranks.map(|(rank, (to, from))| Arc::new(Thread { rank, to, from }) as Arc<dyn Communicator>).collect()
}

impl Communicator for Thread {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.to.len()
    }

    fn begin(&self, to: Vec<Vec<u8>>, lengths: &[usize]) -> Result<Box<dyn Messages>, String> {
        let is_sent = |(rank, bytes): &(usize, Vec<u8>)| *rank != self.rank && !bytes.is_empty();
        for (rank, bytes) in to.into_iter().enumerate().filter(is_sent) {
            self.to[rank].send(bytes).map_err(|_| ended(rank))?;
        }
        let of_others = |(rank, length): (usize, &usize)| if rank == self.rank { 0 } else { *length };
        let lengths = lengths.iter().enumerate().map(of_others).collect();
        Ok(Box::new(Awaited { from: self.from.clone(), lengths }))
    }
}

/// Messages that are to come.
struct Awaited {
    from: Vec<Arc<Mutex<Receiver<Vec<u8>>>>>,
    lengths: Vec<usize>,
}

impl Messages for Awaited {
    fn finish(self: Box<Self>) -> Result<Vec<Vec<u8>>, String> {
        let mut come = vec![Vec::new(); self.from.len()];
        for (rank, &length) in self.lengths.iter().enumerate().filter(|(_, length)| **length > 0) {
            let receiver = self.from[rank].lock().unwrap_or_else(PoisonError::into_inner);
            let bytes = receiver.recv().map_err(|_| ended(rank))?;
            if bytes.len() != length {
                return Err(format!("rank {rank} has sent {} bytes instead of {length}", bytes.len()));
            }
            come[rank] = bytes;
        }
        Ok(come)
    }
}

fn ended(rank: usize) -> String {
    format!("rank {rank} has ended")
}

#[cfg(test)]
mod tests {
    use super::*;
    use sphorge_engine::ranks::Ranks;

    #[test]
    fn every_rank_gets_what_each_other_sends_it() {
        std::thread::scope(|scope| {
            for communicator in threads(3) {
                scope.spawn(move || {
                    let rank = communicator.rank();
                    let to: Vec<Vec<u8>> = (0..3).map(|other| vec![10 * rank as u8 + other; rank + 1]).collect();
                    let from = communicator.begin(to, &[1, 2, 3]).unwrap().finish().unwrap();
                    for other in (0..3).filter(|other| *other != rank) {
                        assert_eq!(from[other], vec![(10 * other + rank) as u8; other + 1]);
                    }
                });
            }
        });
    }

    #[test]
    fn values_of_any_number_of_ranks_are_gathered_and_told_in_their_order() {
        for size in 1..10 {
            std::thread::scope(|scope| {
                for communicator in threads(size) {
                    scope.spawn(move || {
                        let ranks = Ranks::new(communicator);
                        let rank = ranks.rank();
                        let of_rank = |rank: usize| (0..rank % 3).map(|k| (10 * rank + k) as u32).collect::<Vec<_>>();
                        let counts: Vec<usize> = (0..size).map(|rank| rank % 3).collect();
                        let all: Vec<u32> = (0..size).flat_map(of_rank).collect();
                        assert_eq!(ranks.gather(&of_rank(rank), &counts), Ok(all.clone()), "{rank} of {size}");
                        assert_eq!(ranks.gather_all(&of_rank(rank)), Ok(all), "{rank} of {size}");
                        let told = if rank == 0 { vec![7, 8, 9] } else { Vec::new() };
                        assert_eq!(ranks.broadcast(&told, 3), Ok(vec![7, 8, 9]), "{rank} of {size}");
                        // All bytes are with the second rank, if there is one; then each has one more than the one before it.
                        let wanted: Vec<usize> = (0..size).collect();
                        let (count, holder) = (wanted.iter().sum::<usize>(), 1.min(size - 1));
                        let of_holder = |number: usize| if number == holder { count } else { 0 };
                        let lengths: Vec<usize> = (0..size).map(of_holder).collect();
                        let bytes: Vec<u8> = (0..of_holder(rank) as u8).collect();
                        let own = ranks.share_anew(&bytes, &lengths, &wanted).unwrap();
                        let first = wanted[..rank].iter().sum::<usize>() as u8;
                        assert_eq!(own, (first..first + rank as u8).collect::<Vec<_>>());
                        assert_eq!(ranks.share_anew(&own, &wanted, &lengths), Ok(bytes));
                        let failed = if rank * 2 > size { Err(format!("of {rank}")) } else { Ok(()) };
                        let first = size / 2 + 1;
                        let expected = if first < size { Err(format!("rank {first}: of {first}")) } else { Ok(()) };
                        assert_eq!(ranks.first_failure(failed), Ok(expected));
                    });
                }
            });
        }
    }

    #[test]
    fn a_rank_that_has_ended_is_named() {
        let mut ranks = threads(2);
        drop(ranks.pop());
        let lost = ranks[0].begin(vec![vec![], vec![]], &[0, 1]).unwrap().finish();
        assert_eq!(lost, Err("rank 1 has ended".to_owned()));
        assert_eq!(ranks[0].begin(vec![vec![], vec![0]], &[0, 0]).err(), Some("rank 1 has ended".to_owned()));
    }
}
