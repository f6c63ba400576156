//! As much of HTTP/1.1 as a browser on this machine needs: requests without a body, each connection in a thread of its own, kept for the next
//! request. What is longer, slower or other than a browser's is refused.

use serde::Serialize;
use std::{
    io::{self, Read, Write},
    net::{Shutdown, TcpListener, TcpStream},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    thread,
    time::{Duration, Instant},
};

/// Longest head of a request, bytes; most lines of it.
const LONGEST: usize = 16 << 10;
const MOST_LINES: usize = 100;
/// Connections side by side: a browser opens six. One more takes the place of the one that has waited longest.
const MOST_CONNECTIONS: usize = 48;
/// How long a connection is kept without a request, and how long a reader may let us wait.
const IDLE: Duration = Duration::from_secs(60);

/// What a browser is to do with any answer: take it for what it is called, fetch from here alone, show it in no other page, tell nobody the address, which
/// is a secret, and keep nothing, for a run goes on.
const HEADERS: &str = "\
X-Content-Type-Options: nosniff\r\n\
Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data: blob:; frame-ancestors 'none'\r\n\
Cross-Origin-Resource-Policy: same-origin\r\n\
Referrer-Policy: no-referrer\r\n\
Cache-Control: no-store\r\n";

/// An answer: its code, what it is, and its bytes.
pub(super) struct Answer {
    pub(super) code: u16,
    pub(super) kind: &'static str,
    pub(super) bytes: Vec<u8>,
}

impl Answer {
    pub(super) fn text(code: u16, text: &str) -> Self {
        Self { code, kind: "text/plain; charset=utf-8", bytes: text.as_bytes().to_vec() }
    }

    pub(super) fn json(value: &impl Serialize) -> Self {
        match serde_json::to_vec(value) {
            Ok(bytes) => Self { code: 200, kind: "application/json", bytes },
            Err(error) => Self::text(500, &error.to_string()),
        }
    }

    pub(super) fn numbers(bytes: Vec<u8>) -> Self {
        Self { code: 200, kind: "application/octet-stream", bytes }
    }

    fn reason(&self) -> &'static str {
        match self.code {
            200 => "OK",
            400 => "Bad Request",
            403 => "Forbidden",
            404 => "Not Found",
            405 => "Method Not Allowed",
            _ => "Internal Server Error",
        }
    }

    /// Writes it; without its bytes to who asked for the head alone.
    fn write(&self, out: &mut impl Write, head_alone: bool, is_last: bool) -> io::Result<()> {
        let last = if is_last { "Connection: close\r\n" } else { "" };
        let allow = if self.code == 405 { "Allow: GET, HEAD\r\n" } else { "" };
        let head = format!(
            "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\n{HEADERS}{allow}{last}\r\n",
            self.code,
            self.reason(),
            self.kind,
            self.bytes.len()
        );
        out.write_all(head.as_bytes())?;
        if !head_alone {
            out.write_all(&self.bytes)?;
        }
        out.flush()
    }
}

/// A request as far as it matters.
#[derive(Debug, PartialEq)]
struct Head {
    method: String,
    address: String,
    is_last: bool,
    has_body: bool,
    /// Bytes of it.
    length: usize,
}

/// Reads the head of a request; none while it is not complete.
fn read_head(bytes: &[u8]) -> Result<Option<Head>, ()> {
    let mut headers = [httparse::EMPTY_HEADER; MOST_LINES];
    let mut request = httparse::Request::new(&mut headers);
    let httparse::Status::Complete(length) = request.parse(bytes).map_err(drop)? else { return Ok(None) };
    let (Some(method), Some(address)) = (request.method, request.path) else { return Err(()) };
    let value = |name: &str| {
        let header = request.headers.iter().find(|header| header.name.eq_ignore_ascii_case(name));
        header.map(|header| String::from_utf8_lossy(header.value).trim().to_ascii_lowercase())
    };
    let is_last = request.version != Some(1) || value("connection").is_some_and(|words| words.contains("close"));
    let has_body = value("transfer-encoding").is_some() || value("content-length").is_some_and(|length| length != "0");
    Ok(Some(Head { method: method.to_owned(), address: address.to_owned(), is_last, has_body, length }))
}

