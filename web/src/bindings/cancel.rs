//! Work that can be cancelled between two waits for the GPU.

use std::{
    cell::Cell,
    future::{Future, poll_fn},
    pin::pin,
    rc::Rc,
    task::Poll,
};

/// A wish to cancel, which clones share.
#[derive(Clone, Default)]
pub struct Cancel(Rc<Cell<bool>>);

impl Cancel {
    /// Makes [`Self::unless`] end its work.
    pub fn request(&self) {
        self.0.set(true);
    }

    /// The result of `work`; `None` if it was cancelled, and dropped then.
    pub async fn unless<T>(&self, work: impl Future<Output = T>) -> Option<T> {
        self.0.set(false);
        let mut work = pin!(work);
        poll_fn(|context| {
            if self.0.get() {
                return Poll::Ready(None);
            }
            work.as_mut().poll(context).map(Some)
        })
        .await
    }
}
