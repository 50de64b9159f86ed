#!/usr/bin/env python3
"""How a map in tiles differs from the map of the whole picture: the table of docs/scale.md. Needs opencv-python.

    scripts/compare-tiles.py pictures STEREO OUT           # two pairs of 20 megapixels, from a folder of Middlebury's and KITTI's pairs
    hsad match OUT/mosaic-left.png OUT/mosaic-right.png -o whole --force
    hsad match OUT/mosaic-left.png OUT/mosaic-right.png -o tiled --force --tiles 1024
    scripts/compare-tiles.py maps whole tiled 1024

A pixel differs if its disparities do by over half a pixel, or if one map alone has a disparity. Printed are the shares of all pixels, of
those of some distance from a seam, and of those that have a confidence of 64 or more in both maps.
"""

import sys
from pathlib import Path

import cv2
import numpy as np

SCENES = ["Adirondack_Q", "Aloe_full_gray", "Art", "Books", "Cones", "KITTI15_js0", "Motorcycle_Q", "Teddy", "Adirondack_Q_exposure"]
WIDTH, HEIGHT = 1720, 1292  # px per scene of the mosaic
BORDERS = [0, 16, 64, 128, np.inf]  # px from a seam


def pictures(stereo: Path, out: Path) -> None:
    """Writes a mosaic of nine scenes, and Aloe enlarged four times."""
    out.mkdir(parents=True, exist_ok=True)
    for view in ("left", "right"):
        cells = []
        for scene in SCENES:
            picture = cv2.imread(str(stereo / scene / f"{view}.png"), cv2.IMREAD_GRAYSCALE)
            if scene == "Aloe_full_gray":
                cv2.imwrite(str(out / f"aloe-{view}.png"), cv2.resize(picture, None, fx=4, fy=4, interpolation=cv2.INTER_CUBIC))
            scale = max(WIDTH / picture.shape[1], HEIGHT / picture.shape[0])
            cells.append(cv2.resize(picture, None, fx=scale, fy=scale, interpolation=cv2.INTER_CUBIC)[:HEIGHT, :WIDTH])
        rows = [np.hstack(cells[first : first + 3]) for first in (0, 3, 6)]
        cv2.imwrite(str(out / f"mosaic-{view}.png"), np.vstack(rows))


def from_seam(length: int, side: int) -> np.ndarray:
    """Pixels between each column or row and the nearest seam."""
    places = np.arange(length)
    seams = np.arange(side, length, side)
    return np.abs(places[:, None] + 0.5 - seams).min(axis=1, initial=np.inf)


def maps(folders: list[Path], side: int) -> None:
    """Prints how the maps of two folders differ."""
    first, second = (cv2.imread(str(folder / "disparity.pfm"), cv2.IMREAD_UNCHANGED) for folder in folders)
    confidence = np.minimum(*(cv2.imread(str(folder / "confidence.png"), cv2.IMREAD_UNCHANGED) for folder in folders))
    with np.errstate(invalid="ignore"):
        differ = (np.isfinite(first) != np.isfinite(second)) | (np.abs(first - second) > 0.5)
    seam = np.minimum(from_seam(differ.shape[0], side)[:, None], from_seam(differ.shape[1], side))
    print(f"{100 * differ.mean():.2f} % differ")
    for near, far in zip(BORDERS, BORDERS[1:]):
        print(f"{100 * differ[(seam >= near) & (seam < far)].mean():.2f} % from {near} to {far} px from a seam")
    sure = confidence >= 64
    print(f"{100 * differ[sure].mean():.4f} % of the {100 * sure.mean():.0f} % with a confidence of 64 or more")


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["pictures", stereo, out]:
            pictures(Path(stereo), Path(out))
        case ["maps", whole, tiled, side]:
            maps([Path(whole), Path(tiled)], int(side))
        case _:
            sys.exit(__doc__)
