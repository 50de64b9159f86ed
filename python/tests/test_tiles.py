"""Pairs in tiles: the bytes of the whole way, wherever a tile is matched."""

import pickle

import numpy as np
import pytest
from conftest import DATA

import hsad
import hsad.ray

LEFT, RIGHT = ((DATA / "curved" / f"{side}.png") for side in ("left", "right"))


def views():
    return LEFT.read_bytes(), RIGHT.read_bytes()


def test_tiles_are_matched_apart_and_put_together():
    tiles = hsad.cut_tiles(*views(), tiles=256)
    assert [(tile["x"], tile["y"], tile["width"], tile["height"]) for tile in tiles] == [(0, 0, 256, 255), (256, 0, 84, 255)]
    rows = []
    for tile in pickle.loads(pickle.dumps(tiles)):
        disparity, confidence = hsad.match_tile(tile)
        assert (disparity, confidence) == hsad.match_tile(tile, device="cpu")
        rows.append(tile | {"disparity": disparity, "confidence": confidence})
    found = hsad.merge_tiles(*views(), rows[::-1], names=("l", "r"))
    bounds = {"min_disparity": tiles[0]["min_disparity"], "disparities": tiles[0]["disparities"]}
    expected = hsad.match_encoded(*views(), tiles=256, **bounds)
    assert (found.disparity_png, found.confidence_png) == (expected.disparity_png, expected.confidence_png)
    assert found.report["left"] == "l" and found.trust == expected.trust
    assert {**found.report, "seconds": 0, "left": 0, "right": 0} == {**expected.report, "seconds": 0, "left": 0, "right": 0}


def test_tiles_that_do_not_fit_are_named(tmp_path):
    with pytest.raises(hsad.ParameterError, match="256"):
        hsad.cut_tiles(*views(), tiles=100)
    with pytest.raises(hsad.ParameterError, match="needed"):
        hsad.cut_tiles(*views())
    first, second = hsad.cut_tiles(*views(), tiles=256)
    with pytest.raises(hsad.ParameterError, match="the tile has no levels"):
        hsad.match_tile({name: value for name, value in first.items() if name != "levels"})
    with pytest.raises(hsad.ParameterError, match="left of the tile is 340x255 pixels, but its view is 340x200"):
        hsad.match_tile(first | {"view_height": 200, "height": 200})
    with pytest.raises(hsad.ParameterError, match="no part of its view"):
        hsad.match_tile(first | {"x": 200})
    with pytest.raises(hsad.ParameterError, match="all tiles of the pair"):
        disparity, confidence = hsad.match_tile(first)
        hsad.merge_tiles(*views(), [first | {"disparity": disparity, "confidence": confidence}])
    with pytest.raises(hsad.ParameterError, match="no tile"):
        hsad.merge_tiles(*views(), [])
    assert second["tile"] == 1


def test_the_classes_for_clusters_do_the_same():
    good = {"name": "good", "left": str(LEFT), "right": str(RIGHT), "number": 7}
    cut, match, merge = hsad.ray.CutTiles(tiles=256, preset="fast"), hsad.ray.TileDisparity(), hsad.ray.MergeTiles()
    tiles = [tile for row in (good, good | {"name": "bad", "right": "none.png"}) for tile in cut(row)]
    assert [(tile["name"], tile["tile"]) for tile in tiles] == [("good", 0), ("good", 1), ("bad", -1)]
    maps = match({name: np.array([tile[name] for tile in tiles], object) for name in tiles[0]})
    assert "left" not in maps and list(maps["number"]) == [7, 7, 7]
    whole, bad = (merge({name: column[part] for name, column in maps.items()}) for part in (np.s_[:2], np.s_[2:]))
    assert "none.png" in bad["error"][0] and bad["disparity"][0] is None
    assert whole["error"][0] is None and whole["left"][0] == str(LEFT) and "tile" not in whole
    bounds = {"min_disparity": int(maps["min_disparity"][0]), "disparities": int(maps["disparities"][0])}
    assert whole["disparity"][0] == hsad.match_encoded(*views(), tiles=256, preset="fast", **bounds).disparity_png


def test_columns_of_tiles_are_refused_and_groups_are_of_one_pair():
    pair = {"name": "one", "left": str(LEFT), "right": str(RIGHT)}
    cut, match, merge = hsad.ray.CutTiles(tiles=256, preset="balanced"), hsad.ray.TileDisparity(), hsad.ray.MergeTiles()
    with pytest.raises(hsad.ParameterError, match=r"columns of tiles or of the answer \(options, x, report\): rename them"):
        cut(pair | {"options": "", "x": 1, "note": 2, "report": None})
    tiles = cut(pair)
    maps = match({name: np.array([tile[name] for tile in tiles], object) for name in tiles[0]})

    def error(rows, **changed):
        columns = {name: column[rows] for name, column in maps.items()}
        columns |= {name: np.array(values, object) for name, values in changed.items()}
        (told,) = merge(columns)["error"]
        return told

    assert error([1, 0]) is None
    assert error([0, 1, 0]).startswith("the list of tiles is with more than one at (0, 0), but all tiles")
    levels, gain = (int(maps[name][0]) for name in ("levels", "gain"))
    options = maps["options"][0]
    for name, values, told in (
        ("min_disparity", [0, 1], "ranges"),
        ("disparities", [8, 9], "ranges"),
        ("gain", [gain, gain + 1], "changes of brightness"),
        ("options", [options, options.replace("balanced", "quality")], "options"),
        ("levels", [levels, levels + 1], "options"),
    ):
        assert error([0, 1], **{name: values}).startswith(f"the list of tiles is of different {told}"), name
    assert "differ in right_file:" in error([0, 1], right_file=[str(RIGHT), "other.png"])
