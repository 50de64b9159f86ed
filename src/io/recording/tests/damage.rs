//! Recordings that are damaged, cut off, or of other formats.

use super::*;

#[test]
fn a_recording_that_breaks_off_gives_its_pairs_first() {
    let whole = recorded(plain().chunk_size(Some(1)), &ride());
    let mut most = 0;
    for length in 0..whole.len() {
        let (_folder, file) = written(&whole[..length]);
        let Ok((found, _, error)) = read(&file) else { continue };
        assert_eq!(found, PAIRS[..found.len()]);
        // What follows the data may be missing.
        if found.len() < 3 {
            assert!(
                error.is_some_and(|error| error.contains("the recording is cut off: mcap recover IN.mcap -o OUT.mcap")),
                "{length}"
            );
        }
        most = most.max(found.len());
    }
    assert_eq!(most, 3);
}

/// A small generator (xorshift).
fn random(state: &mut u64) -> u64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    *state
}

#[test]
fn no_damage_is_more_than_an_error() {
    for options in [plain().chunk_size(Some(200)), plain().use_chunks(false)] {
        let whole = recorded(options, &ride());
        let mut state = 88;
        for _ in 0..400 {
            let mut bytes = whole.clone();
            for _ in 0..=random(&mut state) % 3 {
                let place = random(&mut state) as usize % bytes.len();
                bytes[place] = [0, 255, 127, 1, random(&mut state) as u8][random(&mut state) as usize % 5];
            }
            let (_folder, file) = written(&bytes);
            let _ = read(&file);
        }
    }
}

#[test]
fn damaged_messages_are_counted_and_a_frame_without_a_time_has_that_of_its_record() {
    let mut sent = ride();
    sent.insert(0, ("/right/image", IMAGE, vec![0, 1, 0, 0, 9]));
    // Recorded at 109 and 110.
    sent.extend([("/left/image", IMAGE, grey(0, 54)), ("/right/image", IMAGE, grey(0, 64))]);
    let (_folder, file) = written(&recorded(plain(), &sent));
    let (found, left_out, _) = read(&file).unwrap();
    assert_eq!(found, [&PAIRS[..], &[(109, [54, 64])]].concat());
    assert_eq!((left_out.alone, left_out.damaged), ([1, 0], [0, 1]));
    assert!(left_out.reason.unwrap().contains("cut off"));
}

#[test]
fn the_whole_files_of_a_recording_are_read_beside_broken_ones() {
    let folder = tempfile::tempdir().unwrap();
    let part = |sent: &[Sent<'_>]| recorded(plain(), sent);
    let ride = ride();
    let file = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    file("ride_0.mcap", &part(&ride[..3]));
    file("ride_1.mcap", b"");
    let cut = part(&ride[3..4]);
    file("ride_2.mcap", &cut[..100]);
    file("ride_3.mcap", &part(&[]));
    file("ride_4.mcap", &part(&ride[4..]));
    file("._ride_0.mcap", b"of a Mac");
    assert!(Recording::is_one(folder.path()), "without metadata.yaml");
    let (found, left_out, error) = read(folder.path()).unwrap();
    assert_eq!((found, left_out.alone), (PAIRS.to_vec(), [0, 0]));
    let error = error.unwrap();
    assert!(
        error.contains("2 of its files are broken or lacking") && error.contains("ride_1.mcap: the recording is cut"),
        "{error}"
    );
    fs::remove_file(folder.path().join("ride_1.mcap")).unwrap();
    let error = read(folder.path()).unwrap().2.unwrap();
    assert!(error.contains("ride_2.mcap: the recording is cut off: mcap recover"), "{error}");
    for name in ["ride_0.mcap", "ride_3.mcap", "ride_4.mcap"] {
        fs::remove_file(folder.path().join(name)).unwrap();
    }
    assert!(read(folder.path()).unwrap_err().to_string().contains("ride_2.mcap: the recording is cut off"));
}

#[test]
fn files_that_a_recording_lacks_are_told_once_the_others_were_read() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    let metadata = |names: &str| file("metadata.yaml", format!("a:\n  relative_file_paths: [{names}]\n").as_bytes());
    file("ride_0.mcap", &recorded(plain(), &ride()));
    let error = || {
        let (found, _, error) = read(folder.path()).unwrap();
        assert_eq!(found, PAIRS);
        error
    };
    metadata("ride_0.mcap");
    assert_eq!(error(), None);
    metadata("ride/ride_0.mcap, ride/ride_1.mcap, ride/ride_2.mcap");
    let told = error().unwrap();
    assert!(
        told.contains("metadata.yaml: the folder lacks 2 of the files that are named there (ride_1.mcap, ride_2.mcap)"),
        "{told}"
    );
    file("ride_1.mcap", b"");
    let told = error().unwrap();
    assert!(told.contains("2 of its files are broken or lacking") && told.contains("(ride_2.mcap)"), "{told}");
    fs::remove_file(folder.path().join("ride_1.mcap")).unwrap();
    file("metadata.yaml", b"");
    assert!(error().unwrap().contains("metadata.yaml: the file is empty"));
    metadata("'");
    assert!(error().unwrap().contains("which files the recording has is not known"));
}

