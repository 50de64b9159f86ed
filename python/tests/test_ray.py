"""hsad.ray: batches of pairs without Ray, and a cluster of two nodes where it is installed."""

import json
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from conftest import DATA

import hsad
import hsad.ray
from hsad.ray import _disparity, _files, _gpus, _parts, _run
from hsad.ray._disparity import is_none


def pairs(folder, count):
    """Small pairs, each another part of a scene; their names and files."""
    left, right = hsad.read_pair(DATA / "curved" / "left.png", DATA / "curved" / "right.png")
    rows = []
    for index in range(count):
        part = np.s_[8 * index : 8 * index + 100, 40:280, :3]
        files = [str(folder / f"{side}-{index}.png") for side in ("left", "right")]
        for file, view in zip(files, (left, right)):
            hsad.write_png(file, np.ascontiguousarray(view[part]))
        rows.append({"name": f"pair-{index}", "left": files[0], "right": files[1]})
    return rows


def columns(rows):
    return {name: np.array([row[name] for row in rows], object) for name in rows[0]}


def by_the_command(row, folder, *options):
    """The maps that the command writes for a pair."""
    command = shutil.which("hsad")
    if command is None:
        pytest.skip("NOT RUN: the command hsad is not in PATH")
    ran = subprocess.run([command, "match", row["left"], row["right"], "-o", folder, "-q", *options], capture_output=True, text=True)
    assert ran.returncode in (0, 4, 5), ran.stderr
    return [(folder / name).read_bytes() for name in ("disparity.png", "confidence.png")]


def test_maps_are_those_of_the_command(tmp_path):
    rows = pairs(tmp_path, 2)
    found = hsad.ray.Disparity()(columns(rows))
    assert list(found["error"]) == [None, None] and list(found["name"]) == ["pair-0", "pair-1"]
    for index, row in enumerate(rows):
        expected = by_the_command(row, tmp_path / str(index))
        assert [found["disparity"][index], found["confidence"][index]] == expected
        assert (found["width"][index], found["height"][index]) == (240, 100)
        report = json.loads(found["report"][index])
        assert report["left"] == row["left"] and report["trust"] == pytest.approx(found["trust"][index])
        assert report["range"]["min"] == found["range_min"][index]


def test_a_calibration_is_followed_as_by_the_command(tmp_path):
    (row,) = pairs(tmp_path, 1)
    geometry = {"focal": [388.0], "baseline": [0.095], "doffs": [None]}
    found = hsad.ray.Disparity()({**{name: [value] for name, value in row.items()}, **geometry})
    assert found["error"][0] is None and json.loads(found["report"][0])["calibration"]["focal_px"] == 388
    assert found["disparity"][0] == by_the_command(row, tmp_path / "out", "--focal", "388", "--baseline", "0.095")[0]
    camera = "[388 0 119.5; 0 388 49.5; 0 0 1]"
    (tmp_path / "calib.txt").write_text(f"cam0={camera}\ncam1={camera}\ndoffs=0\nbaseline=95\n")
    files = {"calib": [str(tmp_path / "calib.txt")]}
    by_file = hsad.ray.Disparity()({**{name: [value] for name, value in row.items()}, **files})
    assert json.loads(by_file["report"][0])["calibration"] == json.loads(found["report"][0])["calibration"]


def test_pictures_are_taken_as_bytes_and_maps_given_as_tensors(tmp_path):
    rows = pairs(tmp_path, 2)
    batch = {side: [Path(row[side]).read_bytes() for row in rows] for side in ("left", "right")} | {"number": [7, 8]}
    tensors = hsad.ray.Disparity(maps="tensor", jobs=1)(batch)
    assert list(tensors) == ["number", *hsad.ray.COLUMNS] and list(tensors["number"]) == [7, 8]
    pngs = hsad.ray.Disparity()(batch)
    for index in range(2):
        path = tmp_path / "map.png"
        path.write_bytes(pngs["disparity"][index])
        assert tensors["disparity"][index].dtype == np.float32
        assert np.array_equal(hsad.read_kitti(path), tensors["disparity"][index], equal_nan=True)


