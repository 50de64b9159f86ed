"""From two pictures to depth, a picture of the disparities and a point cloud: python depth.py LEFT RIGHT FOLDER [CALIBRATION]"""

import sys
from pathlib import Path

import hsad

left, right = hsad.read_pair(sys.argv[1], sys.argv[2])
found = hsad.match(left, right)
folder = Path(sys.argv[3])
hsad.write_png(folder / "disparity.png", found.colors())
print(f"{found.range[0]} to {found.range[1]} px, trust {found.trust:.2f} of 1")
if len(sys.argv) > 4:
    calibration = hsad.read_calibration(sys.argv[4])
    points, colors = hsad.points(hsad.depth(found.disparity, calibration), left, calibration)
    hsad.write_ply(folder / "cloud.ply", points, colors)
