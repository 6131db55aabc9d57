#!/usr/bin/env python3
"""OpenCV's Farnebäck fields for real pairs with ground truth, and their errors.

    python benches/reference_fields.py [--data DIR] [--out DIR]

DIR (or $VIEWSPHERE_DATA, or ../shared/data) holds yosemite/ and middlebury/. Without it the script
says so and exits with 0. The output folder receives, per pair, the gray images used, <pair>_0.pgm and
<pair>_1.pgm, and one field per setting, <pair>_<setting>.flo. The script prints the mean endpoint
error in pixels and the mean angle in degrees between (u, v, 1) vectors, over pixels with ground
truth; for Yosemite on land only, as its sky has none.
"""

import argparse
import os
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "benches"), str(ROOT / "tests/golden")]
import pinned  # noqa: E402

pinned.ensure()
import cv2  # noqa: E402
import numpy as np  # noqa: E402

import scene  # noqa: E402

# name: (pyr_scale, levels, winsize, iterations, poly_n, poly_sigma, flags)
SETTINGS = {
    "heavy": (0.5, 5, 13, 10, 5, 1.1, 0),
    "heavy-gauss": (0.5, 5, 13, 10, 5, 1.1, cv2.OPTFLOW_FARNEBACK_GAUSSIAN),
    "light": (0.5, 3, 15, 3, 5, 1.2, 0),
}

# name: (first, second, truth, mask or None), below the data folder.
YOSEMITE = "yosemite/derived_{}"
PAIRS = {
    "yosemite_9_10": (YOSEMITE.format("yos09.png"), YOSEMITE.format("yos10.png"),
                      YOSEMITE.format("flow09.flo"), YOSEMITE.format("mask_land.png")),
    "yosemite_8_9": (YOSEMITE.format("yos08.png"), YOSEMITE.format("yos09.png"), None,
                     YOSEMITE.format("mask_land.png")),
    **{name.lower(): tuple(f"middlebury/{name}/{file}" for file in
                           ("frame10.png", "frame11.png", "flow10.flo")) + (None,)
       for name in ("RubberWhale", "Dimetrodon", "Venus")},
}


def errors(flow, truth, keep):
    """Mean endpoint error (pixels) and mean angular error (degrees) over the pixels to keep."""
    a, b = flow[keep].astype(np.float64), truth[keep].astype(np.float64)
    endpoint = np.hypot(*(a - b).T)
    cosine = (1 + (a * b).sum(1)) / np.sqrt((1 + (a * a).sum(1)) * (1 + (b * b).sum(1)))
    return endpoint.mean(), np.degrees(np.arccos(np.clip(cosine, -1, 1))).mean()


def gray(path):
    image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise FileNotFoundError(path)
    return image


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=pathlib.Path)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "target/reference")
    options = parser.parse_args()
    data = options.data or pathlib.Path(os.environ.get("VIEWSPHERE_DATA")
                                        or ROOT.parent / "shared/data")
    if not (data / "middlebury").is_dir() or not (data / "yosemite").is_dir():
        print(f"no data in {data} (set --data or VIEWSPHERE_DATA): nothing done")
        return
    options.out.mkdir(parents=True, exist_ok=True)
    cv2.ocl.setUseOpenCL(False)
    print(f"opencv {cv2.__version__}, numpy {np.__version__}; AEE px / AAE degrees")
    print(f"{'pair':16}" + "".join(f"{setting:>18}" for setting in SETTINGS))
    for pair, (first, second, truth_file, mask) in PAIRS.items():
        images = gray(data / first), gray(data / second)
        truth = scene.read_flo(data / (truth_file or PAIRS["yosemite_9_10"][2]))
        keep = (np.abs(truth) < 1e9).all(2)
        if mask:
            keep &= gray(data / mask) > 0
        for k, image in enumerate(images):
            with open(options.out / f"{pair}_{k}.pgm", "wb") as f:
                scene.write_pgm(f, image)
        line = f"{pair:16}"
        for setting, (*numbers, flags) in SETTINGS.items():
            flow = cv2.calcOpticalFlowFarneback(*images, None, *numbers, flags)
            with open(options.out / f"{pair}_{setting}.flo", "wb") as f:
                scene.write_flo(f, flow)
            line += "{:>10.4f} /{:>6.2f}".format(*errors(flow, truth, keep))
        print(line)


if __name__ == "__main__":
    main()
