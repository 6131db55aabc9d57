#!/usr/bin/env python3
"""Times viewsphere and OpenCV in alternation, and compares their flow fields.

    python benches/opencv.py                              # 640x480, synthetic scene
    python benches/opencv.py --sizes 320x240,1280x720 --rounds 30 --json figures.json
    python benches/opencv.py --images a.png b.png

viewsphere runs in one long-lived process, `viewsphere bench --serve`, which times itself and keeps
its device and engines between requests; OpenCV runs in this process. A round runs each contender
once. The starting contender changes from round to round, and ratios are taken within a round, so
that a machine that slows down or speeds up affects both alike. Two warm-up rounds go first; the
fields are compared in the first of them. "stream" is viewsphere on a video: the second image's
data are reused for the next pair.

Ends with 1 if a field differs from OpenCV's by more than 1e-4 px on average or more than 1e-2 px at
the 99.9th percentile, with 2 if viewsphere fails otherwise (a missing GPU is a failure only with --need-gpu).

The protocol, one JSON object per line on the server's stdin and stdout:
    {"a": path, "b": path, "backend": "gpu"|"cpu", "params": {"pyr_scale", "levels", "winsize",
     "iterations", "poly_n", "poly_sigma", "window": "box"|"gaussian"}, "repeat": n,
     "stream": bool, "flow": path or null}
    {"wall_ms": [n numbers], "adapter": text or null, "error": text or null}
"""

import argparse
import json
import os
import pathlib
import platform
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(ROOT / "benches"), str(ROOT / "tests/golden")]
import pinned  # noqa: E402

pinned.ensure()
import cv2  # noqa: E402
import numpy as np  # noqa: E402

import scene  # noqa: E402

NAMES = ("pyr_scale", "levels", "winsize", "iterations", "poly_n", "poly_sigma", "window")
SETTINGS = {name: dict(zip(NAMES, values)) for name, values in {
    "light": (0.5, 3, 15, 3, 5, 1.2, "box"),
    "heavy": (0.5, 5, 13, 10, 5, 1.1, "box"),
    "heavy-gauss": (0.5, 5, 13, 10, 5, 1.1, "gaussian"),
}.items()}
# name: (backend, stream)
OURS = {"gpu": ("gpu", False), "cpu": ("cpu", False),
        "gpu stream": ("gpu", True), "cpu stream": ("cpu", True)}
WARM_UP = 2
MEAN_BOUND, P999_BOUND = 1e-4, 1e-2


class Server:
    """The server process and its requests."""

    def __init__(self, command):
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        text=True, bufsize=1, encoding="utf-8")

    def ask(self, **request):
        try:
            self.process.stdin.write(json.dumps(request) + "\n")
            self.process.stdin.flush()
            line = self.process.stdout.readline()
        except BrokenPipeError:
            line = ""
        if not line:
            sys.stderr.write(f"the server has ended with {self.process.wait()}\n")
            sys.exit(2)
        try:
            return json.loads(line)
        except ValueError:
            sys.stderr.write(f"not an answer: {line}")
            sys.exit(2)

    def close(self):
        self.process.stdin.close()
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.kill()


def opencv(first, second, params):
    """OpenCV's flow field, and its time in milliseconds."""
    flags = cv2.OPTFLOW_FARNEBACK_GAUSSIAN if params["window"] == "gaussian" else 0
    numbers = [params[name] for name in NAMES[:-1]]
    start = time.perf_counter()
    flow = cv2.calcOpticalFlowFarneback(first, second, None, *numbers, flags)
    return flow, (time.perf_counter() - start) * 1e3


def difference(ours, theirs):
    """Mean, 99.9th percentile and maximum of the distance between the vectors, in pixels."""
    if ours.shape != theirs.shape:
        return {"mean": float("inf"), "p99.9": float("inf"), "max": float("inf")}
    d = np.hypot(*np.moveaxis(ours.astype(np.float64) - theirs, 2, 0))
    d = np.where(np.isfinite(d), d, np.inf)
    return {"mean": float(d.mean()), "p99.9": float(np.partition(d.ravel(), k := int(np.ceil(
        0.999 * d.size)) - 1)[k]), "max": float(d.max())}


