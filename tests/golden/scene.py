"""A synthetic scene for tests and benches: band-limited texture under a smooth known motion.

The texture is a continuous function of the plane (octaves of value noise on hashed integer
lattices, blended with a quintic), so the second image is the texture sampled through the motion
and not an interpolation of the first image. Only integer hashing and double arithmetic are used:
no generator whose stream may change with a release of numpy.
"""

import numpy as np

# (lattice spacing in pixels, weight) of each octave. The finest is near two pixels, so that
# smoothing and rounding matter; the coarsest gives large-scale contrast to the upper levels.
OCTAVES = ((41.0, 1.0), (19.0, 0.9), (9.0, 0.7), (4.5, 0.45), (2.3, 0.2))


def _hash(ix, iy, seed):
    """A value in [0, 1) for each lattice point: the finaliser of splitmix64."""
    with np.errstate(over="ignore"):
        z = (ix.astype(np.int64).astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15)
             ^ iy.astype(np.int64).astype(np.uint64) * np.uint64(0xC2B2AE3D27D4EB4F)
             ^ np.uint64(seed) * np.uint64(0x165667B19E3779F9))
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        z ^= z >> np.uint64(31)
    return (z >> np.uint64(11)).astype(np.float64) / float(1 << 53)


def noise(x, y, cell, seed):
    """Smoothed lattice noise in [-1, 1] with lattice spacing `cell`."""
    x, y = x / cell, y / cell
    x0, y0 = np.floor(x), np.floor(y)
    fx, fy = x - x0, y - y0
    fx = fx * fx * fx * (fx * (fx * 6 - 15) + 10)
    fy = fy * fy * fy * (fy * (fy * 6 - 15) + 10)
    a, b = _hash(x0, y0, seed), _hash(x0 + 1, y0, seed)
    c, d = _hash(x0, y0 + 1, seed), _hash(x0 + 1, y0 + 1, seed)
    return 2 * ((a * (1 - fx) + b * fx) * (1 - fy) + (c * (1 - fx) + d * fx) * fy) - 1


def texture(x, y, seed):
    """The scene's brightness at real coordinates, before it is scaled to 8 bits."""
    total = np.zeros(np.broadcast(x, y).shape)
    for octave, (cell, weight) in enumerate(OCTAVES):
        # Each octave has its own orientation: no lattice line coincides with an image row.
        c, s = np.cos(0.4 + octave), np.sin(0.4 + octave)
        total += weight * noise(c * x - s * y, s * x + c * y, cell, seed + 1000 * octave)
    return total


def _motion(x, y, width, height, strength):
    """Where a point of the second image came from in the first, less the point itself.

    Zoom and rotation about a point off the centre, a translation, and a slow ripple: some four
    pixels at most for a strength of 1 (large images turn and zoom by smaller angles and factors).
    """
    cx, cy = 0.45 * width, 0.55 * height
    turn = strength * min(1.0, 200.0 / max(width, height))
    zoom, angle = 1 - 0.018 * turn, 0.015 * turn
    c, s = zoom * np.cos(angle), zoom * np.sin(angle)
    dx, dy = x - cx, y - cy
    u = c * dx - s * dy - dx + strength * (-1.3 + 0.4 * np.sin(y / 17.0 + 0.3))
    v = s * dx + c * dy - dy + strength * (0.8 + 0.4 * np.cos(x / 23.0 - 0.2))
    return u, v


def grid(width, height):
    """Pixel coordinates as two arrays of doubles."""
    y, x = np.mgrid[0:height, 0:width].astype(np.float64)
    return x, y


def pair(width, height, seed=1, strength=1.0):
    """Two 8-bit gray images of the scene. Brightness spans 0..255 (two percent is clipped)."""
    x, y = grid(width, height)
    u, v = _motion(x, y, width, height, strength)
    first, second = texture(x, y, seed), texture(x + u, y + v, seed)
    if first.size >= 64:
        low, high = np.quantile(first, (0.01, 0.99))
    elif first.size > 1:
        low, high = first.min(), first.max()
    else:
        low, high = -1.6, 1.6
    return tuple(np.clip(np.rint((t - low) * (255.0 / (high - low))), 0, 255).astype(np.uint8)
                 for t in (first, second))


def truth(width, height, strength=1.0):
    """The flow from the first image to the second, by inverting the motion: (h, w, 2) doubles."""
    x, y = grid(width, height)
    fx, fy = np.zeros_like(x), np.zeros_like(y)
    for _ in range(40):
        u, v = _motion(x + fx, y + fy, width, height, strength)
        fx, fy = -u, -v
    return np.dstack((fx, fy))


def guess(width, height, seed=1, strength=1.0):
    """An initial flow: two thirds of the truth and errors of up to a pixel that change every
    few pixels, so that the way it is reduced to the coarsest level shows. (h, w, 2) floats."""
    x, y = grid(width, height)
    rough = np.dstack((noise(x, y, 3.7, seed + 77), noise(x, y, 3.1, seed + 78)))
    return (truth(width, height, strength) * (2 / 3) + rough).astype(np.float32)


def write_pgm(file, image):
    """Binary PGM (P5), 8 bits, into an open file."""
    height, width = image.shape
    file.write(b"P5\n%d %d\n255\n" % (width, height))
    file.write(np.ascontiguousarray(image, np.uint8).tobytes())


def write_flo(file, flow):
    """Middlebury .flo into an open file: "PIEH", width, height (i32), then u, v (f32) by rows;
    little-endian."""
    height, width = flow.shape[:2]
    file.write(b"PIEH" + np.array([width, height], "<i4").tobytes())
    file.write(np.ascontiguousarray(flow, "<f4").tobytes())


def read_flo(path):
    """The (h, w, 2) floats of a .flo file."""
    with open(path, "rb") as f:
        raw = f.read()
    if raw[:4] != b"PIEH":
        raise ValueError(f"{path}: not a .flo file")
    width, height = np.frombuffer(raw, "<i4", 2, 4)
    return np.frombuffer(raw, "<f4", int(width) * int(height) * 2, 12).reshape(height, width, 2)
