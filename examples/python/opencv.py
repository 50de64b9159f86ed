"""A script for OpenCV; its first import is all that was changed: python opencv.py LEFT RIGHT DISPARITIES MAP

Without hsad the line is `import cv2`.
"""

import sys
import time

import hsad.cv as cv2

left, right = cv2.imread(sys.argv[1]), cv2.imread(sys.argv[2])
matcher = cv2.StereoSGBM_create(
    minDisparity=0,
    numDisparities=int(sys.argv[3]),
    blockSize=3,
    P1=8 * 3 * 3**2,
    P2=32 * 3 * 3**2,
    disp12MaxDiff=1,
    uniquenessRatio=5,
    speckleWindowSize=100,
    speckleRange=2,
)
matcher.compute(left, right)
start = time.perf_counter()
disparity = matcher.compute(left, right)
milliseconds = 1000 * (time.perf_counter() - start)
print(f"{disparity.dtype}, {disparity.min()} to {disparity.max()}, {milliseconds:.0f} ms")
grey = cv2.normalize(disparity, None, 0, 255, cv2.NORM_MINMAX, cv2.CV_8U)
cv2.imwrite(sys.argv[4], cv2.applyColorMap(grey, cv2.COLORMAP_TURBO))
