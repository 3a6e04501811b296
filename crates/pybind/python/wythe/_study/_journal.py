"""The journal of a study: finished samples survive the end of the process.

``journal.jsonl`` has a header that identifies the study and one line for each finished sample. A line is valid only
with its newline; an incomplete last line of a killed process is cut off. The active process holds ``study.lock``.
"""

from __future__ import annotations

import contextlib
import fcntl
import json
import os
import platform
import shutil
import stat
from pathlib import Path
from typing import TypedDict

from wythe._study._errors import StudyError
from wythe._study._samples import Sample
from wythe._study._worker import Scalar

FORMAT = 1
NAME = "journal.jsonl"
LOCK = "study.lock"


class Header(TypedDict):
    """Identity of the study of a journal."""

    wythe_study: int
    model: str
    samples: str
    count: int
    measure: str


class Line(TypedDict):
    """A finished sample."""

    sample: int
    parameters: Sample
    status: str
    message: str
    attempts: int
    measures: dict[str, Scalar]


class Journal:
    """The journal in a folder, locked by this process until it is closed."""

    def __init__(self, folder: Path, header: Header) -> None:
        self.folder = folder
        self.path = folder / NAME
        self._lock = _Lock(folder)
        try:
            self.lines = self._opened(header)
            self._sweep()
        except BaseException:
            self._lock.release()
            raise

    def add(self, line: Line) -> None:
        """Writes a line to the disk, so that it survives a kill and a power failure."""
        self._write(f"{json.dumps(line, ensure_ascii=False, allow_nan=False)}\n".encode())

    def _write(self, content: bytes) -> None:
        self._file.write(content)
        self._file.flush()
        os.fsync(self._file.fileno())

    def close(self) -> None:
        """Closes the journal and releases the folder."""
        self._file.close()
        self._sweep()
        self._lock.release()

    def _opened(self, header: Header) -> list[Line]:
        whole = self.path.read_bytes() if self.path.exists() else b""
        kept = _complete(whole)
        begin = (json.dumps(header) + "\n").encode()
        if not kept:
            if whole and not begin.startswith(whole):
                raise _foreign(self.path)
            if any(self.folder.glob("sample-*")):
                raise StudyError(
                    f"out: {self.folder} has runs (sample-…) but no journal; choose another folder"
                )
            lines: list[Line] = []
        else:
            found, lines = _parsed(self.path, kept)
            _compare(self.folder, found, header)
        # A new file, so that links to the old one keep its content.
        part = self.path.with_name(f"{NAME}.tmp")
        part.unlink(missing_ok=True)
        self._file = open(part, "xb")  # noqa: SIM115 - open until the journal is closed
        self._write(kept or begin)
        os.replace(part, self.path)
        # The name of a new file survives a power failure only if its folder is synced.
        handle = os.open(self.folder, os.O_RDONLY)
        os.fsync(handle)
        os.close(handle)
        return lines

    def _sweep(self) -> None:
        """Removes the remains of abandoned runs."""
        for part in self.folder.glob("sample-*.part-*"):
            shutil.rmtree(part, ignore_errors=True)


def read(folder: Path) -> tuple[Header, list[Line]]:
    """Reads the journal of a folder, also while another process writes it."""
    path = folder / NAME
    if not path.is_file():
        raise StudyError(f"{folder} has no {NAME}, so it is not the folder of a study")
    return _parsed(path, _complete(path.read_bytes()))


def _complete(content: bytes) -> bytes:
    """The lines that end with a newline; a line that a kill cut has none."""
    return content[: content.rfind(b"\n") + 1]


def _parsed(path: Path, kept: bytes) -> tuple[Header, list[Line]]:
    texts = kept.splitlines()
    try:
        header: Header = json.loads(texts[0])
        version = header["wythe_study"]
    except (IndexError, KeyError, TypeError, ValueError):
        raise _foreign(path) from None
    if version != FORMAT:
        raise StudyError(f"{path}: expected format {FORMAT}, got {version}: another version wrote it")
    # A later line of a sample comes from a further attempt and replaces the earlier one.
    lines: dict[int, Line] = {}
    for at, text in enumerate(texts[1:], start=2):
        try:
            line: Line = json.loads(text)
            lines[line["sample"]] = line
        except (KeyError, TypeError, ValueError):
            raise StudyError(f"{path}: line {at} is damaged; remove it to have its sample run again") from None
    return header, [lines[number] for number in sorted(lines)]


def _compare(folder: Path, found: Header, header: Header) -> None:
    told = {
        "model": "another model",
        "count": f"{found['count']} samples instead of {header['count']}",
        "samples": "other samples",
        "measure": f"another measure ({found['measure'].partition(' ')[0] or 'none'})",
    }
    theirs, ours = dict(found), dict(header)
    for key, what in told.items():
        if theirs[key] != ours[key]:
            raise StudyError(
                f"out: {folder} holds a study of {what}; go on with what it was begun with, or "
                "choose another folder"
            )


def _foreign(path: Path) -> StudyError:
    return StudyError(f"out: {path} is not the journal of a study; choose another folder")


class _Lock:
    """Lock of a folder: one process, and in it one study, at a time."""

    held: set[Path] = set()

    def __init__(self, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self._folder = folder.resolve()
        # Checked first, because a process loses its POSIX lock when it closes the file anywhere.
        if self._folder in _Lock.held:
            raise _busy(folder, "this process")
        path = self._folder / LOCK
        # Writing would follow a link.
        with contextlib.suppress(FileNotFoundError):
            about = path.lstat()
            if stat.S_ISLNK(about.st_mode) or about.st_nlink > 1:
                path.unlink()
        self._handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            # POSIX locks work over NFS, end with the process in all cases, and are not inherited.
            fcntl.lockf(self._handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            who = os.read(self._handle, 64).decode(errors="replace").strip()
            os.close(self._handle)
            raise _busy(folder, who or "another process") from None
        _Lock.held.add(self._folder)
        os.ftruncate(self._handle, 0)
        os.write(self._handle, f"process {os.getpid()} on {platform.node()}\n".encode())

    def release(self) -> None:
        """Releases the folder."""
        _Lock.held.discard(self._folder)
        os.close(self._handle)


def _busy(folder: Path, who: str) -> StudyError:
    return StudyError(f"out: a study is at work in {folder} ({who}); wait for it, or choose another folder")
