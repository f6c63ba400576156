use super::*;
use crate::output::remove_former_checkpoints;

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_run_that_has_taken_no_step_is_in_nobodys_way() {
    let folder = tempfile::tempdir().unwrap();
    let root = &folder.path().join("run");
    let leave = |status, steps| {
        let run = RunDirectory::begin(root, true, false, Some("title = 1\n")).unwrap();
        let summary = Summary { status, steps, ..crate::output::testing::summary(2.0) };
        summary.write(&run).unwrap();
        run
    };
    for (status, steps) in [(Status::Stopped, 1), (Status::Completed, 0), (Status::Failed, 0)] {
        drop(leave(status, steps));
        let refused = RunDirectory::begin(root, false, false, None);
        assert!(matches!(refused, Err(OutputError::Exists { .. })), "{status:?} {steps}");
    }
    // Nor while somebody holds it.
    let held = leave(Status::Stopped, 0);
    assert!(matches!(RunDirectory::check(root, false), Err(OutputError::Exists { .. })));
    drop(held);
    fs::write(root.join("notes.txt"), "mine").unwrap();
    RunDirectory::check(root, false).unwrap();
    let run = RunDirectory::begin(root, false, false, Some("title = 2\n")).unwrap();
    assert!(!run.summary().exists() && fs::read_to_string(root.join("notes.txt")).unwrap() == "mine");
    assert_eq!(fs::read_to_string(run.deck()).unwrap(), "title = 2\n");
    // One that has left a state has gone on from somewhere.
    drop(run);
    write(&leave(Status::Stopped, 0), &["checkpoint-000000000000.zip"]);
    assert!(matches!(RunDirectory::check(root, false), Err(OutputError::Exists { .. })));
}

#[test]
fn an_existing_folder_is_refused_untouched() {
    let folder = tempfile::tempdir().unwrap();
    let refused = || RunDirectory::create(folder.path(), false).unwrap_err();
    drop(RunDirectory::create(folder.path(), false).unwrap());
    assert!(matches!(refused(), OutputError::Exists { .. }));
    let folder = tempfile::tempdir().unwrap();
    let refused = || RunDirectory::create(folder.path(), false).unwrap_err();
    fs::write(folder.path().join("summary.json"), "old").unwrap();
    // `--overwrite` would not help: it is not advised.
    assert!(matches!(refused(), OutputError::NotARun { .. }));
    assert_eq!(names(folder.path()), ["summary.json"]);
}

/// Writes files as a run does.
fn write(run: &RunDirectory, names: &[&str]) {
    for name in names {
        run.write(name, Durability::Process, |out| out.write_all(b"ours")).unwrap();
    }
}

/// A picture as `plot` writes it.
fn draw(run: &Path, name: &str) {
    RunDirectory::open(run).unwrap().note_picture(name).unwrap();
    fs::write(run.join("plots").join(name), "ours").unwrap();
}

#[test]
fn overwriting_removes_what_the_former_run_wrote_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let root = &folder.path().join("run");
    let run = RunDirectory::begin(root, false, false, Some("title = 1\n")).unwrap();
    write(&run, &["summary.json", "fields.pvd", "fields/000003.vtp", "checkpoint-000000000012.zip"]);
    let (opened, _) = run.share("fields/000004").unwrap();
    opened.make_inside("fields/000004").unwrap();
    fs::write(root.join("fields/000004/0001.vtp"), "ours").unwrap();
    draw(root, "pressure-last.png");
    drop(run);
    // Names that a run could have given, and of those that it has given only these.
    let foreign = [
        "notes.txt",
        "history.csv",
        "fields/mine.vtp",
        "fields/000005.vtp",
        "fields/000004/notes.txt",
        "checkpoint-000000000013.zip",
        "plots/pressure-mine.png",
    ];
    for name in foreign {
        fs::write(root.join(name), "mine").unwrap();
    }
    let run = RunDirectory::begin(root, true, false, Some("title = 2\n")).unwrap();
    assert_eq!(fs::read_to_string(root.join("deck.toml")).unwrap(), "title = 2\n");
    let kept = |inside: &str| names(&root.join(inside));
    let top = [
        ".sphorge-lock",
        ".sphorge-run",
        "checkpoint-000000000013.zip",
        "deck.toml",
        "fields",
        "history.csv",
        "notes.txt",
    ];
    assert_eq!(kept(""), [&top[..], &["plots"]].concat());
    assert_eq!(kept("fields"), ["000004", "000005.vtp", "mine.vtp"]);
    assert_eq!((kept("fields/000004"), kept("plots")), (vec!["notes.txt".into()], vec!["pressure-mine.png".into()]));
    assert!(foreign.iter().all(|name| fs::read_to_string(root.join(name)).unwrap() == "mine"));
    // The new run answers for its own files alone.
    drop(run);
    fs::write(root.join("summary.json"), "mine").unwrap();
    drop(RunDirectory::create(root, true).unwrap());
    assert!(root.join("summary.json").exists() && !root.join("deck.toml").exists());
}

