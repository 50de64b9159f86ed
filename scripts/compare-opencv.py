#!/usr/bin/env python3
"""Times hsad's block matching beside OpenCV's StereoBM, in turn, on the same pair.

    pip install opencv-python-headless
    cargo build --release --benches
    scripts/compare-opencv.py LEFT RIGHT [--size 768x512] [--disparities 64] [--rounds 5]

StereoBM runs with its window of 7 and two threads, with its texture, uniqueness (15 %) and
left-right checks; hsad with a window of 7, uniqueness (15 %), left-right check and sub-pixel. Both
are given as the minimum of 20 runs in a round; machines drift, so only the ratio of a round counts.
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


def stereo_bm(left, right, disparities):
    matcher = cv2.StereoBM_create(disparities, 7)
    matcher.setDisp12MaxDiff(1)
    times = []
    for _ in range(20):
        start = time.perf_counter()
        matcher.compute(left, right)
        times.append(1e3 * (time.perf_counter() - start))
    return min(times)


def hsad(binary, paths, disparities):
    environment = {"XDG_RUNTIME_DIR": "/tmp", **os.environ}
    run = subprocess.run([binary, *paths, str(disparities)], capture_output=True, text=True, check=True, env=environment)
    return float(re.search(r"dense 7x7: .* minimum ([\d.]+) ms", run.stdout)[1]), run.stdout


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("left")
    parser.add_argument("right")
    parser.add_argument("--size", default="768x512")
    parser.add_argument("--disparities", type=int, default=64)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--binary", help="the built bench, by default the newest in target/release/deps")
    arguments = parser.parse_args()

    binary = arguments.binary
    if not binary:
        built = [path for path in glob.glob("target/release/deps/speed-*") if "." not in os.path.basename(path)]
        if not built:
            parser.error("no bench is built: cargo build --release --benches")
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
        ratios = []
        for _ in range(arguments.rounds):
            peer = stereo_bm(*views, arguments.disparities)
            ours, output = hsad(binary, paths, arguments.disparities)
            ratios.append(peer / ours)
            print(
                f"StereoBM {peer:.1f} ms ({work / peer:.0f} Mpd/s), hsad {ours:.1f} ms ({work / ours:.0f} Mpd/s), "
                f"speed ratio {ratios[-1]:.2f}"
            )
        print(output.splitlines()[0])
        print(f"median ratio {statistics.median(ratios):.2f} of {arguments.rounds} rounds")


if __name__ == "__main__":
    main()
