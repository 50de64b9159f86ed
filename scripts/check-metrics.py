#!/usr/bin/env python3
"""Compares the figures of `hsad eval dense` with those computed by numpy, on real scenes.

    check-metrics.py [--hsad PROGRAM] [--tolerance 1e-6] FOLDER...

FOLDER holds scenes in the layout of data/. The scenes are scored in the three layouts that the program reads: as they
are, as Middlebury 2014, and as KITTI. Each is scored with the program's own map and with maps made here from the ground
truth: perfect, empty, and noisy with holes. Needs numpy, and OpenCV or Pillow for pictures.
"""

import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np

try:
    import cv2

    def read_picture(path):
        return cv2.imread(str(path), cv2.IMREAD_UNCHANGED)

    def write_picture(path, values):
        cv2.imwrite(str(path), values)

except ImportError:
    from PIL import Image

    def read_picture(path):
        return np.array(Image.open(path))

    def write_picture(path, values):
        Image.fromarray(values).save(path)


def read_pfm(path):
    """The values of a PFM in pixels, +inf for unknown, the top row first."""
    with open(path, "rb") as file:
        assert file.readline().strip() == b"Pf", path
        width, height = map(int, file.readline().split())
        order = "<f4" if float(file.readline()) < 0 else ">f4"
        return np.flipud(np.frombuffer(file.read(), order).reshape(height, width)).astype(np.float64)


def write_pfm(path, values):
    height, width = values.shape
    with open(path, "wb") as file:
        file.write(b"Pf\n%d %d\n-1\n" % (width, height))
        file.write(np.flipud(values).astype("<f4").tobytes())


def read_kitti(path):
    values = read_picture(path).astype(np.float64)
    return np.where(values == 0, np.inf, values / 256)


def write_kitti(path, values):
    known = np.isfinite(values)
    fixed = np.clip(np.round(np.where(known, values, 0) * 256), 1, 65535)
    write_picture(path, np.where(known, fixed, 0).astype(np.uint16))


def figures(found, truth, scored):
    """All figures of one region, computed from their definitions."""
    known = scored & np.isfinite(truth)
    estimated = known & np.isfinite(found)
    error = np.abs(found[estimated] - truth[estimated])
    missing, pixels = known.sum() - estimated.sum(), known.sum()

    def shares(wrong):
        with np.errstate(invalid="ignore"):
            return (wrong.sum() + missing) / pixels, np.float64(wrong.sum()) / estimated.sum()

    result = {"pixels": pixels, "estimated": estimated.sum(), "density": estimated.sum() / pixels}
    for threshold in (0.5, 1.0, 2.0, 4.0):
        result[f"bad {threshold} of_all"], result[f"bad {threshold} of_estimated"] = shares(error > threshold)
    outlier = (error > 3) & (error > 0.05 * np.abs(truth[estimated]))
    result["d1 of_all"], result["d1 of_estimated"] = shares(outlier)
    if error.size:
        result["average_error_px"] = error.mean()
        result["rms_error_px"] = np.sqrt((error**2).mean())
        values, counts = np.unique(error, return_counts=True)
        for percent in (50, 90, 99):
            enough = 100 * np.cumsum(counts) >= percent * error.size
            result[f"a{percent}_px"] = values[np.argmax(enough)]
    return result


def reported(region):
    """The program's figures under the same names, without undefined ones."""
    result = {key: value for key, value in region.items() if key not in ("bad", "d1")}
    for bad in region["bad"]:
        for of in ("of_all", "of_estimated"):
            result[f"bad {bad['above_px']} {of}"] = bad[of]
    result |= {f"d1 {of}": value for of, value in region["d1"].items()}
    return {key: value for key, value in result.items() if value is not None}


class Scene:
    """Argument and name of a scene, its ground truth, and its non-occluded pixels (None: unknown)."""

    def __init__(self, argument, name, truth, visible):
        self.argument, self.name, self.truth, self.visible = argument, name, truth, visible


def as_they_are(folders):
    for folder in folders:
        mask = folder / "nonocc.png"
        visible = read_picture(mask) == 255 if mask.exists() else None
        yield Scene(folder, folder.name, read_pfm(folder / "disp_left.pfm"), visible)


def as_middlebury(folders, root):
    for folder in folders:
        there = root / folder.name
        there.mkdir(parents=True)
        copies = [("left.png", "im0.png"), ("right.png", "im1.png"), ("disp_left.pfm", "disp0GT.pfm")]
        for name, new in copies + ([("nonocc.png", "mask0nocc.png")] if (folder / "nonocc.png").exists() else []):
            shutil.copyfile(folder / name, there / new)
        visible = read_picture(there / "mask0nocc.png") == 255 if (there / "mask0nocc.png").exists() else None
        yield Scene(there, folder.name, read_pfm(there / "disp0GT.pfm"), visible)


