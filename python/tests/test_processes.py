"""Threads, forked processes and memory."""

import multiprocessing
import os
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import hsad


def test_other_threads_run_while_the_device_works(scene):
    matcher = hsad.Matcher(scene.size, 128, preset="quality", search_both_views=True)
    matcher.match(scene.left, scene.right)
    done, turns = threading.Event(), 0

    def work():
        for _ in range(5):
            matcher.match(scene.left, scene.right)
        done.set()

    # Threads that hold the interpreter give it away at this interval only.
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1e6)
    try:
        thread = threading.Thread(target=work)
        thread.start()
        while not done.is_set():
            turns += 1
            time.sleep(0.001)
        thread.join()
    finally:
        sys.setswitchinterval(interval)
    assert turns > 5, turns


def test_threads_share_a_matcher(dots):
    matcher = hsad.Matcher((90, 60), 16)
    expected, _ = matcher.match(*dots)
    results = []
    threads = [threading.Thread(target=lambda: results.append(matcher.match(*dots)[0])) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(results) == 8 and all(np.array_equal(found, expected, equal_nan=True) for found in results)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="NOT RUN: this system has no fork")
@pytest.mark.parametrize("device", ["best", "cpu"])
def test_a_forked_process_says_what_to_do(device):
    program = f"""
import os, numpy as np, hsad
left = np.random.default_rng(1).integers(0, 256, (60, 90), dtype=np.uint8)
matcher = hsad.Matcher((90, 60), 16, device={device!r})
matcher.match(left, left)
points = hsad.features(left, device={device!r})
child = os.fork()
if child == 0:
    told = 0
    for work in (lambda: hsad.match(left, left), lambda: matcher.match(left, left), lambda: hsad.match_features(points, points)):
        try:
            work()
        except hsad.ForkError as error:
            told += "spawn" in str(error)
    os._exit(told)
_, status = os.waitpid(child, 0)
matcher.match(left, left)
print(os.waitstatus_to_exitcode(status))
"""
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    assert run.stdout == "3\n", run.stdout + run.stderr


@pytest.mark.skipif(sys.platform != "linux", reason="NOT RUN: only Vulkan's loader is told of no driver so")
def test_without_a_device_the_cpu_does_the_work():
    program = """
import numpy as np, hsad
left = np.random.default_rng(1).integers(0, 256, (60, 90), dtype=np.uint8)
disparity, _ = hsad.Matcher((90, 60), 16).match(left, np.roll(left, -7, axis=1))
print(hsad.devices(), np.nanmedian(disparity))
"""
    environment = {**os.environ, "VK_DRIVER_FILES": "/none", "VK_ICD_FILENAMES": "/none"}
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env=environment, timeout=120)
    assert run.stdout == "['cpu'] 7.0\n", run.stdout + run.stderr
    assert "the CPU does the work: no GPU adapter was found" in run.stderr


def _median(views):
    return float(np.nanmedian(hsad.match(*views, disparities=16, force=True).disparity))


def test_spawned_processes_work(dots):
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.map(_median, [dots]) == [7]


def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="NOT RUN: only Linux tells the memory of a process so")
def test_frames_leave_no_memory_behind(dots):
    matcher = hsad.Matcher((90, 60), 16, preset="fast")
    colours = [np.dstack([view] * 3) for view in dots]
    to, confidence = np.zeros((60, 90), np.float32), np.zeros((60, 90), np.uint8)

    def frames(count):
        for _ in range(count):
            matcher.match(*dots, disparity=to, confidence=confidence)
            matcher.match(*colours)
        return resident()

    frames(200)
    before = frames(200)
    # One answer of 90x60 pixels that stays per frame would be 8 MB.
    assert frames(300) - before < 4 << 20
