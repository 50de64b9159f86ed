"""Pairs that the tests match: the project's own scenes always, real pairs where HSAD_REAL_PAIRS names their folder."""

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import hsad
import hsad.cv

DATA = Path(__file__).resolve().parents[2] / "data"


@dataclass
class Scene:
    """A pair with its truth: RGB, disparities of the left view, and a mask of pixels that both views show."""

    name: str
    left: NDArray[np.uint8]
    right: NDArray[np.uint8]
    truth: NDArray[np.float32]
    seen: NDArray[np.bool_]

    @classmethod
    def read(cls, folder: Path) -> "Scene":
        left, right = hsad.read_pair(folder / "left.png", folder / "right.png")
        seen = hsad.read_image(folder / "nonocc.png")[..., 0] == 255
        return cls(folder.name, left[..., :3], right[..., :3], hsad.read_disparity(folder / "disp_left.pfm"), seen)

    @property
    def size(self) -> tuple[int, int]:
        return self.left.shape[1], self.left.shape[0]

    @property
    def disparities(self) -> int:
        """The number of disparities that holds the truth, in whole sixteens."""
        return int(np.nanmax(self.truth) + 16) // 16 * 16


@pytest.fixture(scope="session")
def scene() -> Scene:
    return Scene.read(DATA / "curved")


@pytest.fixture(scope="session")
def found(scene: Scene) -> hsad.Match:
    return hsad.match(scene.left, scene.right)


@pytest.fixture
def dots() -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Noise of 90x60 pixels, the right view 7 px further to the left."""
    left = np.random.default_rng(1).integers(0, 256, (60, 90), dtype=np.uint8)
    return left, np.roll(left, -7, axis=1)


@pytest.fixture
def told_nothing() -> Iterator[None]:
    """As if no parameter of OpenCV had been warned of."""
    hsad.cv._matcher._warned.clear()
    yield
    hsad.cv._matcher._warned.clear()


def real_scenes() -> list[Path]:
    """Folders of real pairs, laid out as those of data/."""
    folder = os.environ.get("HSAD_REAL_PAIRS")
    found = sorted(Path(folder).glob("*/nonocc.png")) if folder else []
    return [path.parent for path in found if (path.parent / "disp_left.pfm").exists()]
