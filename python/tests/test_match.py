"""hsad.match and hsad.Matcher: results, arrays of any kind, errors."""

import numpy as np
import pytest

import hsad


def test_a_scene_is_matched(scene, found):
    assert found.disparity.shape == scene.truth.shape and found.disparity.dtype == np.float32
    assert found.confidence.shape == scene.truth.shape and found.confidence.dtype == np.uint8
    score = hsad.evaluate(found.disparity, scene.truth, scene.seen)
    assert score["bad"][2]["of_all"] < 0.05, score
    least, most = found.range
    assert 0 < least < np.nanmin(scene.truth) and np.nanmax(scene.truth) < most
    assert 0.5 < found.trust <= 1.0
    assert found.report["range"]["min"] == least and found.report["parameters"]["method"] == "hsad"
    assert found.report["seconds"].keys() == {"luma", "features", "seeding", "dense"}
    assert found.colors().shape == (*scene.truth.shape, 3)
    assert "340x255" in repr(found)
    assert found.warnings == found.report["warnings"] == [] and found.not_trusted is found.report["not_trusted"] is None


def test_doubts_are_told(dots):
    left, _ = dots
    options = {"device": "cpu", "preset": "fast", "disparities": 16}
    found = hsad.match(left, left, **options)
    assert found.not_trusted is not None and found.report["not_trusted"] == found.not_trusted
    assert any("both views are the same picture" in warning for warning in found.warnings)
    forced = hsad.match(left, left, **options, force=True)
    assert forced.not_trusted is None and found.not_trusted in forced.warnings


def test_device_and_cpu_agree_to_the_bit(scene):
    options = {"preset": "fast", "min_disparity": 0, "disparities": 72}
    maps = [hsad.match(scene.left, scene.right, device=device, **options) for device in ("best", "cpu")]
    assert np.array_equal(maps[0].disparity, maps[1].disparity, equal_nan=True)
    assert np.array_equal(maps[0].confidence, maps[1].confidence)


def test_arrays_of_any_stride_and_order_are_the_same_picture(scene, found):
    left, right = scene.left, scene.right
    wide = np.zeros((*left.shape[:2], 7), np.uint8)
    wide[..., 5:2:-1] = left
    views = [
        (np.asfortranarray(left), right),
        (wide[..., 5:2:-1], right[::-1][::-1]),
        (left[..., ::-1][..., ::-1], np.dstack([right, np.full(right.shape[:2], 255, np.uint8)])),
        (left.astype(">u2") * 257, right.astype("<u2") * 257),
        (left.tolist() and left, right),
    ]
    for one, other in views:
        again = hsad.match(one, other)
        assert np.array_equal(again.disparity, found.disparity, equal_nan=True), (one.dtype, one.strides)


def test_grey_has_the_luma_of_equal_channels(scene):
    grey = [view[..., 1] for view in (scene.left, scene.right)]
    matcher = hsad.Matcher(scene.size, 72)
    maps = [matcher.match(*views) for views in (grey, [view[..., None] for view in grey], [np.dstack([v, v, v]) for v in grey])]
    maps.append(matcher.match(*(np.dstack([v, np.full_like(v, 255)]) for v in grey)))
    for disparity, confidence in maps[1:]:
        assert np.array_equal(disparity, maps[0][0], equal_nan=True) and np.array_equal(confidence, maps[0][1])


@pytest.mark.parametrize("dtype", [np.float16, np.float32, np.float64])
def test_floats_are_stretched(scene, dtype):
    views = [view.astype(dtype) / 255 for view in (scene.left, scene.right)]
    score = hsad.evaluate(hsad.match(*views).disparity, scene.truth, scene.seen)
    assert score["bad"][2]["of_all"] < 0.05, score


def test_what_is_not_seen_has_no_disparity(dots):
    left, right = (view.astype(np.float32) for view in dots)
    left[:, :30] = np.nan
    found = hsad.match(left, right, disparities=16, force=True)
    assert np.isnan(found.disparity[:, :28]).all() and np.nanmedian(found.disparity[:, 40:]) == 7


def test_dlpack_tensors_are_taken(dots):
    class Tensor:
        """What speaks DLPack and nothing else of NumPy, as a tensor of another library."""

        def __init__(self, array):
            self.array = array

        def __dlpack__(self, **keywords):
            return self.array.__dlpack__(**keywords)

        def __dlpack_device__(self):
            return self.array.__dlpack_device__()

    expected = hsad.match(*dots, disparities=16, force=True).disparity
    given = hsad.match(*map(Tensor, dots), disparities=16, force=True).disparity
    assert np.array_equal(given, expected, equal_nan=True)


def test_torch_tensors_are_taken(dots):
    torch = pytest.importorskip("torch", reason="NOT RUN: torch is not installed")
    tensors = [torch.from_numpy(view) for view in dots]
    assert np.nanmedian(hsad.match(*tensors, disparities=16, force=True).disparity) == 7


def test_disparities_below_zero_keep_their_sign(dots):
    left, right = dots
    found = hsad.match(right, left, min_disparity=-15, disparities=16, force=True)
    assert found.range == (-15, 0) and found.disparity.dtype == np.float32
    assert np.nanmedian(found.disparity) == -7
    disparity, _ = hsad.Matcher((90, 60), 16, min_disparity=-15).match(right, left)
    assert np.nanmedian(disparity) == -7
    # At the start of the range, and beside it.
    for first in (-7, -8):
        disparity, _ = hsad.Matcher((90, 60), 16, min_disparity=first).match(right, left)
        assert np.nanmedian(disparity) == -7 and np.nanmin(disparity) > first - 1


