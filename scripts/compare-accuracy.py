#!/usr/bin/env python3
"""Scores hsad's maps beside OpenCV's best filtered ones, on the same scenes, with one evaluator.

    pip install opencv-contrib-python-headless
    cargo build
    scripts/compare-accuracy.py [--hsad PROGRAM] SCENE... [-- OPTIONS OF hsad eval dense]

SCENE is a folder as those of data/. OpenCV's StereoSGBM runs along three paths (MODE_SGBM_3WAY) with blocks of 5x5
and the penalties of its documentation, on pictures padded by the range so that no margin is lost, and its
weighted-least-squares filter (ximgproc) fills and smooths the map with a search of both views; the filter's defaults
(lambda 8000) blur so much that a far smaller one is taken, the best found on a street scene. It is told the truth's range in whole sixteens;
hsad finds the range by itself.
"""

import pathlib
import subprocess
import sys
import tempfile

import cv2
import numpy as np


def read_pfm(path):
    with open(path, "rb") as file:
        file.readline()
        width, height = map(int, file.readline().split())
        order = "<f4" if float(file.readline()) < 0 else ">f4"
        return np.frombuffer(file.read(), order).reshape(height, width)[::-1]


def write_pfm(path, values):
    with open(path, "wb") as file:
        file.write(f"Pf\n{values.shape[1]} {values.shape[0]}\n-1\n".encode())
        file.write(values[::-1].astype("<f4").tobytes())


def filtered(left, right, disparities, block=5):
    pad = [cv2.copyMakeBorder(view, 0, 0, disparities, 0, cv2.BORDER_REPLICATE) for view in (left, right)]
    matcher = cv2.StereoSGBM_create(
        0, disparities, block, P1=8 * block**2, P2=32 * block**2, preFilterCap=63, mode=cv2.STEREO_SGBM_MODE_SGBM_3WAY
    )
    both = matcher.compute(*pad), cv2.ximgproc.createRightMatcher(matcher).compute(*pad[::-1])
    wls = cv2.ximgproc.createDisparityWLSFilter(matcher)
    wls.setLambda(30)
    wls.setSigmaColor(1.0)
    return wls.filter(both[0], pad[0], disparity_map_right=both[1])[:, disparities:].astype(np.float32) / 16


def main():
    arguments = sys.argv[1:]
    options = arguments[arguments.index("--") + 1 :] if "--" in arguments else []
    scenes = arguments[: arguments.index("--")] if "--" in arguments else arguments
    program = "target/debug/hsad"
    if scenes[:1] == ["--hsad"]:
        program, scenes = scenes[1], scenes[2:]
    if not scenes:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        for scene in map(pathlib.Path, scenes):
            truth = read_pfm(scene / "disp_left.pfm")
            disparities = int(truth[np.isfinite(truth)].max() // 16 + 1) * 16
            views = [cv2.imread(str(scene / name), cv2.IMREAD_GRAYSCALE) for name in ("left.png", "right.png")]
            write_pfm(f"{folder}/{scene.name}.pfm", filtered(*views, disparities))
        given = f"OpenCV 3WAY + WLS={folder}/{{scene}}.pfm"
        sys.exit(subprocess.run([program, "eval", "dense", *scenes, "--disparity", given, *options]).returncode)


if __name__ == "__main__":
    main()
