//! What the kernels that see made-up surfaces share: how rays and surfaces lie in their buffers.
//!
//! A surface stands in a frame of its own: a box around the middle of its frame, a rectangle as a box of no height, a
//! plane as a rectangle of 10⁶ km, a cylinder around z. All places are the camera's, so that nothing far from the
//! world's origin is rounded by more than what is near it.

/// Pixels across and down of a tile, whose pixels have one list of surfaces.
pub const TILE: [usize; 2] = [16, 8];
/// Pixels that a reference works on at once.
pub(super) const LANES: usize = TILE[0];
pub(super) type Lanes = [f32; LANES];

/// Where in a pixel its four samples lie, in pixels from its centre: no two in one row or column.
pub const OFFSETS: [[f32; 2]; 4] = [[-0.125, -0.375], [0.375, -0.125], [0.125, 0.375], [-0.375, 0.125]];

/// Values of one pixel in the `rays` buffer: x/z and y/z of its centre, its width in radians (0 where the lens shows
/// nothing), 0; then how x/z changes to the right and down, and y/z.
pub const RAY: usize = 8;
/// Values of one surface in the `surfaces` buffer, which begins with four values: the direction up, and 0.
pub const SURFACE_LEN: usize = 24;

/// A surface as the kernels see it.
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
    /// What it is.
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
    /// As the buffer holds it.
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
