#!/usr/bin/env python3
"""Times hsad and OpenCV in turn on the same pair: block matching against StereoBM, presets against StereoSGBM.

    pip install opencv-python-headless
    cargo build --release --benches
    scripts/compare-opencv.py LEFT RIGHT [--size 768x512] [--disparities 64] [--rounds 5]

StereoBM runs with a window of 7, two threads, and its texture, uniqueness (15 %) and left-right checks;
hsad with a window of 7, uniqueness (15 %), left-right check and sub-pixel interpolation. StereoSGBM runs along
eight paths (MODE_HH, block size 3, two threads), against the presets balanced and quality. Each time is the
minimum of several runs in a round; machines drift, so only the ratio within a round counts.
"""

import argparse
import glob
import os
import re
import statistics
import subprocess
import tempfile
import time

import cv2


def milliseconds(matcher, left, right, runs):
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        matcher.compute(left, right)
        times.append(1e3 * (time.perf_counter() - start))
    return min(times)


def opencv(left, right, disparities):
    block_matcher = cv2.StereoBM_create(disparities, 7)
    block_matcher.setDisp12MaxDiff(1)
    semi_global = cv2.StereoSGBM_create(
        0, disparities, 3, P1=72, P2=288, disp12MaxDiff=1, uniquenessRatio=5, mode=cv2.STEREO_SGBM_MODE_HH
    )
    return {
        "StereoBM": milliseconds(block_matcher, left, right, 20),
        "SGBM-HH": milliseconds(semi_global, left, right, 3),
    }


def hsad(binary, paths, disparities):
    environment = {"XDG_RUNTIME_DIR": "/tmp", **os.environ}
    run = subprocess.run([binary, *paths, str(disparities)], capture_output=True, text=True, check=True, env=environment)
    times = re.findall(r"dense (\w+): .* minimum ([\d.]+) ms", run.stdout)
    return {name: float(time) for name, time in times}, run.stdout


PAIRS = [("7x7", "StereoBM"), ("fast", "StereoBM"), ("balanced", "SGBM-HH"), ("quality", "SGBM-HH")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("left")
    parser.add_argument("right")
    parser.add_argument("--size", default="768x512")
    parser.add_argument("--disparities", type=int, default=64)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--binary", help="path of the built benchmark [default: the newest in target/release/deps]")
    arguments = parser.parse_args()

    binary = arguments.binary
    if not binary:
        built = [path for path in glob.glob("target/release/deps/speed-*") if "." not in os.path.basename(path)]
        if not built:
            parser.error("the benchmark is not built: cargo build --release --benches")
        binary = max(built, key=os.path.getmtime)
    size = tuple(int(side) for side in arguments.size.split("x"))
    cv2.setNumThreads(2)
    with tempfile.TemporaryDirectory() as folder:
        views, paths = [], []
        for name in ("left", "right"):
            view = cv2.imread(getattr(arguments, name), cv2.IMREAD_GRAYSCALE)
            if view is None:
                parser.error(f"{getattr(arguments, name)} is not a picture")
            views.append(cv2.resize(view, size, interpolation=cv2.INTER_AREA))
            paths.append(os.path.join(folder, name + ".png"))
            cv2.imwrite(paths[-1], views[-1])
        work = size[0] * size[1] * arguments.disparities / 1e3
        ratios = {pair: [] for pair in PAIRS}
        for _ in range(arguments.rounds):
            theirs = opencv(*views, arguments.disparities)
            ours, output = hsad(binary, paths, arguments.disparities)
            for preset, peer in PAIRS:
                ratios[preset, peer].append(theirs[peer] / ours[preset])
            both = [*theirs.items(), *ours.items()]
            print(", ".join(f"{name} {ms:.1f} ms ({work / ms:.0f} Mpd/s)" for name, ms in both))
        print(output.splitlines()[0])
        for (preset, peer), values in ratios.items():
            print(f"{preset}: {statistics.median(values):.2f} of the speed of {peer}, median of {arguments.rounds} rounds")


if __name__ == "__main__":
    main()
