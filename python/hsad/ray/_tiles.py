"""Large pairs in tiles: cut by one worker, matched by all, put together or left as they are."""

import os
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

import hsad

from . import _gpus
from ._disparity import COLUMNS, as_array, columns_of, is_none, nothing, of_encoded, opened, read

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ..types import MatchOptions

# Of a tile, what is needed after it was matched, and what only to match it.
_PLACE: Final = ("tile", "x", "y", "width", "height", "view_x", "view_y", "view_width", "view_height")
_FOUND: Final = ("min_disparity", "disparities", "gain", "offset", "levels", "options")
_VIEWS: Final = ("left", "right", "colors", "own_mask", "other_mask", "keeps_hidden")
_FILES: Final = ("left_file", "right_file")

# Columns that tiles or the answer have, and a pair thus has not.
_TAKEN: Final = {*_PLACE, *_FOUND, *_VIEWS, *_FILES, *COLUMNS} - {"left", "right"}


class CutTiles:
    """Cuts a large pair into tiles, for ``ds.flat_map``: a row of :class:`Disparity` becomes a row per tile.

    Range, brightness and rows are found from the whole pair: see :func:`hsad.cut_tiles`, which has the columns. ``left`` and ``right``
    become ``left_file`` and ``right_file``. A pair that fails is one row with an ``error``. Calibrations are not read.

    Parameters
    ----------
    device, **options
        As for :class:`Disparity`; ``tiles``, the side of a tile in pixels, is 2048 by default.

    Raises
    ------
    ParameterError
        An option that does not exist or does not fit, or a column that tiles or the answer have, too.
    DeviceError
        The device cannot be opened or is lost.
    """

    def __init__(self, device: str | None = None, **options: "Unpack[MatchOptions]") -> None:
        options.setdefault("tiles", 2048)
        self.device: Final = opened(device, options)
        self._options: Final = options

    def __call__(self, row: Mapping[str, Any]) -> list[dict[str, Any]]:
        """The tiles of a pair."""
        taken = [name for name in row if name in _TAKEN]
        if taken:
            raise hsad.ParameterError(f"the pairs have columns of tiles or of the answer ({', '.join(taken)}): rename them")
        kept = {name: value for name, value in row.items() if name not in ("left", "right")}
        kept |= {"left_file": row["left"], "right_file": row["right"], "error": None}
        try:
            left, right = read(row["left"]), read(row["right"])
            if left is None or right is None:
                raise hsad.ParameterError("the pair lacks a view")
            return [kept | tile for tile in hsad.cut_tiles(left, right, device=self.device, **self._options)]
        except (hsad.DeviceLostError, hsad.ForkError):
            raise
        except Exception as error:
            numbers = dict.fromkeys((*_PLACE, *_FOUND[:-1]), 0) | {"tile": -1, "keeps_hidden": False, "options": ""}
            return [kept | numbers | dict.fromkeys(_VIEWS[:-1]) | {"error": str(error) or type(error).__name__}]


class TileDisparity:
    """Matches tiles, for ``ds.map_batches``: rows of :class:`CutTiles` with ``disparity``, a PFM in pixels, and ``confidence``, a PNG, of the
    tile's pixels in place of its views.

    Parameters
    ----------
    device, jobs
        As for :class:`Disparity`.
    """

    def __init__(self, device: str | None = None, jobs: int = 1) -> None:
        self.device: Final = opened(device, {})
        self._threads: Final = ThreadPoolExecutor(jobs, "hsad")

    def __call__(self, batch: Any) -> dict[str, NDArray[Any]]:
        """Matches the tiles of a batch."""
        columns = columns_of(batch)
        rows = [dict(zip(columns, row)) for row in zip(*columns.values())]
        found = list(self._threads.map(self._row, rows))
        kept = {name: as_array(values) for name, values in columns.items() if name not in (*_VIEWS, "error")}
        return kept | {name: as_array([row[name] for row in found]) for name in ("disparity", "confidence", "error")}

    def _row(self, row: Mapping[str, Any]) -> dict[str, Any]:
        if not is_none(row["error"]):
            return {"disparity": None, "confidence": None, "error": row["error"]}
        try:
            disparity, confidence = hsad.match_tile(_plain(row), device=self.device)
            return {"disparity": disparity, "confidence": confidence, "error": None}
        except hsad.DeviceLostError:
            if _gpus.is_worker():
                os._exit(1)
            raise
        except hsad.ForkError:
            raise
        except Exception as error:
            return {"disparity": None, "confidence": None, "error": str(error) or type(error).__name__}


class MergeTiles:
    """Puts the tiles of a pair together, for ``ds.groupby("name").map_groups``: rows of :class:`TileDisparity` become a row of
    :class:`Disparity`.

    The files of the pair are read again. An error of a tile is that of the pair, and so is a group of tiles that are not of one pair.

    Parameters
    ----------
    device
        As for :class:`Disparity`.
    """

    def __init__(self, device: str | None = None) -> None:
        self.device: Final = opened(device, {})

    def __call__(self, batch: Any) -> dict[str, NDArray[Any]]:
        """The pair of a group's tiles."""
        columns = columns_of(batch)
        rows = [_plain(dict(zip(columns, row))) for row in zip(*columns.values())]
        found = nothing() | self._merged(rows)
        tile = {*_PLACE, *_FOUND, "disparity", "confidence", "error"}
        kept = {name: value for name, value in rows[0].items() if name not in tile}
        kept = {name.removesuffix("_file") if name in _FILES else name: value for name, value in kept.items()}
        return {name: as_array([value]) for name, value in kept.items()} | {name: as_array([found[name]], name) for name in COLUMNS}

    def _merged(self, rows: list[dict[str, Any]]) -> dict[str, Any]:
        errors = [row["error"] for row in rows if not is_none(row["error"])]
        if errors:
            return {"error": errors[0]}
        try:
            _check(rows)
            names = [file if isinstance(file, str) else side for side in ("left", "right") for file in [rows[0][f"{side}_file"]]]
            left, right = (read(rows[0][f"{side}_file"]) for side in ("left", "right"))
            if left is None or right is None:
                raise hsad.ParameterError("the pair lacks a view")
            return of_encoded(hsad.merge_tiles(left, right, rows, names=(names[0], names[1]), device=self.device), is_png=True)
        except (hsad.DeviceLostError, hsad.ForkError):
            raise
        except Exception as error:
            return {"error": str(error) or type(error).__name__}


def _check(rows: list[dict[str, Any]]) -> None:
    """Tiles of one pair are of the same files; :func:`hsad.merge_tiles` checks the rest.

    Raises
    ------
    ParameterError
        They are not.
    """
    differ = [name for name in _FILES if any(row.get(name) != rows[0].get(name) for row in rows)]
    if differ:
        raise hsad.ParameterError(f"tiles of one pair differ in {', '.join(differ)}: group them by a name that each pair has alone")


def _plain(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row without NumPy's own kinds of numbers, and with None for NaN, which stands for it where a column has nothing else."""
    plain = {name: value.item() if isinstance(value, np.generic) else value for name, value in row.items()}
    return {name: None if isinstance(value, float) and is_none(value) else value for name, value in plain.items()}
