"""Disparities of a stereo camera or a video, both views side by side in a frame: python video.py SOURCE [--disparities N] [--save FILE]

SOURCE is the number of a camera or a file. The pair must be rectified. With --save the maps become a video, otherwise they are shown
until a key is pressed.
"""

import argparse
import time

import cv2
import numpy as np

import hsad

arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("source")
arguments.add_argument("--disparities", type=int, default=64)
arguments.add_argument("--preset", default="fast")
arguments.add_argument("--save")
given = arguments.parse_args()

video = cv2.VideoCapture(int(given.source) if given.source.isdigit() else given.source)
matcher, writer, count, seconds = None, None, 0, 0.0
while True:
    there, frame = video.read()
    if not there:
        break
    grey = cv2.cvtColor(frame, cv2.COLOR_BGR2GRAY)
    height, width = grey.shape[0], grey.shape[1] // 2
    if matcher is None:
        matcher = hsad.Matcher((width, height), given.disparities, preset=given.preset)
        disparity, confidence = np.empty((height, width), np.float32), np.empty((height, width), np.uint8)
    start = time.perf_counter()
    # Halves of a frame are views of any stride, and the answers go to the same arrays each time.
    matcher.match(grey[:, :width], grey[:, width:], disparity=disparity, confidence=confidence)
    seconds += time.perf_counter() - start
    count += 1
    colors = hsad.colorize(disparity, (0, given.disparities))[..., ::-1]
    if given.save:
        writer = writer or cv2.VideoWriter(given.save, cv2.VideoWriter.fourcc(*"MJPG"), 25, (width, height))
        writer.write(np.ascontiguousarray(colors))
        continue
    cv2.imshow("disparities", colors)
    if cv2.waitKey(1) >= 0:
        break
if writer:
    writer.release()
if count == 0:
    raise SystemExit(f"{given.source}: no frame: name a camera by its number, or a video file")
print(f"{count} frames, {1000 * seconds / count:.1f} ms per frame")
