"""Pairs in batches of columns."""

import json
import logging
import os
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import TYPE_CHECKING, Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

import hsad

from . import _files, _gpus

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ..types import MatchOptions

# What is read of a row besides the views; whatever else there is passes through.
_CALIBRATION: Final = "calib"
_GEOMETRY: Final = ("focal", "baseline", "doffs")

# All of a row that its map depends on.
INPUT: Final = ("left", "right", _CALIBRATION, *_GEOMETRY)

# The columns that are added, and their types in Arrow.
COLUMNS: Final = {
    "disparity": "binary",
    "confidence": "binary",
    "width": "int32",
    "height": "int32",
    "range_min": "int32",
    "range_max": "int32",
    "trust": "float32",
    "not_trusted": "string",
    "report": "string",
    "error": "string",
}

# Of a pair that failed, where a column has no None.
_NONE: Final = {"width": 0, "height": 0, "range_min": 0, "range_max": 0, "trust": np.nan}

_log = logging.getLogger("hsad.ray")


class Disparity:
    """Matches the pairs of a batch as ``hsad match`` does, on one device that stays open.

    A batch is a mapping from names of columns to their values: NumPy's arrays, lists, a DataFrame of pandas, a table of pyarrow. Of each
    row it reads

    - ``left`` and ``right``: a path, a URI that pyarrow can open, or the bytes of a file; without ``right``, or where it is None, ``left``
      has both views (MPO, JPS);
    - ``calib``, optional: a calibration file, in the same ways;
    - ``focal`` (px), ``baseline`` (m) and ``doffs`` (px), optional: the geometry of a rectified pair.

    The answer has the columns of the batch, but for views given in bytes, and

    ================================  ==================================================================================================
    ``disparity``, ``confidence``     bytes of ``disparity.png`` and ``confidence.png`` as ``hsad match`` writes them; with
                                      ``maps="tensor"`` disparity is float32 of shape (height, width), NaN for none, and confidence uint8
    ``width``, ``height``             size of the map, in pixels
    ``range_min``, ``range_max``      disparities that were searched, in pixels
    ``trust``                         0 to 1
    ``not_trusted``                   why the map is not to be trusted; None
    ``report``                        ``report.json``, a text
    ``error``                         why there is no map: then the maps are None, numbers 0 and trust NaN; None
    ================================  ==================================================================================================

    A pair that fails is a row with an ``error``; the others go on. Where no pair of a block has an ``error``, Ray may show NaN for None.

    Parameters
    ----------
    device : str, optional
        As for :func:`hsad.match`. By default the GPU that Ray has assigned to the worker, found by its place on the PCI bus, or the best
        device where Ray has assigned none.
    maps : str
        ``"png"`` or ``"tensor"``.
    jobs : int
        Pairs at work at once, so that reading and decoding overlap with the device; each takes the memory of a pair.
    **options
        As for :func:`hsad.match`.

    Raises
    ------
    ParameterError
        An option that does not exist or does not fit, or a column that a batch already has.
    DeviceError
        The device cannot be opened. A device that is lost later ends a worker of Ray's, which starts another one and gives it the batch.
    """

    def __init__(
        self,
        device: str | None = None,
        maps: Literal["png", "tensor"] = "png",
        jobs: int = 2,
        **options: "Unpack[MatchOptions]",
    ) -> None:
        if maps not in ("png", "tensor"):
            raise hsad.ParameterError(f"maps is {maps!r}, but it must be 'png' or 'tensor'")
        if jobs < 1:
            raise hsad.ParameterError(f"jobs is {jobs}, but it must be at least 1")
        self._given: Final[dict[str, Any]] = {"device": device, "maps": maps, "jobs": jobs, **options}
        self.device: Final = opened(device, options)
        self._options: Final = options
        self._is_png: Final = maps == "png"
        self._threads: Final = ThreadPoolExecutor(jobs, "hsad")

    def __reduce__(self) -> tuple[Any, ...]:
        """Another process opens a device of its own."""
        return partial(Disparity, **self._given), ()

    def __call__(self, batch: Any) -> dict[str, NDArray[Any]]:
        """Matches the pairs of a batch; see the class for the columns of both."""
        columns = columns_of(batch)
        taken = COLUMNS.keys() & columns.keys()
        if taken:
            raise hsad.ParameterError(f"the pairs have a column {min(taken)}, which is one of the answer: rename it")
        if "left" not in columns:
            raise hsad.ParameterError(f"the pairs have no column left (only {', '.join(columns) or 'none'}), and maybe right")
        answer = self.match_rows(columns)
        return {name: as_array(values) for name, values in _passed_on(columns)} | answer

    def match_rows(self, columns: Mapping[str, list[Any]]) -> dict[str, NDArray[Any]]:
        """The columns that are added to those of a batch."""
        rows = (dict(zip(columns, row)) for row in zip(*columns.values()))
        found = list(self._threads.map(self._row, rows))
        return {name: as_array([row[name] for row in found], name) for name in COLUMNS}

    def _row(self, row: Mapping[str, Any]) -> dict[str, Any]:
        """What is found of a pair; an error is part of it."""
        try:
            return nothing() | self._matched(row)
        except hsad.DeviceLostError as error:
            if _gpus.is_worker():
                _log.error("the worker ends, since its device is lost: %s", error)
                os._exit(1)
            raise
        except hsad.ForkError:
            raise
        except Exception as error:
            return nothing() | {"error": str(error) or type(error).__name__}

    def _matched(self, row: Mapping[str, Any]) -> dict[str, Any]:
        views = [row["left"], row.get("right")]
        if is_none(views[0]):
            raise hsad.ParameterError("the pair has no left view")
        names = [side if not isinstance(view, str) else view for view, side in zip(views, ("left", "right"))]
        left, right = (read(view) for view in views)
        assert left is not None
        found = hsad.match_encoded(
            left,
            right,
            names=(names[0], names[1]),
            calibration=read(row.get(_CALIBRATION)),
            depth=_geometry(row),
            device=self.device,
            **self._options,
        )
        return of_encoded(found, self._is_png)


