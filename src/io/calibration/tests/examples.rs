//! A file of every format.

pub const MIDDLEBURY: &str =
    "cam0=[400 0 170; 0 402 127; 0 0 1]\ncam1=[400 0 182; 0 402 127; 0 0 1]\nbaseline=100\nwidth=340\nheight=255\n";
pub const KITTI: &str = "P0: 721.5 0 609.5 0 0 721.5 172.8 0 0 0 1 0\nP1: 721.5 0 609.5 -387.5 0 721.5 172.8 0 0 0 1 0\n\
                     P2: 721.5 0 609.5 44.8 0 721.5 172.8 0.2 0 0 1 0.002\nP3: 721.5 0 609.5 -339.5 0 721.5 172.8 2.1 0 0 1 0.002\n";
pub const KITTI_RAW: &str = "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 9.950000e-02\nS_00: 1.392e+03 5.12e+02\n\
    K_00: 984.2 0 690 0 980.8 233.1 0 0 1\nD_00: -0.37 0.19 0.001 0.001 -0.07\nR_00: 1 0 0 0 1 0 0 0 1\nT_00: 0 0 0\n\
    S_rect_00: 1242 375\nR_rect_00: 1 0 0 0 1 0 0 0 1\nP_rect_00: 721.5 0 609.5 0 0 721.5 172.8 0 0 0 1 0\n\
    S_01: 1392 512\nK_01: 989.5 0 702 0 987.8 245.5 0 0 1\nD_01: -0.36 0.17 -0.0008 -0.0001 -0.06\n\
    R_01: 1 0 0 0 1 0 0 0 1\nT_01: -0.537 0.004 -0.012\nS_rect_01: 1242 375\nR_rect_01: 1 0 0 0 1 0 0 0 1\n\
    P_rect_01: 721.5 0 609.5 -387.5 0 721.5 172.8 0 0 0 1 0\n";
pub const NUMBERS: &str = "754.668 0.0 489.379 0.0 754.668 265.16 0.0 0.0 1.0\n0.063\n";
pub const OPENCV: &str = "%YAML:1.0\n---\nM1: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 534., 0., 335., 0.,\n       \
    535., 240., 0., 0., 1. ]\nD1: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [ -0.3, 0.1, 0.001, 0., 0. ]\n\
    M2: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 536., 0., 334., 0., 537., 242., 0., 0., 1. ]\n\
    D2: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n   data: [ -0.2, 0.05, 0., 0., 0. ]\n";
pub const OPENCV_POSE: &str = "%YAML:1.0\n---\nR: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ]\n\
    T: !!opencv-matrix\n   rows: 3\n   cols: 1\n   dt: d\n   data: [ -120., 0.5, 0.2 ]\n\
    P1: !!opencv-matrix\n   rows: 3\n   cols: 4\n   dt: d\n   data: [ 530., 0., 330., 0., 0., 530., 241., 0., 0., 0., 1., 0. ]\n\
    P2: !!opencv-matrix\n   rows: 3\n   cols: 4\n   dt: d\n   data: [ 530., 0., 330., -63600., 0., 530., 241., 0., 0., 0., 1., 0. ]\n";
pub const OPENCV_XML: &str = "<?xml version=\"1.0\"?>\n<opencv_storage>\n<K1 type_id=\"opencv-matrix\">\n  <rows>3</rows>\n  <cols>3</cols>\n  \
    <dt>d</dt>\n  <data>\n    534. 0. 335. 0. 535. 240. 0. 0. 1.</data></K1>\n<D1 type_id=\"opencv-matrix\">\n  <rows>1</rows>\n  \
    <cols>4</cols>\n  <dt>d</dt>\n  <data>\n    -0.01 0.02 0.001 0.</data></D1>\n<K2 type_id=\"opencv-matrix\">\n  \
    <data>\n    536. 0. 334. 0. 537. 242. 0. 0. 1.</data></K2>\n<D2 type_id=\"opencv-matrix\">\n  \
    <data>\n    -0.02 0.05 0. 0.</data></D2>\n<R type_id=\"opencv-matrix\">\n  <data>\n    1. 0. 0. 0. 1. 0. 0. 0. 1.</data></R>\n\
    <T type_id=\"opencv-matrix\">\n  <data>\n    -0.12 0. 0.</data></T>\n\
    <distortion_model>fisheye</distortion_model><image_width>640</image_width><image_height>480</image_height>\n</opencv_storage>\n";
