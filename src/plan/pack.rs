//! Packing and unpacking: conversion between the host's types and the layout of a plan's buffers.
//!
//! Rows of a buffer are padded to [`Size::stride`] values, and the surplus repeats the row's last pixel. An image of
//! several channels holds row 0 of each channel, then row 1 of each channel.

use std::iter::repeat_n;

use super::{PortKind, Value};
use crate::frame::{FlowField, Plane, Size};

/// The destination of packed values: main memory, or a mapped buffer of a GPU.
pub(crate) trait Sink {
    /// Writes bytes from this offset on.
    fn bytes(&mut self, at: usize, bytes: &[u8]);
    /// Writes the values from the beginning.
    fn values(&mut self, values: impl Iterator<Item = f32>);
}

impl Sink for [f32] {
    fn bytes(&mut self, at: usize, bytes: &[u8]) {
        bytemuck::cast_slice_mut::<f32, u8>(self)[at..at + bytes.len()].copy_from_slice(bytes);
    }

    fn values(&mut self, values: impl Iterator<Item = f32>) {
        for (out, value) in self.iter_mut().zip(values) {
            *out = value;
        }
    }
}

/// Writes a value that has passed [`Port::check`](super::Port::check). Returns the number of `f32` values written.
pub(crate) fn pack<S: Sink + ?Sized>(kind: PortKind, value: &Value<'_>, sink: &mut S) -> usize {
    match (kind, value) {
        (PortKind::Frame { size, format }, Value::Frame(frame)) => {
            let row_bytes = 4 * format.row_words(size.width);
            for y in 0..size.height {
                sink.bytes(y as usize * row_bytes, frame.row(y));
            }
        }
        (PortKind::Plane { range, .. }, Value::Plane(plane)) => match range {
            // In this form NaN becomes the lower end.
            Some([low, high]) => {
                sink.values(plane_values(plane, move |v| if v > low { v.min(high) } else { low }));
            }
            None => sink.values(plane_values(plane, |v| v)),
        },
        (PortKind::Flow { .. }, Value::Flow(field)) => sink.values(flow_values(field)),
        (_, Value::Raw(values)) => {
            sink.bytes(0, bytemuck::cast_slice(values));
            return values.len();
        }
        _ => unreachable!("a value is checked before it is packed"),
    }
    kind.len()
}

/// A plane of values from 0 to 1 as a constant of a plan. Other values are clamped, and NaN becomes 0.
pub(crate) fn share(plane: &Plane) -> Vec<f32> {
    let kind = PortKind::Plane { size: plane.size, range: Some([0.0, 1.0]) };
    let mut values = vec![0.0; kind.len()];
    pack(kind, &Value::Plane(plane), values.as_mut_slice());
    values
}

/// Padded rows of `N` values per pixel, side by side; `value` is called in the order of memory.
pub(crate) fn padded_groups<const N: usize>(
    size: Size,
    mut value: impl FnMut(usize, usize) -> [f32; N],
) -> Vec<f32> {
    let mut values = Vec::with_capacity(N * size.stride() * size.height as usize);
    for y in 0..size.height as usize {
        let mut last = [0.0; N];
        for x in 0..size.width as usize {
            last = value(x, y);
            values.extend(last);
        }
        (size.width as usize..size.stride()).for_each(|_| values.extend(last));
    }
    values
}

/// A plane's values in the layout of a buffer.
fn plane_values(plane: &Plane, value: impl Fn(f32) -> f32 + Copy) -> impl Iterator<Item = f32> {
    let size = plane.size;
    plane.data.chunks_exact(size.width as usize).flat_map(move |row| {
        let last = value(row[row.len() - 1]);
        padded(size, row.iter().map(move |v| value(*v)), last)
    })
}

