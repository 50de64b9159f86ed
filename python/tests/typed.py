"""Calls that mypy must accept, and calls that it must refuse: `warn_unused_ignores` of strict mode fails if one of those passes."""

import numpy as np
from numpy.typing import NDArray

import hsad
import hsad.cv as cv2


def accepted(left: NDArray[np.uint8], right: NDArray[np.uint8]) -> float:
    found = hsad.match(left, right, preset="quality", disparities=64, no_fill=True, device="cpu")
    matcher = hsad.Matcher((640, 480), 64, preset="fast")
    disparity, confidence = matcher.match(left, right, disparity=found.disparity)
    points, colors = hsad.points(hsad.depth(disparity, hsad.Calibration(1.0, 1.0, cx=0, cy=0)), left, hsad.read_calibration("a"))
    hsad.write_ply("cloud.ply", points, colors)
    score = hsad.evaluate(disparity, disparity, confidence)
    sixteenths: NDArray[np.int16] = cv2.StereoSGBM_create(numDisparities=64).compute(left, right)
    return (score["rms_error_px"] or 0.0) + found.trust + float(sixteenths[0, 0])


def refused(left: NDArray[np.uint8]) -> None:
    hsad.match(left, left, preset="best")  # type: ignore[arg-type]
    hsad.match(left, left, windows=7)  # type: ignore[call-arg]
    hsad.Matcher((640, 480), 64, disparity=3)  # type: ignore[call-arg]
    hsad.features(left, preset="fast")  # type: ignore[call-arg]
    hsad.match(left, left).disparity = left  # type: ignore[misc, assignment]