def measure(server, name, params, first, second, folder, options):
    """Measures all contenders with one setting and one size."""
    height, width = first.shape
    paths = [str(folder / f"{width}x{height}_{k}.png") for k in (0, 1)]
    for path, image in zip(paths, (first, second)):
        if not cv2.imwrite(path, image):
            sys.exit(f"cannot write {path}")
    contenders = ["opencv", *options.ours]
    times = {c: [] for c in contenders}
    adapters, errors, differences = {}, {}, {}
    theirs = None
    for round_ in range(WARM_UP + options.rounds):
        turn = round_ % len(contenders)
        order = contenders if round_ == 0 else contenders[turn:] + contenders[:turn]
        for c in order:
            if c in errors:
                continue
            if c == "opencv":
                flow, ms = opencv(first, second, params)
                theirs = flow if theirs is None else theirs
            else:
                backend, stream = OURS[c]
                flow_path = folder / "ours.flo"
                answer = server.ask(a=paths[0], b=paths[1], backend=backend, params=params,
                                    repeat=1, stream=stream,
                                    flow=str(flow_path) if round_ == 0 else None)
                if answer.get("error"):
                    errors[c] = answer["error"]
                    continue
                adapters[c] = answer.get("adapter")
                ms = answer["wall_ms"][0]
                if round_ == 0:
                    differences[c] = difference(scene.read_flo(flow_path), theirs)
                    flow_path.unlink()
            if round_ >= WARM_UP:
                times[c].append(ms)
            time.sleep(options.pause_ms / 1e3)
    result = {"setting": name, "size": f"{width}x{height}", "params": params, "ms": times,
              "adapters": adapters, "errors": errors, "difference": differences}
    result["median_ms"] = {c: float(np.median(t)) for c, t in times.items() if t}
    result["ratio"] = {}
    for c in options.ours:
        if c not in errors:
            ratios = np.array(times["opencv"]) / np.array(times[c])
            result["ratio"][c] = {"median": float(np.median(ratios)), "min": float(ratios.min()),
                                  "max": float(ratios.max())}
    return result


def cpu_name():
    try:
        for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def surroundings(binary):
    """The versions and the machine on which the figures depend."""
    version = subprocess.run([*binary, "--version"], capture_output=True, text=True, check=False)
    git = subprocess.run(["git", "-C", str(ROOT), "describe", "--always", "--dirty"],
                         capture_output=True, text=True, check=False)
    return {
        "viewsphere": version.stdout.strip(), "commit": git.stdout.strip(),
        "opencv": cv2.__version__, "opencv_threads": cv2.getNumThreads(),
        "numpy": np.__version__, "python": platform.python_version(),
        "system": platform.platform(), "cpu": cpu_name(), "cpus": os.cpu_count(),
        "load_before": list(os.getloadavg()) if hasattr(os, "getloadavg") else None,
    }


