"""hsad.cv beside OpenCV."""

import warnings

import numpy as np
import pytest
from conftest import DATA, Scene, real_scenes

import hsad
import hsad.cv

PAIRS = [DATA / "curved", DATA / "planes", *real_scenes()]

SGBM = {
    "minDisparity": -16,
    "numDisparities": 64,
    "blockSize": 5,
    "P1": 600,
    "P2": 2400,
    "disp12MaxDiff": 1,
    "preFilterCap": 31,
    "uniquenessRatio": 10,
    "speckleWindowSize": 100,
    "speckleRange": 2,
    "mode": 1,
}


@pytest.fixture
def cv2():
    return pytest.importorskip("cv2", reason="NOT RUN: opencv-python is not installed")


def test_real_pairs_are_among_them():
    if not real_scenes():
        pytest.skip("NOT RUN: real pairs, since HSAD_REAL_PAIRS names no folder of them")
    assert len(PAIRS) > 2


def getters(matcher):
    return sorted(name for name in dir(matcher) if name.startswith("get"))


@pytest.mark.filterwarnings("ignore:.* means nothing to hsad")
def test_parameters_are_those_of_opencv(cv2):
    for make in (lambda module: module.StereoSGBM_create(), lambda module: module.StereoBM_create()):
        ours, theirs = make(hsad.cv), make(cv2)
        assert getters(ours) == getters(theirs)
        for name in getters(theirs):
            if name == "getDefaultName":
                continue
            assert getattr(ours, name)() == getattr(theirs, name)(), name
            value = (1, 2, 3, 4) if "ROI" in name else 1
            getattr(ours, name.replace("get", "set"))(value)
            getattr(theirs, name.replace("get", "set"))(value)
            assert getattr(ours, name)() == getattr(theirs, name)(), name
    ours, theirs = hsad.cv.StereoSGBM_create(**SGBM), cv2.StereoSGBM_create(**SGBM)
    assert all(getattr(ours, name)() == getattr(theirs, name)() for name in getters(theirs) if name != "getDefaultName")
    for name in vars(hsad.cv):
        if name.startswith(("StereoSGBM_", "StereoBM_", "StereoMatcher_", "STEREO_")) and not name.endswith("create"):
            assert getattr(hsad.cv, name) == getattr(cv2, name), name


@pytest.mark.filterwarnings("ignore:.* means nothing to hsad")
@pytest.mark.parametrize("path", PAIRS, ids=lambda path: path.name)
@pytest.mark.parametrize("first", [0, -16])
def test_answers_have_opencvs_form(cv2, path, first):
    scene = Scene.read(path)
    left, right = (view[..., ::-1] for view in (scene.left, scene.right))
    parameters = {**SGBM, "minDisparity": first, "numDisparities": scene.disparities - first, "mode": 0}
    ours = hsad.cv.StereoSGBM_create(**parameters).compute(left, right)
    theirs = cv2.StereoSGBM_create(**parameters).compute(np.ascontiguousarray(left), np.ascontiguousarray(right))
    invalid = (first - 1) * 16
    last = first + parameters["numDisparities"] - 1
    for answer in (ours, theirs):
        assert answer.dtype == np.int16 and answer.shape == scene.truth.shape
        assert answer.min() == invalid and (answer == invalid).any()
        valid = answer[answer != invalid]
        assert valid.min() > invalid and valid.max() < 16 * (last + 1)
    grey = [hsad_grey(view) for view in (scene.left, scene.right)]
    blocks = [module.StereoBM_create(scene.disparities, 9) for module in (hsad.cv, cv2)]
    for matcher in blocks:
        matcher.setMinDisparity(first)
        answer = matcher.compute(*grey)
        assert answer.dtype == np.int16 and answer.min() == invalid
        assert answer[answer != invalid].min() > invalid and answer.max() < 16 * (first + scene.disparities)


def hsad_grey(view):
    return (view @ np.array([0.299, 0.587, 0.114])).round().astype(np.uint8)


