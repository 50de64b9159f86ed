//! What was built on a device and is not in use, kept for whoever needs the same next.

use std::{
    any::Any,
    fmt,
    sync::{Mutex, PoisonError},
};

use wgpu::WasmNotSend;

use crate::error::{Error, Result};

/// Devices of browsers stay on their thread.
#[cfg(not(target_arch = "wasm32"))]
type Thing = Box<dyn Any + Send>;
#[cfg(target_arch = "wasm32")]
type Thing = Box<dyn Any>;

/// Matchers and detectors that are not in use, those used last at the end.
#[derive(Default)]
pub(super) struct Shelf {
    /// Most bytes of the device that they take.
    most: u64,
    kept: Mutex<Vec<(Thing, u64)>>,
}

impl fmt::Debug for Shelf {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes = |kept: &mut Vec<(Thing, u64)>| kept.iter().map(|&(_, bytes)| bytes).collect::<Vec<_>>();
        f.debug_struct("Shelf").field("most", &self.most).field("bytes", &self.with(bytes)).finish()
    }
}

impl Shelf {
    pub fn new(most: u64) -> Self {
        Self { most, kept: Mutex::default() }
    }

    /// Most bytes of the device.
    pub fn most(&self) -> u64 {
        self.most
    }

    fn with<T>(&self, work: impl FnOnce(&mut Vec<(Thing, u64)>) -> T) -> T {
        work(&mut self.kept.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Takes the `T` that was used last of those that `fits` accepts.
    pub fn take<T: Any>(&self, fits: impl Fn(&T) -> bool) -> Option<T> {
        let (thing, _) = self.with(|kept| {
            let index = kept.iter().rposition(|(thing, _)| thing.downcast_ref().is_some_and(&fits))?;
            Some(kept.remove(index))
        })?;
        thing.downcast().ok().map(|thing| *thing)
    }

    /// Keeps a thing that takes `bytes` of the device. What was not used for longest makes room.
    pub fn put<T: Any + WasmNotSend>(&self, thing: T, bytes: u64) {
        if bytes > self.most {
            return;
        }
        let dropped: Vec<_> = self.with(|kept| {
            kept.push((Box::new(thing), bytes));
            let mut total: u64 = kept.iter().map(|(_, bytes)| bytes).sum();
            let is_too_much = |&&(_, bytes): &&(Thing, u64)| {
                let is_too_much = total > self.most;
                total -= bytes;
                is_too_much
            };
            let count = kept.iter().take_while(is_too_much).count();
            kept.drain(..count).collect()
        });
        // A driver may take its time to free memory: not while other threads wait.
        drop(dropped);
    }

    /// Drops everything; whether there was anything.
    fn clear(&self) -> bool {
        !self.with(std::mem::take).is_empty()
    }

    /// What `build` builds. Where there is no memory for it, what is kept makes room for a second attempt.
    pub async fn with_room<T, F: Future<Output = Result<T>>>(&self, build: impl Fn() -> F) -> Result<T> {
        match build().await {
            Err(Error::OutOfMemory(_)) if self.clear() => build().await,
            built => built,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::{cell::Cell, future::ready};

    use super::*;

    #[test]
    fn what_was_not_used_for_longest_makes_room() {
        let shelf = Shelf::new(10);
        (1..=3).for_each(|number: u8| shelf.put(number, 3));
        shelf.put("a text", 1);
        assert_eq!(shelf.take(|_: &u8| true), Some(3), "the latest");
        shelf.put(3_u8, 3);
        assert_eq!(shelf.take(|&number: &u8| number == 1), Some(1));
        shelf.put(1_u8, 6);
        assert_eq!(shelf.take(|&number: &u8| number == 2), None, "2 made room");
        assert_eq!(shelf.take(|_: &&str| true), Some("a text"));
        shelf.put(9_u8, 11);
        assert_eq!(shelf.take(|&number: &u8| number == 9), None, "more than all room");
        assert_eq!([shelf.clear(), shelf.clear()], [true, false]);
        assert_eq!(Shelf::default().most(), 0, "nothing is kept unless it is asked for");
    }

    #[test]
    fn what_is_kept_makes_room_for_what_finds_no_memory() {
        let shelf = Shelf::new(10);
        let attempts = Cell::new(0);
        let build = |needed: u64| {
            attempts.set(0);
            pollster::block_on(shelf.with_room(|| {
                attempts.set(attempts.get() + 1);
                let kept: u64 = shelf.with(|kept| kept.iter().map(|(_, bytes)| bytes).sum());
                ready(if kept + needed <= 10 { Ok(needed) } else { Err(Error::OutOfMemory("a thing".into())) })
            }))
        };
        shelf.put("a text", 6);
        assert!(matches!(build(4), Ok(4)) && attempts.get() == 1, "there is room");
        assert!(matches!(build(5), Ok(5)) && attempts.get() == 2, "the text makes room");
        assert!(matches!(build(11), Err(Error::OutOfMemory(_))) && attempts.get() == 1, "nothing is kept");
        shelf.put("a text", 6);
        assert!(matches!(build(11), Err(Error::OutOfMemory(_))) && attempts.get() == 2);
    }
}
