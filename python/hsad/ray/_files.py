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


def folder_of(pairs: str) -> str:
    """The folder of a list of pairs, which may be one of several files, from the root on."""
    from pyarrow.fs import FileType

    system, path = file_system(pairs)
    place = absolute(pairs.rstrip("/"))
    return place if system.get_file_info(path).type == FileType.Directory else os.path.dirname(place)


def in_folder(folder: str, place: str) -> str:
    """A path of a list, which is relative to the folder of the list, from the root on; URIs as they are.

    Raises
    ------
    ParameterError
        The folder is a URI with parameters, behind which no path can stand.
    """
    if "://" in place or os.path.isabs(place):
        return place
    if "://" in folder and "?" in folder:
        raise hsad.ParameterError(f"{place} is relative to {folder}, which has parameters: the list needs URIs of views")
    return f"{folder}/{place}"


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
