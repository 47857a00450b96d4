//! Threads for one call, on a pool of the call's own.
//!
//! Work is cut into items whose number and bounds do not depend on the number of threads, and sums are taken over the items in
//! order, so a result has the same bits on one thread and on many.

use crate::{Error, Result};
use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};
use std::thread::JoinHandle;

/// Prefix of the names of the pool's threads.
pub const THREAD_NAME: &str = "keepout";

/// Threads that a call may ask for. Far more than help; asked for a thousand million, the pool would start tens of thousands of them.
pub const MOST_THREADS: u32 = 1024;

/// Bytes of a thread's stack.
const STACK: usize = 2 << 20;

/// The threads of one call. Dropping it joins them.
pub struct Workers {
    pool: Option<rayon::ThreadPool>,
    threads: Vec<JoinHandle<()>>,
}

impl Workers {
    /// `n_threads` threads: 0 for all cores, 1 for none but the caller's.
    pub fn new(n_threads: u32) -> Result<Self> {
        Workers::check(n_threads)?;
        let n_threads = count(n_threads);
        if n_threads == 1 {
            return Ok(Workers::caller_only());
        }
        // A pool alone would let its threads run on after it is dropped: into the caller's dlclose, or the end of the process.
        let mut threads = Vec::new();
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(n_threads)
            .thread_name(|i| format!("{THREAD_NAME}-{i}"))
            .spawn_handler(|thread| {
                let name = thread.name().unwrap_or(THREAD_NAME).to_owned();
                threads.push(std::thread::Builder::new().name(name).stack_size(STACK).spawn(|| thread.run())?);
                Ok(())
            })
            .build();
        match pool {
            Ok(pool) => Ok(Workers { pool: Some(pool), threads }),
            Err(_) => {
                join(threads);
                Err(no_threads(n_threads))
            }
        }
    }

    /// Refuses a number of threads that no call should ask for.
    pub fn check(n_threads: u32) -> Result<()> {
        if n_threads <= MOST_THREADS {
            return Ok(());
        }
        Err(Error::InvalidArgument(format!(
            "n_threads is {n_threads}; it must be at most {MOST_THREADS}, and 0 takes all cores"
        )))
    }

    /// No thread but the caller's.
    pub fn caller_only() -> Self {
        Workers { pool: None, threads: Vec::new() }
    }

    /// Threads that work at once.
    pub fn n_threads(&self) -> usize {
        self.pool.as_ref().map_or(1, rayon::ThreadPool::current_num_threads)
    }

    /// Runs `work` on every item, in any order.
    pub fn for_each<T: Send>(&self, items: impl IntoIterator<Item = T>, work: impl Fn(T) + Send + Sync) {
        match &self.pool {
            None => items.into_iter().for_each(work),
            Some(pool) => match listed(items) {
                Ok(items) => pool.install(|| items.into_par_iter().for_each(work)),
                Err(items) => items.for_each(work),
            },
        }
    }

    /// Runs `work` on every item, in any order; the error of the first item that failed, in the order of the items.
    pub fn try_for_each<T: Send>(
        &self,
        items: impl IntoIterator<Item = T>,
        work: impl Fn(T) -> Result<()> + Send + Sync,
    ) -> Result<()> {
        match &self.pool {
            None => items.into_iter().try_for_each(work),
            Some(pool) => match listed(items) {
                Err(mut items) => items.try_for_each(work),
                Ok(items) => {
                    let first = Mutex::new(None);
                    let work = |(i, item)| work(item).unwrap_or_else(|error| keep_first(&first, i, error));
                    pool.install(|| items.into_par_iter().enumerate().for_each(work));
                    first_error(first)
                }
            },
        }
    }

    /// The results of `work` on the items 0..n, in that order.
    pub fn map<R: Send>(&self, n: usize, work: impl Fn(usize) -> R + Send + Sync) -> Vec<R> {
        match &self.pool {
            None => (0..n).map(work).collect(),
            Some(pool) => pool.install(|| (0..n).into_par_iter().map(work).collect()),
        }
    }
}

impl Drop for Workers {
    fn drop(&mut self) {
        drop(self.pool.take());
        join(std::mem::take(&mut self.threads));
    }
}

/// What 0 stands for, or `n_threads` itself.
pub fn count(n_threads: u32) -> usize {
    match n_threads {
        0 => std::thread::available_parallelism().map_or(1, usize::from),
        n => n as usize,
    }
}

/// The error of threads that do not start: what the system is short of, since each takes a stack.
fn no_threads(n: usize) -> Error {
    Error::OutOfMemory { what: format!("the stacks of {n} threads"), bytes: n as u128 * STACK as u128, limit: None }
}