#[test]
fn files_with_the_names_of_a_run_do_not_make_a_folder_one() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    for name in ["history.csv", "deck.toml", "summary.json", "fields.pvd"] {
        fs::write(root.join(name), "the only copy").unwrap();
        assert!(matches!(RunDirectory::create(root, true), Err(OutputError::NotARun { .. })), "{name}");
    }
    assert_eq!(names(root).len(), 4);
}

#[cfg(unix)]
#[test]
fn nothing_behind_a_link_is_removed_or_written() {
    use std::os::unix::fs::symlink;
    for linked in ["fields", "plots"] {
        let folder = tempfile::tempdir().unwrap();
        let (root, own) = (folder.path().join("run"), folder.path().join("own"));
        let run = RunDirectory::begin(&root, false, false, Some("former")).unwrap();
        write(&run, &["fields/000001.vtp"]);
        draw(&root, "pressure-last.png");
        drop(run);
        fs::rename(root.join(linked), &own).unwrap();
        symlink(&own, root.join(linked)).unwrap();
        let before = names(&own);
        let made = RunDirectory::begin(&root, true, false, Some("new")).map(drop);
        let resumed = RunDirectory::go_on(&root, false).map(drop);
        let drawn = RunDirectory::open(&root).unwrap().note_picture("history.png");
        match linked {
            "fields" => {
                for refused in [made, resumed] {
                    let Err(OutputError::InTheWay { name, source, .. }) = refused else { panic!("{refused:?}") };
                    assert_eq!(
                        (name, source.to_string().as_str()),
                        (linked, "is a symbolic link, which is not followed")
                    );
                }
                assert_eq!(fs::read_to_string(root.join("deck.toml")).unwrap(), "former");
            }
            _ => {
                made.unwrap();
                assert!(matches!(drawn, Err(OutputError::InTheWay { .. })), "{drawn:?}");
            }
        }
        assert_eq!(names(&own), before, "{linked}");
    }
}

#[test]
fn what_was_killed_before_its_deck_was_written_is_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::create_dir(root.join("fields")).unwrap();
    for name in [".sphorge-lock", ".sphorge-a1.unfinished"] {
        fs::write(root.join(name), "").unwrap();
    }
    drop(RunDirectory::create(root, true).unwrap());
    fs::remove_file(root.join(".sphorge-run")).unwrap();
    drop(RunDirectory::create(root, true).unwrap());
    fs::remove_file(root.join(".sphorge-run")).unwrap();
    fs::write(root.join("fields/mine.vtp"), "").unwrap();
    assert!(matches!(RunDirectory::create(root, true), Err(OutputError::NotARun { .. })));
}

#[test]
fn two_runs_do_not_write_into_one_folder() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("run");
    let first = RunDirectory::create(&root, false).unwrap();
    write(&first, &["summary.json"]);
    for refused in [RunDirectory::create(&root, true), RunDirectory::go_on(&root, false)] {
        let Err(OutputError::Locked { owner, .. }) = refused else { panic!("{refused:?}") };
        assert!(owner.starts_with(&format!("process {} on ", std::process::id())), "{owner}");
    }
    assert_eq!(fs::read_to_string(root.join("summary.json")).unwrap(), "ours");
    drop(first);
    RunDirectory::create(&root, true).unwrap();
}

