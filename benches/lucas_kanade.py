#!/usr/bin/env python3
"""Compares dense Lucas-Kanade flow with OpenCV's sparse one on a grid of points, on pairs with ground truth.

    python benches/lucas_kanade.py DATA [--binary target/release/viewsphere] [flags of `viewsphere flow` ...]

DATA is a folder with yosemite/ and middlebury/. Needs numpy and opencv-python. OpenCV tracks each point forward and back;
it converges if it returns within 0.5 px and OpenCV reports it as found. viewsphere's converges if its forward and backward
flow agree within 0.5 px.
"""
import argparse
import pathlib
import subprocess
import tempfile

import cv2
import numpy as np

STEP, BORDER = 4, 16


def read_flo(path):
    with open(path, "rb") as file:
        assert np.fromfile(file, np.float32, 1)[0] == np.float32(202021.25), path
        width, height = np.fromfile(file, np.int32, 2)
        return np.fromfile(file, np.float32).reshape(height, width, 2)


def pairs(data):
    land = cv2.imread(str(data / "yosemite/derived_mask_land.png"), cv2.IMREAD_GRAYSCALE) > 0
    yosemite = data / "yosemite"
    yield "Yosemite 9-10", yosemite / "derived_yos09.png", yosemite / "derived_yos10.png", yosemite / "derived_flow09.flo", land
    for name in ["RubberWhale", "Dimetrodon", "Venus"]:
        folder = data / "middlebury" / name
        yield name, folder / "frame10.png", folder / "frame11.png", folder / "flow10.flo", None


def ours(binary, flags, a, b):
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "flow.flo"
        command = [binary, "flow", a, b, "-o", out, "--algorithm", "lucas-kanade", "--backend", "cpu", *flags]
        subprocess.run([str(part) for part in command], check=True, capture_output=True)
        return read_flo(out)


def opencv(a, b, points):
    images = [cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) for path in (a, b)]
    settings = dict(winSize=(21, 21), maxLevel=3, criteria=(3, 30, 0.01))
    there, found, _ = cv2.calcOpticalFlowPyrLK(*images, points, None, **settings)
    back, found_back, _ = cv2.calcOpticalFlowPyrLK(*images[::-1], there, None, **settings)
    returns = np.linalg.norm(back - points, axis=-1).ravel() < 0.5
    return (there - points).reshape(-1, 2), returns & (found.ravel() > 0) & (found_back.ravel() > 0)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("--binary", default="target/release/viewsphere")
    options, flags = parser.parse_known_args()
    head = "pair", "points", "both converge", "difference: median px", "AEE ours px", "AEE OpenCV px", "AAE ours °", "AAE OpenCV °"
    print("| " + " | ".join(head) + " |\n" + "|---" * len(head) + "|")
    for name, a, b, truth, mask in pairs(options.data):
        truth = read_flo(truth)
        height, width = truth.shape[:2]
        y, x = np.mgrid[BORDER : height - BORDER : STEP, BORDER : width - BORDER : STEP]
        known = (np.abs(truth) < 1e9).all(-1) & (True if mask is None else mask)
        x, y = x[known[y, x]], y[known[y, x]]
        theirs, converged = opencv(a, b, np.stack([x, y], -1).astype(np.float32).reshape(-1, 1, 2))
        field, back = ours(options.binary, flags, a, b), ours(options.binary, flags, b, a)
        here = field[y, x]
        there = np.stack([x, y], -1) + here
        nearest = np.clip(np.rint(there).astype(int), 0, [width - 1, height - 1])
        returned = np.linalg.norm(here + back[nearest[:, 1], nearest[:, 0]], axis=-1) < 0.5
        both = converged & returned
        right = truth[y, x]
        difference = np.linalg.norm(here - theirs, axis=-1)[both]

        def errors(flow):
            ends = np.linalg.norm(flow - right, axis=-1)[both].mean()
            lift = lambda d: np.concatenate([d, np.ones((len(d), 1))], -1) / np.sqrt((d**2).sum(-1, keepdims=True) + 1)
            cosine = np.clip((lift(flow) * lift(right)).sum(-1), -1, 1)
            return ends, np.degrees(np.arccos(cosine))[both].mean()

        (end, angle), (their_end, their_angle) = errors(here), errors(theirs)
        print(f"| {name} | {len(x)} | {both.mean():.1%} | {np.median(difference):.3f} | {end:.3f} | {their_end:.3f} | {angle:.2f} | {their_angle:.2f} |")


if __name__ == "__main__":
    main()