def test_a_bad_pair_is_recorded_and_the_others_go_on(tmp_path):
    _, broken, other, missing, lacking = rows = pairs(tmp_path, 5)
    with open(broken["left"], "r+b") as file:
        file.truncate(500)
    hsad.write_png(other["right"], np.zeros((20, 30), np.uint8))
    missing["right"] = str(tmp_path / "none.png")
    lacking["left"] = None
    found = hsad.ray.Disparity()(columns(rows))
    assert found["error"][0] is None and found["disparity"][0]
    for error, told in zip(found["error"][1:], ("cut off", "240x100", "none.png", "no left view")):
        assert told in error, error
    for name, value in (("disparity", None), ("report", None), ("width", 0), ("range_max", 0)):
        assert all(found[name][index] == value for index in range(1, 5)), name
    assert np.isnan(found["trust"][1:]).all() and found["trust"][0] > 0


def test_mistakes_are_told_before_a_pair_is_read(tmp_path):
    with pytest.raises(hsad.ParameterError, match="preset"):
        hsad.ray.Disparity(preset="quick")
    with pytest.raises(hsad.DeviceError, match="no device matches"):
        hsad.ray.Disparity("pci:0000:ff:1f.7")
    with pytest.raises(hsad.ParameterError, match="maps"):
        hsad.ray.Disparity(maps="tiff")
    match = hsad.ray.Disparity()
    with pytest.raises(hsad.ParameterError, match="no column left"):
        match({"first": ["a.png"]})
    with pytest.raises(hsad.ParameterError, match="a column trust"):
        match({"left": ["a.png"], "right": ["b.png"], "trust": [1.0]})


def test_a_relative_folder_is_the_same_one_to_workers_elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert _files.absolute("out") == str(tmp_path / "out") and _files.absolute("s3://bucket/out") == "s3://bucket/out"


def test_a_list_with_columns_of_the_answer_is_refused():
    pyarrow = pytest.importorskip("pyarrow", reason="NOT RUN: pyarrow is not installed")
    listed = {"left": ["a.png"], "right": ["b.png"], "note": ["c"]}
    assert _run.named(pyarrow.table(listed)).column_names == ["left", "right", "note", "name"]
    with pytest.raises(hsad.ParameterError, match=r"columns of the answer \(width, error\): rename them"):
        _run.named(pyarrow.table(listed | {"width": [0], "error": ["lost"]}))


def test_files_of_a_list_lie_in_its_folder(tmp_path, monkeypatch):
    pyarrow = pytest.importorskip("pyarrow", reason="NOT RUN: pyarrow is not installed")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lists").mkdir()
    (tmp_path / "lists/pairs.parquet").touch()
    folder = str(tmp_path / "lists")
    assert [_files.folder_of(pairs) for pairs in ("lists/pairs.parquet", "lists", f"{folder}/", f"file://{folder}")] == [folder] * 3 + [
        f"file://{folder}"
    ]
    views = {"left": ["a/l.png", "/b/l.png", "s3://c/l.png"], "right": ["a/r.png", None, None], "calib": [b"f B", b"", None], "focal": [1, 2, 3]}
    placed = _run.in_folder(pyarrow.table(views), folder).to_pydict()
    assert placed == views | {"left": [f"{folder}/a/l.png", *views["left"][1:]], "right": [f"{folder}/a/r.png", None, None]}
    assert _files.in_folder("s3://bucket/lists", "l.png") == "s3://bucket/lists/l.png"
    with pytest.raises(hsad.ParameterError, match="l.png is relative to s3://bucket/lists.region=x, which has parameters"):
        _files.in_folder("s3://bucket/lists?region=x", "l.png")


def test_mistakes_are_told_before_the_folder_is_made(tmp_path):
    pytest.importorskip("pyarrow", reason="NOT RUN: pyarrow is not installed")
    pytest.importorskip("ray.data", exc_type=ImportError, reason="NOT RUN: Ray Data is not installed (ray[data])")
    listed, out = tmp_path / "pairs.csv", tmp_path / "out"
    listed.write_text("left,right\na.png,b.png\n")
    numbers = [("jobs", 0), ("rows", 0), ("workers", 0), ("cpus", 0), ("cpus", np.nan), ("gpus", -1), ("gpus", 1.5), ("gpus", np.nan)]
    for name, number in numbers:
        with pytest.raises(hsad.ParameterError, match=f"{name} is {number}, but it must be"):
            hsad.ray.run(str(listed), str(out), **{name: number})
    with pytest.raises(hsad.FormatError, match=r"pairs\.csv: the list is a Parquet file"):
        hsad.ray.run(str(listed), str(out), gpus=0)
    with pytest.raises(hsad.ParameterError, match="ftp://host/pairs is not the URI"):
        hsad.ray.run("ftp://host/pairs", str(out), gpus=2)
    with pytest.raises(FileNotFoundError):
        hsad.ray.run(str(tmp_path / "none"), str(out), gpus=0.5)
    assert not out.exists()