/// Why a run does not write any more.
fn lost(run: &RunDirectory) -> &'static str {
    match run.write("history.csv", Durability::Process, |out| out.write_all(b"former")) {
        Err(OutputError::Lost { reason, .. }) => reason,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_run_whose_folder_is_moved_or_taken_writes_to_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let (root, moved) = (folder.path().join("run"), folder.path().join("moved"));
    let former = RunDirectory::create(&root, false).unwrap();
    write(&former, &["history.csv"]);
    fs::rename(&root, &moved).unwrap();
    assert!(lost(&former).contains("moved"));
    let new = RunDirectory::create(&root, false).unwrap();
    write(&new, &["history.csv"]);
    assert!(lost(&former).contains("moved"));
    assert_eq!(fs::read_to_string(root.join("history.csv")).unwrap(), "ours");
    // Brought back, it goes on.
    drop(new);
    fs::remove_dir_all(&root).unwrap();
    fs::rename(&moved, &root).unwrap();
    write(&former, &["history.csv"]);
    // Taken by force, or its lock removed.
    let taken = RunDirectory::go_on(&root, true).unwrap();
    assert!(lost(&former).contains("lock"));
    write(&taken, &["history.csv"]);
    fs::remove_file(root.join(".sphorge-lock")).unwrap();
    assert!(lost(&taken).contains("lock"));
    // Removed, and made anew.
    let last = RunDirectory::create(&root, true).unwrap();
    fs::remove_dir_all(&root).unwrap();
    assert!(lost(&last).contains("removed"));
    assert!(!root.exists());
}

#[test]
fn other_processes_of_a_run_do_not_write_to_another() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("run");
    let former = RunDirectory::create(&root, false).unwrap();
    let (_, shared) = former.share("fields/000001").unwrap();
    shared.open().unwrap();
    drop(former);
    let _new = RunDirectory::create(&root, true).unwrap();
    assert!(matches!(shared.open(), Err(OutputError::Lost { .. })));
}

#[test]
fn a_run_that_goes_on_keeps_the_frames_it_had() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path();
    fs::create_dir(root.join("fields")).unwrap();
    for name in ["summary.json", "fields/000001.vtp", "fields/000002.vtp", "fields/000003.vtp", "fields/mine.vtp"] {
        fs::write(root.join(name), "x").unwrap();
    }
    let directory = RunDirectory::go_on(root, false).unwrap();
    assert!(directory.summary().exists() && !directory.has_checkpoint());
    directory.clear_end().unwrap();
    directory.remove_frames(2).unwrap();
    assert_eq!(names(&root.join("fields")), ["000001.vtp", "mine.vtp"]);
    assert_eq!(names(root), [".sphorge-lock", "fields"]);
    // Its first file brings the mark that it has lost, with the files that it had.
    write(&directory, &["history.csv"]);
    drop(directory);
    RunDirectory::create(root, true).unwrap();
    assert_eq!(names(&root.join("fields")), ["mine.vtp"]);
}

