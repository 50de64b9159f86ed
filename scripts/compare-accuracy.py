#!/usr/bin/env python3
"""Scores the maps of hsad and of OpenCV with its best filter, on the same scenes, by `hsad eval dense`.

    pip install opencv-contrib-python-headless
    cargo build
    scripts/compare-accuracy.py [--hsad PROGRAM] SCENE... [-- OPTIONS OF hsad eval dense]

SCENE is a folder in the layout of data/. OpenCV's StereoSGBM runs along three paths (MODE_SGBM_3WAY) with blocks of
5x5 and the penalties of its documentation, on pictures padded by the disparity range so that no margin is lost. Its
weighted-least-squares filter (ximgproc) fills and smooths the map, with both views matched; the filter's default
lambda of 8000 blurs so much that a far smaller one is used, the best found on a street scene. OpenCV gets the disparity
range of the ground truth, rounded up to a multiple of 16; hsad finds the range by itself.
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
        maps = f"OpenCV 3WAY + WLS={folder}/{{scene}}.pfm"
        sys.exit(subprocess.run([program, "eval", "dense", *scenes, "--disparity", maps, *options]).returncode)


if __name__ == "__main__":
    main()
