"""The programs of examples/python/, run as their users run them."""

import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import DATA

import hsad

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "python"
LEFT, RIGHT = (DATA / "curved" / f"{side}.png" for side in ("left", "right"))


@pytest.fixture
def calibration(tmp_path):
    path = tmp_path / "calib.txt"
    path.write_text("cam0=[388 0 169.5; 0 388 127; 0 0 1]\ncam1=[388 0 180.5; 0 388 127; 0 0 1]\ndoffs=11\nbaseline=95\n")
    return path


def run(name, *arguments):
    program = [sys.executable, "-W", "ignore", EXAMPLES / name, *arguments]
    ran = subprocess.run(program, capture_output=True, text=True, timeout=300)
    assert ran.returncode == 0, ran.stderr
    return ran.stdout


def needs(module):
    """The module; also those that are there and lack a library of the system are not."""
    return pytest.importorskip(module, exc_type=ImportError, reason=f"NOT RUN: {module} is not installed")


def test_depth(tmp_path, calibration):
    told = run("depth.py", LEFT, RIGHT, tmp_path, calibration)
    assert "trust 0." in told
    assert hsad.read_image(tmp_path / "disparity.png").shape == (255, 340, 4)
    points, colors = hsad.read_ply(tmp_path / "cloud.ply")
    assert len(points) > 80_000 and 0.5 < np.median(points[:, 2]) < 2 and colors.std() > 10


def test_opencv(tmp_path):
    needs("cv2")
    told = run("opencv.py", LEFT, RIGHT, "64", tmp_path / "map.png")
    assert told.startswith("int16, -16 to ")
    assert hsad.read_image(tmp_path / "map.png").shape == (255, 340, 4)


def test_video(tmp_path, scene):
    cv2 = needs("cv2")
    # JPEG in a video has even sides.
    height, width = (side // 2 * 2 for side in scene.truth.shape)
    left, right = (view[:height, :width, ::-1] for view in (scene.left, scene.right))
    path = tmp_path / "pair.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 25, (2 * width, height))
    assert writer.isOpened()
    for _ in range(5):
        writer.write(np.hstack([left, right]))
    writer.release()
    told = run("video.py", path, "--save", tmp_path / "maps.avi")
    assert told.startswith("5 frames, ")
    video = cv2.VideoCapture(str(tmp_path / "maps.avi"))
    assert video.get(cv2.CAP_PROP_FRAME_COUNT) == 5
    there, frame = video.read()
    assert there and frame.shape == (height, width, 3) and frame.std() > 20


def test_notebook():
    needs("ipykernel")
    nbformat, nbclient = needs("nbformat"), needs("nbclient")
    notebook = nbformat.read(EXAMPLES / "cloud.ipynb", as_version=4)
    assert not any(cell.get("outputs") for cell in notebook.cells), "outputs are not committed"
    nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(EXAMPLES)}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert sum("image/png" in output.get("data", {}) for output in outputs) == 2
    page = next(output.data["text/html"] for output in outputs if "text/html" in output.get("data", {}))
    assert "<canvas" in page and len(page) > 300_000, "the cloud is in the page"


def test_rerun(tmp_path, calibration):
    needs("rerun")
    told = run("rerun_log.py", LEFT, RIGHT, calibration, tmp_path / "pair.rrd")
    assert int(told.split()[0]) > 50
    bytes_ = (tmp_path / "pair.rrd").read_bytes()
    assert bytes_.startswith(b"RRF") and len(bytes_) > 500_000
    assert all(name in bytes_ for name in (b"DepthImage", b"Pinhole", b"world/left/depth", b"confidence", b"LineStrips2D"))


@pytest.mark.parametrize("library", ["dask", "daft"])
def test_tables_of_pairs(library, tmp_path):
    needs(f"{library}.dataframe")
    parquet, pyarrow = needs("pyarrow.parquet"), needs("pyarrow")
    views = {"left": str(LEFT), "right": str(RIGHT)}
    rows = [views | {"number": 0}, views | {"number": 1, "right": str(tmp_path / "none.png")}]
    parquet.write_table(pyarrow.Table.from_pylist(rows), tmp_path / "pairs.parquet")
    run(f"{library}_pairs.py", tmp_path / "pairs.parquet", tmp_path / "out")
    found = {row["number"]: row for row in parquet.read_table(tmp_path / "out").to_pylist()}
    assert "none.png" in found[1]["error"] and found[1]["disparity"] is None and found[0]["error"] is None
    assert found[0]["disparity"] == hsad.match_encoded(LEFT.read_bytes(), RIGHT.read_bytes()).disparity_png


def test_open3d(tmp_path, calibration):
    needs("open3d")
    run("open3d_cloud.py", LEFT, RIGHT, calibration, tmp_path / "cloud.ply")
    points, colors = hsad.read_ply(tmp_path / "cloud.ply")
    # Upright for Open3D, and in front of it.
    assert len(points) > 10_000 and -2 < np.median(points[:, 2]) < -0.5 and colors.std() > 10


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_ros_node(scene):
    rclpy = needs("rclpy")
    messages, stereo = needs("sensor_msgs.msg"), needs("stereo_msgs.msg")
    sys.path.insert(0, str(EXAMPLES))
    from ros2_node import Stereo

    rclpy.init(args=["--ros-args", "-p", "disparities:=64"])
    node, tester = Stereo(), rclpy.create_node("tester")
    answers = {}
    tester.create_subscription(stereo.DisparityImage, "disparity", lambda m: answers.update(disparity=m), 1)
    tester.create_subscription(messages.PointCloud2, "points2", lambda m: answers.update(points=m), 1)
    publishers = []
    for side, view, shift in (("left", scene.left, 0.0), ("right", scene.right, -388 * 0.095)):
        height, width, _ = view.shape
        image = messages.Image(height=height, width=width, encoding="bgr8", step=3 * width, data=view[..., ::-1].tobytes())
        image.header.stamp.sec, image.header.frame_id = 7, "camera"
        info = messages.CameraInfo(p=[388.0, 0, 169.5 + 11 * (side == "right"), shift, 0, 388, 127, 0, 0, 0, 1, 0])
        publishers.append((tester.create_publisher(messages.CameraInfo, f"{side}/camera_info", 1), info))
        publishers.append((tester.create_publisher(messages.Image, f"{side}/image_rect", 1), image))
    executor = rclpy.executors.SingleThreadedExecutor()
    executor.add_node(node)
    executor.add_node(tester)
    until = time.time() + 60
    while len(answers) < 2 and time.time() < until:
        for publisher, message in publishers:
            publisher.publish(message)
        for _ in range(10):
            executor.spin_once(timeout_sec=0.05)
    rclpy.shutdown()
    disparity, cloud = answers["disparity"], answers["points"]
    assert (disparity.f, round(disparity.t, 6), disparity.header.frame_id) == (388, 0.095, "camera")
    values = np.frombuffer(bytes(disparity.image.data), "<f4").reshape(scene.truth.shape)
    expected, _ = hsad.Matcher(scene.size, 64, preset="fast").match(scene.left, scene.right)
    assert np.array_equal(values, np.nan_to_num(expected, nan=-1))
    points = np.frombuffer(bytes(cloud.data), "<f4").reshape(-1, 4)[:, :3]
    assert len(points) == np.isfinite(expected).sum() and 0.5 < np.median(points[:, 2]) < 2
