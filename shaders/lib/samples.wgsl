
// The offsets of a pixel's four samples from its centre, in pixels: no two in one row or column.
const OFFSET_X = vec4f(-0.125, 0.375, 0.125, -0.375);
const OFFSET_Y = vec4f(-0.375, -0.125, 0.375, 0.125);
