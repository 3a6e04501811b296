//! `wythe view`: the page that it serves, when it changes, and whom it answers.

mod common;

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};

use common::*;

/// A server of `wythe view`, which ends with the test.
struct Server {
    process: Child,
    /// 127.0.0.1 and the port.
    address: String,
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

impl Server {
    fn of(arguments: &[&str]) -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_wythe"))
            .arg("view")
            .args(arguments)
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        let told = process.stdout.take().unwrap();
        BufReader::new(told).read_line(&mut line).unwrap();
        let address = line
            .strip_prefix("http://")
            .unwrap_or_else(|| panic!("{line}"));
        let address = address.split_whitespace().next().unwrap().to_owned();
        Self { process, address }
    }

    /// The answer to a request for `path`, sent to the host of that name.
    fn asked_as(&self, path: &str, host: &str) -> String {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        write!(
            stream,
            "GET {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n"
        )
        .unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer
    }

    fn asked(&self, path: &str) -> String {
        self.asked_as(path, &self.address)
    }

    /// The stamp of the files, without the headers of the answer.
    fn stamp(&self) -> String {
        let answer = self.asked("/stamp");
        answer.split_once("\r\n\r\n").unwrap().1.trim().to_owned()
    }
}

#[test]
fn a_model_is_shown_at_rest_and_anew_when_its_file_changes() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("couplet.toml");
    let deck = std::fs::read_to_string(couplet()).unwrap();
    std::fs::write(&file, &deck).unwrap();
    let server = Server::of(&[&file.display().to_string()]);
    let page = server.asked("/");
    assert!(page.starts_with("HTTP/1.1 200"), "{page}");
    assert!(page.contains("<title>Couplet in tension</title>") && page.contains("\"view\":{"));
    assert!(page.contains("no increment yet"));
    assert!(page.contains("support bottom: x, y, z held"), "{page}");
    assert!(page.contains("z driven by 0.2500 mm"), "{page}");
    let stamp = server.stamp();
    assert!(
        page.contains(&format!("const stamp = \"{stamp}\"")),
        "{stamp}"
    );

    std::fs::write(&file, deck.replace("Couplet in tension", "Another couplet")).unwrap();
    assert_ne!(server.stamp(), stamp);
    assert!(server.asked("/").contains("<title>Another couplet</title>"));

    std::fs::write(&file, deck.replace("[[steps]]", "[[stops]]")).unwrap();
    let page = server.asked("/");
    assert!(
        page.contains("This cannot be shown") && page.contains("stops"),
        "{page}"
    );
    // Nothing is left in the folder of the model.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn a_run_is_shown_and_anew_when_it_has_a_new_row() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("couplet.out").display().to_string();
    let set = "steps.1.displacement=0.01 mm";
    let run = wythe(&["run", &couplet(), "--out", &out, "--set", set]);
    assert_eq!(code(&run), 0, "{}", stderr(&run));
    let server = Server::of(&[&out]);
    let page = server.asked("/");
    assert!(page.contains("connect-src 'self'") && page.contains("\"view\":{"));
    let stamp = server.stamp();
    let history = Path::new(&out).join("history.csv");
    let rows = std::fs::read_to_string(&history).unwrap();
    let (fewer, _) = rows.trim_end().rsplit_once('\n').unwrap();
    std::fs::write(&history, format!("{fewer}\n")).unwrap();
    assert_ne!(server.stamp(), stamp);
    assert!(server.asked("/").starts_with("HTTP/1.1 200"));
}

#[test]
fn only_this_machine_by_its_name_is_answered_and_only_what_there_is() {
    let server = Server::of(&[&couplet()]);
    assert!(
        server
            .asked_as("/", "example.org")
            .starts_with("HTTP/1.1 403")
    );
    assert!(server.asked("/../Cargo.toml").starts_with("HTTP/1.1 404"));
    let port = server.address.rsplit_once(':').unwrap().1;
    let taken = wythe(&["view", &couplet(), "--port", port]);
    assert_eq!(code(&taken), 4, "{}", stderr(&taken));
    assert!(stderr(&taken).contains("--port"), "{}", stderr(&taken));
}

#[cfg(unix)]
#[test]
fn an_interrupt_ends_the_server_without_an_error() {
    let mut server = Server::of(&[&couplet()]);
    let id = server.process.id().to_string();
    let sent = Command::new("kill").args(["-INT", &id]).status().unwrap();
    assert!(sent.success());
    assert!(server.process.wait().unwrap().success());
}

#[test]
fn what_cannot_be_shown_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let none = folder.path().join("none.out").display().to_string();
    let view = wythe(&["view", &none]);
    assert_eq!(code(&view), 4, "{}", stderr(&view));
    let view = wythe(&["view", &none, "--set", "wall.length=1"]);
    assert_eq!(code(&view), 2, "{}", stderr(&view));
    let wrong = folder.path().join("wrong.toml");
    std::fs::write(&wrong, "format = 1\n").unwrap();
    let view = wythe(&["view", &wrong.display().to_string()]);
    assert_eq!(code(&view), 2, "{}", stderr(&view));
}
