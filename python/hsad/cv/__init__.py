"""OpenCV's StereoSGBM and StereoBM, computed by hsad: ``import hsad.cv as cv2`` in place of ``import cv2``.

Whatever else a script asks this module for is OpenCV's own, where OpenCV is installed.

Disparities are int16, 16 times the pixels, and ``(minDisparity - 1) * 16`` where there is none. What a parameter means here:

===================================  =================================================================================================
minDisparity, numDisparities         as in OpenCV; any number of disparities, not only multiples of 16. OpenCV leaves the columns empty
                                     whose whole range lies outside the right picture; here they have disparities
blockSize                            StereoSGBM: side of the window that averages costs before the paths, at most 31. StereoBM: side of the
                                     blocks, 3 to 31: larger ones are 31
mode                                 MODE_SGBM and MODE_SGBM_3WAY: 3 paths; MODE_HH4: 4; MODE_HH: 8
disp12MaxDiff                        the largest left-right difference in pixels; below 0 no check; 0, OpenCV's default, is hsad's own: 1 px
                                     for StereoSGBM, none for StereoBM
uniquenessRatio                      as in OpenCV, in per cent, against rivals two or more disparities away; StereoBM's default of 15 stands
                                     for hsad's own
P1, P2                               nothing: hsad's costs have another scale, and its penalties belong to them
preFilterCap, preFilterSize,         nothing: census and soft ranks need no filter before
preFilterType
textureThreshold                     nothing: uniqueness and the agreement of neighbours decide
speckleWindowSize, speckleRange      nothing: pixels without support in their 7x7 neighbourhood are always removed
ROI1, ROI2                           nothing
===================================  =================================================================================================

A parameter that means nothing warns once, when it is set to something else than OpenCV's default.
"""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from .. import ParameterError
from ..types import DenseOptions
from ._matcher import StereoMatcher

StereoMatcher_DISP_SHIFT: Final = 4
StereoMatcher_DISP_SCALE: Final = 16
StereoSGBM_MODE_SGBM: Final = 0
StereoSGBM_MODE_HH: Final = 1
StereoSGBM_MODE_SGBM_3WAY: Final = 2
StereoSGBM_MODE_HH4: Final = 3
StereoBM_PREFILTER_NORMALIZED_RESPONSE: Final = 0
StereoBM_PREFILTER_XSOBEL: Final = 1
STEREO_MATCHER_DISP_SHIFT: Final = StereoMatcher_DISP_SHIFT
STEREO_MATCHER_DISP_SCALE: Final = StereoMatcher_DISP_SCALE
STEREO_SGBM_MODE_SGBM: Final = StereoSGBM_MODE_SGBM
STEREO_SGBM_MODE_HH: Final = StereoSGBM_MODE_HH
STEREO_SGBM_MODE_SGBM_3WAY: Final = StereoSGBM_MODE_SGBM_3WAY
STEREO_SGBM_MODE_HH4: Final = StereoSGBM_MODE_HH4
STEREO_BM_PREFILTER_NORMALIZED_RESPONSE: Final = StereoBM_PREFILTER_NORMALIZED_RESPONSE
STEREO_BM_PREFILTER_XSOBEL: Final = StereoBM_PREFILTER_XSOBEL

device: str = "best"
"""The device of matchers that are made from now on, as for :func:`hsad.match`."""

class StereoSGBM(StereoMatcher):
    """Semi-global matching: see StereoSGBM_create."""

    _means_nothing = frozenset({"P1", "P2", "preFilterCap", "speckleWindowSize", "speckleRange"})

    def _options(self) -> DenseOptions:
        mode = self.getMode()
        if mode == StereoSGBM_MODE_HH:
            options: DenseOptions = {"paths": 8}
        else:
            options = {"paths": 4} if mode == StereoSGBM_MODE_HH4 else {"paths": 3}
        # OpenCV takes blocks without a centre and without an extent, too.
        side = min(max(self.getBlockSize(), 1) | 1, 31)
        uniqueness = min(max(self.getUniquenessRatio(), 0), 100)
        return {**options, **self._left_right(), "cost_window": side, "uniqueness": uniqueness, "no_fill": True}

    def getP1(self) -> int:
        return int(self._values["P1"])

    def setP1(self, P1: int) -> None:
        self._set("P1", P1)

    def getP2(self) -> int:
        return int(self._values["P2"])

    def setP2(self, P2: int) -> None:
        self._set("P2", P2)

    def getMode(self) -> int:
        return int(self._values["mode"])

    def setMode(self, mode: int) -> None:
        self._set("mode", mode)