def test_maps_of_an_earlier_run_are_of_the_same_files_and_geometry(tmp_path):
    pyarrow = pytest.importorskip("pyarrow", reason="NOT RUN: pyarrow is not installed")
    parts = _parts.Parts(str(tmp_path / "out"))
    parts.begin({})
    row = {"name": "a", "left": "l.png", "right": None, "calib": "c.txt", "focal": 388.0, "baseline": 0.1}
    parts.write("part-0.parquet", pyarrow.Table.from_pylist([row]), {name: [value] for name, value in _disparity.nothing().items()})

    def left(*rows):
        return _run._left(pyarrow.Table.from_pylist(list(rows)), parts)["name"].to_pylist()

    assert left(row | {"doffs": np.nan}, row | {"name": "b", "calib": "d.txt"}) == ["b"]
    for changed in ({"left": "m.png"}, {"right": "r.png"}, {"calib": None}, {"focal": 400.0}, {"baseline": 1.0}, {"doffs": 2.0}):
        with pytest.raises(hsad.ParameterError, match=f"the maps of a in .*out are of another {min(changed)}: name another folder"):
            left(row | changed)
    with pytest.raises(hsad.ParameterError, match="another calib and focal"):
        left({name: row[name] for name in ("name", "left", "baseline")})


class Store:
    """A file system of another kind in a local folder, whose moves go onto no file."""

    def __init__(self, kind, fs):
        self.type_name, self.written, self._local = kind, [], fs.LocalFileSystem()
        self.get_file_info, self.delete_file = self._local.get_file_info, self._local.delete_file

    def open_output_stream(self, path):
        self.written.append(Path(path).name)
        return self._local.open_output_stream(path)

    def move(self, old, new):
        if Path(new).exists():
            raise OSError(f"{new} exists")
        self._local.move(old, new)


@pytest.mark.parametrize("kind", ["hdfs", "s3"])
def test_parts_appear_whole_on_file_systems_of_all_kinds(tmp_path, monkeypatch, kind):
    fs = pytest.importorskip("pyarrow.fs", reason="NOT RUN: pyarrow is not installed")
    store, parts = Store(kind, fs), _parts.Parts("there")
    monkeypatch.setattr(_files, "file_system", lambda _: (store, str(tmp_path)))
    for data in (b"first", b"second"):
        parts._write("part-0.parquet", data)
        assert (tmp_path / "part-0.parquet").read_bytes() == data
    assert [path.name for path in tmp_path.iterdir()] == ["part-0.parquet"]
    in_place = [name == "part-0.parquet" for name in store.written]
    assert in_place == [kind == "s3"] * 2
    if kind == "hdfs":
        # An error on the way leaves no part behind.
        with pytest.raises(TypeError):
            parts._write("part-1.parquet", None)
        assert not (tmp_path / "part-1.parquet").exists()


SMI = "0, GPU-5a, 00000000:3B:00.0\n1, GPU-77, 00000000:AF:00.0"


