//! Key F1, which opens the lessons with the system's opener.

use std::fs;
use std::os::unix::fs::PermissionsExt;

use crate::app::App;
use crate::display::{Display, until};

#[test]
fn a_key_opens_the_lessons() {
    let Some(display) = Display::open() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let opener = folder.path().join("xdg-open");
    fs::write(
        &opener,
        "#!/bin/sh\necho \"$@\" > asked.tmp\nmv asked.tmp asked\n",
    )
    .unwrap();
    fs::set_permissions(&opener, fs::Permissions::from_mode(0o755)).unwrap();
    let app = App::open(&display, folder.path(), &["r", "0.01", "--scene", "simple"]);
    app.press("F1");
    let asked = folder.path().join("asked");
    let asked = until("the opener", || fs::read_to_string(&asked).ok());
    let index = folder.path().join("a3/lessons/README.md");
    assert_eq!(asked.trim_end(), index.to_str().unwrap());
    let page = fs::read_to_string(index).unwrap();
    assert!(page.starts_with("# Lessons"), "{page}");
    app.expect_frames();
}
