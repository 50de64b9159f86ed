//! XML as OpenCV's FileStorage writes it.

use std::path::Path;

use roxmltree::{Document, ParsingOptions};

use super::tree::{MAX_DEPTH, MAX_NODES, Node};
use crate::{error::Result, io::malformed};

/// Parses a file: an element with elements is a mapping, any other is its text.
pub(super) fn parse(text: &str, path: &Path) -> Result<Node> {
    let options = ParsingOptions { nodes_limit: MAX_NODES as u32, ..ParsingOptions::default() };
    let refused = |what: String| malformed(path, format!("{what}: this is not the XML of a calibration"));
    let document = Document::parse_with_options(text, options).map_err(|error| refused(error.to_string()))?;
    node_of(document.root_element(), MAX_DEPTH)
        .ok_or_else(|| refused(format!("it is nested more than {MAX_DEPTH} deep")))
}

fn node_of(element: roxmltree::Node<'_, '_>, depth: usize) -> Option<Node> {
    let below = depth.checked_sub(1)?;
    let entries = element.children().filter(roxmltree::Node::is_element);
    let entries: Option<Vec<(String, Node)>> =
        entries.map(|child| Some((child.tag_name().name().into(), node_of(child, below)?))).collect();
    let entries = entries?;
    let text = || element.children().filter_map(|child| child.text()).collect();
    Some(if entries.is_empty() { Node::Text(text()) } else { Node::Map(entries) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opencvs_xml_is_read() {
        let file = "<?xml version=\"1.0\"?>\n<opencv_storage>\n<M1 type_id=\"opencv-matrix\">\n  <rows>1</rows>\n\
                    <data>\n 1. 2.</data></M1>\n<!-- no --><n>3</n>\n</opencv_storage>\n";
        let text = |value: &str| Node::Text(value.into());
        let matrix = Node::Map(vec![("rows".into(), text("1")), ("data".into(), text("\n 1. 2."))]);
        assert_eq!(
            parse(file, Path::new("a.xml")).unwrap(),
            Node::Map(vec![("M1".into(), matrix), ("n".into(), text("3"))])
        );
    }

    #[test]
    fn what_is_hostile_is_refused() {
        let bomb = "<!DOCTYPE a [<!ENTITY b \"cc\">]><a>&b;</a>";
        for (text, expected) in [
            (bomb, "DTD"),
            (&"<a>".repeat(100_000), "XML"),
            (&format!("{}{}", "<a>".repeat(20), "</a>".repeat(20)), "nested more than 16 deep"),
            (&format!("<a>{}</a>", "<b/>".repeat(70_000)), "limit"),
            ("<a><b></a>", "expected"),
        ] {
            let error = parse(text, Path::new("a.xml")).unwrap_err().to_string();
            assert!(error.starts_with("a.xml: ") && error.contains(expected), "{error}");
        }
    }
}
