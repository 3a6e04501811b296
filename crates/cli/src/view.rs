//! `wythe view`: serves the page of a run, or of a model before its run, to browsers of this machine.

use std::fmt::Write as _;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};
use std::time::{Duration, UNIX_EPOCH};

use tiny_http::{Header, Request, Response, Server};
use wythe_core::results::output::{OF_A_RUN, REPORT};
use wythe_core::results::{Report, RunDirectory, RunFolder};

use crate::arguments::{ModelArguments, ViewPage};
use crate::failure::Failure;
use crate::findings::{self, Sound, Unsound};
use crate::interrupt::Interrupt;
use crate::say::print;

/// Serves the page until the process ends.
pub fn view(arguments: &ViewPage) -> Result<(), Failure> {
    let shown = Shown::of(arguments)?;
    // An error at the start ends the command; later errors are shown on the page.
    let mut page = Page::of(&shown).map_err(|unshown| match unshown {
        Unshown::Deck(unsound) => unsound.tell(&arguments.path),
        Unshown::Other(failure) => failure,
    })?;
    let address = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), arguments.port);
    let server = Server::http(address).map_err(|error| unserved(address, &*error))?;
    let port = server.server_addr().to_ip().map_or(0, |ip| ip.port());
    let own = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
    let interrupt = Interrupt::listen_saying("the page is no longer served");
    print(&format!(
        "http://{} shows {}; Ctrl-C ends it\n",
        own[0],
        arguments.path.display()
    ))?;
    while !interrupt.requested() {
        let request = server
            .recv_timeout(PATIENCE)
            .map_err(|error| unserved(address, &error))?;
        if let Some(request) = request {
            // A browser that leaves before its answer is no failure of the server.
            drop(answer(request, &shown, &mut page, &own));
        }
    }
    Ok(())
}

/// Time after which a request to stop is seen at the latest.
const PATIENCE: Duration = Duration::from_millis(200);

fn unserved(address: SocketAddr, error: &(dyn std::error::Error + Send + Sync)) -> Failure {
    Failure::InputOutput(miette::miette!(
        help = "give another --port, or none for any free one",
        "{address} cannot be served: {error}"
    ))
}

/// Subject of the page.
enum Shown<'a> {
    /// Folder of a run.
    Run(RunFolder),
    /// File of a model, and its changes.
    Model(&'a Path, &'a ModelArguments),
}

impl<'a> Shown<'a> {
    fn of(arguments: &'a ViewPage) -> Result<Self, Failure> {
        let path = &arguments.path;
        if path.extension().is_some_and(|ending| ending == "toml") {
            return Ok(Self::Model(path, &arguments.with));
        }
        if !arguments.with.overrides().is_empty() {
            return Err(Failure::Model(miette::miette!(
                help = "give the model, a .toml file, to show it with other keys",
                "--set and --strategy change a model, and {} is no .toml file",
                path.display()
            )));
        }
        Ok(Self::Run(RunFolder::open(path)?))
    }

    /// Sizes and times of the files that the page shows. It differs once one of them has changed.
    fn stamp(&self) -> String {
        let files: Vec<PathBuf> = match self {
            Self::Run(folder) => {
                let names = OF_A_RUN.iter().filter(|name| **name != REPORT);
                names.map(|name| folder.path().join(name)).collect()
            }
            Self::Model(path, _) => vec![path.to_path_buf()],
        };
        let mut stamp = String::new();
        for file in files {
            let Ok(known) = file.metadata() else {
                continue;
            };
            let changed = known.modified().ok();
            let changed = changed.and_then(|at| at.duration_since(UNIX_EPOCH).ok());
            let at = changed.map_or(0, |since| since.as_millis());
            // Writing to a String does not fail.
            let _ = write!(stamp, "{}-{at}.", known.len());
        }
        stamp
    }

