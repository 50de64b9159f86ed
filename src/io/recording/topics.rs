//! Topics of a recording, and which of them show the left and the right view.

use super::messages::Kind;

/// Names of a left and of a right camera in the names of topics.
const SIDES: [[&str; 2]; 6] = [
    ["left", "right"],
    ["cam0", "cam1"],
    ["cam_0", "cam_1"],
    ["camera0", "camera1"],
    ["infra1", "infra2"],
    ["image_00", "image_01"],
];

/// A topic of pictures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Topic {
    /// The name.
    pub name: String,
    /// The type of its messages, such as `sensor_msgs/msg/Image`.
    pub message_type: String,
    /// Number of its messages, if the recording has a summary.
    pub messages: Option<u64>,
}

impl Topic {
    pub(super) fn kind(&self) -> Option<Kind> {
        Kind::of(&self.message_type)
    }

    /// Whether the topic has pictures.
    pub(super) fn has_pictures(&self) -> bool {
        matches!(self.kind(), Some(Kind::Image | Kind::CompressedImage)) && !self.name.ends_with("/compressedDepth")
    }

    /// The name of the topic whose pictures these are, compressed or not.
    fn base(&self) -> &str {
        self.name.strip_suffix("/compressed").unwrap_or(&self.name)
    }
}

/// The topic of the calibration of a picture topic: beside it.
pub(super) fn camera_info_of(topic: &Topic) -> String {
    let folder = topic.base().rsplit_once('/').map_or("", |(folder, _)| folder);
    format!("{folder}/camera_info")
}

/// Whether the pictures of a topic are rectified, by its name: `image_rect`, `image_rect_color`, `image_rect_raw`.
pub(super) fn is_rectified(topic: &str) -> bool {
    topic.rsplit('/').any(|part| part.starts_with("image_rect"))
}

/// The left and the right topic, if their names tell: of the pictures of one camera not compressed ones rather than compressed ones.
pub(super) fn of_both_views(topics: &[Topic]) -> Option<[&Topic; 2]> {
    let is_sent = |topic: &&Topic| topic.has_pictures() && topic.messages != Some(0);
    let partner = |topic: &Topic| {
        let names = SIDES.iter().filter(|[left, _]| topic.name.contains(left));
        let mut partners = names.filter_map(|[left, right]| {
            let name = topic.name.replace(left, right);
            topics.iter().filter(is_sent).find(|other| other.name == name && other.message_type == topic.message_type)
        });
        partners.next()
    };
    let pairs: Vec<[&Topic; 2]> =
        topics.iter().filter(is_sent).filter_map(|topic| Some([topic, partner(topic)?])).collect();
    let is_raw = |[left, _]: &&[&Topic; 2]| left.kind() == Some(Kind::Image);
    let of_one_camera = |pair: &&[&Topic; 2]| {
        is_raw(pair) || !pairs.iter().filter(is_raw).any(|[left, _]| left.base() == pair[0].base())
    };
    let mut found = pairs.iter().filter(of_one_camera);
    found.next().filter(|_| found.next().is_none()).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn topic(name: &str) -> Topic {
        let message_type =
            if name.ends_with("/compressed") { "sensor_msgs/msg/CompressedImage" } else { "sensor_msgs/msg/Image" };
        Topic { name: name.into(), message_type: message_type.into(), messages: None }
    }

    fn found(names: &[&str]) -> Option<[String; 2]> {
        let topics: Vec<Topic> = names.iter().map(|name| topic(name)).collect();
        of_both_views(&topics).map(|both| both.map(|topic| topic.name.clone()))
    }

    #[test]
    fn topics_of_both_views_are_told_by_their_names() {
        for both in [
            ["/left/image_raw", "/right/image_raw"],
            ["/stereo/left/image_raw/compressed", "/stereo/right/image_raw/compressed"],
            ["/zed/zed_node/left/image_rect_color", "/zed/zed_node/right/image_rect_color"],
            ["/left_camera/left_image", "/right_camera/right_image"],
            ["/cam0/image_raw", "/cam1/image_raw"],
            ["/camera/infra1/image_rect_raw", "/camera/infra2/image_rect_raw"],
            ["/kitti/image_00", "/kitti/image_01"],
        ] {
            assert_eq!(found(&["/front/image_raw", both[1], both[0]]), Some(both.map(str::to_owned)));
            assert_eq!(found(&[both[0], "/front/image_raw"]), None);
        }
        let compressed =
            ["/left/image_raw", "/left/image_raw/compressed", "/right/image_raw", "/right/image_raw/compressed"];
        assert_eq!(found(&compressed), Some(["/left/image_raw", "/right/image_raw"].map(str::to_owned)));
        let twice = ["/left/image_raw", "/left/image_rect", "/right/image_raw", "/right/image_rect"];
        assert_eq!(found(&twice), None);
    }

    #[test]
    fn calibrations_lie_beside_the_pictures() {
        assert_eq!(camera_info_of(&topic("/a/left/image_raw")), "/a/left/camera_info");
        assert_eq!(camera_info_of(&topic("/a/left/image_raw/compressed")), "/a/left/camera_info");
        assert_eq!(camera_info_of(&topic("picture")), "/camera_info");
        assert!(is_rectified("/zed/left/image_rect_color/compressed") && !is_rectified("/rectangle/image_raw"));
    }
}
