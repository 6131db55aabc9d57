#!/usr/bin/env python3
"""Makes the golden files beside it: image pairs and OpenCV's flow fields between them.

    python -m venv v && v/bin/pip install opencv-python-headless==4.13.0.92 numpy==2.4.6
    v/bin/python tests/golden/make.py            # writes *.pgm, *.flo and cases.csv
    v/bin/python tests/golden/make.py --check    # writes nothing, compares with the existing files

Nothing is random and nothing is real data: scene.py computes texture and motion. The images are
the same bytes everywhere. The fields depend on the instruction set OpenCV picks at run time, by
less than 1e-4 pixels; the last column printed says how much they change on this machine when
OpenCV's vector code and IPP are switched off.
"""

import csv
import io
import pathlib
import sys

import cv2
import numpy as np

import scene

OPENCV, NUMPY = "4.13.0", "2.4.6"
HERE = pathlib.Path(__file__).resolve().parent
BOX, GAUSSIAN = "box", "gaussian"
COLUMNS = ("name image0 image1 pyr_scale levels winsize iterations poly_n poly_sigma window init "
           "flow").split()

# name: (width, height, seed, strength of the motion, first textured column)
PAIRS = {
    "200x150": (200, 150, 1, 1.0, 0),
    "129x97": (129, 97, 2, 1.0, 0),
    "128x96": (128, 96, 3, 1.0, 0),
    "97x71": (97, 71, 4, 1.0, 0),
    "70x66": (70, 66, 5, 1.0, 0),
    "65x33": (65, 33, 6, 1.0, 0),
    "65x33_strong": (65, 33, 7, 4.0, 0),  # up to seven pixels: much of it leaves the image
    "65x33_flat": (65, 33, 8, 1.0, 30),  # the left part is one gray: nothing to find there
    "33x40": (33, 40, 9, 1.0, 0),
    "40x3": (40, 3, 10, 0.5, 0),
    "7x5": (7, 5, 11, 0.5, 0),
    "1x9": (1, 9, 12, 0.5, 0),
    "1x1": (1, 1, 13, 0.5, 0),
}

# Pairs that have an initial flow, <pair>_init.flo.
INITS = ("97x71", "70x66", "65x33")

# `levels` counts the levels above the full image: 0 is the image alone. No level is made on which
# a side would be below 32 pixels; "used" in the comments counts those above the full image.
CASES = (
    # pair, pyr_scale, levels, winsize, iterations, poly_n, poly_sigma, window, initial flow, tag
    ("200x150", 0.5, 3, 15, 3, 5, 1.2, BOX, False, "light"),  # 2 used
    ("129x97", 0.5, 5, 13, 10, 5, 1.1, GAUSSIAN, False, "heavy"),  # 1 used: 64x48, ties to even
    ("129x97", 0.8, 6, 13, 3, 5, 1.1, BOX, False, "p80"),  # 4 used
    ("129x97", 0.63, 4, 12, 2, 7, 1.5, GAUSSIAN, False, "p63"),  # 2 used
    ("128x96", 0.5, 0, 12, 1, 7, 1.5, BOX, False, "one"),
    ("97x71", 0.5, 1, 5, 3, 5, 1.1, BOX, False, "small"),  # 1 used
    ("97x71", 0.8, 5, 13, 2, 5, 1.2, BOX, True, "init"),  # 3 used
    ("70x66", 0.5, 5, 13, 10, 5, 1.1, BOX, False, "heavy"),  # 1 used
    ("70x66", 0.63, 1, 15, 1, 5, 1.1, GAUSSIAN, True, "init"),  # 1 used
    ("70x66", 0.5, 3, 12, 2, 7, 1.5, BOX, True, "init_half"),  # 1 used: exactly half
    ("65x33", 0.8, 3, 15, 1, 5, 1.2, GAUSSIAN, False, "short"),  # 0 used
    ("65x33", 0.5, 0, 9, 1, 5, 1.1, BOX, True, "init_one"),
    ("65x33_strong", 0.5, 0, 15, 8, 7, 1.5, BOX, False, "one"),
    ("65x33_flat", 0.5, 0, 7, 3, 5, 1.1, BOX, False, "one"),
    ("33x40", 0.8, 3, 12, 3, 5, 1.1, BOX, False, "short"),  # 0 used
    ("33x40", 0.5, 0, 8, 5, 7, 1.5, GAUSSIAN, False, "one"),
    ("40x3", 0.5, 1, 13, 3, 7, 1.5, GAUSSIAN, False, "tiny"),
    ("40x3", 0.5, 0, 6, 2, 5, 1.1, BOX, False, "tiny"),
    ("7x5", 0.5, 3, 5, 2, 5, 1.1, BOX, False, "tiny"),
    ("7x5", 0.5, 0, 15, 3, 7, 1.5, GAUSSIAN, False, "tiny"),
    ("1x9", 0.5, 0, 5, 3, 5, 1.1, BOX, False, "tiny"),
    ("1x9", 0.5, 0, 12, 3, 7, 1.5, GAUSSIAN, False, "tiny"),
    ("1x1", 0.5, 3, 15, 3, 5, 1.2, BOX, False, "tiny"),
    ("1x1", 0.5, 0, 13, 1, 7, 1.5, GAUSSIAN, False, "tiny"),
)


