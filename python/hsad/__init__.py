"""Stereo depth from two photographs, on any GPU.

>>> import numpy as np
>>> left = np.random.default_rng(1).integers(0, 256, (60, 90), dtype=np.uint8)
>>> right = np.roll(left, -7, axis=1)
>>> float(np.nanmedian(hsad.match(left, right, device="cpu", disparities=16, force=True).disparity))
7.0

``hsad.cv`` has OpenCV's StereoSGBM and StereoBM.
"""

from ._errors import DeviceError, DeviceLostError, Error, ForkError, FormatError, NoRangeError, NotRectifiedError, ParameterError
from ._hsad import (
    Calibration,
    Encoded,
    Features,
    Match,
    Matcher,
    Rectified,
    __version__,
    colorize,
    depth,
    devices,
    error_colors,
    evaluate,
    features,
    match,
    match_encoded,
    match_features,
    options,
    points,
    read_calibration,
    read_disparity,
    read_image,
    read_kitti,
    read_pair,
    read_pfm,
    read_ply,
    rectify,
    write_kitti,
    write_pfm,
    write_ply,
    write_png,
)

__all__ = [
    "Calibration",
    "DeviceError",
    "DeviceLostError",
    "Encoded",
    "Error",
    "Features",
    "ForkError",
    "FormatError",
    "Match",
    "Matcher",
    "NoRangeError",
    "NotRectifiedError",
    "ParameterError",
    "Rectified",
    "__version__",
    "colorize",
    "depth",
    "devices",
    "error_colors",
    "evaluate",
    "features",
    "match",
    "match_encoded",
    "match_features",
    "options",
    "points",
    "read_calibration",
    "read_disparity",
    "read_image",
    "read_kitti",
    "read_pair",
    "read_pfm",
    "read_ply",
    "rectify",
    "write_kitti",
    "write_pfm",
    "write_ply",
    "write_png",
]
