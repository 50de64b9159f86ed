"""A ROS 2 node: a rectified stereo pair becomes a DisparityImage and a PointCloud2.

Subscribes to left/image_rect, right/image_rect, left/camera_info and right/camera_info, as image_proc publishes them; publishes disparity
and points2, in the frame of the left camera. Parameters: disparities (128), min_disparity (0), preset (fast).

    python ros2_node.py --ros-args -r __ns:=/stereo -p disparities:=64
"""

import numpy as np
import rclpy
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import CameraInfo, Image, PointCloud2, PointField
from stereo_msgs.msg import DisparityImage

import hsad

# Samples per pixel and their type; the order of RGB and BGR decides the luma.
ENCODINGS = {
    "mono8": (np.uint8, 1),
    "mono16": (np.uint16, 1),
    "rgb8": (np.uint8, 3),
    "bgr8": (np.uint8, 3),
    "rgba8": (np.uint8, 4),
    "bgra8": (np.uint8, 4),
}


def picture(message: Image) -> np.ndarray:
    """The message's pixels, without a copy: grey, or RGB."""
    dtype, channels = ENCODINGS[message.encoding]
    dtype = np.dtype(dtype).newbyteorder(">" if message.is_bigendian else "<")
    shape, strides = (message.height, message.width, channels), (message.step, channels * dtype.itemsize, dtype.itemsize)
    pixels = np.ndarray(shape, dtype, bytes(message.data), strides=strides)
    if channels == 1:
        return pixels[..., 0]
    return pixels[..., 2::-1] if message.encoding.startswith("bgr") else pixels[..., :3]


class Stereo(Node):
    def __init__(self) -> None:
        super().__init__("hsad")
        self.disparities = self.declare_parameter("disparities", 128).value
        self.min_disparity = self.declare_parameter("min_disparity", 0).value
        self.preset = self.declare_parameter("preset", "fast").value
        self.matcher: hsad.Matcher | None = None
        self.cameras: dict[str, CameraInfo] = {}
        self.waiting: dict[str, Image] = {}
        self.disparity = self.create_publisher(DisparityImage, "disparity", 1)
        self.points = self.create_publisher(PointCloud2, "points2", 1)
        for side in ("left", "right"):
            self.create_subscription(
                CameraInfo, f"{side}/camera_info", lambda info, side=side: self.cameras.update({side: info}), 1
            )
            self.create_subscription(
                Image, f"{side}/image_rect", lambda image, side=side: self.take(side, image), qos_profile_sensor_data
            )

    def take(self, side: str, image: Image) -> None:
        """Matches a pair when both of its pictures, of one time, and both cameras are there."""
        self.waiting[side] = image
        both = [self.waiting.get(side) for side in ("left", "right")]
        if None in both or both[0].header.stamp != both[1].header.stamp or len(self.cameras) < 2:
            return
        self.waiting.clear()
        self.match(*both)

    def match(self, left: Image, right: Image) -> None:
        size = (left.width, left.height)
        if self.matcher is None or self.matcher.size != size:
            self.matcher = hsad.Matcher(size, self.disparities, min_disparity=self.min_disparity, preset=self.preset)
        view = picture(left)
        disparity, _ = self.matcher.match(view, picture(right))
        # P of CameraInfo, row by row: the focal length, the principal point, and of the right camera minus focal times baseline.
        own, other = self.cameras["left"].p, self.cameras["right"].p
        focal, baseline = own[0], -other[3] / other[0]
        calibration = hsad.Calibration(focal, baseline, cx=own[2], cy=own[6], doffs=other[2] - own[2])

        first, last = self.matcher.range
        # ROS has no disparity where a value lies below min_disparity.
        values = np.nan_to_num(disparity, nan=first - 1).astype("<f4")
        message = DisparityImage(header=left.header, f=focal, t=baseline, min_disparity=float(first), max_disparity=float(last))
        message.delta_d = 1 / 256
        message.image = Image(header=left.header, height=left.height, width=left.width, encoding="32FC1", step=4 * left.width)
        message.image.data = values.tobytes()
        self.disparity.publish(message)

        points, colors = hsad.points(hsad.depth(disparity, calibration), view, calibration)
        cloud = np.zeros(len(points), [("xyz", "<f4", 3), ("rgb", "<u4")])
        cloud["xyz"] = points
        cloud["rgb"] = colors.astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], np.uint32)
        fields = [
            PointField(name=name, offset=4 * place, datatype=PointField.FLOAT32, count=1)
            for place, name in enumerate(("x", "y", "z", "rgb"))
        ]
        message = PointCloud2(header=left.header, height=1, width=len(cloud), fields=fields, is_dense=True)
        message.point_step, message.row_step, message.data = 16, 16 * len(cloud), cloud.tobytes()
        self.points.publish(message)


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(Stereo())
