"""Documentation, types and options: what is described is what there is."""

import doctest
import inspect
import shutil
import subprocess
import sys
from typing import get_args, get_type_hints

import pytest

import hsad
import hsad.cv
from hsad.types import MatchOptions, PointOptions

PUBLIC = [getattr(hsad, name) for name in hsad.__all__ if name != "__version__"]


def described(thing):
    """The thing and its public methods."""
    yield thing
    if inspect.isclass(thing):
        for name, member in vars(thing).items():
            if not name.startswith("_") and callable(member):
                yield member


@pytest.mark.parametrize("thing", [hsad, hsad.cv, *PUBLIC, hsad.cv.StereoSGBM_create, hsad.cv.StereoBM_create])
def test_examples_in_the_documentation_are_true(thing):
    for part in [thing] if inspect.ismodule(thing) else described(thing):
        text = inspect.getdoc(part)
        assert text, part
        name = getattr(part, "__name__", str(part))
        test = doctest.DocTestParser().get_doctest(text, {"hsad": hsad}, name, None, None)
        assert doctest.DocTestRunner().run(test).failed == 0, name


def test_the_documentation_has_examples():
    lacking = [thing.__name__ for thing in PUBLIC if inspect.isbuiltin(thing) and ">>>" not in thing.__doc__]
    # Those of files and of rectification need files and scenes: see test_parts.py.
    assert all(name.startswith(("read_", "write_")) or name in ("rectify", "error_colors", "match_encoded", "cut_tiles", "match_tile", "merge_tiles") for name in lacking), lacking


def test_types_are_those_of_the_module():
    pytest.importorskip("mypy", reason="NOT RUN: mypy is not installed")
    ran = subprocess.run([sys.executable, "-m", "mypy.stubtest", "hsad._hsad"], capture_output=True, text=True)
    assert ran.returncode == 0, ran.stdout


def test_every_option_has_a_type():
    """An option of the library appears here by itself; its type is written by hand."""
    options = hsad.options()
    assert get_type_hints(MatchOptions).keys() == {option["name"] for option in options}
    points = {option["name"] for option in options if option["heading"] == "Interest points"}
    assert get_type_hints(PointOptions).keys() == points
    for option in options:
        given, none = get_args(get_type_hints(MatchOptions)[option["name"]])
        assert none is type(None)
        if option["kind"] == "choice":
            assert [str(value) for value in get_args(given)] == option["choices"], option["name"]
        else:
            assert given is {"flag": bool, "whole": int, "number": float}[option["kind"]], option["name"]


def test_the_command_has_the_same_options():
    command = shutil.which("hsad")
    if command is None:
        pytest.skip("NOT RUN: the command hsad is not in PATH")
    text = subprocess.run([command, "match", "--help"], capture_output=True, text=True, check=True).stdout
    for option in hsad.options():
        assert f"--{option['name'].replace('_', '-')}" in text, option["name"]
        for choice in option["choices"]:
            assert choice in text