def as_kitti(folders, root):
    kinds = ("image_2", "image_3", "disp_occ_0", "disp_noc_0")
    for kind in kinds:
        (root / kind).mkdir(parents=True)
    for number, folder in enumerate(folders):
        name = f"{number:06}_10"
        left, right, occluded, visible = (root / kind / f"{name}.png" for kind in kinds)
        shutil.copyfile(folder / "left.png", left)
        shutil.copyfile(folder / "right.png", right)
        truth = read_pfm(folder / "disp_left.pfm")
        write_kitti(occluded, truth)
        mask = folder / "nonocc.png"
        write_kitti(visible, np.where(read_picture(mask) == 255, truth, np.inf) if mask.exists() else truth)
        yield Scene(left, name, read_kitti(occluded), np.isfinite(read_kitti(visible)))


def check(hsad, scenes, form, scratch):
    """Scores `scenes` by both; returns the largest difference and the number of figures compared."""
    out, maps = scratch / f"out-{form}", scratch / f"maps-{form}"
    random = np.random.default_rng(1)
    for scene in scenes:
        (maps / scene.name).mkdir(parents=True)
        hole = random.random(scene.truth.shape) < 0.2
        noisy = scene.truth + random.standard_cauchy(scene.truth.shape)
        made = {"perfect": scene.truth, "empty": np.full_like(scene.truth, np.inf), "noisy": np.where(hole, np.inf, noisy)}
        for name, values in made.items():
            write_pfm(maps / scene.name / f"{name}.pfm", values)
        write_kitti(maps / scene.name / "coded.png", made["noisy"].clip(0, 255))
    supplied = {"perfect": "perfect.pfm", "empty": "empty.pfm", "noisy": "noisy.pfm", "coded": "coded.png"}
    command = [hsad, "eval", "dense", *(scene.argument for scene in scenes), "-q", "-o", out, "--json", scratch / form]
    command += [f"--disparity={name}={maps}/{{scene}}/{file}" for name, file in supplied.items()]
    subprocess.run(command, check=True)

    by_name = {scene.name: scene for scene in scenes}
    report = json.loads((scratch / form).read_text())
    assert len(report["results"]) == (1 + len(supplied)) * len(scenes), "a result is missing"
    largest, count = 0.0, 0
    for result in report["results"]:
        scene, method = by_name[result["scene"]], result["method"]
        path = out / scene.name / "disparity.pfm" if method == "hsad" else maps / scene.name / supplied[method]
        found = read_kitti(path) if path.suffix == ".png" else read_pfm(path)
        regions = {"all": np.full(scene.truth.shape, True), "non_occluded": scene.visible}
        for region, scored in regions.items():
            if scored is None:
                assert result[region] is None, f"{scene.name}: non-occluded pixels without a mask"
                continue
            expected = {k: v for k, v in figures(found, scene.truth, scored).items() if np.isfinite(v)}
            ours = reported(result[region])
            assert ours.keys() == expected.keys(), f"{scene.name} {method}: {ours.keys() ^ expected.keys()}"
            for key, value in expected.items():
                largest, count = max(largest, abs(ours[key] - value)), count + 1
            if method == "perfect":
                assert ours["bad 0.5 of_all"] == ours["a99_px"] == ours["rms_error_px"] == 0, "perfect is not 0"
            if method == "empty":
                assert ours["bad 4.0 of_all"] == ours["d1 of_all"] == 1, "empty is not 100 %"
    return largest, count


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--hsad", default="target/debug/hsad", metavar="PROGRAM", help="default: %(default)s")
    parser.add_argument("--tolerance", type=float, default=1e-6, help="default: %(default)s")
    parser.add_argument("folders", nargs="+", type=pathlib.Path, metavar="FOLDER")
    arguments = parser.parse_args()
    hsad = os.path.abspath(shutil.which(arguments.hsad) or parser.error(f"there is no program {arguments.hsad}"))
    folders = sorted(path.parent for folder in arguments.folders for path in folder.glob("*/disp_left.pfm"))
    folders = [folder for folder in folders if (folder / "left.png").exists()]
    if not folders:
        parser.error("there are no scenes in these folders")
    failed = False
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        forms = {
            "shipped": lambda: as_they_are(folders),
            "middlebury": lambda: as_middlebury(folders, scratch / "as-middlebury"),
            "kitti": lambda: as_kitti(folders, scratch / "as-kitti"),
        }
        for form, lay_out in forms.items():
            scenes = list(lay_out())
            largest, count = check(hsad, scenes, form, scratch)
            failed |= not largest <= arguments.tolerance
            print(f"{form:11}{len(scenes)} scenes, {count} figures, largest difference {largest:.1e}", flush=True)
    sys.exit(f"a difference is above {arguments.tolerance}" if failed else 0)


if __name__ == "__main__":
    main()