def test_the_gpu_that_ray_assigns_is_found_by_its_place(tmp_path, monkeypatch):
    shown = ["NVIDIA H100 (vulkan, pci:0000:af:00.0)", "NVIDIA H100 (vulkan, pci:0000:3b:00.0)", "llvmpipe (vulkan)", "cpu"]
    monkeypatch.setattr(hsad, "devices", lambda: shown)
    monkeypatch.setattr(_gpus, "_PROC", tmp_path / "none")
    # A program nvidia-smi in front of all others.
    program = tmp_path / "nvidia-smi"
    program.write_text(f"#!/bin/sh\necho '{SMI}'\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")

    def device(*assigned):
        monkeypatch.setattr(_gpus, "_assigned", lambda: list(assigned))
        return _gpus.device_of_worker()

    assert [device(), device("0"), device("1"), device("GPU-77")] == ["best", "pci:0000:3b:00.0", *["pci:0000:af:00.0"] * 2]
    with pytest.raises(hsad.DeviceError, match="GPU 2, and nothing tells where it is"):
        device("2")
    shown.pop(0)
    with pytest.raises(hsad.DeviceError, match="0000:af:00.0, and Vulkan shows no adapter there"):
        device("1")
    # Without the program, by the driver's files, and without these by the order of the places.
    program.unlink()
    monkeypatch.setenv("PATH", str(tmp_path))
    shown.insert(0, "NVIDIA H100 (vulkan, pci:0000:af:00.0)")
    assert device("1") == "pci:0000:af:00.0"
    # Ray may count integrated adapters or not, and only one of one kind is certain.
    shown.append("Intel(R) UHD Graphics 770 (vulkan, pci:0000:00:02.0)")
    with pytest.raises(hsad.DeviceError, match=r"GPU 0, and nothing tells where it is \(known: none; shown: NVIDIA.*\): name a device"):
        device("0")
    del shown[:2]
    assert device("0") == "pci:0000:00:02.0"
    shown[:] = ["NVIDIA H100 (vulkan, pci:0000:af:00.0)", "Tesla T4 (vulkan, pci:0000:3b:00.0)", shown[-1]]
    for place, uuid in (("0000:af:00.0", "GPU-77"), ("0000:3b:00.0", "GPU-5a")):
        (tmp_path / "gpus" / place).mkdir(parents=True)
        information = f"Model: \t\t NVIDIA H100\nGPU UUID: \t {uuid}\nBus Location: \t {place}\n"
        (tmp_path / "gpus" / place / "information").write_text(information)
    monkeypatch.setattr(_gpus, "_PROC", tmp_path / "gpus")
    assert [device("0"), device("GPU-77")] == ["pci:0000:3b:00.0", "pci:0000:af:00.0"]


@pytest.fixture(scope="module")
def cluster():
    """Two nodes with a processor each."""
    ray = pytest.importorskip("ray", reason="NOT RUN: Ray is not installed (ray[data])")
    pytest.importorskip("ray.data", exc_type=ImportError, reason="NOT RUN: Ray Data is not installed (ray[data])")
    from ray.cluster_utils import Cluster

    # Workers import what this process does.
    os.environ["PYTHONPATH"] = os.pathsep.join(path for path in sys.path if path)
    nodes = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    nodes.add_node(num_cpus=1)
    ray.init(address=nodes.address, log_to_driver=False)
    yield nodes
    ray.shutdown()
    nodes.shutdown()


def workers(nodes):
    """Processes of the cluster that match pairs."""
    import psutil

    for node in nodes.list_all_nodes():
        for process in node.all_processes["raylet"]:
            for child in psutil.Process(process.process.pid).children(recursive=True):
                if "MapWorker" in " ".join(child.cmdline()):
                    yield child.pid


