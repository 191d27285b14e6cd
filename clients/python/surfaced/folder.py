"""Folders of scans."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from .client import Client, SurfacedError
from .types import Template


@dataclass(frozen=True)
class Enrolled:
    """What became of a scan: one of template and error is None."""

    path: str
    subject: str
    template: Template | None
    error: SurfacedError | None
    done: int  # so many of all, this one too
    all: int


def enroll_folder(client: Client, folder: str | os.PathLike[str], *, threads: int = 4,
                  subject_of: Callable[[str], str] | None = None,
                  progress: Callable[[Enrolled], object] = lambda _: None) -> list[Enrolled]:
    """Enrolls the scans of a folder, those of a subject one after the other; returns what became of
    each, in the order of their names.  A scan that is refused stops nothing else, and one that is
    enrolled already stays as it is.

    subject_of  the subject of a file's name; by default the name up to its first "_", as surfacectl
                enroll has it, or without its ending
    progress    is called after each scan, by one thread at a time
    """
    names = sorted(e.name for e in os.scandir(folder) if e.is_file() and not e.name.startswith("."))
    by_subject: dict[str, list[str]] = {}
    for name in names:
        subject = subject_of(name) if subject_of else name.split("_" if "_" in name else ".")[0]
        by_subject.setdefault(subject, []).append(name)
    out: dict[str, Enrolled] = {}
    lock = threading.Lock()

    def enroll(subject: str) -> None:
        for name in by_subject[subject]:
            path = os.path.join(folder, name)
            template, error = None, None
            try:
                template = client.enroll(subject, path)
            except SurfacedError as refused:
                error = refused
            with lock:
                out[name] = Enrolled(path, subject, template, error, len(out) + 1, len(names))
                progress(out[name])

    with ThreadPoolExecutor(threads) as pool:
        for finished in [pool.submit(enroll, subject) for subject in by_subject]:
            finished.result()
    return [out[name] for name in names]