pub const ROS_LEFT: &str = "image_width: 640\nimage_height: 480\ncamera_name: left\ncamera_matrix:\n  rows: 3\n  cols: 3\n  \
    data: [430.1, 0, 306.8, 0, 430.5, 227.2, 0, 0, 1]\ndistortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  \
    data: [-0.33, 0.11, 0.0005, 0.0007, 0]\nrectification_matrix:\n  rows: 3\n  cols: 3\n  \
    data: [0.9995000416652778, 0, 0.03161750711666, 0, 1, 0, -0.03161750711666, 0, 0.9995000416652778]\nprojection_matrix:\n  rows: 3\n  cols: 4\n  \
    data: [429, 0, 318, 0, 0, 429, 236, 0, 0, 0, 1, 0]\n";
pub const ROS_RIGHT: &str = "height: 480\nwidth: 640\ndistortion_model: \"rational_polynomial\"\nD: [-0.3, 0.1, 0.0, 0.0, 0.0, 0.02, 0.01, 0.0]\n\
    K: [431.0, 0.0, 310.0, 0.0, 431.0, 230.0, 0.0, 0.0, 1.0]\nR: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\n\
    P: [429.0, 0.0, 318.0, -51.48, 0.0, 429.0, 236.0, 0.0, 0.0, 0.0, 1.0, 0.0]\n";
pub const KALIBR: &str = "cam0:\n  cam_overlaps: [1]\n  camera_model: pinhole\n  distortion_coeffs: [-0.01, 0.02, -0.006, 0.0008]\n  \
    distortion_model: equidistant\n  intrinsics: [190.9, 190.9, 254.9, 256.9]\n  resolution: [512, 512]\n  rostopic: /cam0/image_raw\n\
    cam1:\n  T_cn_cnm1:\n  - [1.0, 0.0, 0.0, -0.101]\n  - [0.0, 1.0, 0.0, 0.001]\n  - [0.0, 0.0, 1.0, 0.002]\n  - [0.0, 0.0, 0.0, 1.0]\n  \
    camera_model: omni\n  distortion_coeffs: [-0.05, 0.01, 0.001, -0.002]\n  distortion_model: radtan\n  intrinsics: [0.9, 190.4, 190.4, 252.6, 254.9]\n  \
    resolution: [512, 512]\n";
pub const EUROC_LEFT: &str = "# General sensor definitions.\nsensor_type: camera\ncomment: VI-Sensor cam0 (MT9M034)\n\nT_BS:\n  cols: 4\n  rows: 4\n  \
    data: [0.0, -1.0, 0.0, -0.02,\n         1.0, 0.0, 0.0, -0.06,\n        0.0, 0.0, 1.0, 0.009,\n         0.0, 0.0, 0.0, 1.0]\n\n\
    rate_hz: 20\nresolution: [752, 480]\ncamera_model: pinhole\nintrinsics: [458.654, 457.296, 367.215, 248.375] #fu, fv, cu, cv\n\
    distortion_model: radial-tangential\ndistortion_coefficients: [-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05]\n";
pub const COLMAP_CAMERAS: &str = "# Camera list with one line of data per camera:\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n\
    # Number of cameras: 2\n0 PINHOLE 752 480 458.0 457.0 367.5 248.5\n1 OPENCV_FISHEYE 752 480 458 457 367 248 0.01 0.02 0.001 0\n";
pub const COLMAP_IMAGES: &str = "# Image list with two lines of data per image:\n#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n\
    7 1 0 0 0 0.1 0.2 0.3 0 images/im0.png\n1.5 2.5 -1\n8 1 0 0 0 -0.02 0.2 0.3 1 images/im1.png\n\n";
pub const OWN: &str = "{\"left\": {\"size\": [640, 480], \"focal\": [430, 431], \"centre\": [319.5, 239.5], \"model\": \"pinhole\",\n\
    \"distortion\": [-0.3, 0.1, 0.001, 0]}, \"right\": {\"focal\": [200, 200], \"centre\": [320, 240], \"model\": \"double sphere\", \"xi\": -0.2,\n\
    \"alpha\": 0.55}, \"rotation\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], \"translation\": [-120, 0, 0], \"unit\": \"mm\"}\n";

pub fn euroc_right() -> String {
    EUROC_LEFT.replace("0.0, 0.0, -0.06", "0.0, 0.0, 0.05")
}

/// Every format, with files that belong together.
pub fn examples() -> Vec<Vec<String>> {
    let own = |texts: &[&str]| texts.iter().map(|&text| text.to_owned()).collect();
    vec![
        own(&[MIDDLEBURY]),
        own(&[KITTI]),
        own(&[KITTI_RAW]),
        own(&[NUMBERS]),
        own(&[OPENCV, OPENCV_POSE]),
        own(&[OPENCV_POSE]),
        own(&[OPENCV_XML]),
        own(&[ROS_LEFT, ROS_RIGHT]),
        own(&[KALIBR]),
        own(&[EUROC_LEFT, &euroc_right()]),
        own(&[COLMAP_CAMERAS, COLMAP_IMAGES]),
        own(&[OWN]),
    ]
}
