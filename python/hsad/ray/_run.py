"""A run over many pairs: which are left, who matches them, and what became of them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from hashlib import blake2b
from typing import TYPE_CHECKING, Any, Final

import hsad

from . import _files
from ._disparity import COLUMNS, INPUT, Disparity
from ._parts import Parts, input_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ..types import MatchOptions


# How often a worker starts again, and how often it is given the same pairs: a pair that always loses the device would go round for ever.
_RESTARTS: Final = 8


@dataclass
class Summary:
    """What became of the pairs of a run."""

    pairs: int = 0
    """All pairs of the list."""
    earlier: int = 0
    """Those whose maps an earlier run had written."""
    done: int = 0
    """Those whose maps this run has written."""
    not_trusted: int = 0
    """Those of them whose maps are not to be trusted."""
    failed: int = 0
    """Those without a map; their rows say why."""


def run(
    pairs: str,
    folder: str,
    *,
    device: str | None = None,
    workers: int | None = None,
    cpus: float = 1,
    gpus: float | None = None,
    rows: int = 16,
    jobs: int = 2,
    told: Callable[[Summary], None] = lambda _: None,
    **options: "Unpack[MatchOptions]",
) -> Summary:
    """Matches the pairs of a Parquet file, or of a folder of them, on Ray's cluster, and writes a folder of Parquet files.

    A pair is a row with ``left`` and ``right``, as :class:`Disparity` reads them, in URIs or in paths, which are relative to the folder of
    the list, and perhaps a ``name`` of its own; without one it gets a name from its files. Each file of the answer has a few pairs, appears
    whole or not at all, and is named by them: a worker that ends before or after it has written one leaves nothing lost or doubled. A run
    into the same folder goes on: it matches the pairs that are missing or have failed. One run at a time writes into a folder. A worker
    that ends, since its device is lost or its machine is, starts again up to 8 times, and so often it is given the same pairs; then the
    run ends.

    Parameters
    ----------
    pairs, folder : str
        Paths that all machines see, or URIs.
    device : str, optional
        As for :class:`Disparity`.
    workers : int, optional
        Number of workers; by default as many as the cluster has room for.
    cpus, gpus : float
        What a worker takes of them: parts of a GPU are possible. By default a GPU where the cluster has any.
    rows : int
        Pairs per file.
    jobs, **options
        As for :class:`Disparity`.
    told : callable
        Called with the :class:`Summary` so far.

    Returns
    -------
    Summary

    Raises
    ------
    ParameterError
        A list without ``left``, pairs of one name, a folder of other options, numbers that do not fit, and what :class:`Disparity` raises.
    FormatError
        A list that is not Parquet.
    OSError
        Files that cannot be read or written.
    ray.exceptions.RayError
        A worker has ended too often, or cannot start.
    """
    import ray
    from ray import data

    # Options are checked here, and not by a worker that starts again and again.
    _check(workers, cpus, gpus, rows)
    Disparity("cpu", jobs=jobs, **options)
    # Workers have working folders of their own.
    folder = _files.absolute(folder)
    summary, parts = Summary(), Parts(folder)
    table = in_folder(named(_table(pairs)), _files.folder_of(pairs))
    parts.begin(options)
    summary.pairs = table.num_rows
    left = _left(table, parts)
    summary.earlier = table.num_rows - left.num_rows
    told(summary)
    if left.num_rows == 0:
        return summary
    if not ray.is_initialized():
        ray.init()
    there = ray.cluster_resources()
    if gpus is None:
        gpus = 1 if there.get("GPU") else 0
    room = there.get("GPU", 0) / gpus if gpus else there.get("CPU", 1) / cpus
    blocks = [left.slice(start, rows) for start in range(0, left.num_rows, rows)]
    found = data.from_arrow(blocks).map_batches(
        Worker,
        fn_constructor_kwargs={"folder": folder, "device": device, "jobs": jobs, "options": dict(options)},
        batch_size=None,
        batch_format="pyarrow",
        compute=data.ActorPoolStrategy(size=max(1, min(workers or int(room), len(blocks)))),
        num_cpus=cpus,
        num_gpus=gpus,
        max_restarts=_RESTARTS,
        max_task_retries=_RESTARTS,
    )
    for row in found.iter_rows():
        summary.done += row["done"]
        summary.not_trusted += row["not_trusted"]
        summary.failed += row["failed"]
        told(summary)
    return summary


class Worker:
    """Matches pairs and writes their part, unless it is there."""

    def __init__(self, folder: str, device: str | None, jobs: int, options: Mapping[str, Any]) -> None:
        self._parts: Final = Parts(folder)
        self._disparity: Final = Disparity(device, jobs=jobs, **options)

    def __call__(self, pairs: Any) -> dict[str, list[int]]:
        """The numbers of a table's pairs by what became of them."""
        name = self._parts.name_of(pairs["name"].to_pylist())
        if self._parts.has(name):
            return self._tallied(name)
        columns = {column: pairs[column].to_pylist() for column in pairs.column_names}
        self._parts.write(name, pairs, self._disparity.match_rows(columns))
        return self._tallied(name)

    def _tallied(self, name: str) -> dict[str, list[int]]:
        from pyarrow import parquet

        system, path = self._parts.path(name)
        rows = parquet.read_table(path, columns=["error", "not_trusted"], filesystem=system).to_pylist()
        failed = sum(row["error"] is not None for row in rows)
        doubtful = sum(row["not_trusted"] is not None for row in rows)
        return {"done": [len(rows) - failed], "not_trusted": [doubtful], "failed": [failed]}


