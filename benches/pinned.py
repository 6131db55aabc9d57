"""Runs the calling script with the pinned OpenCV and numpy, in benches/.venv if necessary."""

import os
import pathlib
import subprocess
import sys
import venv

OPENCV, OPENCV_WHEEL, NUMPY = "4.13.0", "4.13.0.92", "2.4.6"
HERE = pathlib.Path(__file__).resolve().parent


def _importable():
    try:
        import cv2
        import numpy
    except ImportError:
        return False
    return cv2.__version__ == OPENCV and numpy.__version__ == NUMPY


def ensure():
    """Returns if cv2 and numpy can be imported in the pinned versions. Otherwise creates the virtual
    environment if it is missing, and restarts the command inside it."""
    if _importable():
        return
    home = HERE / ".venv"
    python = home / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    if os.environ.get("VIEWSPHERE_BENCH_VENV") == str(home):
        sys.exit(f"{home} lacks opencv {OPENCV} or numpy {NUMPY}: delete it and run this again")
    wanted = [f"opencv-python-headless=={OPENCV_WHEEL}", f"numpy=={NUMPY}"]
    ready = home / "ready"
    if not ready.exists() or ready.read_text().split() != wanted:
        print(f"making {home} with {', '.join(wanted)}", file=sys.stderr)
        venv.create(home, with_pip=True, clear=True)
        subprocess.run([python, "-m", "pip", "install", "--quiet",
                        "--disable-pip-version-check", *wanted], check=True)
        ready.write_text("\n".join(wanted) + "\n")
    arguments = [str(python), str(pathlib.Path(sys.argv[0]).resolve()), *sys.argv[1:]]
    environment = {**os.environ, "VIEWSPHERE_BENCH_VENV": str(home)}
    if os.name == "nt":
        sys.exit(subprocess.run(arguments, env=environment).returncode)
    sys.stdout.flush()
    os.execve(python, arguments, environment)
