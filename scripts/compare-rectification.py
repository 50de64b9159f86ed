#!/usr/bin/env python3
"""Measures how well pairs that are not rectified are matched, by hsad and by OpenCV.

    pip install opencv-python-headless
    cargo build
    scripts/compare-rectification.py [--hsad PROGRAM] [--markdown] SCENE...

SCENE is a folder in the layout of data/. Its right view is turned, scaled or sheared about its centre, or both views get the distortion
of a lens, k1 = -0.2 in units of their mean side; `hsad match --preset balanced --map-back` matches the pair, with the calibration of
that lens in the line 'k1, calibrated', and by its matches alone in all others. A pixel is wrong if it has no disparity, or if its partner
in the undisturbed right view is more than 1 px off the true one, across or along the rows. Pixels count that have a true disparity, are
seen by both views (nonocc.png, if there is one), and are shown by both disturbed views, no closer than 1 px to an edge. Beside it
stands the undisturbed pair, on the same pixels.

OpenCV: SIFT with a ratio of 0.8 and a mutual check, findFundamentalMat (USAC_MAGSAC, 1.5 px), stereoRectifyUncalibrated, pictures
enlarged to hold both warped views whole, StereoSGBM (MODE_HH, blocks of 3x3) over the range that the matches show, a quarter wider on
either side, and the map taken back; stereoRectify with the calibration. A missing value counts as wrong, as for hsad.
"""

import argparse
import json
import os
import pathlib
import subprocess
import tempfile

import cv2
import numpy as np

K1 = -0.2


def read_pfm(path):
    with open(path, "rb") as file:
        file.readline()
        width, height = map(int, file.readline().split())
        order = "<f4" if float(file.readline()) < 0 else ">f4"
        return np.frombuffer(file.read(), order).reshape(height, width)[::-1]


def mapped(homography, points):
    there = np.c_[points, np.ones(len(points))] @ np.asarray(homography).T
    return there[:, :2] / there[:, 2:]


class Lens:
    """A place x from the centre of the picture appears at x (1 + k1 r^2), r in units of `unit`."""

    def __init__(self, size, k1):
        self.centre, self.unit, self.k1 = (np.array(size) - 1) / 2, sum(size) / 2, k1

    def distorted(self, points):
        place = (points - self.centre) / self.unit
        return self.centre + self.unit * place * (1 + self.k1 * (place**2).sum(1, keepdims=True))

    def straight(self, points):
        place = (points - self.centre) / self.unit
        seen = np.linalg.norm(place, axis=1)
        radius = seen.copy()
        for _ in range(20):
            radius -= (radius * (1 + self.k1 * radius**2) - seen) / (1 + 3 * self.k1 * radius**2)
        return self.centre + self.unit * place * (radius / np.maximum(seen, 1e-12))[:, None]


def about_centre(size, linear):
    shift = np.eye(3)
    shift[:2, 2] = (np.array(size) - 1) / 2
    whole = np.eye(3)
    whole[:2, :2] = linear
    return shift @ whole @ np.linalg.inv(shift)