/// Runs `work` on every item once, in any order, on `n_threads` threads as [`Workers::new`] takes them, the caller's one of them: for work
/// of milliseconds, which a pool would begin later. No more threads are started than there are items left.
pub fn share<T: Send>(n_threads: u32, items: Vec<T>, work: impl Fn(T) + Sync) -> Result<()> {
    Workers::check(n_threads)?;
    let n_threads = count(n_threads).min(items.len());
    if n_threads <= 1 {
        items.into_iter().for_each(work);
        return Ok(());
    }
    let items = Mutex::new(items.into_iter());
    let next = || items.lock().unwrap_or_else(PoisonError::into_inner).next();
    let toil = || {
        while let Some(item) = next() {
            work(item);
        }
    };
    std::thread::scope(|scope| {
        let start = |i| {
            let thread = std::thread::Builder::new().name(format!("{THREAD_NAME}-{i}")).stack_size(STACK);
            thread.spawn_scoped(scope, toil)
        };
        let started: std::io::Result<Vec<_>> = (1..n_threads).map(start).collect();
        if started.is_ok() {
            toil();
        } else {
            // Nothing is left to those that did start.
            while next().is_some() {}
        }
        for thread in started.map_err(|_| no_threads(n_threads))? {
            // Here, not by the scope, which would lose the text of the panic.
            thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        }
        Ok(())
    })
}

/// [`share`] for work that may fail: the error of the first item that failed, in the order of the items.
pub fn try_share<T: Send>(n_threads: u32, items: Vec<T>, work: impl Fn(T) -> Result<()> + Sync) -> Result<()> {
    let first = Mutex::new(None);
    share(n_threads, items.into_iter().enumerate().collect(), |(i, item)| {
        work(item).unwrap_or_else(|error| keep_first(&first, i, error));
    })?;
    first_error(first)
}

/// The items in a list; themselves where there is no room for one, to be worked on one after the other.
fn listed<I: IntoIterator>(items: I) -> std::result::Result<Vec<I::Item>, I::IntoIter> {
    let (items, mut list) = (items.into_iter(), Vec::new());
    match list.try_reserve(items.size_hint().0) {
        Ok(()) => {
            list.extend(items);
            Ok(list)
        }
        Err(_) => Err(items),
    }
}

/// An error with the place of its item.
type FirstError = Mutex<Option<(usize, Error)>>;

/// Keeps `error` of item `i`, unless that of an item before it is kept.
fn keep_first(first: &FirstError, i: usize, error: Error) {
    let mut first = first.lock().unwrap_or_else(PoisonError::into_inner);
    if first.as_ref().is_none_or(|(at, _)| i < *at) {
        *first = Some((i, error));
    }
}

/// What was kept.
fn first_error(first: FirstError) -> Result<()> {
    first.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), |(_, error)| Err(error))
}

fn join(threads: Vec<JoinHandle<()>>) {
    for thread in threads {
        // The pool hands a worker's panic to the caller of the work; none is left to tell of here.
        let _ = thread.join();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_on_any_number_of_threads() {
        for n_threads in [1, 2, 5] {
            let workers = Workers::new(n_threads).unwrap();
            assert_eq!(workers.map(100, |i| i * i), (0..100).map(|i| i * i).collect::<Vec<_>>());
            let mut squares = vec![0; 100];
            workers.for_each(squares.iter_mut().enumerate(), |(i, s)| *s = i * i);
            assert_eq!(workers.map(100, |i| i * i), squares);
        }
    }

    #[test]
    fn shared_items_are_all_done_once() {
        for n_threads in [0, 1, 2, 5, 300] {
            let mut squares = vec![0; 100];
            share(n_threads, squares.iter_mut().enumerate().collect(), |(i, s)| *s += i * i).unwrap();
            assert_eq!(squares, (0..100).map(|i| i * i).collect::<Vec<_>>());
            share(n_threads, Vec::<u8>::new(), |_| unreachable!()).unwrap();
        }
    }

    #[test]
    #[should_panic(expected = "item 77")]
    fn the_panic_of_a_shared_item_is_told() {
        let _ = share(3, (0..100).collect(), |i: usize| assert!(i != 77, "item {i}"));
    }

    #[test]
    fn the_first_error_of_shared_items_is_told() {
        for n_threads in [1, 2, 5] {
            let fails = |i: usize| if i < 7 { Ok(()) } else { Err(Error::Degenerate(i.to_string())) };
            assert_eq!(try_share(n_threads, (0..7).collect(), fails), Ok(()));
            assert_eq!(try_share(n_threads, (0..100).collect(), fails), Err(Error::Degenerate("7".into())));
        }
    }

    #[test]
    fn the_first_error_is_told() {
        for n_threads in [1, 2, 5] {
            let workers = Workers::new(n_threads).unwrap();
            let odd_fails = |i: usize| if i.is_multiple_of(2) { Ok(()) } else { Err(Error::Degenerate(i.to_string())) };
            assert_eq!(workers.try_for_each((0..100).step_by(2), odd_fails), Ok(()));
            assert_eq!(workers.try_for_each(6..100, odd_fails), Err(Error::Degenerate("7".into())));
        }
    }

    #[test]
    fn absurd_numbers_of_threads_are_refused() {
        assert!(matches!(Workers::new(MOST_THREADS + 1), Err(Error::InvalidArgument(text)) if text.contains("1025")));
    }
}