/// The connections that are open: whoever connects is answered, however many others only hold theirs.
#[derive(Default)]
struct Connections(Mutex<Vec<Connection>>);

struct Connection {
    number: u64,
    stream: TcpStream,
    /// It has asked for something and has not taken all of the answer.
    is_answered: bool,
    since: Instant,
}

impl Connections {
    fn lock(&self) -> MutexGuard<'_, Vec<Connection>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes a connection in. Where there are as many as may be, the one that has waited longest for a request is ended, and only where all are
    /// being answered the one whose answer has taken longest.
    fn enter(&self, number: u64, stream: TcpStream) {
        let mut open = self.lock();
        if open.len() >= MOST_CONNECTIONS {
            let last = (0..open.len()).min_by_key(|&k| (open[k].is_answered, open[k].since));
            if let Some(k) = last {
                // Its thread wakes up and finds that nobody is there.
                let _ = open.swap_remove(k).stream.shutdown(Shutdown::Both);
            }
        }
        open.push(Connection { number, stream, is_answered: false, since: Instant::now() });
    }

    fn note(&self, number: u64, is_answered: bool) {
        if let Some(own) = self.lock().iter_mut().find(|own| own.number == number) {
            (own.is_answered, own.since) = (is_answered, Instant::now());
        }
    }

    fn leave(&self, number: u64) {
        self.lock().retain(|own| own.number != number);
    }
}

/// Answers the requests of whoever connects, until the program ends.
pub(super) fn serve(listener: &TcpListener, answer: impl Fn(&str, &str) -> Answer + Send + Sync + 'static) {
    let answer = Arc::new(answer);
    let open = Arc::new(Connections::default());
    for (number, stream) in (0..).zip(listener.incoming()) {
        // Too many files are open, or who has called is gone: the next one may do.
        let Some((stream, second)) =
            stream.ok().and_then(|stream| stream.try_clone().ok().map(|second| (stream, second)))
        else {
            thread::sleep(Duration::from_millis(10));
            continue;
        };
        open.enter(number, second);
        let (answer, of_thread) = (Arc::clone(&answer), Arc::clone(&open));
        let attended = thread::Builder::new().spawn(move || {
            // A page that goes away in the middle of an answer is no fault.
            let _ = attend(stream, &*answer, |is_answered| of_thread.note(number, is_answered));
            of_thread.leave(number);
        });
        // Without a thread nobody is answered.
        if attended.is_err() {
            open.leave(number);
        }
    }
}