@pytest.mark.filterwarnings("ignore:.* means nothing to hsad")
@pytest.mark.parametrize("path", PAIRS, ids=lambda path: path.name)
def test_no_less_accurate_than_opencv(cv2, path):
    """Wrong by over 2 px or without a disparity, of the pixels that both views show."""
    scene = Scene.read(path)
    left, right = (np.ascontiguousarray(view[..., ::-1]) for view in (scene.left, scene.right))
    parameters = {**SGBM, "minDisparity": 0, "numDisparities": scene.disparities, "blockSize": 3, "P1": 216, "P2": 864, "mode": 0}
    wrong = []
    for module in (hsad.cv, cv2):
        fixed = module.StereoSGBM_create(**parameters).compute(left, right)
        disparity = np.where(fixed >= 0, fixed / np.float32(16), np.float32(np.nan))
        wrong.append(hsad.evaluate(disparity, scene.truth, scene.seen)["bad"][2]["of_all"])
    assert wrong[0] <= wrong[1] + 0.01, f"{scene.name}: {wrong[0]:.3f}, OpenCV {wrong[1]:.3f}"


def test_answers_without_opencv(dots):
    left, right = dots
    matcher = hsad.cv.StereoSGBM_create(numDisparities=16)
    answer = matcher.compute(left, right)
    assert answer.dtype == np.int16 and np.median(answer[answer >= 0]) == 7 * 16 and answer.min() >= -16
    assert np.array_equal(answer, matcher.compute(np.dstack([left] * 3), np.dstack([right] * 3)))
    to = np.zeros((60, 90), np.int16)
    assert matcher.compute(left, right, to) is to and np.array_equal(to, answer)
    matcher.setMinDisparity(-16)
    assert (matcher.compute(left, right) < 0).all()
    below = hsad.cv.StereoSGBM_create(minDisparity=-16, numDisparities=16).compute(right, left)
    assert np.median(below[below > -17 * 16]) == -7 * 16 and (below >= -17 * 16).all()


def test_a_changed_parameter_counts(dots):
    matcher = hsad.cv.StereoSGBM_create(numDisparities=16)
    assert matcher.empty()
    first = matcher.compute(*dots)
    assert not matcher.empty()
    matcher.setNumDisparities(4)
    assert (matcher.compute(*dots) < 4 * 16).all() and (first >= 6 * 16).any()
    matcher.clear()
    assert matcher.empty()


def test_what_means_nothing_warns_once(told_nothing, dots):
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        for _ in range(2):
            hsad.cv.StereoSGBM_create(0, 16, 3, P1=8, P2=32, speckleWindowSize=100)
    assert sorted(str(warning.message).split()[0] for warning in told) == ["P1", "P2", "speckleWindowSize"]
    assert all(warning.filename == __file__ for warning in told), told[0].filename


def test_errors_say_what_is_wrong(dots):
    left, right = dots
    matcher = hsad.cv.StereoSGBM_create(numDisparities=16)
    for views, words in [
        ((left, right[:, :50]), "shape"),
        ((left.astype(np.float32), right), "float32"),
        ((left, np.dstack([right] * 3)), "shape"),
    ]:
        with pytest.raises(hsad.ParameterError, match=words):
            matcher.compute(*views)
    with pytest.raises(hsad.ParameterError, match="StereoBM takes grey"):
        hsad.cv.StereoBM_create().compute(np.dstack([left] * 3), np.dstack([right] * 3))
    with pytest.raises(hsad.ParameterError, match="hsad.match has floats"):
        hsad.cv.StereoSGBM_create(numDisparities=4096).compute(left, right)


def test_the_rest_is_opencvs(cv2):
    assert hsad.cv.imread is cv2.imread and hsad.cv.COLOR_BGR2GRAY == cv2.COLOR_BGR2GRAY
    with pytest.raises(AttributeError):
        hsad.cv.no_such_name
