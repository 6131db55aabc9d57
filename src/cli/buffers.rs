//! Between what a plan's buffers hold and what files hold.

use crate::frame::{FlowField, Frame, Plane, Size};
use crate::kernels::luma;

/// A frame's bytes as the plan's frame buffer holds them: rows begin at whole words.
pub(super) fn put_frame(frame: &Frame<'_>, buffer: &mut [f32]) {
    let row_bytes = 4 * luma::row_words(frame.size(), frame.format());
    let bytes: &mut [u8] = bytemuck::cast_slice_mut(buffer);
    for (y, row) in (0..frame.size().height).zip(bytes.chunks_exact_mut(row_bytes)) {
        let pixels = frame.row(y);
        row[..pixels.len()].copy_from_slice(pixels);
    }
}

/// A plane as a buffer holds it: rows of [`Size::stride`] values, whose surplus repeats the last one.
pub(super) fn put_plane(plane: &Plane, buffer: &mut [f32]) {
    let width = plane.size.width as usize;
    for (row, padded) in plane.data.chunks_exact(width).zip(buffer.chunks_exact_mut(plane.size.stride())) {
        padded[..width].copy_from_slice(row);
        padded[width..].fill(row[width - 1]);
    }
}

/// The flow field in a buffer of two channels, row by row in turn.
pub(super) fn take_flow(buffer: &[f32], size: Size) -> FlowField {
    let (width, stride) = (size.width as usize, size.stride());
    let data = (buffer.chunks_exact(2 * stride))
        .flat_map(|rows| (0..width).map(move |x| [rows[x], rows[stride + x]]))
        .collect();
    FlowField { size, data }
}
