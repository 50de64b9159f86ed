"""The point cloud of a pair in Open3D, without what is not confident: python open3d_cloud.py LEFT RIGHT CALIBRATION [FILE.ply]

Without a file a window shows the cloud. Needs open3d.
"""

import sys

import numpy as np
import open3d as o3d

import hsad

left, right = hsad.read_pair(sys.argv[1], sys.argv[2])
calibration = hsad.read_calibration(sys.argv[3])
found = hsad.match(left, right)
sure = np.where(found.confidence >= 64, found.disparity, np.nan)
points, colors = hsad.points(hsad.depth(sure, calibration), left, calibration)

cloud = o3d.geometry.PointCloud()
cloud.points = o3d.utility.Vector3dVector(points)
cloud.colors = o3d.utility.Vector3dVector(colors / 255)
cloud, _ = cloud.remove_statistical_outlier(nb_neighbors=20, std_ratio=2.0)
# Open3D looks along -z, with y up.
cloud.transform(np.diag([1, -1, -1, 1]))
print(f"{len(cloud.points)} of {len(points)} points, {np.asarray(cloud.get_axis_aligned_bounding_box().get_extent()).round(2)} m")
if len(sys.argv) > 4:
    o3d.io.write_point_cloud(sys.argv[4], cloud)
else:
    o3d.visualization.draw_geometries([cloud])