def parse():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", help="the program (default: target/release/viewsphere, built if missing)")
    parser.add_argument("--sizes", default="640x480", help="comma-separated, such as 320x240")
    parser.add_argument("--images", nargs=2, metavar=("A", "B"), help="two images in place of the synthetic scene")
    parser.add_argument("--settings", default=",".join(SETTINGS), help="comma-separated; default: all")
    parser.add_argument("--ours", default=",".join(OURS),
                        help="some of: " + ", ".join(OURS) + " (comma-separated)")
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--pause-ms", type=float, default=5.0,
                        help="sleep after each run, so that its threads settle")
    parser.add_argument("--opencv-threads", type=int, help="default: OpenCV's own choice")
    parser.add_argument("--need-gpu", action="store_true", help="fail if there is no GPU")
    parser.add_argument("--json", type=pathlib.Path, help="write the figures to this file")
    options = parser.parse_args()
    options.ours = [c.strip() for c in options.ours.split(",")]
    options.settings = [s.strip() for s in options.settings.split(",")]
    if unknown := set(options.ours) - set(OURS) | set(options.settings) - set(SETTINGS):
        parser.error(f"unknown: {', '.join(sorted(unknown))}")
    if options.rounds < 1:
        parser.error("at least one round")
    try:
        options.sizes = [tuple(map(int, s.split("x"))) for s in options.sizes.split(",")]
        if any(len(s) != 2 or min(s) < 1 for s in options.sizes):
            raise ValueError
    except ValueError:
        parser.error("sizes are like 640x480,1280x720")
    return options


def load(paths):
    images = [cv2.imread(p, cv2.IMREAD_GRAYSCALE) for p in paths]
    for path, image in zip(paths, images):
        if image is None:
            sys.exit(f"cannot read {path}")
    if images[0].shape != images[1].shape:
        sys.exit("the images differ in size")
    return images


def find_binary(given):
    if given:
        return [given]
    binary = ROOT / "target/release" / ("viewsphere.exe" if os.name == "nt" else "viewsphere")
    if not binary.exists():
        subprocess.run(["cargo", "build", "--release"], cwd=ROOT, check=True)
    return [str(binary)]


def show(result):
    """Prints the rows of one setting and size; returns the resulting exit code."""
    code = 0
    head = f"{result['setting']:12}{result['size']:>10}{result['median_ms']['opencv']:>10.2f}"
    for c, error in result["errors"].items():
        print(f"{head}  {c:10}  {error}")
    for c, ratio in result["ratio"].items():
        d = result["difference"][c]
        bad = not (d["mean"] <= MEAN_BOUND and d["p99.9"] <= P999_BOUND)
        code = max(code, int(bad))
        print(f"{head}  {c:10}{result['median_ms'][c]:>9.2f}{ratio['median']:>9.2f}x"
              f"{ratio['min']:>8.2f} ..{ratio['max']:>7.2f}"
              f"{d['mean']:>11.1e}{d['p99.9']:>10.1e}{d['max']:>10.1e}"
              + ("  DIFFERS" if bad else ""))
    return code


def main():
    options = parse()
    cv2.ocl.setUseOpenCL(False)
    if options.opencv_threads is not None:
        cv2.setNumThreads(options.opencv_threads)
    binary = find_binary(options.binary)
    if options.images:
        inputs = [load(options.images)]
    else:
        inputs = [scene.pair(*size) for size in options.sizes]
    report = {"surroundings": surroundings(binary), "rounds": options.rounds, "results": []}
    for key, value in report["surroundings"].items():
        print(f"{key}: {value}")
    print(f"\n{'setting':12}{'size':>10}{'OpenCV ms':>10}  {'ours':10}{'ms':>9}{'ratio':>10}"
          f"{'min .. max':>18}{'mean px':>11}{'p99.9':>10}{'max':>10}", flush=True)
    code = 0
    server = Server([*binary, "bench", "--serve"])
    try:
        with tempfile.TemporaryDirectory() as folder:
            for first, second in inputs:
                for name in options.settings:
                    result = measure(server, name, SETTINGS[name], first, second,
                                     pathlib.Path(folder), options)
                    report["results"].append(result)
                    code = max(code, show(result))
                    if any(OURS[c][0] == "cpu" or options.need_gpu for c in result["errors"]):
                        code = 2
                    sys.stdout.flush()
    finally:
        server.close()
        if options.json:
            options.json.write_text(json.dumps(report, indent=1) + "\n")
    adapters = {a for r in report["results"] for a in r["adapters"].values() if a}
    print("adapters: " + (", ".join(sorted(adapters)) or "none"))
    sys.exit(code)


if __name__ == "__main__":
    main()
