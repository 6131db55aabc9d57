//! Shared by the CPU references: rows distributed over the cores, and weighted sums of rows.
//!
//! Sums are plain multiplications and additions in a fixed order, without fused multiply-add on any processor, so that
//! every x86 and ARM machine computes the same bits.

use std::cell::RefCell;

use pulp::{Arch, NullaryFnOnce};

use crate::frame::Size;

/// Work on fewer values than this stays on one core: distributing it would cost more.
pub(crate) const SMALLEST_SHARE: usize = 1 << 15;

/// The output rows `y0 .. y0 + rows` of up to three buffers, and scratch memory.
pub(crate) struct Band<'a> {
    /// The first row's number.
    pub(crate) y0: usize,
    /// Rows of the first output.
    pub(crate) out: &'a mut [f32],
    /// Rows of the second output, if there is one.
    pub(crate) second: &'a mut [f32],
    /// Rows of the third output, if there is one.
    pub(crate) third: &'a mut [f32],
    /// Scratch memory of the requested length, with arbitrary values.
    pub(crate) scratch: &'a mut [f32],
}

/// How [`bands`] splits its outputs.
#[derive(Clone, Copy, Default)]
pub(crate) struct Split {
    /// Values per row of the first output, all channels together.
    pub(crate) row: usize,
    /// The same for the second output; 0 without one.
    pub(crate) second_row: usize,
    /// The same for the third output.
    pub(crate) third_row: usize,
    /// Number of scratch values that a band needs.
    pub(crate) scratch: usize,
    /// The cost of a value relative to a usual one; 0 stands for 1.
    pub(crate) dearer: usize,
    /// Bands of fewer rows are not split any more; 0 stands for 16.
    pub(crate) fewest_rows: usize,
}

impl Split {
    pub(crate) fn rows_of(row: usize) -> Self {
        Self { row, ..Self::default() }
    }

    /// Whether a band of this many rows stays whole.
    fn is_whole(&self, rows: usize) -> bool {
        let fewest = if self.fewest_rows == 0 { 16 } else { self.fewest_rows };
        rows < fewest || rows * self.row * self.dearer.max(1) < SMALLEST_SHARE
    }

    /// The most rows that a band of an image of `height` rows has.
    pub(crate) fn most_rows(&self, height: usize) -> usize {
        let mut rows = height;
        while !self.is_whole(rows) {
            rows -= rows / 2;
        }
        rows
    }
}

/// Runs `f` over bands of rows, on all cores of rayon's pool and with the widest vectors that this processor has.
///
/// `f` and the functions that it calls should be `#[inline(always)]`; otherwise they are compiled for the narrowest
/// vectors.
pub(crate) fn bands<F: Fn(Band<'_>) + Sync>(out: &mut [f32], second: &mut [f32], split: Split, f: F) {
    halve(0, [out, second, &mut []], split, &f);
}

/// [`bands`] with a third output.
pub(crate) fn bands_of_three<F: Fn(Band<'_>) + Sync>(outputs: [&mut [f32]; 3], split: Split, f: F) {
    halve(0, outputs, split, &f);
}

fn halve<F: Fn(Band<'_>) + Sync>(y0: usize, [out, second, third]: [&mut [f32]; 3], split: Split, f: &F) {
    let rows = out.len() / split.row;
    if split.is_whole(rows) {
        return vectorised(y0, [out, second, third], split.scratch, f);
    }
    let half = rows / 2;
    let (out_above, out_below) = out.split_at_mut(half * split.row);
    let (second_above, second_below) = second.split_at_mut(half * split.second_row);
    let (third_above, third_below) = third.split_at_mut(half * split.third_row);
    rayon::join(
        || halve(y0, [out_above, second_above, third_above], split, f),
        || halve(y0 + half, [out_below, second_below, third_below], split, f),
    );
}

fn vectorised<F: Fn(Band<'_>)>(y0: usize, [out, second, third]: [&mut [f32]; 3], scratch: usize, f: &F) {
    struct Work<'a, F>(&'a F, Band<'a>);

    impl<F: Fn(Band<'_>)> NullaryFnOnce for Work<'_, F> {
        type Output = ();

        #[inline(always)]
        fn call(self) {
            (self.0)(self.1);
        }
    }

    thread_local! {
        static SCRATCH: RefCell<Vec<f32>> = const { RefCell::new(Vec::new()) };
    }
    SCRATCH.with_borrow_mut(|room| {
        if room.len() < scratch {
            room.resize(scratch, 0.0);
        }
        let band = Band { y0, out, second, third, scratch: &mut room[..scratch] };
        Arch::new().dispatch(Work(f, band));
    });
}

/// `out[x] = Σ_k weights[k] · source(k)[x]`, where every `source(k)` is as long as `out`.
#[inline(always)]
pub(crate) fn weighted_sum<'a>(out: &mut [f32], weights: &[f32], source: impl Fn(usize) -> &'a [f32]) {
    const LANES: usize = 64;
    let (blocks, rest) = out.as_chunks_mut::<LANES>();
    for (i, block) in blocks.iter_mut().enumerate() {
        let mut sum = [0.0; LANES];
        for (k, &weight) in weights.iter().enumerate() {
            let values = &source(k)[i * LANES..][..LANES];
            for (s, v) in sum.iter_mut().zip(values) {
                *s += weight * v;
            }
        }
        *block = sum;
    }
    let start = blocks.len() * LANES;
    rest.fill(0.0);
    for (k, &weight) in weights.iter().enumerate() {
        for (s, v) in rest.iter_mut().zip(&source(k)[start..]) {
            *s += weight * v;
        }
    }
}

/// Index `i` clamped to `0 .. n`.
#[inline(always)]
pub(crate) fn clamp_index(i: isize, n: usize) -> usize {
    i.clamp(0, n as isize - 1) as usize
}

/// Index `i` mirrored into `0 .. n`, the end samples not repeated.
#[inline(always)]
pub(crate) fn reflect_101(i: isize, n: usize) -> usize {
    if n == 1 {
        return 0;
    }
    let period = 2 * (n - 1);
    let j = i.unsigned_abs() % period;
    j.min(period - j)
}

/// `row`, its first `width` values continued by `radius` copies of the first before and of the last after.
#[inline(always)]
pub(crate) fn extend_row(extended: &mut [f32], row: &[f32], width: usize, radius: usize) {
    extended[..radius].fill(row[0]);
    extended[radius..radius + width].copy_from_slice(&row[..width]);
    extended[radius + width..].fill(row[width - 1]);
}

/// Makes the surplus of a row repeat its last pixel.
#[inline(always)]
pub(crate) fn repeat_last(row: &mut [f32], width: usize) {
    let last = row[width - 1];
    row[width..].fill(last);
}

/// Width, height and stride as indices.
#[inline(always)]
pub(crate) fn dimensions(width: u32, height: u32) -> (usize, usize, usize) {
    (width as usize, height as usize, Size::new(width, height).stride())
}