/// A flow's values in the layout of a buffer: u and then v of each row; unknown displacements become zero.
fn flow_values(field: &FlowField) -> impl Iterator<Item = f32> {
    let size = field.size;
    let known = |uv: [f32; 2], c: usize| if FlowField::is_known(uv) { uv[c] } else { 0.0 };
    field.data.chunks_exact(size.width as usize).flat_map(move |row| {
        [0, 1].into_iter().flat_map(move |c| {
            let last = known(row[row.len() - 1], c);
            padded(size, row.iter().map(move |uv| known(*uv, c)), last)
        })
    })
}

/// The padding rule: a row, then copies of its last value up to the stride.
fn padded(size: Size, row: impl Iterator<Item = f32>, last: f32) -> impl Iterator<Item = f32> {
    row.chain(repeat_n(last, size.stride() - size.width as usize))
}

/// The flow in a buffer as pairs, without the surplus.
pub(crate) fn unpack_flow(values: &[f32], size: Size, out: &mut [[f32; 2]]) {
    let (width, stride) = (size.width as usize, size.stride());
    for (rows, out) in values.chunks_exact(2 * stride).zip(out.chunks_exact_mut(width)) {
        let (u, v) = rows.split_at(stride);
        for ((out, &u), &v) in out.iter_mut().zip(u).zip(v) {
            *out = [u, v];
        }
    }
}

/// The plane in a buffer, without the surplus.
pub(crate) fn unpack_plane(values: &[f32], size: Size, out: &mut [f32]) {
    let width = size.width as usize;
    for (row, out) in values.chunks_exact(size.stride()).zip(out.chunks_exact_mut(width)) {
        out.copy_from_slice(&row[..width]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::UNKNOWN_FLOW;

    fn packed(kind: PortKind, value: Value<'_>) -> Vec<f32> {
        let mut values = vec![9.0; kind.len()];
        assert_eq!(pack(kind, &value, values.as_mut_slice()), values.len());
        values
    }

    #[test]
    fn a_share_is_clamped_to_0_and_1() {
        let values = [-1.0, f32::NAN, 0.25, f32::INFINITY, 2.0, -0.0];
        let plane = Plane { size: Size::new(3, 2), data: values.to_vec() };
        let kind = PortKind::Plane { size: plane.size, range: Some([0.0, 1.0]) };
        assert_eq!(packed(kind, Value::Plane(&plane)), [0.0, 0.0, 0.25, 0.25, 1.0, 1.0, 0.0, 0.0]);
    }

    #[test]
    fn a_flow_comes_back_as_it_was() {
        for width in 1..6 {
            let size = Size::new(width, 2);
            let data: Vec<[f32; 2]> = (0..2 * width).map(|i| [i as f32, -(i as f32)]).collect();
            let field = FlowField { size, data };
            let packed = packed(PortKind::Flow { size }, Value::Flow(&field));
            assert_eq!(packed[size.stride() - 1], width as f32 - 1.0);
            let mut back = vec![[9.0; 2]; field.data.len()];
            unpack_flow(&packed, size, &mut back);
            assert_eq!(back, field.data);
        }
    }

    #[test]
    fn an_unknown_flow_is_zero() {
        let size = Size::new(2, 1);
        let field = FlowField { size, data: vec![[UNKNOWN_FLOW; 2], [f32::NAN, 1.0]] };
        assert_eq!(packed(PortKind::Flow { size }, Value::Flow(&field)), [0.0; 8]);
    }

    #[test]
    fn rows_and_groups_repeat_their_last_pixel() {
        let size = Size::new(2, 2);
        let plane = Plane { size, data: vec![0.0, 0.1, 0.2, 0.3] };
        assert_eq!(share(&plane), [0.0, 0.1, 0.1, 0.1, 0.2, 0.3, 0.3, 0.3]);
        let groups = padded_groups(Size::new(1, 1), |_, _| [1.0, 2.0]);
        assert_eq!(groups, [1.0, 2.0, 1.0, 2.0, 1.0, 2.0, 1.0, 2.0]);
    }
}
