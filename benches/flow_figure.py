#!/usr/bin/env python3
"""Error against time of viewsphere's algorithms and presets and of OpenCV's, measured in one run, as a table and a plot.

    python benches/flow_figure.py DATA [--binary target/release/viewsphere] [--svg docs/flow.svg] [--json FILE]

DATA is a folder with yosemite/ and middlebury/. Needs numpy and opencv-contrib-python. Everything runs on one thread; a time is
processor time of a lone pair, summed over the five pairs, as a multiple of that of DIS medium. An error is the geometric mean of
the ratios to that of DIS medium. Rounds alternate between all contenders, and a contender's time is its least one.
"""
import argparse
import json
import os
import pathlib
import subprocess
import tempfile
import time

import cv2
import numpy as np

REFERENCE = "DIS medium"


def read_flo(path):
    with open(path, "rb") as file:
        assert np.fromfile(file, np.float32, 1)[0] == np.float32(202021.25), path
        width, height = np.fromfile(file, np.int32, 2)
        return np.fromfile(file, np.float32).reshape(height, width, 2)


def pairs(data):
    yosemite = data / "yosemite"
    land = cv2.imread(str(yosemite / "derived_mask_land.png"), cv2.IMREAD_GRAYSCALE) > 0
    for first, second in (("08", "09"), ("09", "10")):
        images = [yosemite / f"derived_yos{number}.png" for number in (first, second)]
        yield f"{int(first)}-{int(second)}", images, yosemite / "derived_flow09.flo", land
    for name in ("RubberWhale", "Dimetrodon", "Venus"):
        folder = data / "middlebury" / name
        yield name, [folder / "frame10.png", folder / "frame11.png"], folder / "flow10.flo", True


def errors(flow, truth, mask):
    known = (np.abs(truth) < 1e9).all(-1) & mask
    a, b = flow[known].astype(float), truth[known].astype(float)
    product = (a * b).sum(-1) + 1
    length = np.sqrt(((a * a).sum(-1) + 1) * ((b * b).sum(-1) + 1))
    angle = np.degrees(np.arccos(np.clip(product / length, -1, 1)))
    return np.linalg.norm(a - b, axis=-1).mean(), angle.mean()


def opencv():
    """Each contender of OpenCV: a function from two gray images to the flow."""
    def dis(preset):
        return lambda a, b: cv2.DISOpticalFlow_create(preset).calc(a, b, None)

    def contrib(create):
        return lambda a, b: create().calc(a, b, None)

    def rlof(a, b):
        colour = [cv2.cvtColor(image, cv2.COLOR_GRAY2BGR) for image in (a, b)]
        return cv2.optflow.calcOpticalFlowDenseRLOF(*colour, None)

    return {
        "Farnebäck": lambda a, b: cv2.calcOpticalFlowFarneback(a, b, None, 0.5, 3, 15, 3, 5, 1.2, 0),
        "Farnebäck heavy": lambda a, b: cv2.calcOpticalFlowFarneback(a, b, None, 0.5, 5, 13, 10, 5, 1.1, 0),
        "DIS ultrafast": dis(0), "DIS fast": dis(1), "DIS medium": dis(2),
        "TV-L1": contrib(cv2.optflow.DualTVL1OpticalFlow_create),
        "PCAFlow": contrib(cv2.optflow.createOptFlow_PCAFlow),
        "DeepFlow": contrib(cv2.optflow.createOptFlow_DeepFlow),
        "RLOF": rlof,
    }


