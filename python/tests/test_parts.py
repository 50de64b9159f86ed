"""Interest points, depth and points, scores, colours, files."""

import numpy as np
import pytest

import hsad


def test_interest_points_match(scene):
    left, right = (hsad.features(view) for view in (scene.left, scene.right))
    assert len(left) == left.positions.shape[0] == left.scales.size == left.responses.size == left.dark.size
    assert left.descriptors.shape == (len(left), 64) and left.found == len(left) and left.dark.dtype == bool
    assert not left.orientations.any() and hsad.features(scene.left, oriented=True).orientations.any()
    assert np.allclose(np.linalg.norm(left.descriptors, axis=1), 1, atol=1e-3)
    indices, confidences, distances = hsad.match_features(left, right, max_dy=1.5)
    assert indices.shape == (confidences.size, 2) and (np.diff(confidences) <= 0).all() and (distances <= 2).all()
    first, second = left.positions[indices[:, 0]], right.positions[indices[:, 1]]
    x, y = np.rint(first).astype(int).T
    errors = np.abs(first[:, 0] - second[:, 0] - scene.truth[y, x])
    assert len(indices) > 100 and np.mean(errors < 2) > 0.8
    assert len(hsad.match_features(left, right, strongest=10)[0]) == 10
    assert len(hsad.features(scene.left, max_features=50)) == 50
    with pytest.raises(hsad.ParameterError, match="ratio is 2"):
        hsad.match_features(left, right, ratio=2.0)
    with pytest.raises(hsad.ParameterError, match="octaves is 6"):
        hsad.features(scene.left, octaves=6)


def test_depth_and_points_by_hand():
    calibration = hsad.Calibration(1000.0, 0.2, cx=1.0, cy=0.5, doffs=30.0)
    depth = hsad.depth([[10.0, -30.0, np.nan]], calibration)
    assert depth.dtype == np.float32 and depth[0, 0] == 5.0 and np.isinf(depth[0, 1]) and np.isnan(depth[0, 2])
    points, colors = hsad.points(depth, np.array([[[1, 2, 3]] * 3], np.uint8), calibration)
    assert points.tolist() == [[np.float32(-0.005), np.float32(-0.0025), 5.0]] and colors.tolist() == [[1, 2, 3]]
    for numbers in [(0.0, 1.0), (1.0, float("nan"))]:
        with pytest.raises(hsad.ParameterError, match="10\\^-6 to 10\\^6"):
            hsad.Calibration(*numbers, cx=0.0, cy=0.0)


def rig(folder, turn):
    """The calibration of two cameras 0.1 apart, of which the right one is turned."""
    path = folder / "rig.yml"
    matrices = [
        ("M1", 3, [500.0, 0, 170, 0, 500, 127, 0, 0, 1]),
        ("D1", 1, [0.0] * 5),
        ("M2", 3, [500.0, 0, 170, 0, 500, 127, 0, 0, 1]),
        ("D2", 1, [0.0] * 5),
        ("R", 3, np.asarray(turn).ravel().tolist()),
        ("T", 3, [-0.1, 0.001, 0.0]),
    ]
    path.write_text(
        "%YAML:1.0\n---\n"
        + "".join(
            f"{name}: !!opencv-matrix\n   rows: {rows}\n   cols: {len(data) // rows}\n   dt: d\n   data: {data}\n"
            for name, rows, data in matrices
        )
    )
    return path


def test_calibrations_are_read(tmp_path):
    file = tmp_path / "calib.txt"
    file.write_text("cam0=[999.4 0 294.2; 0 999.4 252.7; 0 0 1]\ncam1=[999.4 0 327 ; 0 999.4 252.7; 0 0 1]\ndoffs=32.8\nbaseline=193\n")
    calibration = hsad.read_calibration(file)
    assert (calibration.focal, calibration.baseline, calibration.cx, calibration.cy) == (999.4, 0.193, 294.2, 252.7)
    assert calibration.is_rectified and abs(calibration.doffs - 32.8) < 1e-9 and calibration.notes == []
    taken = hsad.read_calibration(rig(tmp_path, np.eye(3)), unit=1.0)
    assert not taken.is_rectified
    with pytest.raises(hsad.ParameterError, match="rectify the pair by it first"):
        hsad.depth([[1.0]], taken)
    with pytest.raises(OSError, match="none.yml"):
        hsad.read_calibration(tmp_path / "none.yml")
    file.write_text("nonsense")
    with pytest.raises(hsad.FormatError, match="no calibration that hsad knows"):
        hsad.read_calibration(file)


def test_a_calibration_rectifies(scene, tmp_path):
    calibration = hsad.Calibration(500.0, 0.1, cx=170.0, cy=127.0)
    pair = hsad.rectify(scene.left, scene.right, calibration)
    own = pair.calibration
    assert own is not None and own.baseline == pytest.approx(0.1) and pair.report["method"] == "calibrated"
    found = pair.match()
    depth = hsad.depth(found.disparity, own)
    assert 0.5 < np.nanmedian(depth) < 5.0
    assert found.warnings == [] and found.not_trusted is None