def images(pair):
    width, height, seed, strength, textured_from = PAIRS[pair]
    first, second = scene.pair(width, height, seed, strength)
    first[:, :textured_from] = 90
    second[:, :textured_from] = 90
    return first, second


def initial(pair):
    width, height, seed, strength, _ = PAIRS[pair]
    return scene.guess(width, height, seed, strength)


def field(case):
    pair, pyr_scale, levels, winsize, iterations, poly_n, poly_sigma, window, init, _ = case
    flags = cv2.OPTFLOW_FARNEBACK_GAUSSIAN if window == GAUSSIAN else 0
    flow = None
    if init:
        flags |= cv2.OPTFLOW_USE_INITIAL_FLOW
        flow = initial(pair)  # overwritten and returned
    first, second = images(pair)
    return cv2.calcOpticalFlowFarneback(first, second, flow, pyr_scale, levels, winsize,
                                        iterations, poly_n, poly_sigma, flags)


def distance(a, b):
    return float(np.abs(a.astype(np.float64) - b).max())


def plain_difference(case, flow):
    """How far the field moves, at most, without vector code and without IPP."""
    cv2.setUseOptimized(False)
    a = field(case)
    cv2.setUseOptimized(True)
    b = flow
    if hasattr(cv2, "ipp"):
        cv2.ipp.setUseIPP(False)
        b = field(case)
        cv2.ipp.setUseIPP(True)
    return max(distance(a, flow), distance(b, flow))


def main():
    check = sys.argv[1:] == ["--check"]
    if sys.argv[1:] and not check:
        sys.exit(__doc__)
    print(f"opencv {cv2.__version__}, numpy {np.__version__}")
    if (cv2.__version__, np.__version__) != (OPENCV, NUMPY):
        sys.exit(f"wanted opencv {OPENCV} and numpy {NUMPY}: see the top of this file")
    cv2.setNumThreads(1)
    cv2.ocl.setUseOpenCL(False)

    wrong = []
    if not check:
        for old in (*HERE.glob("*.pgm"), *HERE.glob("*.flo")):
            old.unlink()

    def exact(name, write):
        """Writes a file, or compares it byte by byte with what is there."""
        if check:
            made = io.BytesIO()
            write(made)
            if (HERE / name).read_bytes() != made.getvalue():
                wrong.append(name)
        else:
            with open(HERE / name, "wb") as f:
                write(f)

    for pair in PAIRS:
        for k, image in enumerate(images(pair)):
            exact(f"{pair}_{k}.pgm", lambda f: scene.write_pgm(f, image))
    for pair in INITS:
        exact(f"{pair}_init.flo", lambda f: scene.write_flo(f, initial(pair)))

    rows = []
    for case in CASES:
        pair, *numbers, window, init, tag = case
        name = f"{pair}_{window}_{tag}"
        flow = field(case)
        if not np.isfinite(flow).all():
            sys.exit(f"{name}: the field is not finite")
        file = f"{name}.flo"
        if check:
            if distance(scene.read_flo(HERE / file), flow) > 1e-4:
                wrong.append(file)
        else:
            with open(HERE / file, "wb") as f:
                scene.write_flo(f, flow)
        rows.append([name, f"{pair}_0.pgm", f"{pair}_1.pgm", *numbers, window,
                     f"{pair}_init.flo" if init else "", file])
        length = np.hypot(flow[..., 0], flow[..., 1])
        print(f"{name:32} length mean {length.mean():8.4f} max {length.max():8.4f}"
              f"  without vector code {plain_difference(case, flow):.1e}")

    assert len({row[0] for row in rows}) == len(rows)
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(COLUMNS)
    table.writerows(rows)
    exact("cases.csv", lambda f: f.write(text.getvalue().encode()))

    size = sum(f.stat().st_size for p in ("*.pgm", "*.flo", "cases.csv") for f in HERE.glob(p))
    print(f"{len(rows)} cases, {size / 1e6:.3f} MB")
    if wrong:
        sys.exit("differ: " + ", ".join(wrong))


if __name__ == "__main__":
    main()
