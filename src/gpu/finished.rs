//! The end of what was submitted, as a future.

use std::future::Future;
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, Waker};

use super::Gpu;
use crate::error::Result;

/// A future that is ready when everything is done that had been submitted when it was made. Of [`Gpu::finished`].
#[must_use = "a future does nothing unless it is awaited"]
pub struct Finished {
    gpu: Gpu,
    state: Arc<Mutex<State>>,
}

#[derive(Default)]
struct State {
    done: bool,
    waker: Option<Waker>,
}

impl Finished {
    pub(super) fn new(gpu: &Gpu) -> Self {
        let state = Arc::<Mutex<State>>::default();
        let told = state.clone();
        // Asking for the end submits what is pending, so it may not happen while another thread polls.
        let _alone = gpu.polling.lock().unwrap_or_else(PoisonError::into_inner);
        gpu.queue.on_submitted_work_done(move || {
            let mut state = locked(&told);
            state.done = true;
            if let Some(waker) = state.waker.take() {
                waker.wake();
            }
        });
        Self { gpu: gpu.clone(), state }
    }
}

impl Future for Finished {
    type Output = Result<()>;

    fn poll(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Result<()>> {
        if self.gpu.lost().is_some() {
            return Poll::Ready(Err(self.gpu.lost_error("")));
        }
        let mut state = locked(&self.state);
        if state.done {
            return Poll::Ready(Ok(()));
        }
        state.waker = Some(context.waker().clone());
        Poll::Pending
    }
}

fn locked(state: &Mutex<State>) -> MutexGuard<'_, State> {
    state.lock().unwrap_or_else(PoisonError::into_inner)
}