def _check(workers: int | None, cpus: float, gpus: float | None, rows: int) -> None:
    """Numbers that Ray would refuse late, or never.

    Raises
    ------
    ParameterError
        One does not fit.
    """
    for name, number in (("workers", workers), ("rows", rows)):
        if number is not None and not number >= 1:
            raise hsad.ParameterError(f"{name} is {number}, but it must be at least 1")
    if not cpus > 0:
        raise hsad.ParameterError(f"cpus is {cpus}, but it must be above 0")
    if gpus is not None and not (0 <= gpus <= 1 or (gpus > 1 and gpus % 1 == 0)):
        raise hsad.ParameterError(f"gpus is {gpus}, but it must be 0, a part of one, or a whole number")


def named(table: Any) -> Any:
    """The table of pairs with a name for each.

    Raises
    ------
    ParameterError
        A list without views, with views in bytes, with columns of the answer, or with pairs of one name.
    """
    import pyarrow

    if "left" not in table.column_names:
        raise hsad.ParameterError(f"the list has no column left (only {', '.join(table.column_names) or 'none'}), and maybe right")
    taken = [column for column in table.column_names if column in COLUMNS]
    if taken:
        raise hsad.ParameterError(f"the list has columns of the answer ({', '.join(taken)}): rename them or leave them out")
    for view in ("left", "right"):
        if view in table.column_names and pyarrow.types.is_binary(table.schema.field(view).type):
            raise hsad.ParameterError(
                f"the column {view} has pictures, but a list names files: ds.map_batches(hsad.ray.Disparity, ...) takes pictures, too"
            )
    if "name" not in table.column_names:
        files = [table[column].to_pylist() for column in ("left", "right", "calib") if column in table.column_names]
        names = [blake2b(repr(row).encode(), digest_size=8).hexdigest() for row in zip(*files)]
        table = table.append_column("name", pyarrow.array(names, pyarrow.string()))
    names = [str(name) for name in table["name"].to_pylist()]
    if len(set(names)) < len(names):
        seen: set[str] = set()
        twice = next(name for name in names if name in seen or seen.add(name))  # type: ignore[func-returns-value]
        raise hsad.ParameterError(f"two pairs have the name {twice}: names are one per pair, and without them files are")
    return table.set_column(table.column_names.index("name"), "name", pyarrow.array(names, pyarrow.string()))


def in_folder(table: Any, folder: str) -> Any:
    """The table of pairs with the files of a list in ``folder``: workers have working folders of their own."""
    import pyarrow

    for column in ("left", "right", "calib"):
        if column in table.column_names and not pyarrow.types.is_binary(table.schema.field(column).type):
            files = [file and _files.in_folder(folder, str(file)) for file in table[column].to_pylist()]
            table = table.set_column(table.column_names.index(column), column, pyarrow.array(files, pyarrow.string()))
    return table


def _table(pairs: str) -> Any:
    """The rows of a list.

    Raises
    ------
    FormatError
        It is not Parquet, or its files have columns of other kinds.
    """
    import pyarrow
    from pyarrow import dataset

    system, path = _files.file_system(pairs)
    try:
        return dataset.dataset(path, format="parquet", filesystem=system).to_table()
    except (pyarrow.ArrowInvalid, pyarrow.ArrowTypeError) as error:
        raise hsad.FormatError(f"{pairs}: the list is a Parquet file, or a folder of them alike, but: {error}") from error


def _left(table: Any, parts: Parts) -> Any:
    """The pairs that no earlier run has written.

    Raises
    ------
    ParameterError
        A name that stands for other files, or for another geometry, than in an earlier run.
    """
    import pyarrow

    written = parts.written()
    keep = []
    for row in table.select([column for column in table.column_names if column in ("name", *INPUT)]).to_pylist():
        name, now = row["name"], input_of(row)
        differ = [column for column in INPUT if now[column] != written.get(name, now)[column]]
        if differ:
            raise hsad.ParameterError(f"the maps of {name} in {parts.folder} are of another {' and '.join(differ)}: name another folder")
        keep.append(name not in written)
    return table.filter(pyarrow.array(keep, pyarrow.bool_()))