    /// The report of the run or the model.
    fn report(&self) -> Result<Report, Unshown> {
        match self {
            Self::Run(folder) => Ok(Report::of(folder, None).map_err(Failure::from)?),
            Self::Model(path, with) => {
                let sound = findings::read(path, with).map_err(Unshown::Deck)?;
                Ok(at_rest(&sound)?)
            }
        }
    }
}

/// The report of a run that has not begun: the mesh at rest.
fn at_rest(sound: &Sound) -> Result<Report, Failure> {
    let folder = tempfile::tempdir()
        .map_err(|error| Failure::InputOutput(miette::miette!("no temporary folder: {error}")))?;
    let run = RunDirectory::of_deck(folder.path(), &sound.model, &sound.deck)?;
    let report = Report::at_rest(&RunFolder::open(folder.path())?, &sound.model)?;
    drop(run);
    Ok(report)
}

/// Reason for which there is no report.
enum Unshown {
    /// The deck has errors, or cannot be read.
    Deck(Unsound),
    Other(Failure),
}

impl From<Failure> for Unshown {
    fn from(failure: Failure) -> Self {
        Self::Other(failure)
    }
}

impl Unshown {
    /// The errors, each with its line and advice.
    fn in_words(&self) -> String {
        match self {
            Self::Deck(Unsound::Wrong(_, error)) => {
                let told = error.all().map(|error| {
                    let line = error
                        .line()
                        .map_or(String::new(), |n| format!("line {n}, "));
                    let (key, message) = (error.key(), error.message());
                    format!("{line}{key}: {message}\n  {}\n", error.advice())
                });
                told.collect()
            }
            Self::Deck(Unsound::Unread(failure)) | Self::Other(failure) => {
                let (message, help) = failure.in_words();
                format!("{message}\n  {help}\n")
            }
        }
    }
}

/// The page and the stamp of the files that it shows.
struct Page {
    stamp: String,
    html: String,
}

impl Page {
    fn of(shown: &Shown) -> Result<Self, Unshown> {
        let stamp = shown.stamp();
        let html = shown.report()?.live(&stamp);
        Ok(Self { stamp, html })
    }

    /// Reads the files again if they have changed. If they cannot be read, the page lists the errors.
    fn renew(&mut self, shown: &Shown) {
        let stamp = shown.stamp();
        if stamp == self.stamp {
            return;
        }
        *self = Self::of(shown).unwrap_or_else(|unshown| {
            let html = Report::failed(&unshown.in_words()).live(&stamp);
            Self { stamp, html }
        });
    }
}

/// Answers one request. The host must be this machine, so that no web site can read the page under its own name.
fn answer(request: Request, shown: &Shown, page: &mut Page, own: &[String]) -> std::io::Result<()> {
    let host = request.headers().iter().find(|h| h.field.equiv("Host"));
    let asked = host.map(|header| header.value.as_str());
    if !own.iter().any(|name| asked == Some(name.as_str())) {
        return request.respond(Response::from_string("unknown host").with_status_code(403));
    }
    let path = request
        .url()
        .split('?')
        .next()
        .unwrap_or_default()
        .to_owned();
    match path.as_str() {
        "/" => {
            page.renew(shown);
            let response = Response::from_string(page.html.as_str());
            request.respond(typed(response, "text/html; charset=utf-8"))
        }
        "/stamp" => {
            let response = Response::from_string(shown.stamp());
            request.respond(typed(response, "text/plain; charset=utf-8"))
        }
        _ => request.respond(Response::from_string("not found").with_status_code(404)),
    }
}

/// Adds the content type to a response; browsers must not cache it.
fn typed<R: std::io::Read>(response: Response<R>, kind: &str) -> Response<R> {
    let headers = [("Content-Type", kind), ("Cache-Control", "no-store")];
    let headers = headers.into_iter();
    headers
        .filter_map(|(name, value)| Header::from_bytes(name, value).ok())
        .fold(response, Response::with_header)
}
