"""Bytes of files by path or URI."""

import os
from typing import Any

import hsad

LOCAL = "file://"


def read(place: str) -> bytes:
    """The bytes of a file: a path, or a URI of a file system that pyarrow knows (``s3://``, ``gs://``, ``abfs://``, ``hdfs://``)."""
    if "://" not in place or place.startswith(LOCAL):
        with open(place.removeprefix(LOCAL), "rb") as file:
            return file.read()
    system, path = file_system(place)
    with system.open_input_stream(path) as stream:
        data: bytes = stream.read()
    return data


def absolute(place: str) -> str:
    """A path from the root on, which means the same to processes in other folders; URIs as they are."""
    return place if "://" in place else os.path.abspath(place)


def file_system(place: str) -> tuple[Any, str]:
    """The file system of a path or URI, and the path there."""
    from pyarrow import ArrowInvalid, fs

    if "://" not in place:
        return fs.LocalFileSystem(), absolute(place)
    try:
        system, path = fs.FileSystem.from_uri(place)
    except ArrowInvalid as error:
        raise hsad.ParameterError(f"{place} is not the URI of a file system that pyarrow knows: {error}") from error
    return system, path
