//! Library errors in the words of the program.
//!
//! The library names its own parameters, since embedding applications and the page in a browser show the same errors;
//! here the options of `hsad` take their place.

use hsad::Error;

/// The message of a library error, with the options that help.
pub fn in_options(error: &Error) -> String {
    match error {
        Error::NotRectified { diagnosis } => {
            format!("the pair is not rectified: {diagnosis}, or search along rows all the same with --force")
        }
        Error::NoRange { reason } => {
            format!("the disparity range could not be found: {reason}; name it with --min-disparity and --disparities")
        }
        Error::WrongResults { device, what, command } => format!(
            "{device} computes wrong results ({what}): use another device (hsad devices) or --device cpu, and repeat \
             the failure with {command}"
        ),
        Error::Parameter { name, value, expected } => match OPTIONS.iter().find(|(parameter, _)| parameter == name) {
            Some((_, option)) => format!("{option} is {value}, but {expected}"),
            None => error.to_string(),
        },
        Error::Format { .. } => {
            error.to_string().replace("name the unit of length", "name the unit of length with --calib-unit")
        }
        _ => error.to_string(),
    }
}

/// Parameters of the library, and the options that set them.
const OPTIONS: [(&str, &str); 16] = [
    ("agreement", "--agreement"),
    ("condition", "--condition"),
    ("max-lr-difference", "--max-lr-difference"),
    ("max_features", "--max-features"),
    ("octaves", "--octaves"),
    ("only", "--only"),
    ("preset", "--preset"),
    ("ratio", "--ratio"),
    ("size", "--size"),
    ("step", "--step"),
    ("strongest", "--strongest"),
    ("the number of disparities", "--disparities"),
    ("the window of costs", "--cost-window"),
    ("threshold", "--threshold"),
    ("uniqueness", "--uniqueness"),
    ("window", "--window"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_the_options_that_help() {
        let no_range = Error::NoRange { reason: "3 points".into() };
        let wrong = Error::WrongResults { device: "GPU".into(), what: "pad".into(), command: "hsad verify".into() };
        let even = |name| Error::Parameter { name, value: "8".into(), expected: "it must be odd".into() };
        for (error, options) in [
            (Error::NotRectified { diagnosis: "turned".into() }, &["turned", "--force"][..]),
            (no_range, &["3 points", "--min-disparity", "--disparities"]),
            (wrong, &["GPU", "pad", "--device cpu", "hsad verify"]),
            (even("the window of costs"), &["--cost-window is 8, but it must be odd"]),
            (
                Error::Format { path: "rig.yml".into(), reason: "a baseline of 3: name the unit of length".into() },
                &["rig.yml: a baseline of 3: name the unit of length with --calib-unit"],
            ),
            (even("another"), &["another is 8, but it must be odd"]),
            (Error::NoAdapter, &[&Error::NoAdapter.to_string()]),
        ] {
            let text = in_options(&error);
            assert!(options.iter().all(|option| text.contains(option)), "{text}");
        }
    }
}