def turned(degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return [[c, -s], [s, c]]


LINEAR = {
    "turned by 5": turned(5),
    "turned by 30": turned(30),
    "turned by 90": turned(90),
    "turned by 180": turned(180),
    "scaled by 0.7": np.eye(2) * 0.7,
    "scaled by 1.5": np.eye(2) * 1.5,
    "sheared": [[1, 0.15], [0, 1]],
}
LENSES = ["k1, calibrated", "k1, from matches"]


class Disturbed:
    """A pair with the places of the true points in it, and the way of a right point back to the undisturbed view."""

    def __init__(self, scene, name):
        size = scene.size
        self.left, self.left_points = scene.left, scene.left_points
        if name in LINEAR:
            change = about_centre(size, LINEAR[name])
            self.right = cv2.warpPerspective(scene.right, change, size, flags=cv2.INTER_CUBIC)
            self.right_points = mapped(change, scene.right_points)
            self.undone = lambda points: mapped(np.linalg.inv(change), points)
        else:
            lens = Lens(size, K1)
            pixels = np.stack(np.meshgrid(np.arange(size[0]), np.arange(size[1])), -1).reshape(-1, 2).astype(float)
            grid = lens.straight(pixels).astype(np.float32).reshape(size[1], size[0], 2)
            self.left, self.right = [cv2.remap(view, grid, None, cv2.INTER_CUBIC) for view in (scene.left, scene.right)]
            self.left_points, self.right_points = map(lens.distorted, (scene.left_points, scene.right_points))
            self.undone = lens.straight
        self.calibrated = name == LENSES[0]
        last = np.array(size) - 1
        inside = lambda points, margin: ((points >= margin) & (points <= last - margin)).all(1)
        # None of the pixels that a bicubic interpolation takes lay outside a disturbed picture.
        self.shown = inside(self.left_points, 0) & inside(self.right_points, 0) & inside(scene.right_points, 1)
        if name in LENSES:
            self.shown &= inside(scene.left_points, 1)


class Scene:
    def __init__(self, folder):
        view = lambda name: cv2.imread(next(iter(sorted(map(str, folder.glob(f"{name}.*"))))))
        self.left, self.right = view("left"), view("right")
        self.size = self.left.shape[1::-1]
        truth = read_pfm(folder / "disp_left.pfm")
        y, x = np.mgrid[: self.size[1], : self.size[0]]
        known = np.isfinite(truth) & (x - truth >= 0)
        mask = cv2.imread(str(folder / "nonocc.png"), cv2.IMREAD_GRAYSCALE)
        if mask is not None:
            known &= mask == 255
        self.truth = truth[known].astype(float)
        self.left_points = np.c_[x[known], y[known]].astype(float)
        self.right_points = self.left_points - np.c_[self.truth, np.zeros(len(self.truth))]


def wrong(found, scene, pair):
    """Whether the points found in the undisturbed right view, NaN for none, are wrong."""
    return ~(np.linalg.norm(found - scene.right_points[pair.shown], axis=1) <= 1)


def run(program, command, left, right, folder, options=()):
    paths = [str(folder / name) for name in ("l.png", "r.png")]
    for path, view in zip(paths, (left, right)):
        cv2.imwrite(path, view)
    environment = {"XDG_RUNTIME_DIR": "/tmp", **os.environ}
    words = [program, command, *paths, "-o", str(folder / "out"), *options]
    done = subprocess.run(words, capture_output=True, text=True, env=environment)
    return None if done.returncode not in (0, 4) else folder / "out"


def row_model(report, size, points):
    """Points of the view as it was matched, from those of the view whose rows were aligned."""
    rows = report["rectification"]["rows"]
    p0, p1, p2, p3, p4 = rows["parameters"] if rows["model"] != "as is" else (0, 1, 0, 0, 0)
    centre = (np.array(size) - 1) / 2
    x, y = (points - centre).T
    return np.c_[points[:, 0], (y * (1 + p3 * x) - p0 * x - p2) / (p1 - p4 * y) + centre[1]]


def by_hsad(program, pair, size, folder):
    """The points of the undisturbed right view that hsad finds; None if it refuses the pair."""
    options = ["--map-back"]
    if pair.calibrated:
        lens = Lens(size, K1)
        camera = dict(size=size, focal=[lens.unit] * 2, centre=list(lens.centre), model="pinhole", distortion=[K1])
        (folder / "rig.json").write_text(json.dumps(dict(left=camera, right=camera, translation=[-0.1, 0, 0], unit="m")))
        options += ["--calib", str(folder / "rig.json")]
    out = run(program, "match", pair.left, pair.right, folder, options)
    if out is None:
        return None
    report, disparities = json.loads((out / "report.json").read_text()), read_pfm(out / "disparity.pfm")
    taken = pair.left_points[pair.shown]
    columns, rows = np.rint(taken).astype(int).T
    disparity = disparities[rows, columns].astype(float)
    shift = np.c_[np.where(np.isfinite(disparity), disparity, np.nan), np.zeros(len(disparity))]
    found = report["rectified"]
    if found is None:
        return pair.undone(row_model(report, size, taken - shift))
    if found["method"] == "calibrated":
        new, lens = found["calibration"], Lens(size, K1)
        focal, centre = new["focal_px"], np.array([new["cx_px"], new["cy_px"]])
        own = np.diag([lens.unit, lens.unit, 1.0])
        own[:2, 2] = lens.centre
        out_of = np.array([[focal, 0, centre[0]], [0, focal, centre[1]], [0, 0, 1]])
        left, right = [out_of @ np.array(found["rotations"][view]) @ np.linalg.inv(own) for view in ("left", "right")]
    else:
        left, right = [np.array(found["homographies"][view]) for view in ("left", "right")]
        lens = Lens(size, found["k1"])
    rectified = mapped(left, lens.straight(taken)) - shift
    rectified = row_model(report, (found["width"], found["height"]), rectified)
    return pair.undone(lens.distorted(mapped(np.linalg.inv(right), rectified)))


def semi_global(left, right, least, most):
    least = int(np.floor(least))
    count = max(16, -(-int(np.ceil(most) - least + 1) // 16) * 16)
    before, after = max(0, least + count), max(0, -least)
    views = [cv2.copyMakeBorder(view, 0, 0, before, after, cv2.BORDER_REPLICATE) for view in (left, right)]
    matcher = cv2.StereoSGBM_create(
        least, count, 3, P1=72, P2=288, disp12MaxDiff=1, uniquenessRatio=5, mode=cv2.STEREO_SGBM_MODE_HH
    )
    found = matcher.compute(*views)[:, before : before + left.shape[1]].astype(float) / 16
    return np.where(found < least, np.nan, found)


def sift_matches(left, right):
    sift = cv2.SIFT_create()
    views = [sift.detectAndCompute(cv2.cvtColor(view, cv2.COLOR_BGR2GRAY), None) for view in (left, right)]
    matcher = cv2.BFMatcher()

    def best(a, b):
        pairs = [pair for pair in matcher.knnMatch(a, b, 2) if len(pair) == 2]
        return {m.queryIdx: m.trainIdx for m, n in pairs if m.distance < 0.8 * n.distance}

    there, back = best(views[0][1], views[1][1]), best(views[1][1], views[0][1])
    both = [(i, j) for i, j in there.items() if back.get(j) == i]
    return [np.array([view[0][pair[side]].pt for pair in both]) for side, view in enumerate(views)]


def by_opencv(pair, size):
    """The same for OpenCV."""
    if pair.calibrated:
        lens = Lens(size, K1)
        own = np.array([[lens.unit, 0, lens.centre[0]], [0, lens.unit, lens.centre[1]], [0, 0, 1]])
        distortion = np.array([K1, 0, 0, 0.0])
        R1, R2, P1, P2, *_ = cv2.stereoRectify(own, distortion, own, distortion, size, np.eye(3), np.array([[-0.1], [0], [0]]), alpha=0)
        maps = [cv2.initUndistortRectifyMap(own, distortion, R, P, size, cv2.CV_32FC1) for R, P in ((R1, P1), (R2, P2))]
        views = [cv2.remap(view, *grid, cv2.INTER_CUBIC) for view, grid in zip((pair.left, pair.right), maps)]
        into = lambda points, R, P: cv2.undistortPoints(points[:, None], own, distortion, R=R, P=P)[:, 0]
        left = into(pair.left_points[pair.shown], R1, P1)
        truth = left[:, 0] - into(pair.right_points[pair.shown], R2, P2)[:, 0]
        back = lambda points: lens.distorted(mapped(own @ R2.T @ np.linalg.inv(P2[:, :3]), points))
        span = np.quantile(truth, [0, 1])
    else:
        points = sift_matches(pair.left, pair.right)
        if len(points[0]) < 8:
            return None
        F, inliers = cv2.findFundamentalMat(*points, cv2.USAC_MAGSAC, 1.5, 0.9999, 10000)
        if F is None:
            return None
        points = [view[inliers[:, 0] != 0] for view in points]
        done, *maps = cv2.stereoRectifyUncalibrated(*points, F, size)
        if not done:
            return None
        corners = np.array([[0, 0], [size[0], 0], [0, size[1]], size], float)
        edges = [mapped(change, corners) for change in maps]
        top = min(view[:, 1].min() for view in edges)
        fitted = [[[1, 0, -view[:, 0].min()], [0, 1, -top], [0, 0, 1]] @ change for view, change in zip(edges, maps)]
        edges = [mapped(change, corners) for change in fitted]
        canvas = np.ceil(np.max([view.max(0) for view in edges], 0)).astype(int)
        if (canvas > 4 * max(size)).any():
            return None
        views = [cv2.warpPerspective(view, change, canvas, flags=cv2.INTER_CUBIC) for view, change in zip((pair.left, pair.right), fitted)]
        span = np.quantile(mapped(fitted[0], points[0])[:, 0] - mapped(fitted[1], points[1])[:, 0], [0.01, 0.99])
        left = mapped(fitted[0], pair.left_points[pair.shown])
        back = lambda points: mapped(np.linalg.inv(fitted[1]), points)
    margin = (span[1] - span[0]) / 4 + 4
    disparity = semi_global(*views, span[0] - margin, span[1] + margin)
    columns, rows = np.rint(left).astype(int).T
    inside = (columns >= 0) & (columns < disparity.shape[1]) & (rows >= 0) & (rows < disparity.shape[0])
    found = np.full(len(left), np.nan)
    found[inside] = disparity[rows[inside], columns[inside]]
    return pair.undone(back(left - np.c_[found, np.zeros(len(found))]))


def of_undisturbed(disparities, scene):
    """The right points by a map of the undisturbed pair."""
    columns, rows = scene.left_points.astype(int).T
    found = disparities[rows, columns].astype(float)
    return scene.left_points - np.c_[np.where(np.isfinite(found), found, np.nan), np.zeros(len(found))]


def compare_scenes(program, scenes, markdown):
    kinds = [*LINEAR, *LENSES]
    # Per kind and scene: hsad, hsad undisturbed, OpenCV, OpenCV undisturbed, in per cent.
    results = {kind: [] for kind in kinds}
    for path in map(pathlib.Path, scenes):
        scene = Scene(path)
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            out = run(program, "match", scene.left, scene.right, folder)
            plain = of_undisturbed(read_pfm(out / "disparity.pfm"), scene)
            peer = of_undisturbed(semi_global(scene.left, scene.right, scene.truth.min() - 4, scene.truth.max() + 4), scene)
            for kind in kinds:
                pair = Disturbed(scene, kind)
                found = by_hsad(program, pair, scene.size, folder), by_opencv(pair, scene.size)
                places = found[0], plain[pair.shown], found[1], peer[pair.shown]
                row = [100.0 if place is None else 100 * wrong(place, scene, pair).mean() for place in places]
                results[kind].append(row)
                print("{:22} {:18} hsad {:6.2f} undisturbed {:6.2f}  OpenCV {:6.2f} undisturbed {:6.2f}".format(path.name, kind, *row), flush=True)
    start, separator, end = ("| ", " | ", " |") if markdown else ("", "  ", "")
    line = lambda name, cells: print(start + separator.join([name, *cells]) + end)
    line("right view" if markdown else f"{'right view':18}", ["hsad", "undisturbed", "more", "at most", "OpenCV", "undisturbed", "more"])
    if markdown:
        print("|---" * 8 + "|")
    for name, rows in [*results.items(), ("all", sum(results.values(), []))]:
        rows = np.array(rows)
        more = rows[:, 0] - rows[:, 1]
        figures = [*rows[:, :2].mean(0), more.mean(), more.max(), *rows[:, 2:].mean(0), (rows[:, 2] - rows[:, 3]).mean()]
        line(name if markdown else f"{name:18}", [f"{figure:.2f}" for figure in figures])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="+", metavar="SCENE")
    parser.add_argument("--hsad", default="target/debug/hsad", metavar="PROGRAM")
    parser.add_argument("--markdown", action="store_true", help="print the table for a page")
    arguments = parser.parse_args()
    compare_scenes(arguments.hsad, arguments.scenes, arguments.markdown)


if __name__ == "__main__":
    main()
