//! The viewer by plain HTTP: what is served to whom, while a run grows, and what is told of bad input.

mod common;

use common::{Ended, Place, files, wait_for};
use std::{
    fs,
    io::{BufRead, BufReader, Read, Write},
    net::{TcpListener, TcpStream},
    process::Child,
    time::Duration,
};

/// A viewer that runs until it is dropped.
struct Served {
    child: Child,
    /// Such as 127.0.0.1:40000.
    host: String,
    token: String,
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Served {
    fn new(place: &Place, arguments: &[&str]) -> Self {
        let mut child = place.command(&[&["view", "--no-open"], arguments].concat()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
        Self::at(child, &line)
    }

    fn at(child: Child, address: &str) -> Self {
        let (host, token) = address.trim().strip_prefix("http://").unwrap().split_once('/').unwrap();
        Self { child, host: host.to_owned(), token: token.trim_end_matches('/').to_owned() }
    }

    /// Code, head and body of the answer to a request line.
    fn raw(&self, line: &str) -> (u16, String, Vec<u8>) {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
        write!(stream, "{line} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n", self.host).unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        let end = answer.windows(4).position(|four| four == b"\r\n\r\n").unwrap();
        let head = String::from_utf8(answer[..end].to_vec()).unwrap();
        (head[9..12].parse().unwrap(), head, answer[end + 4..].to_vec())
    }

    fn get(&self, path: &str) -> (u16, String, Vec<u8>) {
        self.raw(&format!("GET /{}/{path}", self.token))
    }

    fn json(&self, path: &str) -> serde_json::Value {
        let (code, _, body) = self.get(path);
        assert_eq!(code, 200, "{path}");
        serde_json::from_slice(&body).unwrap()
    }

    fn frames(&self) -> usize {
        self.json("runs.json")[0]["times"].as_array().unwrap().len()
    }
}

fn with_run() -> Place {
    let place = Place::new();
    place.run(&["run", "plate.toml", "-q"]).expect_code(0);
    place
}

#[test]
fn the_page_and_its_numbers_are_served_and_nothing_is_written() {
    let place = with_run();
    let before = files(&place.path("out/plate")).len();
    let served = Served::new(&place, &["out/plate"]);
    assert!(served.host.starts_with("127.0.0.1:") && served.token.len() == 32);
    let (code, head, page) = served.get("");
    let page = String::from_utf8(page).unwrap();
    assert!(code == 200 && page.contains("<canvas") && head.contains("text/html"), "{head}");
    assert!(
        head.contains("Content-Security-Policy: default-src 'none'") && head.contains("Referrer-Policy: no-referrer"),
        "{head}"
    );
    // Every part that the page names is there.
    let parts: Vec<&str> = page.split(['"']).filter(|word| word.ends_with(".js") || word.ends_with(".css")).collect();
    assert!(parts.len() > 10, "{parts:?}");
    assert!(parts.iter().all(|part| served.get(part).0 == 200), "{parts:?}");
    let run = &served.json("runs.json")[0];
    assert_eq!((run["count"].as_u64(), run["status"].as_str()), (Some(192), Some("completed")));
    assert_eq!((run["bodies"][0]["name"].as_str(), run["walls"][0]["normal"][1].as_f64()), (Some("plate"), Some(1.0)));
    assert_eq!(served.json("start.json")["maps"][0][1].as_str().map(str::len), Some(6 * 256));
    let (code, _, pressure) = served.get("run/0/frame/4/array/pressure");
    assert_eq!((code, pressure.len()), (200, 64 + 4 * 192));
    let (_, _, range) = served.get("run/0/frame/4/range/pressure");
    assert_eq!(range, pressure[..64]);
    assert_eq!(served.get("run/0/frame/4/array/position").2.len(), 64 + 12 * 192);
    let particle = served.json("run/0/frame/4/particle/7");
    let value = particle["fields"].as_array().unwrap().iter().find(|field| field["name"] == "pressure").unwrap();
    let sent = f32::from_le_bytes(pressure[64 + 28..64 + 32].try_into().unwrap());
    assert_eq!((value["values"][0].as_f64(), particle["body"].as_str()), (Some(f64::from(sent)), Some("plate")));
    let time = run["columns"].as_array().unwrap().iter().position(|column| column["name"] == "time").unwrap();
    let (_, _, times) = served.get(&format!("run/0/history/{time}"));
    assert_eq!(f64::from_le_bytes(times[times.len() - 8..].try_into().unwrap()), 2e-6);
    assert_eq!(served.raw(&format!("HEAD /{}/", served.token)).2.len(), 0);
    assert_eq!(files(&place.path("out/plate")).len(), before);
}

#[test]
fn who_does_not_know_the_address_and_what_is_outside_are_refused() {
    let place = with_run();
    let served = Served::new(&place, &["out/plate"]);
    let token = &served.token;
    let other = "0".repeat(32);
    for path in [
        "/",
        "/runs.json",
        &format!("/{other}/"),
        &format!("/{other}/runs.json"),
        &format!("/{}/", &token[1..]),
        &format!("/{token}0/"),
        "*",
    ] {
        let (code, _, body) = served.raw(&format!("GET {path}"));
        assert_eq!((code, String::from_utf8_lossy(&body).contains(token)), (403, false), "{path}");
    }
    for path in [
        "../deck.toml",
        "deck.toml",
        "..%2fdeck.toml",
        "run/0/frame/0/array/../../../../deck.toml",
        "//etc/passwd",
        "run/7/cells",
        "run/0/frame/0/array/%2e%2e",
    ] {
        let (code, _, body) = served.get(path);
        assert!(code == 404 && !String::from_utf8_lossy(&body).contains("armco-iron"), "{path}: {code}");
    }
    let (code, _, body) = served.get("run/0/frame/0/array/presure");
    let text = String::from_utf8(body).unwrap();
    assert!(code == 404 && text.contains("no field `presure`") && text.contains("`pressure`"), "{text}");
    assert_eq!(served.get("run/0/frame/99/array/pressure").0, 404);
    assert_eq!(served.get("run/0/frame/0/particle/192").0, 404);
    for method in ["POST", "PUT", "DELETE", "OPTIONS"] {
        assert_eq!(served.raw(&format!("{method} /{token}/runs.json")).0, 405, "{method}");
        assert_eq!(served.raw(&format!("{method} /runs.json")).0, 403, "{method}");
    }
    // What is no request at all does not end the program.
    let mut stream = TcpStream::connect(&served.host).unwrap();
    stream.write_all(&[b'x'; 70_000]).ok();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).ok();
    assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 400"), "{answer}");
    assert_eq!(served.frames(), 5);
}

#[test]
fn requests_behind_each_other_on_one_connection_are_all_answered() {
    let place = with_run();
    let served = Served::new(&place, &["out/plate"]);
    let mut stream = TcpStream::connect(&served.host).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
    let request = |close: &str| format!("GET /{}/main.js HTTP/1.1\r\nHost: x\r\n{close}\r\n", served.token);
    stream.write_all((request("") + &request("") + &request("Connection: close\r\n")).as_bytes()).unwrap();
    let mut answers = String::new();
    stream.read_to_string(&mut answers).unwrap();
    assert_eq!(answers.matches("HTTP/1.1 200 OK").count(), 3);
}

#[test]
fn a_run_that_grows_vanishes_and_comes_back_is_seen_as_it_is() {
    let place = with_run();
    let (folder, series) = (place.path("out/plate"), place.path("out/plate/fields.pvd"));
    let whole = fs::read_to_string(&series).unwrap();
    // Frames come when they are there, whether they are listed or not.
    let two: String = whole
        .lines()
        .filter(|line| !["000002", "000003", "000004"].iter().any(|k| line.contains(k)))
        .map(|line| format!("{line}\n"))
        .collect();
    fs::write(&series, two).unwrap();
    let third = folder.join("fields/000002.vtp");
    fs::rename(&third, place.path("third")).unwrap();
    fs::remove_file(folder.join("summary.json")).unwrap();
    let served = Served::new(&place, &["out/plate"]);
    let told = &served.json("runs.json")[0];
    assert_eq!((served.frames(), told["status"].as_str()), (2, Some("interrupted")));
    // The history has gone on to the end.
    assert!(told["end"].as_f64().unwrap() > 0.0 && told["reached"] == told["end"], "{told}");
    fs::rename(place.path("third"), &third).unwrap();
    assert_eq!(served.frames(), 5);
    fs::write(&series, whole).unwrap();
    assert_eq!(served.frames(), 5);
    assert_eq!(served.get("run/0/frame/4/array/pressure").0, 200);
    fs::rename(&folder, place.path("out/away")).unwrap();
    let gone = &served.json("runs.json")[0];
    assert!(gone["error"].as_str().unwrap().contains("it does not exist"), "{gone}");
    assert_eq!((served.get("").0, served.get("run/0/frame/4/array/pressure").0), (200, 404));
    fs::rename(place.path("out/away"), &folder).unwrap();
    assert_eq!(served.frames(), 5);
}

#[test]
fn a_run_with_a_page_shows_it_from_its_beginning_and_leaves_it_open() {
    let place = Place::new();
    let mut child = place.command(&["run", "plate.toml", "--view", "--no-open", "--json"]).spawn().unwrap();
    let mut line = String::new();
    let mut told = BufReader::new(child.stderr.take().unwrap());
    while !line.starts_with("http://") {
        line.clear();
        assert!(told.read_line(&mut line).unwrap() > 0);
    }
    let mut served = Served::at(child, &line);
    wait_for("the last frame", || served.json("runs.json")[0]["status"] == "completed");
    assert_eq!(served.frames(), 5);
    assert!(served.child.try_wait().unwrap().is_none());
    // Standard output is the summary alone.
    #[cfg(unix)]
    {
        assert!(
            std::process::Command::new("kill")
                .args(["-INT", &served.child.id().to_string()])
                .status()
                .unwrap()
                .success()
        );
        let mut out = String::new();
        served.child.stdout.take().unwrap().read_to_string(&mut out).unwrap();
        assert!(served.child.wait().unwrap().success());
        let printed: serde_json::Value = serde_json::from_str(&out).unwrap();
        assert_eq!(printed, place.summary("out/plate"));
        let mut rest = String::new();
        told.read_to_string(&mut rest).unwrap();
        assert!(rest.contains("until Ctrl-C") && !rest.contains("stopping after this step"), "{rest}");
    }
}

#[test]
fn bad_input_is_refused_with_what_was_meant() {
    let place = with_run();
    fs::create_dir(place.path("empty")).unwrap();
    fs::create_dir(place.path("folder.html")).unwrap();
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port().to_string();
    let cases: [(&[&str], &[&str]); 21] = [
        (&["nowhere"], &["nowhere is not the folder of a run: it does not exist", "out/plate"]),
        (&["plate.toml"], &["plate.toml is not the folder of a run", "may be out/plate"]),
        (&["empty"], &["empty is not the folder of a run", "out/plate"]),
        (&["out/plate", "empty"], &["empty is not the folder of a run"]),
        (&["out/plate", "--field", "presure"], &["no field `presure`", "did you mean `pressure`"]),
        (&["out/plate", "--field", "stress.xq"], &["no field `stress.xq`"]),
        (&["out/plate", "--body", "plat"], &["no body `plat`", "did you mean `plate`"]),
        (&["out/plate", "--column", "hight"], &["no column `hight`", "did you mean `height`"]),
        (&["out/plate", "--frame", "9"], &["there is no frame 9", "the run has frames 0 to 4"]),
        (&["out/plate", "--mirror"], &["no plane of symmetry"]),
        (&["out"], &["not the folder of a run", "give one of the runs in it: out/plate"]),
        (&["out/plate", "--field", "pressure", "--range", "2,1 GPa"], &["the first value is not the smaller one"]),
        (
            &["out/plate", "--range", "2,1"],
            &["`--range 2,1` of plastic_strain", "the first value is not the smaller one"],
        ),
        (&["out/plate", "--range", "0,1 GPa"], &["`--range 0,1 GPa` of plastic_strain"]),
        (
            &["out/plate", "--section=x at 1 m"],
            &["the section cuts nothing: it is at 1 m (x)", "and the bodies are between"],
        ),
        (
            &["out/plate", "--body", "plate", "--section=1,1,0 at 1,1,0 m"],
            &["the section cuts nothing", "along the normal"],
        ),
        (&["out/plate", "-o", "folder.html"], &["folder.html is no file"]),
        (&["out/plate", "--port", &port], &["cannot listen on port", &port, "leave out `--port`"]),
        (&["out/plate", "-o", "page.png"], &["page.png is not the name of a page", "end it with .html"]),
        (&["out/plate", "-o", "page.html", "--most", "2 kB"], &["more than the 2.0 kB", "`--most`"]),
        (&["out/plate", "-o", "page.html", "--most", "much"], &["write a size"]),
    ];
    for (arguments, texts) in cases {
        let ended =
            place.run(&[&["view", "--no-open"][..if arguments.contains(&"-o") { 1 } else { 2 }], arguments].concat());
        ended.expect_code(2).expect_told(texts);
    }
    assert!(!place.path("page.html").exists());
}

#[test]
fn a_single_page_is_written_below_its_size() {
    let place = with_run();
    let Ended { out, err, .. } = place.run(&["view", "out/plate", "-o", "page.html", "--most", "1 MB"]).expect_code(0);
    let page = fs::read_to_string(place.path("page.html")).unwrap();
    assert!(page.len() < 1_000_000 && out.contains("page.html") && err.contains("rounded"), "{out} {err}");
    assert!(!page.contains(" src=\"") && page.contains("id=\"bytes\""));
    // Folders are made, as those of pictures are.
    place.run(&["view", "out/plate", "-o", "new/folder/page.html", "--most", "1 MB"]).expect_code(0);
    assert!(place.path("new/folder/page.html").is_file());
    // It is not replaced unasked.
    fs::write(place.path("page.html"), "mine").unwrap();
    let again = ["view", "out/plate", "-o", "page.html", "--field", "pressure"];
    place.run(&again).expect_code(2).expect_told(&["page.html exists already", "`--overwrite`"]);
    assert_eq!(fs::read_to_string(place.path("page.html")).unwrap(), "mine");
    place.run(&[&again[..], &["--overwrite"]].concat()).expect_code(0);
    assert!(fs::read_to_string(place.path("page.html")).unwrap().contains("id=\"bytes\""));
}