/// Answers the requests of one connection; tells when it begins with an answer and when it has ended with it.
fn attend(mut stream: TcpStream, answer: &impl Fn(&str, &str) -> Answer, note: impl Fn(bool)) -> io::Result<()> {
    stream.set_read_timeout(Some(IDLE))?;
    stream.set_write_timeout(Some(IDLE))?;
    stream.set_nodelay(true)?;
    let mut bytes = Vec::new();
    loop {
        let head = loop {
            match read_head(&bytes) {
                Ok(Some(head)) => break head,
                Ok(None) if bytes.len() < LONGEST => {}
                Ok(None) | Err(()) => {
                    return Answer::text(400, "This is no request of a browser.\n").write(&mut stream, false, true);
                }
            }
            let mut part = [0; 4096];
            match stream.read(&mut part)? {
                0 => return Ok(()),
                count => bytes.extend_from_slice(&part[..count]),
            }
        };
        // A body, which nothing here takes, would pass for the next request.
        let is_last = head.is_last || head.has_body;
        note(true);
        answer(&head.method, &head.address).write(&mut stream, head.method == "HEAD", is_last)?;
        note(false);
        if is_last {
            return Ok(());
        }
        bytes.drain(..head.length);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_are_read_whole_and_others_refused() {
        let text = b"GET /a/b?c HTTP/1.1\r\nHost: x\r\nConnection: keep-alive\r\n\r\nGET /next";
        let head = read_head(text).unwrap().unwrap();
        assert_eq!(
            (head.method.as_str(), head.address.as_str(), head.is_last, head.has_body),
            ("GET", "/a/b?c", false, false)
        );
        assert_eq!(&text[head.length..], b"GET /next");
        assert_eq!(read_head(&text[..30]), Ok(None));
        let last = |text: &str| read_head(text.as_bytes()).unwrap().unwrap().is_last;
        assert!(last("GET / HTTP/1.0\r\n\r\n") && last("GET / HTTP/1.1\r\nconnection: Close\r\n\r\n"));
        assert!(read_head(b"POST / HTTP/1.1\r\nContent-Length: 3\r\n\r\n").unwrap().unwrap().has_body);
        for bad in [
            &b"\x16\x03\x01\x02\x00\x01"[..],
            b"GET /a b c HTTP/1.1\r\n\r\n",
            b"GET / SPDY\r\n\r\n",
            b"GET / HTTP/1.1\r\n a\r\n\r\n",
        ] {
            assert_eq!(read_head(bad), Err(()), "{bad:?}");
        }
    }

    #[test]
    fn the_head_alone_says_how_long_the_answer_is() {
        let mut out = Vec::new();
        Answer::text(405, "No.\n").write(&mut out, true, true).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert!(text.starts_with("HTTP/1.1 405 Method Not Allowed\r\n") && text.ends_with("\r\n\r\n"), "{text}");
        assert!(
            text.contains("Content-Length: 4\r\n")
                && text.contains("Allow: GET")
                && text.contains("Connection: close\r\n")
        );
    }

    /// An answer to a request on a connection of its own, in time.
    fn asked(port: u16) -> String {
        let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(20))).unwrap();
        stream.write_all(b"GET /short HTTP/1.1\r\nConnection: close\r\n\r\n").unwrap();
        let mut text = String::new();
        stream.read_to_string(&mut text).unwrap();
        text
    }

    #[test]
    fn who_only_holds_a_connection_keeps_nobody_out() {
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let port = listener.local_addr().unwrap().port();
        thread::spawn(move || {
            serve(&listener, |_, address| match address {
                "/long" => Answer::numbers(vec![0; 20_000_000]),
                _ => Answer::text(200, "short\n"),
            });
        });
        let connect = || TcpStream::connect(("127.0.0.1", port)).unwrap();
        let mut held: Vec<TcpStream> = Vec::new();
        for k in 0..2 * MOST_CONNECTIONS {
            let mut stream = connect();
            // Some say nothing, some half of a request, some do not take their answer.
            match k % 3 {
                0 => stream.write_all(b"GET /short HTTP/1.1\r\nHost:").unwrap(),
                1 if k < MOST_CONNECTIONS => stream.write_all(b"GET /long HTTP/1.1\r\n\r\n").unwrap(),
                _ => {}
            }
            held.push(stream);
        }
        assert!(asked(port).ends_with("short\n"));
        // All take an answer, but none of it.
        for _ in 0..MOST_CONNECTIONS {
            let mut stream = connect();
            stream.write_all(b"GET /long HTTP/1.1\r\n\r\n").unwrap();
            held.push(stream);
        }
        assert!(asked(port).ends_with("short\n"));
    }

    #[test]
    fn the_one_that_waits_longest_goes_first() {
        let listener = TcpListener::bind(("127.0.0.1", 0)).unwrap();
        let port = listener.local_addr().unwrap().port();
        let stream = || TcpStream::connect(("127.0.0.1", port)).unwrap();
        let open = Connections::default();
        for number in 0..MOST_CONNECTIONS as u64 {
            open.enter(number, stream());
        }
        // The first waits for its answer, the second has just had one.
        open.note(0, true);
        open.note(1, true);
        open.note(1, false);
        let has = |number: u64| open.lock().iter().any(|own| own.number == number);
        open.enter(100, stream());
        assert!(has(0) && has(1) && !has(2) && has(3) && has(100));
        open.leave(100);
        assert_eq!(open.lock().len(), MOST_CONNECTIONS - 1);
    }
}
