#!/usr/bin/env python3
"""Measures how well pairs of a chessboard are rectified by their calibration, by hsad and by OpenCV.

    pip install opencv-python-headless
    cargo build
    scripts/compare-chessboards.py [--hsad PROGRAM] FOLDER

FOLDER has left*.jpg and right*.jpg of a board with 9x6 inner corners and squares of 25 mm, such as those of Debian's opencv-doc. OpenCV
calibrates the cameras from the pairs that show the board in both views. Both programs rectify each of these pairs by that, and the
corners are found anew in the rectified pictures: how far their rows differ, and how flat and square the board is that they show.
"""

import argparse
import glob
import json
import os
import pathlib
import subprocess
import tempfile

import cv2
import numpy as np

BOARD, SQUARE = (9, 6), 0.025


def corners(view):
    found, places = cv2.findChessboardCornersSB(view, BOARD)
    return places.reshape(-1, 2) if found else None


def calibrate(folder, out):
    grid = np.float32([(x, y, 0) for y in range(BOARD[1]) for x in range(BOARD[0])]) * SQUARE
    files = [sorted(glob.glob(f"{folder}/{view}*.jpg")) for view in ("left", "right")]
    pairs = [pair for pair in zip(*files) if all(corners(cv2.imread(path, 0)) is not None for path in pair)]
    places = [[corners(cv2.imread(pair[view], 0))[:, None] for pair in pairs] for view in (0, 1)]
    points, size = [grid] * len(pairs), cv2.imread(pairs[0][0], 0).shape[::-1]
    (_, M1, D1, *_), (_, M2, D2, *_) = [cv2.calibrateCamera(points, view, size, None, None) for view in places]
    rms, M1, D1, M2, D2, R, T, *_ = cv2.stereoCalibrate(
        points, *places, M1, D1, M2, D2, size, flags=cv2.CALIB_USE_INTRINSIC_GUESS
    )
    file = cv2.FileStorage(str(out), cv2.FILE_STORAGE_WRITE)
    for name, value in dict(M1=M1, D1=D1, M2=M2, D2=D2, R=R, T=T, image_width=size[0], image_height=size[1]).items():
        file.write(name, value)
    file.release()
    print(f"{len(pairs)} of {len(files[0])} pairs with the board in both views, calibrated to {rms:.2f} px")
    return pairs, size, (M1, D1, M2, D2, R, T)


def judged(name, views, Q):
    """Row errors of the corners; flatness of the board, and sides of its squares, in millimetres."""
    rows, flat, sides = [], [], []
    for left, right in views:
        left, right = corners(left), corners(right)
        if left is None or right is None:
            continue
        rows.append(np.abs(left[:, 1] - right[:, 1]))
        there = np.c_[left, left[:, 0] - right[:, 0], np.ones(len(left))] @ np.array(Q).T
        board = 1000 * there[:, :3] / there[:, 3:]
        flat.append(np.abs((board - board.mean(0)) @ np.linalg.svd(board - board.mean(0))[2][2]))
        board = board.reshape(BOARD[1], BOARD[0], 3)
        sides += [np.linalg.norm(np.diff(board, axis=axis), axis=2).ravel() for axis in (0, 1)]
    rows, flat, sides = map(np.concatenate, (rows, flat, sides))
    print(
        f"{name}: {len(rows)} corners, rows differ by {rows.mean():.3f} px in the mean, 95 % by {np.quantile(rows, 0.95):.2f} px; "
        f"board flat to {flat.mean():.2f} mm in the mean; squares of {sides.mean():.2f} mm, deviation {sides.std():.2f} mm"
    )


def rectified(program, left, right, folder):
    paths = [str(folder / name) for name in ("l.png", "r.png")]
    for path, view in zip(paths, (left, right)):
        cv2.imwrite(path, view)
    words = [program, "rectify", *paths, "-o", str(folder / "out"), "--calib", str(folder / "rig.yml")]
    subprocess.run(words, capture_output=True, check=True, env={"XDG_RUNTIME_DIR": "/tmp", **os.environ})
    return folder / "out"


def compare(program, boards):
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        pairs, size, (M1, D1, M2, D2, R, T) = calibrate(boards, folder / "rig.yml")
        R1, R2, P1, P2, Q, *_ = cv2.stereoRectify(M1, D1, M2, D2, size, R, T)
        maps = [cv2.initUndistortRectifyMap(*one, size, cv2.CV_32FC1) for one in ((M1, D1, R1, P1), (M2, D2, R2, P2))]
        taken = [[cv2.imread(path, 0) for path in pair] for pair in pairs]
        theirs = [[cv2.remap(view, *grid, cv2.INTER_CUBIC) for view, grid in zip(pair, maps)] for pair in taken]
        ours = []
        for left, right in taken:
            out = rectified(program, left, right, folder)
            ours.append([cv2.imread(str(out / f"{view}.png"), 0) for view in ("left", "right")])
        judged("hsad", ours, json.loads((out / "rectification.json").read_text())["Q"])
        judged("OpenCV", theirs, Q)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", metavar="FOLDER")
    parser.add_argument("--hsad", default="target/debug/hsad", metavar="PROGRAM")
    arguments = parser.parse_args()
    compare(arguments.hsad, arguments.folder)


if __name__ == "__main__":
    main()