def opened(device: str | None, options: Mapping[str, Any]) -> str:
    """The name of a worker's device, which is open; `options` are checked, too."""
    _gpus.limit_threads()
    name = device if device is not None else _gpus.device_of_worker()
    try:
        hsad.match_encoded(b"", b"", device=name, **options)
    except hsad.FormatError:
        # There is no picture yet.
        pass
    return name


def of_encoded(found: hsad.Encoded, is_png: bool) -> dict[str, Any]:
    """The columns of a pair that was matched."""
    report = found.report
    return {
        "disparity": found.disparity_png if is_png else found.disparity,
        "confidence": found.confidence_png if is_png else found.confidence,
        "width": report["width"],
        "height": report["height"],
        "range_min": found.range[0],
        "range_max": found.range[1],
        "trust": found.trust,
        "not_trusted": report["not_trusted"],
        "report": json.dumps(report),
    }


def nothing() -> dict[str, Any]:
    """The columns of a pair that failed, but for its error."""
    return dict.fromkeys(COLUMNS) | _NONE


def columns_of(batch: Any) -> dict[str, list[Any]]:
    """The columns of a batch: arrays of NumPy, lists, a DataFrame, a table of pyarrow."""
    return {name: _values(batch[name]) for name in _names(batch)}


def _passed_on(columns: Mapping[str, list[Any]]) -> Iterator[tuple[str, list[Any]]]:
    """Columns of a batch that its answer has, too."""
    for name, values in columns.items():
        if name not in ("left", "right") or not any(isinstance(value, (bytes, bytearray, memoryview)) for value in values):
            yield name, values


def _names(batch: Any) -> list[str]:
    names = getattr(batch, "column_names", None)
    return list(batch if names is None else names)


def _values(column: Any) -> list[Any]:
    return column.to_pylist() if hasattr(column, "to_pylist") else list(column)


def as_array(values: Iterable[Any], name: str = "") -> NDArray[Any]:
    """Values as an array: of numbers where all of them are, else of objects; of its own type for a column of the answer."""
    values = list(values)
    none = _NONE.get(name)
    if none is not None:
        return np.array(values, np.float32 if isinstance(none, float) else np.int32)
    if values and all(isinstance(value, (bool, int, float, np.number, np.bool_)) for value in values):
        return np.array(values)
    column = np.empty(len(values), object)
    for index, value in enumerate(values):
        column[index] = value
    return column


def is_none(value: Any) -> bool:
    """Whether a cell is empty, as libraries of tables have it: None, NaN, an empty text."""
    if isinstance(value, (str, float, np.floating)):
        return bool(value == "" or value != value)
    return value is None or type(value).__name__ == "NAType"


def read(value: Any) -> bytes | None:
    """The bytes of a file that is given as bytes, as a path or as a URI."""
    if isinstance(value, (bytes, bytearray, memoryview)):
        return bytes(value)
    if is_none(value):
        return None
    if isinstance(value, (str, os.PathLike)):
        return _files.read(os.fspath(value))
    raise hsad.ParameterError(f"a file is given as {type(value).__name__}, but it must be a path, a URI or bytes")


def _geometry(row: Mapping[str, Any]) -> tuple[float, float, float] | None:
    focal, baseline, doffs = (row.get(name) for name in _GEOMETRY)
    if is_none(focal) and is_none(baseline):
        return None
    if is_none(focal) or is_none(baseline):
        raise hsad.ParameterError("the pair has one of focal and baseline, but both belong together")
    return float(focal or 0), float(baseline or 0), 0.0 if is_none(doffs) else float(doffs or 0)
