#!/usr/bin/env python3
"""Compares `viewsphere track` with OpenCV's goodFeaturesToTrack and calcOpticalFlowPyrLK on pairs of real images.

    python benches/sparse_lucas_kanade.py DATA [--binary target/release/viewsphere] [--backend cpu|gpu]

DATA is a folder with middlebury/, yosemite/ and euroc_v101/. Needs numpy and opencv-python. Both get the gray images that
OpenCV reads, as decoders of JPEG and conversions from colour differ by a gray level. Both track OpenCV's corners and a grid.
A pair of results differs in status if only one has found the point; the differences of places are of points that both
have found.
"""
import argparse
import csv
import pathlib
import subprocess
import tempfile

import cv2
import numpy as np

# window, levels, iterations, epsilon
SETTINGS = [(21, 3, 30, 0.01), (9, 2, 30, 0.01), (15, 3, 10, 0.03), (31, 4, 30, 0.01), (21, 0, 30, 0.01)]
# quality_level, min_distance, block_size, k
CORNERS = [(0.01, 7, 3, None), (0.001, 3, 3, None), (0.01, 10, 7, None), (0.01, 7, 3, 0.04)]


def pairs(data, folder):
    """The pairs' gray images, written to a folder."""
    for i, (name, *images) in enumerate(originals(data)):
        paths = [folder / f"{i}_{k}.png" for k in range(2)]
        for image, path in zip(images, paths):
            assert cv2.imwrite(str(path), cv2.imread(str(image), cv2.IMREAD_GRAYSCALE)), path
        yield name, *paths


def originals(data):
    for name in ["RubberWhale", "Dimetrodon", "Venus"]:
        folder = data / "middlebury" / name
        yield name, folder / "frame10.png", folder / "frame11.png"
    yield "Yosemite", data / "yosemite/derived_yos09.png", data / "yosemite/derived_yos10.png"
    frames = sorted((data / "euroc_v101/cam0").glob("*.jpg"))
    yield "EuRoC, 1 frame", frames[0], frames[1]
    yield "EuRoC, 5 frames", frames[0], frames[5]


def ours(options, inputs, flags):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "tracks.csv"
        command = [options.binary, "track", *inputs, "-o", out, "--backend", options.backend, *flags]
        subprocess.run([str(part) for part in command], check=True, capture_output=True)
        with open(out) as file:
            return list(csv.DictReader(file))


def corners(options, first, second, quality, distance, block, k):
    image = cv2.imread(str(first), cv2.IMREAD_GRAYSCALE)
    settings = dict(blockSize=block, useHarrisDetector=k is not None, k=k or 0.04)
    expected = cv2.goodFeaturesToTrack(image, 1000, quality, distance, **settings).reshape(-1, 2)
    flags = ["--max-corners", 1000, "--quality-level", quality, "--min-distance", distance, "--block-size", block]
    flags += ["--harris", "--k", k] if k is not None else []
    found = [(float(row["x"]), float(row["y"])) for row in ours(options, [first, second], flags) if row["frame"] == "0"]
    same = len(set(map(tuple, expected.tolist())) & set(found))
    return len(expected), len(found), same / max(len(expected), len(found))


def tracks(options, first, second, window, levels, iterations, epsilon):
    images = [cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) for path in (first, second)]
    points = cv2.goodFeaturesToTrack(images[0], 1000, 0.001, 5).reshape(-1, 2)
    corners = len(points)
    # Places between pixels, and on no corner.
    height, width = images[0].shape
    grid = np.float32([(x + 0.3, y + 0.6) for y in range(4, height - 4, 12) for x in range(4, width - 4, 12)])
    points = np.concatenate([points, grid])
    there, status, error = cv2.calcOpticalFlowPyrLK(
        *images, points.reshape(-1, 1, 2), None, winSize=(window, window), maxLevel=levels,
        criteria=(cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, iterations, epsilon))
    with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
        file.writelines(f"{x!r},{y!r}\n" for x, y in points.tolist())
        file.flush()
        flags = ["--points", file.name, "--max-corners", len(points), "--window", window, "--levels", levels,
                 "--iterations", iterations, "--epsilon", epsilon]
        rows = [row for row in ours(options, [first, second], flags) if row["frame"] == "1"]
    assert len(rows) == len(points)
    found = np.array([row["status"] in ("tracked", "outside") for row in rows])
    places = np.float32([(row["x"], row["y"]) for row in rows])
    status = status.ravel() > 0
    both = found & status
    apart = np.linalg.norm(places - there.reshape(-1, 2), axis=1)[both]
    errors = np.abs(np.float32([row["error"] for row in rows]) - error.ravel())[both]
    same = found == status
    return len(points), both.mean(), same.mean(), same[:corners].mean(), *np.quantile(apart, [0.5, 0.9, 0.99]), np.median(errors)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("--binary", default="target/release/viewsphere")
    parser.add_argument("--backend", default="cpu")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        compare(options, list(pairs(options.data, pathlib.Path(folder))))


def compare(options, pairs):
    print("| pair | window, levels | points | found by both | status | of corners | median | 90 % | 99 % | of the error |")
    print("|---" * 10 + "|")
    for name, first, second in pairs:
        for settings in SETTINGS:
            count, both, same, of_corners, median, most, almost, error = tracks(options, first, second, *settings)
            print(f"| {name} | {settings[0]}, {settings[1]} | {count} | {both:.1%} | {same:.2%} | {of_corners:.2%} | {median:.5f} | {most:.4f} "
                  f"| {almost:.3f} | {error:.4f} |", flush=True)
    print("\n| pair | quality, distance, block, k | OpenCV | ours | the same |\n" + "|---" * 5 + "|")
    for name, first, second in pairs:
        for settings in CORNERS:
            expected, found, same = corners(options, first, second, *settings)
            print(f"| {name} | {', '.join(map(str, settings))} | {expected} | {found} | {same:.2%} |", flush=True)


main()
