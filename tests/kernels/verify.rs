//! The verification suite itself: it must be able to fail.

use hsad::{
    Error, Result,
    image::Size,
    verify::{Array, Bench, Case, Subject, Trial},
};

use crate::common::bench;

/// A kernel with wrong outputs.
#[derive(Clone, Copy)]
enum Wrong {
    Word,
    Length,
    Command,
    Error,
}

impl Trial for Wrong {
    fn parameters(&self) -> String {
        String::new()
    }

    fn input(&self) -> Vec<Array> {
        Vec::new()
    }

    fn on_device(&self, bench: &Bench<'_>) -> Result<Vec<Array>> {
        let words: Vec<u32> = match self {
            Self::Word => bench.download(&bench.upload(&[1_u32, 2, 4])?)?,
            Self::Length => bench.download(&bench.upload(&[1_u32, 2])?)?,
            Self::Command => {
                // The copy exceeds the buffer.
                let buffers = [bench.output(1)?, bench.output(1)?];
                bench.run(|encoder| encoder.copy_buffer_to_buffer(&buffers[0], 0, &buffers[1], 0, Some(64)));
                vec![1, 2, 3]
            }
            Self::Error => return Err(Error::DeviceLost("it fell off the bus".into())),
        };
        Ok(vec![Array::exact("words", words)])
    }

    fn twin(&self) -> Result<Vec<Array>> {
        Ok(vec![Array::exact("words", vec![1_u32, 2, 3])])
    }
}

#[test]
fn wrong_results_and_errors_are_faults() {
    static SUBJECTS: [Subject; 4] = [
        Subject::kernel("word", |_, _| Box::new(Wrong::Word)),
        Subject::kernel("length", |_, _| Box::new(Wrong::Length)),
        Subject::kernel("command", |_, _| Box::new(Wrong::Command)),
        Subject::kernel("error", |_, _| Box::new(Wrong::Error)),
    ];
    let expected =
        ["words: value 2 is 4, not 3", "2 words u32, not 3", "cannot run this: command: ", "fell off the bus"];
    for (subject, expected) in SUBJECTS.iter().zip(expected) {
        let outcome = Case { subject, size: Size::new(1, 1), seed: 1 }.run(&bench());
        assert!(!outcome.passes() && outcome.faults[0].contains(expected), "{}: {:?}", subject.name, outcome.faults);
        assert_eq!(outcome.lost, subject.name == "error");
    }
}