def test_a_matcher_gives_what_the_pipeline_gives(scene):
    options = {"preset": "fast", "no_align": True, "no_equalise": True}
    whole = hsad.match(scene.left, scene.right, min_disparity=0, disparities=72, **options)
    disparity, _ = hsad.Matcher(scene.size, 72, preset="fast").match(scene.left, scene.right)
    # The pipeline takes confidence, never a disparity.
    assert np.array_equal(disparity, whole.disparity, equal_nan=True)


@pytest.mark.parametrize("device", ["best", "cpu"])
def test_answers_go_to_the_callers_arrays(dots, device):
    matcher = hsad.Matcher((90, 60), 16, device=device)
    assert matcher.size == (90, 60) and matcher.range == (0, 15)
    expected, confidences = matcher.match(*dots)
    room = np.zeros((60, 180), np.float32)
    to, to_confidence = room[:, ::2], np.zeros((90, 60), np.uint8).T
    disparity, confidence = matcher.match(*dots, disparity=to, confidence=to_confidence)
    assert disparity is to and confidence is to_confidence
    assert np.array_equal(to, expected, equal_nan=True) and np.array_equal(confidence, confidences)
    assert not room[:, 1::2].any()
    for bad, word in [
        (np.zeros((60, 90), np.float64), "float64"),
        (np.zeros((90, 60), np.float32), "(90, 60)|\\[90, 60\\]"),
        ([0.0], "no NumPy array"),
    ]:
        with pytest.raises(hsad.ParameterError, match=word):
            matcher.match(*dots, disparity=bad)
    to = np.zeros((60, 90), np.float32)
    to.flags.writeable = False
    with pytest.raises(hsad.ParameterError, match="read-only"):
        matcher.match(*dots, disparity=to)


def test_the_option_that_is_given_counts(scene, found):
    sparse = hsad.match(scene.left, scene.right, no_fill=True, preset=None)
    assert np.isnan(sparse.disparity).any() and not np.isnan(found.disparity).any()
    by_numpy = hsad.match(scene.left, scene.right, disparities=np.int64(72), uniqueness=np.uint8(5), fill=np.bool_(True))
    assert by_numpy.report["parameters"]["uniqueness_percent"] == 5


@pytest.mark.parametrize(
    ("error", "words", "options"),
    [
        (hsad.ParameterError, "the option is 'windows', but there are only method, preset", {"windows": 7}),
        (hsad.ParameterError, "the option is 'windows'", {"windows": None}),
        (hsad.ParameterError, "preset is 'best', but it must be one of fast, balanced, quality, paper", {"preset": "best"}),
        (hsad.ParameterError, "window is 8, but it must be odd and 3 to 31", {"window": 8}),
        (hsad.ParameterError, "no_fill is given, but `fill` excludes it", {"no_fill": True, "fill": True}),
        (hsad.ParameterError, "fill is '1', but it must be true or false", {"fill": 1}),
        (hsad.DeviceError, "no device matches 'abacus'; there are: 0: ", {"device": "abacus"}),
    ],
)
def test_errors_are_the_librarys_sentences(dots, error, words, options):
    with pytest.raises(error) as raised:
        hsad.match(*dots, **options)
    assert words in str(raised.value) and isinstance(raised.value, hsad.Error)


def test_pictures_that_are_none_are_named(dots):
    left, right = dots
    for views, error, words in [
        ((left, right[:, :50]), hsad.ParameterError, "the left view is 90x60 and the right view 50x60"),
        ((left, right.astype(np.int32)), TypeError, "the right view is an array of int32"),
        ((left, right.astype(bool)), TypeError, "the right view is an array of bool"),
        ((left[0], right), hsad.ParameterError, "the left view is an array of shape [90]"),
        ((left, np.zeros((60, 90, 5), np.uint8)), hsad.ParameterError, "1 to 4 channels"),
        ((left, right.astype(np.float32)), hsad.FormatError, "floating-point samples"),
        ((left.astype(np.float32) * np.nan, right.astype(np.float32)), hsad.FormatError, "no pixel is a finite number"),
        ((np.zeros((0, 9), np.uint8), right), hsad.FormatError, "there is nothing in it"),
        ((None, right), TypeError, "the left view"),
        (("left.png", right), TypeError, "the left view"),
        ((left[:4], right[:4]), hsad.ParameterError, "too small"),
    ]:
        with pytest.raises(error) as raised:
            hsad.match(*views)
        assert words in str(raised.value)
    with pytest.raises(hsad.ParameterError, match="another size needs another Matcher"):
        hsad.Matcher((91, 60), 16).match(left, right)
    for arguments, words in [(((0, 60), 16), "0x60"), (((90, 60), 0), "the number of disparities is 0")]:
        with pytest.raises(hsad.ParameterError, match=words):
            hsad.Matcher(*arguments)
    with pytest.raises(hsad.ParameterError, match="hsad.match takes both"):
        hsad.Matcher((90, 60), 16, method="kamencay")


def test_a_pair_that_is_not_rectified_is_refused_and_rectified(scene):
    moved = np.roll(scene.right, 40, axis=0)
    with pytest.raises(hsad.NotRectifiedError, match="hsad.rectify.*force=True"):
        hsad.match(scene.left, moved)
    pair = hsad.rectify(scene.left, moved)
    assert pair.left.shape == (*pair.left_mask.shape, 4) and pair.right_mask.shape == pair.left_mask.shape
    assert pair.calibration is None and pair.report["method"] == "uncalibrated"
    assert pair.match().trust > 0.5
    with pytest.raises(hsad.NotRectifiedError, match="cannot be rectified"):
        hsad.rectify(scene.left, np.random.default_rng(2).integers(0, 256, scene.left.shape, dtype=np.uint8))