def test_a_calibration_of_other_cameras_is_told(scene, tmp_path):
    turn = [[1, 0, 0], [0, np.cos(0.03), -np.sin(0.03)], [0, np.sin(0.03), np.cos(0.03)]]
    calibration = hsad.read_calibration(rig(tmp_path, turn), unit=1.0)
    found = hsad.rectify(scene.left, scene.right, calibration).match(preset="fast")
    assert any("the calibration does not fit the pictures, and no depth follows" in warning for warning in found.warnings)
    assert found.report["warnings"] == found.warnings


def test_scores_by_hand():
    nan = np.nan
    score = hsad.evaluate([[1.0, 5.0, nan, 9.0]], [[1.5, 2.0, 3.0, nan]], thresholds=[1.0])
    assert (score["pixels"], score["estimated"], score["average_error_px"]) == (3, 2, 1.75)
    assert score["bad"] == [{"above_px": 1.0, "of_all": 2 / 3, "of_estimated": 0.5}]
    masked = hsad.evaluate([[1.0, 5.0]], [[1.0, 2.0]], [[True, False]])
    assert masked["pixels"] == 1 and masked["rms_error_px"] == 0
    assert hsad.evaluate([[nan]], [[1.0]])["average_error_px"] is None
    with pytest.raises(hsad.ParameterError):
        hsad.evaluate([[1.0]], [[1.0, 2.0]])
    with pytest.raises(hsad.ParameterError, match="threshold is -1"):
        hsad.evaluate([[1.0]], [[1.0]], thresholds=[-1.0])


def test_colours():
    colors = hsad.colorize([[np.nan, 1.0, 9.0]])
    assert colors.dtype == np.uint8 and not colors[0, 0].any() and colors[0, 1, 2] > 100 and colors[0, 2, 0] > 100
    assert np.array_equal(hsad.colorize([[5.0]], (1.0, 9.0)), hsad.colorize([[5.0]], (4.0, 6.0)))
    errors = hsad.error_colors([[1.0, 9.0, np.nan]], [[1.0, 1.0, 1.0]], [[1, 1, 0]])
    assert errors.tolist() == [[[44, 123, 182], [215, 25, 28], [85, 85, 85]]]
    with pytest.raises(hsad.ParameterError):
        hsad.error_colors([[1.0]], [[1.0, 2.0]])


def test_maps_come_back_from_files(tmp_path):
    disparity = np.array([[0.5, -3.25, np.nan], [0.0, 255.5, 300.0]], np.float32)
    pfm, png = tmp_path / "map.pfm", tmp_path / "map.png"
    hsad.write_pfm(pfm, disparity)
    for read in (hsad.read_pfm, hsad.read_disparity):
        again = read(pfm)
        assert again.dtype == np.float32 and np.array_equal(again, disparity, equal_nan=True)
    with pytest.warns(UserWarning, match="disparities lie outside"):
        assert hsad.write_kitti(png, disparity) is False
    for read in (hsad.read_kitti, hsad.read_disparity):
        assert np.array_equal(read(png), disparity, equal_nan=True)
    assert hsad.write_kitti(png, disparity[:1, :1].astype(np.float64)[:, ::-1]) is True
    assert hsad.read_kitti(png).tolist() == [[0.5]]


def test_clouds_come_back_from_files(tmp_path):
    points = np.array([[1, 2, 3], [-4, 5.5, 6]], np.float64)
    colors = np.array([[1, 2, 3], [255, 0, 7]], np.uint8)
    path = tmp_path / "cloud.ply"
    hsad.write_ply(path, points, colors)
    again, colors_again = hsad.read_ply(str(path))
    assert again.dtype == np.float32 and np.array_equal(again, points) and np.array_equal(colors_again, colors)
    hsad.write_ply(path, points[:1])
    assert hsad.read_ply(path)[1].tolist() == [[255, 255, 255]]
    with pytest.raises(hsad.ParameterError, match="2 points, but 1 colors"):
        hsad.write_ply(path, points, colors[:1])
    with pytest.raises(hsad.ParameterError, match="must be \\(n, 3\\)"):
        hsad.write_ply(path, points[:, :2])


def test_pictures_come_back_from_files(tmp_path, scene):
    path = tmp_path / "picture.png"
    for picture in (scene.left, scene.left[..., 0], np.dstack([scene.left, scene.left[..., :1]])):
        hsad.write_png(path, picture)
        again = hsad.read_image(path)
        assert again.dtype == np.uint8 and again.shape == (*picture.shape[:2], 4)
        assert np.array_equal(again[..., 0], picture if picture.ndim == 2 else picture[..., 0])
    with pytest.raises(hsad.ParameterError, match="uint8"):
        hsad.write_png(path, scene.truth)
    with pytest.raises(FileNotFoundError, match="none.png"):
        hsad.read_image(tmp_path / "none.png")
    with pytest.raises(OSError):
        hsad.write_png(tmp_path / "none" / "picture.png", scene.left)
    path.write_text("not at all")
    with pytest.raises(hsad.FormatError, match="not a picture"):
        hsad.read_image(path)
