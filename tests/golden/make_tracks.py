#!/usr/bin/env python3
"""Makes corners.csv and tracks.csv beside it: OpenCV's corners and tracks of the golden image pairs.

    python -m venv v && v/bin/pip install opencv-python-headless==4.13.0.92 numpy==2.4.6
    v/bin/python tests/golden/make_tracks.py

The images are those of make.py. A line of corners.csv is a corner: image, settings of goodFeaturesToTrack (k is empty
without Harris' response), place, strongest first. A line of tracks.csv is a point: pair, settings of
calcOpticalFlowPyrLK, its place, where its search begins, where it ends, status and error.
"""

import pathlib

import cv2
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent

# image, quality_level, min_distance, block_size, k
CORNERS = (
    ("200x150_0", 0.01, 7, 3, None),
    ("200x150_1", 0.05, 0, 3, None),
    ("129x97_0", 0.01, 10, 7, None),
    ("129x97_1", 0.01, 5, 4, None),  # an even block extends further to the left and up
    ("97x71_0", 0.01, 5, 3, 0.04),
    ("70x66_0", 0.001, 3, 5, 0.06),
    ("65x33_flat_0", 0.01, 4, 3, None),
)
# pair, window, levels, iterations, epsilon, whether searches begin elsewhere
TRACKS = (
    ("200x150", (21, 21), 3, 30, 0.01, False),
    ("200x150", (9, 15), 2, 10, 0.03, False),
    ("129x97", (15, 15), 3, 30, 0.001, False),
    ("129x97", (31, 31), 5, 30, 0.01, False),  # the window leaves 1 level
    ("97x71", (7, 7), 0, 20, 0.01, True),
    ("65x33_strong", (11, 11), 2, 30, 0.01, False),  # much of it leaves the image
    ("65x33_flat", (9, 9), 1, 30, 0.01, False),  # nothing to find on the left
)


def image(name):
    found = cv2.imread(str(HERE / f"{name}.pgm"), cv2.IMREAD_GRAYSCALE)
    assert found is not None, name
    return found


def number(value):
    return repr(float(np.float32(value))) if value is not None else ""


def corners():
    yield "image,quality_level,min_distance,block_size,k,x,y"
    for name, quality, distance, block, k in CORNERS:
        settings = dict(blockSize=block, useHarrisDetector=k is not None, k=k or 0.04)
        found = cv2.goodFeaturesToTrack(image(name), 60, quality, distance, **settings)
        for x, y in found.reshape(-1, 2):
            yield f"{name},{quality},{distance},{block},{'' if k is None else k},{int(x)},{int(y)}"


def tracks():
    yield "pair,window,levels,iterations,epsilon,x,y,from_x,from_y,to_x,to_y,status,error"
    for pair, window, levels, iterations, epsilon, elsewhere in TRACKS:
        first, second = image(f"{pair}_0"), image(f"{pair}_1")
        height, width = first.shape
        # Places all over the image, at its border and beyond, whole and in between.
        grid = [(x, y) for y in np.linspace(-2, height + 1, 7) for x in np.linspace(-2, width + 1, 8)]
        points = np.float32([(np.round(x), np.round(y)) if i % 3 == 0 else (x, y) for i, (x, y) in enumerate(grid)])
        begin = points + np.float32([0.8, -0.6]) if elsewhere else points
        criteria = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, iterations, epsilon)
        flags = cv2.OPTFLOW_USE_INITIAL_FLOW if elsewhere else 0
        found, status, error = cv2.calcOpticalFlowPyrLK(
            first, second, points.reshape(-1, 1, 2), begin.reshape(-1, 1, 2).copy(), winSize=window, maxLevel=levels,
            criteria=criteria, flags=flags)
        rows = zip(points, begin, found.reshape(-1, 2), status.ravel(), error.ravel())
        for (x, y), (from_x, from_y), (to_x, to_y), status, error in rows:
            values = [x, y, from_x, from_y, to_x, to_y]
            # OpenCV leaves the error of a lost point undefined.
            text = ",".join(map(number, values)) + f",{status},{number(error if status else 0)}"
            yield f"{pair},{window[0]}x{window[1]},{levels},{iterations},{epsilon},{text}"


def main():
    assert cv2.__version__ == "4.13.0", cv2.__version__
    cv2.setNumThreads(1)
    for name, lines in ("corners.csv", corners()), ("tracks.csv", tracks()):
        (HERE / name).write_text("\n".join(lines) + "\n")


main()