#[test]
fn a_run_that_goes_on_removes_no_file_that_is_not_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let root = &folder.path().join("run");
    let run = RunDirectory::create(root, false).unwrap();
    let own = ["fields/000001.vtp", "fields/000002.vtp", "checkpoint-000000000007.zip", "checkpoint-000000000008.zip"];
    write(&run, &own);
    write(&run, &["checkpoint-000000000009.zip"]);
    let (opened, _) = run.share("fields/000003").unwrap();
    opened.make_inside("fields/000003").unwrap();
    let (opened, _) = run.share("checkpoint-000000000007-parts-aa").unwrap();
    opened.make_inside("checkpoint-000000000007-parts-aa").unwrap();
    drop(run);
    let foreign = [
        "fields/000004.vtp",
        "fields/000005/0000.vtp",
        "checkpoint-000000000001.zip",
        "checkpoint-000000000012.zip",
        "checkpoint-000000000003-parts-bb/0001.zip",
    ];
    for name in foreign.map(|name| root.join(name)) {
        fs::create_dir_all(name.parent().unwrap()).unwrap();
        fs::write(name, "mine").unwrap();
    }
    let run = RunDirectory::go_on(root, false).unwrap();
    run.clear_end().unwrap();
    run.remove_frames(2).unwrap();
    remove_former_checkpoints(&run).unwrap();
    assert_eq!(names(&root.join("fields")), ["000001.vtp", "000004.vtp", "000005"]);
    assert!(foreign.iter().all(|name| root.join(name).exists()));
    let is_there = |step: u64| root.join(format!("checkpoint-{step:012}.zip")).exists();
    assert_eq!([7, 8, 9].map(is_there), [false, true, true]);
    assert!(!root.join("checkpoint-000000000007-parts-aa").exists());
}

#[test]
fn a_folder_that_is_no_run_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("deck.toml"), "the only copy").unwrap();
    assert!(matches!(RunDirectory::create(folder.path(), true), Err(OutputError::NotARun { .. })));
    assert_eq!(names(folder.path()), ["deck.toml"]);
    let file = folder.path().join("deck.toml");
    assert!(matches!(RunDirectory::create(&file, true), Err(OutputError::NotARun { .. })));
}

/// Who may write anywhere, as `root` may, sees nothing of this.
#[cfg(unix)]
#[test]
fn a_run_that_nobody_may_write_to_is_not_said_to_have_a_lock_in_its_way() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("run");
    drop(RunDirectory::begin(&root, false, false, Some("title = 1\n")).unwrap());
    let allow = |path: &Path, mode| fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
    let lock = root.join(".sphorge-lock");
    allow(&lock, 0o444);
    allow(&root, 0o555);
    if fs::File::create(root.join("anything")).is_err() {
        let refused = RunDirectory::go_on(&root, false);
        assert!(matches!(refused, Err(OutputError::UnwritableRun { .. })), "{refused:?}");
        let drawn = RunDirectory::open(&root).unwrap().note_picture("a.png").unwrap_err();
        assert!(drawn.is_of_the_place(), "{drawn:?}");
    }
    allow(&root, 0o755);
}

#[test]
fn a_file_that_cannot_be_written_at_its_place_says_where_to_look() {
    use miette::Diagnostic;
    let of = |kind: io::ErrorKind| OutputError::Write { path: "a.png".into(), source: kind.into() };
    let help = |error: &OutputError| error.help().unwrap().to_string();
    for kind in [io::ErrorKind::PermissionDenied, io::ErrorKind::ReadOnlyFilesystem] {
        assert!(of(kind).is_of_the_place() && help(&of(kind)).contains("-o"), "{kind}");
    }
    assert!(of(io::ErrorKind::NotADirectory).is_of_the_place());
    let full = of(io::ErrorKind::StorageFull);
    assert!(!full.is_of_the_place() && help(&full).contains("disk is not full"));
}

#[test]
fn a_run_that_was_killed_is_told_to_be_resumed_where_it_can_be() {
    use miette::Diagnostic;
    let folder = tempfile::tempdir().unwrap();
    let help = || OutputError::NotEnded { path: folder.path().to_owned() }.help().unwrap().to_string();
    assert!(help().contains("--overwrite` runs its deck again") && !help().contains("resume"), "{}", help());
    fs::write(folder.path().join("checkpoint-000000000012.zip"), "").unwrap();
    assert!(help().contains("sphorge resume") && !help().contains("--overwrite"), "{}", help());
}

#[test]
fn missing_parents_are_made_and_a_file_in_the_way_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    RunDirectory::create(&folder.path().join("a/b/c"), false).unwrap();
    fs::write(folder.path().join("file"), "").unwrap();
    let blocked = RunDirectory::create(&folder.path().join("file/run"), false);
    assert!(matches!(blocked, Err(OutputError::Unwritable { .. })), "{blocked:?}");
}
