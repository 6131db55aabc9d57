//! The completion of all submissions, as a future.

use std::future::Future;
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, Waker};

use super::Gpu;
use crate::error::Result;

/// The future of [`Gpu::finished`]: it is ready when everything that was submitted before its creation is done.
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
        // Asking for completion submits pending work, so it must not happen while another thread polls.
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
