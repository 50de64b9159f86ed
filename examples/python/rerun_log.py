"""A pair, its depth, confidences and matched points in Rerun: python rerun_log.py LEFT RIGHT CALIBRATION [FILE.rrd]

Without a file the viewer is opened. Needs rerun-sdk.
"""

import sys

import numpy as np
import rerun as rr

import hsad

left, right = hsad.read_pair(sys.argv[1], sys.argv[2])
calibration = hsad.read_calibration(sys.argv[3])
height, width = left.shape[:2]

rr.init("hsad", spawn=len(sys.argv) < 5)
if len(sys.argv) > 4:
    rr.save(sys.argv[4])

found = hsad.match(left, right)
depth = hsad.depth(found.disparity, calibration)
rr.log("world", rr.ViewCoordinates.RDF, static=True)
camera = rr.Pinhole(
    focal_length=calibration.focal, principal_point=(calibration.cx, calibration.cy), width=width, height=height
)
rr.log("world/left", camera, static=True)
rr.log("world/left/picture", rr.Image(left[..., :3]))
rr.log("world/left/depth", rr.DepthImage(np.where(np.isfinite(depth), depth, 0), meter=1.0))
rr.log("right", rr.Image(right[..., :3]))
rr.log("confidence", rr.Image(found.confidence))

# Both views side by side, with a line per match.
points = [hsad.features(view) for view in (left, right)]
indices, _, _ = hsad.match_features(*points, max_dy=1.5, strongest=200)
ends = [view.positions[indices[:, side]] for side, view in enumerate(points)]
rr.log("matches/pair", rr.Image(np.hstack([left[..., :3], right[..., :3]])))
rr.log("matches/pair/lines", rr.LineStrips2D(np.stack([ends[0], ends[1] + [width, 0]], axis=1)))
print(f"{len(indices)} matches, depth {np.nanmin(depth):.2f} to {depth[np.isfinite(depth)].max():.2f} m")