@pytest.mark.filterwarnings("ignore")
def test_a_cluster_loses_nothing_and_doubles_nothing_when_a_worker_is_killed(tmp_path, cluster):
    parquet, pyarrow = pytest.importorskip("pyarrow.parquet"), pytest.importorskip("pyarrow")
    rows = pairs(tmp_path, 16)
    there = dict(rows[-1])
    rows[-1]["right"] = str(tmp_path / "none.png")
    listed, out = tmp_path / "pairs.parquet", tmp_path / "out"
    parquet.write_table(pyarrow.Table.from_pylist(rows), listed)
    killed = []

    def kill(so_far):
        if so_far.done and not killed:
            assert so_far.done < 8
            killed.extend(list(workers(cluster))[:1])
            os.kill(killed[0], signal.SIGKILL)

    summary = hsad.ray.run(str(listed), str(out), rows=2, jobs=1, told=kill)
    assert killed and (summary.pairs, summary.done, summary.failed) == (16, 15, 1)
    found = {row["name"]: row for row in parquet.read_table(out).to_pylist()}
    assert parquet.read_table(out).num_rows == len(found) == 16
    for row in rows[:-1]:
        expected = by_the_command(row, tmp_path / row["name"])
        assert [found[row["name"]]["disparity"], found[row["name"]]["confidence"]] == expected, row["name"]
    assert "none.png" in found["pair-15"]["error"]

    # Again: only the pair that has failed is matched, now that its file is there.
    parts = {path.name: path.stat().st_mtime_ns for path in out.iterdir()}
    shutil.copy(there["right"], rows[-1]["right"])
    command = [sys.executable, "-m", "hsad.ray", listed.name, "-o", out.name, "--address", cluster.address]
    ran = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout.splitlines()[-1].startswith("16 pairs: 1 done"), ran.stdout
    names = parquet.read_table(out)["name"].to_pylist()
    assert sorted(names) == sorted(found) and parquet.read_table(out)["error"].null_count == 16
    untouched = sum(path.name in parts and path.stat().st_mtime_ns == parts[path.name] for path in out.iterdir())
    # But for the part without the failed pair.
    assert untouched == len(parts) - 1
    ran = subprocess.run([*command, "--preset", "fast"], capture_output=True, text=True, cwd=tmp_path)
    assert ran.returncode == 1 and "other options" in ran.stderr


@pytest.mark.filterwarnings("ignore")
def test_the_class_goes_into_a_data_set_of_ray(tmp_path, cluster):
    from ray import data

    rows = pairs(tmp_path, 3)
    rows[1]["left"] = str(tmp_path / "none.png")
    one, options = data.ActorPoolStrategy(size=1), {"preset": "fast"}
    found = data.from_items(rows).map_batches(hsad.ray.Disparity, batch_size=1, compute=one, fn_constructor_kwargs=options)
    found = {row["name"]: row for row in found.take_all()}
    assert sorted(found) == ["pair-0", "pair-1", "pair-2"] and "none.png" in found["pair-1"]["error"]
    assert found["pair-2"]["disparity"] == by_the_command(rows[2], tmp_path / "out", "--preset", "fast")[0]


@pytest.mark.filterwarnings("ignore")
def test_tiles_are_cut_matched_and_put_together_by_a_cluster(tmp_path, cluster):
    from ray import data

    rows = [{"name": "curved", "left": str(DATA / "curved" / "left.png"), "right": str(DATA / "curved" / "right.png")}]
    one = data.ActorPoolStrategy(size=1)
    tiles = data.from_items(rows).flat_map(hsad.ray.CutTiles, fn_constructor_kwargs={"tiles": 256, "preset": "fast"}, compute=one)
    maps = tiles.materialize().map_batches(hsad.ray.TileDisparity, batch_size=1, compute=one).materialize()
    place = maps.to_pandas().iloc[0]
    (found,) = maps.groupby("name").map_groups(hsad.ray.MergeTiles).take_all()
    bounds = ["--min-disparity", str(place["min_disparity"]), "--disparities", str(place["disparities"])]
    assert is_none(found["error"])
    expected = by_the_command(rows[0], tmp_path / "out", "--preset", "fast", "--tiles", "256", *bounds)
    assert [found["disparity"], found["confidence"]] == expected


# The last one, since the cluster is not used after its workers have ended so.
@pytest.mark.filterwarnings("ignore")
def test_pairs_that_always_end_their_worker_end_the_run(tmp_path, cluster, monkeypatch):
    from ray.exceptions import RayError

    parquet, pyarrow = pytest.importorskip("pyarrow.parquet"), pytest.importorskip("pyarrow")
    tried = tmp_path / "tried"

    class Lost:
        def __init__(self, **_):
            pass

        def __call__(self, pairs):
            with open(tried, "a") as file:
                file.write("x")
            os._exit(1)

    monkeypatch.setattr(_run, "Worker", Lost)
    monkeypatch.setattr(_run, "_RESTARTS", 2)
    parquet.write_table(pyarrow.table({"left": ["a.png"], "right": ["b.png"]}), tmp_path / "pairs.parquet")
    with pytest.raises(RayError):
        hsad.ray.run(str(tmp_path / "pairs.parquet"), str(tmp_path / "out"))
    assert len(tried.read_text()) == 3