class StereoBM(StereoMatcher):
    """Block matching: see StereoBM_create."""

    _means_nothing = frozenset(
        {
            "preFilterCap",
            "preFilterSize",
            "preFilterType",
            "textureThreshold",
            "speckleWindowSize",
            "speckleRange",
            "ROI1",
            "ROI2",
        }
    )

    def _view(self, view: NDArray[np.uint8], name: str) -> NDArray[np.uint8]:
        view = super()._view(view, name)
        if view.ndim == 3 and view.shape[2] > 1:
            raise ParameterError(f"the {name} view has colours, but StereoBM takes grey pictures, as in OpenCV")
        return view

    def _options(self) -> DenseOptions:
        ratio = self.getUniquenessRatio()
        own: DenseOptions = {} if ratio == self._defaults["uniquenessRatio"] else {"uniqueness": min(max(ratio, 0), 100)}
        side = min(max(self.getBlockSize(), 3) | 1, 31)
        check = self._left_right() if self.getDisp12MaxDiff() > 0 else {}
        return {**own, **check, "preset": "fast", "window": side}

    def getPreFilterType(self) -> int:
        return int(self._values["preFilterType"])

    def setPreFilterType(self, preFilterType: int) -> None:
        self._set("preFilterType", preFilterType)

    def getPreFilterSize(self) -> int:
        return int(self._values["preFilterSize"])

    def setPreFilterSize(self, preFilterSize: int) -> None:
        self._set("preFilterSize", preFilterSize)

    def getTextureThreshold(self) -> int:
        return int(self._values["textureThreshold"])

    def setTextureThreshold(self, textureThreshold: int) -> None:
        self._set("textureThreshold", textureThreshold)

    def getSmallerBlockSize(self) -> int:
        return 0

    def setSmallerBlockSize(self, blockSize: int) -> None:
        """Does nothing, as in OpenCV."""

    def getROI1(self) -> tuple[int, int, int, int]:
        x, y, width, height = self._values["ROI1"]
        return x, y, width, height

    def setROI1(self, roi1: tuple[int, int, int, int]) -> None:
        self._set("ROI1", tuple(roi1))

    def getROI2(self) -> tuple[int, int, int, int]:
        x, y, width, height = self._values["ROI2"]
        return x, y, width, height

    def setROI2(self, roi2: tuple[int, int, int, int]) -> None:
        self._set("ROI2", tuple(roi2))


def StereoSGBM_create(
    minDisparity: int = 0,
    numDisparities: int = 16,
    blockSize: int = 3,
    P1: int = 0,
    P2: int = 0,
    disp12MaxDiff: int = 0,
    preFilterCap: int = 0,
    uniquenessRatio: int = 0,
    speckleWindowSize: int = 0,
    speckleRange: int = 0,
    mode: int = StereoSGBM_MODE_SGBM,
) -> StereoSGBM:
    """A semi-global matcher with OpenCV's parameters: see help(hsad.cv) for what they mean here.

    >>> matcher = hsad.cv.StereoSGBM_create(minDisparity=-16, numDisparities=48, blockSize=3)
    >>> matcher.getNumDisparities()
    48
    """
    matcher = StereoSGBM(
        device,
        minDisparity=0,
        numDisparities=16,
        blockSize=3,
        P1=0,
        P2=0,
        disp12MaxDiff=0,
        preFilterCap=0,
        uniquenessRatio=0,
        speckleWindowSize=0,
        speckleRange=0,
        mode=StereoSGBM_MODE_SGBM,
    )
    matcher._give(
        minDisparity=minDisparity,
        numDisparities=numDisparities,
        blockSize=blockSize,
        P1=P1,
        P2=P2,
        disp12MaxDiff=disp12MaxDiff,
        preFilterCap=preFilterCap,
        uniquenessRatio=uniquenessRatio,
        speckleWindowSize=speckleWindowSize,
        speckleRange=speckleRange,
        mode=mode,
    )
    return matcher


def StereoBM_create(numDisparities: int = 0, blockSize: int = 21) -> StereoBM:
    """A block matcher with OpenCV's parameters: see help(hsad.cv) for what they mean here.

    >>> hsad.cv.StereoBM_create(numDisparities=64, blockSize=15).getBlockSize()
    15
    """
    matcher = StereoBM(
        device,
        minDisparity=0,
        numDisparities=64,
        blockSize=21,
        speckleWindowSize=0,
        speckleRange=0,
        disp12MaxDiff=-1,
        preFilterCap=31,
        preFilterSize=9,
        preFilterType=StereoBM_PREFILTER_XSOBEL,
        textureThreshold=10,
        uniquenessRatio=15,
        ROI1=(0, 0, 0, 0),
        ROI2=(0, 0, 0, 0),
    )
    matcher._give(numDisparities=numDisparities or 64, blockSize=blockSize)
    return matcher


def __getattr__(name: str) -> Any:
    """Everything else of OpenCV."""
    if name.startswith("__"):
        raise AttributeError(f"module 'hsad.cv' has no attribute '{name}'")
    try:
        import cv2
    except ImportError:
        raise AttributeError(
            f"module 'hsad.cv' has no attribute '{name}': only stereo matching is hsad's, the rest is OpenCV's, which is not installed "
            "(pip install opencv-python)"
        ) from None
    return getattr(cv2, name)
