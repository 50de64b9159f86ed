"""The output folder of a run: Parquet files, each written whole, named by the pairs in it."""

import json
from collections.abc import Iterable, Mapping
from hashlib import blake2b
from typing import Any, Final
from uuid import uuid4

import hsad

from . import _files
from ._disparity import COLUMNS, INPUT, is_none

# Readers of data sets pass over names that begin so.
_RECIPE: Final = "_hsad.json"
_TEMPORARY: Final = "_new-"

# Kinds of file systems, as pyarrow names them, whose files appear when they are closed.
_WHOLE: Final = ("s3", "gcs", "abfs")


def input_of(row: Mapping[str, Any]) -> dict[str, Any]:
    """What the map of a row depends on; None for what it lacks."""
    return {column: None if is_none(row.get(column)) else row[column] for column in INPUT}


class Parts:
    """A folder of parts; it is found again by workers on other machines."""

    def __init__(self, folder: str) -> None:
        self.folder: Final = folder

    def path(self, name: str) -> tuple[Any, str]:
        """The file system and the path of a file."""
        system, path = _files.file_system(self.folder)
        return system, f"{path}/{name}"

    def begin(self, options: Mapping[str, Any]) -> None:
        """Makes the folder, or checks that an earlier run has matched its pairs by the same options and version.

        Raises
        ------
        ParameterError
            They differ.
        """
        from pyarrow import fs

        system, path = self.path(_RECIPE)
        recipe = {"version": hsad.__version__, "options": dict(sorted(options.items()))}
        system.create_dir(path.rpartition("/")[0], recursive=True)
        if system.get_file_info(path).type == fs.FileType.NotFound:
            self._write(_RECIPE, json.dumps(recipe, indent=2).encode())
            return
        with system.open_input_stream(path) as stream:
            earlier = json.loads(stream.read())
        if earlier != recipe:
            raise hsad.ParameterError(
                f"{self.folder}: its pairs are matched with other options or by another version ({json.dumps(earlier)}): name another folder"
            )

    def written(self) -> dict[str, dict[str, Any]]:
        """Names of pairs whose maps are there, with what these depend on; pairs that failed are taken out, and are tried again."""
        found: dict[str, dict[str, Any]] = {}
        for path, table in self._tables():
            rows = table.to_pylist()
            failed = [row["error"] is not None for row in rows]
            if any(failed):
                self._without(path, failed)
            kept = (row for row, is_failed in zip(rows, failed) if not is_failed)
            found |= {row["name"]: input_of(row) for row in kept}
        return found

    def _tables(self) -> Iterable[tuple[str, Any]]:
        from pyarrow import fs, parquet

        system, path = _files.file_system(self.folder)
        for info in sorted(system.get_file_info(fs.FileSelector(path)), key=lambda info: info.path):
            if info.base_name.startswith(_TEMPORARY):
                system.delete_file(info.path)
            elif info.base_name.startswith("part-"):
                there = set(parquet.read_schema(info.path, filesystem=system).names)
                columns = [name for name in ("name", *INPUT, "error") if name in there]
                yield info.path, parquet.read_table(info.path, columns=columns, filesystem=system)

    def _without(self, path: str, rows: list[bool]) -> None:
        """Writes a part again without some of its rows."""
        import pyarrow
        from pyarrow import parquet

        system, _ = _files.file_system(self.folder)
        kept = parquet.read_table(path, filesystem=system).filter(pyarrow.array([not row for row in rows]))
        if kept.num_rows == 0:
            system.delete_file(path)
        else:
            self._write_table(path.rpartition("/")[2], kept)

    def name_of(self, names: Iterable[str]) -> str:
        """The file of these pairs: the same ones have the same file, whoever matches them and however often."""
        text = "\0".join(names)
        return f"part-{blake2b(text.encode(), digest_size=12).hexdigest()}.parquet"

    def has(self, name: str) -> bool:
        """Whether the file is there."""
        from pyarrow import fs

        system, path = self.path(name)
        return bool(system.get_file_info(path).type == fs.FileType.File)

    def write(self, name: str, pairs: Any, answer: Mapping[str, Any]) -> None:
        """Writes the part of `pairs`, a table of pyarrow, with the columns that were found."""
        import pyarrow

        for column, kind in COLUMNS.items():
            pairs = pairs.append_column(column, pyarrow.array(answer[column], getattr(pyarrow, kind)()))
        self._write_table(name, pairs)

    def _write_table(self, name: str, table: Any) -> None:
        import pyarrow
        from pyarrow import parquet

        out = pyarrow.BufferOutputStream()
        # Maps are compressed already.
        packed = [column for column in table.column_names if column not in ("disparity", "confidence")]
        parquet.write_table(table, out, compression={column: "zstd" for column in packed}, use_dictionary=packed)
        self._write(name, out.getvalue())

    def _write(self, name: str, data: Any) -> None:
        """Writes a file that appears whole or not at all: object stores do so by themselves."""
        system, path = self.path(name)
        if system.type_name in _WHOLE:
            with system.open_output_stream(path) as stream:
                stream.write(data)
            return
        _, temporary = self.path(f"{_TEMPORARY}{uuid4().hex}")
        with system.open_output_stream(temporary) as stream:
            stream.write(data)
        try:
            system.move(temporary, path)
        except OSError:
            # HDFS moves onto no file. Without the old one, its pairs are matched again.
            if not self.has(name):
                raise
            system.delete_file(path)
            system.move(temporary, path)
