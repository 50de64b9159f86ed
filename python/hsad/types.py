"""Types of keyword options and of dictionaries that are returned, for annotations."""

from typing import Literal, TypedDict


class PointOptions(TypedDict, total=False):
    """Options of interest points: see :func:`hsad.options`."""

    octaves: int | None
    step: int | None
    threshold: float | None
    oriented: bool | None
    upright: bool | None
    max_features: int | None


class DenseOptions(PointOptions, total=False):
    """Options of a :class:`hsad.Matcher`."""

    method: Literal["hsad", "kamencay"] | None
    preset: Literal["fast", "balanced", "quality", "paper"] | None
    window: int | None
    paths: Literal[0, 3, 4, 8] | None
    cost_window: int | None
    compare: Literal["luma", "soft-rank"] | None
    whole_range: bool | None
    reference: Literal["left", "right"] | None
    uniqueness: int | None
    max_lr_difference: float | None
    no_lr_check: bool | None
    search_both_views: bool | None
    agreement: int | None
    fill: bool | None
    no_fill: bool | None
    tiles: int | None
    tile_margin: int | None
    no_equalise: bool | None
    no_align: bool | None
    interpolation: Literal["none", "parabola", "equiangular"] | None
    ratio: float | None
    force: bool | None


class MatchOptions(DenseOptions, total=False):
    """Options of :func:`hsad.match`."""

    min_disparity: int | None
    disparities: int | None


class Option(TypedDict):
    """An entry of :func:`hsad.options`."""

    name: str
    heading: str
    kind: Literal["flag", "whole", "number", "choice"]
    unit: str
    help: str
    choices: list[str]


class BadShare(TypedDict):
    """Shares of pixels that are wrong by over a threshold, 0 to 1."""

    above_px: float
    of_all: float | None
    of_estimated: float | None


class OutlierShare(TypedDict):
    """Shares of KITTI's outliers, 0 to 1."""

    of_all: float | None
    of_estimated: float | None


class Score(TypedDict):
    """What :func:`hsad.evaluate` returns; what is undefined is None."""

    pixels: int
    estimated: int
    density: float | None
    bad: list[BadShare]
    d1: OutlierShare
    average_error_px: float | None
    rms_error_px: float | None
    a50_px: float | None
    a90_px: float | None
    a99_px: float | None