def ours(binary, data, runs):
    """Times in ms and errors by contender and pair."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "figures.json"
        command = [binary, "eval", "--data", data / "yosemite", data / "middlebury", "--backend", "cpu", "--repeats", "1",
                   "--quiet", "--json", file, *(["--run", runs] if runs else ["--preset", "all"])]
        subprocess.run([str(part) for part in command], check=True, stdout=subprocess.DEVNULL,
                       env={**os.environ, "RAYON_NUM_THREADS": "1"})
        rows = json.loads(file.read_text())["pairs"]
    found = {}
    for row in rows:
        error = row["errors"]["all"]
        figures = row["time"]["processor_ms"], (error["aee_px"], error["aae_deg"])
        found.setdefault(row["run"], {})[row["pair"]] = figures
    return found


def measure(options):
    cv2.setNumThreads(1)
    all_pairs = list(pairs(options.data))
    found = {}

    def add(name, pair, ms, error):
        old = found.setdefault(name, {}).get(pair, (np.inf, error))
        found[name][pair] = min(ms, old[0]), error

    for _ in range(options.rounds):
        for name, estimate in opencv().items():
            for pair, images, truth, mask in all_pairs:
                a, b = (cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) for path in images)
                begin = time.process_time()
                flow = estimate(a, b)
                add(f"OpenCV {name}", pair, 1e3 * (time.process_time() - begin), errors(flow, read_flo(truth), mask))
        for name, by_pair in ours(options.binary, options.data, options.runs).items():
            for pair, (ms, error) in by_pair.items():
                add(name, pair, ms, error)
    # The flow filter needs a stream: a lone pair shows the error of its first one.
    found = {name: by_pair for name, by_pair in found.items() if not name.startswith("flow-filter")}
    reference = found[f"OpenCV {REFERENCE}"]
    whole = sum(ms for ms, _ in reference.values())
    rows = []
    for name, by_pair in found.items():
        missing = set(reference) - set(by_pair)
        assert not missing, f"{name} lacks {missing}"
        ratios = np.log([np.divide(by_pair[pair][1], reference[pair][1]) for pair in reference])
        aee, aae = np.exp(ratios.mean(0))
        yosemite = by_pair["8-9"][1][1], by_pair["9-10"][1][1]
        rows.append({"name": name, "time": sum(ms for ms, _ in by_pair.values()) / whole, "aee": aee, "aae": aae,
                     "yosemite_aae_deg": yosemite, "ms": sum(ms for ms, _ in by_pair.values())})
    return sorted(rows, key=lambda row: row["time"])


def table(rows):
    print(f"| | time / {REFERENCE} | AEE / {REFERENCE} | AAE / {REFERENCE} | Yosemite 8→9, 9→10 AAE ° |\n|---|---|---|---|---|")
    for row in rows:
        first, second = row["yosemite_aae_deg"]
        print(f"| {row['name']} | {row['time']:.2f} | {row['aee']:.2f} | {row['aae']:.2f} | {first:.2f}, {second:.2f} |")


FAMILIES = {"OpenCV": "#767676", "farneback-tv": "#c0392b", "farneback": "#2c6fbb", "horn-schunck": "#8a5a00",
            "lucas-kanade": "#2e7d32"}


def svg(rows):
    """The plot, both axes logarithmic: time to the right, error up."""
    width, height, left, bottom, top, right = 900, 560, 70, 60, 20, 150
    xs, ys = [row["time"] for row in rows], [row["aee"] for row in rows]
    x_0, x_1 = np.log(min(xs) / 1.3), np.log(max(xs) * 1.3)
    y_0, y_1 = np.log(min(ys) / 1.15), np.log(max(ys) * 1.15)
    x = lambda value: left + (np.log(value) - x_0) / (x_1 - x_0) * (width - left - right)
    y = lambda value: height - bottom - (np.log(value) - y_0) / (y_1 - y_0) * (height - bottom - top)
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12">',
             f'<rect width="{width}" height="{height}" fill="#ffffff"/>']
    for value in (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200):
        if x_0 <= np.log(value) <= x_1:
            parts.append(f'<path d="M{x(value):.1f} {top}V{height - bottom}" stroke="#dddddd"/>'
                         f'<text x="{x(value):.1f}" y="{height - bottom + 18}" text-anchor="middle">{value:g}</text>')
    for value in (0.2, 0.3, 0.4, 0.5, 0.7, 1, 1.5, 2, 3, 4, 6):
        if y_0 <= np.log(value) <= y_1:
            parts.append(f'<path d="M{left} {y(value):.1f}H{width - right}" stroke="#dddddd"/>'
                         f'<text x="{left - 8}" y="{y(value) + 4:.1f}" text-anchor="end">{value:g}</text>')
    parts.append(f'<text x="{(left + width - right) / 2}" y="{height - 14}" text-anchor="middle">processor time / DIS medium</text>'
                 f'<text transform="translate(18 {(height - bottom + top) / 2}) rotate(-90)" text-anchor="middle">'
                 'mean endpoint error / DIS medium</text>')
    taken = []
    for row in sorted(rows, key=lambda row: row["aee"]):
        family, _, preset = row["name"].partition(":")
        family, label = ("OpenCV", row["name"]) if row["name"].startswith("OpenCV") else (family, preset)
        colour = FAMILIES[family]
        at = [x(row["time"]), y(row["aee"])]
        # Labels to the right of their points, moved down until they meet no other.
        place = [at[0] + 8, at[1] + 4]
        while any(abs(place[1] - other[1]) < 12 and abs(place[0] - other[0]) < 90 for other in taken):
            place[1] += 3
        taken.append(place)
        parts.append(f'<circle cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="4.5" fill="{colour}"/>'
                     f'<text x="{place[0]:.1f}" y="{place[1]:.1f}" fill="{colour}">{label}</text>')
    for i, (family, colour) in enumerate(FAMILIES.items()):
        if any(row["name"].startswith(family) for row in rows):
            parts.append(f'<circle cx="{width - right + 25}" cy="{top + 14 + 18 * i}" r="4.5" fill="{colour}"/>'
                         f'<text x="{width - right + 35}" y="{top + 18 + 18 * i}">{family}</text>')
    return "\n".join(parts) + "\n</svg>\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("--binary", default="target/release/viewsphere")
    parser.add_argument("--runs", help="as `viewsphere eval --run` takes them [default: all presets of all algorithms]")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--svg", type=pathlib.Path)
    parser.add_argument("--json", type=pathlib.Path)
    options = parser.parse_args()
    rows = measure(options)
    table(rows)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")
    if options.svg:
        options.svg.write_text(svg(rows))


if __name__ == "__main__":
    main()