#[test]
fn what_cannot_be_read_names_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    for (name, told) in [
        ("ride.bag", "mcap convert IN.bag OUT.mcap"),
        ("ride.db3", "mcap convert IN.db3"),
        ("ride.mcap.zstd", "zstd -d"),
        ("short.mcap", "the recording is cut off"),
        ("other.mcap", "no MCAP recording begins there"),
    ] {
        let file = folder.path().join(name);
        fs::write(&file, if name.starts_with("other") { &b"\x89PNG\r\n\x1a\n"[..] } else { b"\x89MCAP" }).unwrap();
        assert!(Recording::is_one(&file), "{name}");
        let error = Recording::open(&file).unwrap_err().to_string();
        assert!(error.contains(told), "{error}");
    }
    let empty = folder.path().join("folder");
    fs::create_dir(&empty).unwrap();
    fs::write(empty.join("metadata.yaml"), "").unwrap();
    assert!(Recording::open(&empty).unwrap_err().to_string().contains("no recording (.mcap) in the folder"));
    fs::write(empty.join("ride_0.db3"), "").unwrap();
    assert!(Recording::open(&empty).unwrap_err().to_string().contains("ride_0.db3: SQLite bags are not read"));

    let (_folder, file) =
        written(&recorded(plain(), &[("/left/image", IMAGE, grey(1, 1)), ("/front", IMAGE, grey(1, 1))]));
    let recording = Recording::open(&file).unwrap();
    let error = |named| recording.both_views(named).unwrap_err().to_string();
    let told = error(None);
    assert!(told.contains("do not tell") && told.contains("/front (1 messages), /left/image (1 messages)"), "{told}");
    assert!(error(Some(["/left/image", "/rear"])).contains("there is no topic /rear; topics of pictures are /front"));
    assert!(error(Some(["/front", "/front"])).contains("are the same"));
    assert!(recording.both_views(Some(["/front", "/left/image"])).is_ok());

    let sent = [("/left/scan", "sensor_msgs/msg/LaserScan", vec![0, 1, 0, 0])];
    let (_folder, file) = written(&recorded(plain(), &sent));
    let recording = Recording::open(&file).unwrap();
    let told = recording.both_views(Some(["/left/scan", "/left/scan"])).unwrap_err().to_string();
    assert!(told.contains("/left/scan has sensor_msgs/msg/LaserScan") && told.contains("no topic has"), "{told}");

    let zstd = [("/left/image", IMAGE, b"\x28\xb5\x2f\xfd12".to_vec()), ("/right/image", IMAGE, grey(2, 1))];
    let (_folder, file) = written(&recorded(plain(), &zstd));
    assert!(
        read(&file)
            .unwrap()
            .2
            .unwrap()
            .contains("there are 0 and 1 that can be read (rosbag2 has compressed the messages")
    );

    let apart = [("/left/image", IMAGE, grey(1, 1)), ("/right/image", IMAGE, grey(2, 1))];
    let (_folder, file) = written(&recorded(plain(), &apart));
    let (found, _, error) = read(&file).unwrap();
    assert!(found.is_empty() && error.unwrap().contains("has a partner of /right/image at the same time"), "none");
}
