#!/usr/bin/env python3
"""hsad.cv beside OpenCV: the same calls on pairs with a truth, scored and timed.

    pip install ./python opencv-python-headless
    scripts/compare-cv.py FOLDER... [--mode sgbm|3way|hh4|hh|bm] [--block 3]

A FOLDER holds left.png, right.png, disp_left.pfm and nonocc.png, as those of data/. A pixel with a truth is wrong if it has no disparity
or one that is off by over 2 px. Times are the least of several runs on this machine.
"""

import argparse
import time
import warnings
from pathlib import Path

import cv2
import numpy as np

import hsad
import hsad.cv

MODES = {"sgbm": 0, "hh": 1, "3way": 2, "hh4": 3}


def computed(module, views, disparities, mode, block):
    """The map in pixels, NaN for none, and milliseconds."""
    if mode == "bm":
        matcher = module.StereoBM_create(disparities, block)
        views = [cv2.cvtColor(view, cv2.COLOR_BGR2GRAY) for view in views]
    else:
        penalty = 3 * block**2
        matcher = module.StereoSGBM_create(
            numDisparities=disparities, blockSize=block, P1=8 * penalty, P2=32 * penalty, disp12MaxDiff=1,
            uniquenessRatio=5, speckleWindowSize=100, speckleRange=2, mode=MODES[mode],
        )
    times = []
    for _ in range(6):
        start = time.perf_counter()
        found = matcher.compute(*views)
        times.append(1000 * (time.perf_counter() - start))
    # The first run compiles the kernels.
    return np.where(found >= 0, found / np.float32(16), np.float32(np.nan)), min(times[1:])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--mode", default="sgbm", choices=[*MODES, "bm"])
    parser.add_argument("--block", type=int, default=3)
    given = parser.parse_args()
    warnings.filterwarnings("ignore", message=".* means nothing to hsad")
    print(f"{hsad.devices()[0]}, OpenCV {cv2.__version__} with {cv2.getNumThreads()} threads, {given.mode}, blocks of {given.block}")
    print(f"{'scene':24} {'matcher':8} {'non-occluded':>12} {'all':>7} {'estimated':>10} {'density':>8} {'ms':>7}")
    means = {}
    for folder in given.folders:
        views = [cv2.imread(str(folder / f"{side}.png")) for side in ("left", "right")]
        truth, seen = hsad.read_disparity(folder / "disp_left.pfm"), hsad.read_image(folder / "nonocc.png")[..., 0] == 255
        disparities = int(np.nanmax(truth) + 16) // 16 * 16
        for name, module in (("OpenCV", cv2), ("hsad", hsad.cv)):
            found, milliseconds = computed(module, views, disparities, given.mode, given.block)
            whole, shown = hsad.evaluate(found, truth), hsad.evaluate(found, truth, seen)
            shares = [shown["bad"][2]["of_all"], whole["bad"][2]["of_all"], whole["bad"][2]["of_estimated"], whole["density"]]
            means.setdefault(name, []).append([*(100 * share for share in shares), milliseconds])
            row(folder.name, name, means[name][-1])
    for name, rows in means.items():
        row("mean", name, np.mean(rows, axis=0))


def row(scene, name, figures):
    seen, whole, estimated, density, milliseconds = figures
    print(f"{scene:24} {name:8} {seen:10.1f} % {whole:5.1f} % {estimated:8.1f} % {density:6.1f} % {milliseconds:7.1f}")


if __name__ == "__main__":
    main()
