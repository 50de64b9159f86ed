"""What OpenCV's stereo matchers share."""

import sys
import warnings
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from .. import Matcher, ParameterError
from ..types import DenseOptions

SCALE: Final = 16
"""Steps of an answer per pixel."""

_warned: set[str] = set()


def _means_nothing(name: str) -> None:
    if name in _warned:
        return
    _warned.add(name)
    # Told of the line outside these modules.
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_globals["__name__"].startswith("hsad.cv"):
        level, frame = level + 1, frame.f_back
    warnings.warn(f"{name} means nothing to hsad: see help(hsad.cv)", stacklevel=level)


class StereoMatcher:
    """What StereoSGBM and StereoBM share."""

    _means_nothing: frozenset[str] = frozenset()

    def __init__(self, device: str, **defaults: Any) -> None:
        self._device = device
        self._defaults = defaults
        self._values = dict(defaults)
        self._made: tuple[tuple[int, int], Matcher] | None = None

    def _set(self, name: str, value: Any) -> None:
        if name in self._means_nothing:
            if value != self._defaults[name]:
                _means_nothing(name)
        elif value != self._values[name]:
            self._made = None
        self._values[name] = value

    def _give(self, **values: int) -> None:
        for name, value in values.items():
            self._set(name, value)

    def _options(self) -> DenseOptions:
        """What the parameters mean to hsad."""
        raise NotImplementedError

    def _matcher(self, size: tuple[int, int]) -> Matcher:
        if self._made is None or self._made[0] != size:
            first, count = self._values["minDisparity"], self._values["numDisparities"]
            if (first - 1) * SCALE < -32768 or (first + count) * SCALE > 32767:
                raise ParameterError(
                    f"the disparities are {first} to {first + count - 1} px, but int16 holds -2047 to 2046 px in sixteenths: "
                    "hsad.match has floats"
                )
            matcher = Matcher(size, count, min_disparity=first, device=self._device, **self._options())
            self._made = (size, matcher)
        return self._made[1]

    def compute(
        self, left: NDArray[np.uint8], right: NDArray[np.uint8], disparity: NDArray[np.int16] | None = None
    ) -> NDArray[np.int16]:
        """Disparities of the left picture.

        Parameters
        ----------
        left, right : numpy.ndarray
            uint8 of one shape, (height, width) or (height, width, 3), BGR as OpenCV reads them.
        disparity : numpy.ndarray, optional
            An int16 array of shape (height, width) for the answer.

        Returns
        -------
        numpy.ndarray
            int16 of shape (height, width): 16 times the disparity in pixels, ``(minDisparity - 1) * 16`` where there is none.

        Raises
        ------
        hsad.ParameterError
            Pictures of different shapes or of another type, or a parameter outside its range.
        """
        views = [self._view(view, name) for view, name in ((left, "left"), (right, "right"))]
        if views[0].shape != views[1].shape:
            raise ParameterError(
                f"the left view has the shape {views[0].shape} and the right view {views[1].shape}: a rectified pair has one"
            )
        height, width = views[0].shape[:2]
        pixels, _ = self._matcher((width, height)).match(views[0], views[1])
        pixels *= SCALE
        np.nan_to_num(pixels, copy=False, nan=(self._values["minDisparity"] - 1) * SCALE)
        np.rint(pixels, out=pixels)
        if disparity is None or disparity.shape != pixels.shape or disparity.dtype != np.int16:
            return pixels.astype(np.int16)
        disparity[...] = pixels
        return disparity

    def _view(self, view: NDArray[np.uint8], name: str) -> NDArray[np.uint8]:
        view = np.asarray(view)
        if view.dtype != np.uint8 or view.ndim not in (2, 3):
            raise ParameterError(
                f"the {name} view is an array of {view.dtype} of shape {view.shape}, but pictures are uint8, grey or BGR"
            )
        return view[..., 2::-1] if view.ndim == 3 and view.shape[2] > 1 else view

    def clear(self) -> None:
        """Frees the device's memory until the next call of compute."""
        self._made = None

    def empty(self) -> bool:
        """Whether nothing was matched yet."""
        return self._made is None

    def getDefaultName(self) -> str:
        return "my_object"

    def getMinDisparity(self) -> int:
        return int(self._values["minDisparity"])

    def setMinDisparity(self, minDisparity: int) -> None:
        self._set("minDisparity", minDisparity)

    def getNumDisparities(self) -> int:
        return int(self._values["numDisparities"])

    def setNumDisparities(self, numDisparities: int) -> None:
        self._set("numDisparities", numDisparities)

    def getBlockSize(self) -> int:
        return int(self._values["blockSize"])

    def setBlockSize(self, blockSize: int) -> None:
        self._set("blockSize", blockSize)

    def getSpeckleWindowSize(self) -> int:
        return int(self._values["speckleWindowSize"])

    def setSpeckleWindowSize(self, speckleWindowSize: int) -> None:
        self._set("speckleWindowSize", speckleWindowSize)

    def getSpeckleRange(self) -> int:
        return int(self._values["speckleRange"])

    def setSpeckleRange(self, speckleRange: int) -> None:
        self._set("speckleRange", speckleRange)

    def getDisp12MaxDiff(self) -> int:
        return int(self._values["disp12MaxDiff"])

    def setDisp12MaxDiff(self, disp12MaxDiff: int) -> None:
        self._set("disp12MaxDiff", disp12MaxDiff)

    def getPreFilterCap(self) -> int:
        return int(self._values["preFilterCap"])

    def setPreFilterCap(self, preFilterCap: int) -> None:
        self._set("preFilterCap", preFilterCap)

    def getUniquenessRatio(self) -> int:
        return int(self._values["uniquenessRatio"])

    def setUniquenessRatio(self, uniquenessRatio: int) -> None:
        self._set("uniquenessRatio", uniquenessRatio)

    def _left_right(self) -> DenseOptions:
        """The left-right check."""
        most = self.getDisp12MaxDiff()
        if most < 0:
            return {"no_lr_check": True}
        return {"max_lr_difference": min(most, 256)} if most > 0 else {}
