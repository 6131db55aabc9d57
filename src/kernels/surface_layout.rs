//! Shared by the kernels that render surfaces: the layout of rays and surfaces in their buffers.
//!
//! A surface stands in a frame of its own: a box around the middle of its frame, a rectangle as a box of no height, a
//! plane as a rectangle of 10⁶ km, a cylinder around z. All places are the camera's, so that nothing far from the
//! world's origin is rounded by more than what is near it.

/// Width and height of a tile in pixels. The pixels of a tile share one list of surfaces.
pub const TILE: [usize; 2] = [16, 8];
/// Number of pixels that a reference processes at once.
pub(super) const LANES: usize = TILE[0];
pub(super) type Lanes = [f32; LANES];

/// The offsets of a pixel's four samples from its centre, in pixels: no two in one row or column.
pub const OFFSETS: [[f32; 2]; 4] = [[-0.125, -0.375], [0.375, -0.125], [0.125, 0.375], [-0.375, 0.125]];

/// Values of one pixel in the `rays` buffer: x/z and y/z of its centre, its width in radians (0 outside the lens's
/// field of view), 0; then how x/z changes to the right and down, and y/z.
pub const RAY: usize = 8;
/// Values of one surface in the `surfaces` buffer, which begins with four values: the direction up, and 0.
pub const SURFACE_LEN: usize = 24;

/// A surface in the form that the kernels take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceRecord {
    /// The surface's axes in the camera's frame.
    pub axes: [[f32; 3]; 3],
    /// The camera's place along them, from the surface's middle, metres.
    pub place_m: [f32; 3],
    /// Half the lengths along them; of a cylinder radius, radius and half its length.
    pub half_m: [f32; 3],
    /// From the camera to the nearest point, metres.
    pub nearest_m: f32,
    /// The camera's place in the texture beyond [`SurfaceRecord::cells`], metres.
    pub texture_m: [f32; 3],
    /// The camera's place in the texture in whole grid spacings of the coarsest octave.
    pub cells: [f32; 3],
    /// The surface's number in its world.
    pub number: u32,
    /// Its shape.
    pub kind: Kind,
}

/// The shape of a [`SurfaceRecord`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Six faces.
    Cuboid = 0,
    /// A rectangle or a plane: one face.
    Flat = 1,
    /// A mantle and two lids.
    Cylinder = 2,
}

impl SurfaceRecord {
    /// The values in the layout of the buffer.
    pub fn values(&self) -> [f32; SURFACE_LEN] {
        let ([x, y, z], [a, b, c]) = (self.axes, self.place_m);
        let ([u, v, w], [i, j, k], half) = (self.texture_m, self.cells, self.half_m);
        [
            x[0],
            x[1],
            x[2],
            a,
            y[0],
            y[1],
            y[2],
            b,
            z[0],
            z[1],
            z[2],
            c,
            half[0],
            half[1],
            half[2],
            self.nearest_m,
            u,
            v,
            w,
            self.number as f32,
            i,
            j,
            k,
            f32::from(self.kind as u8),
        ]
    }
}

#[inline(always)]
pub(super) fn pick(condition: bool, yes: f32, no: f32) -> f32 {
    if condition { yes } else { no }
}

#[inline(always)]
pub(super) fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
pub(super) fn most(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
