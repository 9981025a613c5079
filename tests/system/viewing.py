"""A served viewer and a browser that looks at it, for tests."""

from __future__ import annotations

import http.client
import os
import shutil
import signal
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
QUIET = (
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"),
    *("--disable-component-update", "--disable-sync", "--enable-unsafe-swiftshader"),
)


PATIENCE_MS = 300_000
"""A busy machine may take long; whoever waits goes on at once when what it waits for is there."""


def await_pictures(page: Any) -> None:
    """Wait until every picture of a page is there, so that nothing moves any more."""
    page.wait_for_function(
        "() => { const all = [...document.querySelectorAll('.picture img')];"
        " return all.length > 0 && all.every((one) => one.naturalWidth > 0); }"
    )


@contextmanager
def served(dataset: Path, *flags: str) -> Iterator[str]:
    """Address of the page of a dataset, served by the command itself; ends it as Ctrl-C does."""
    command = [sys.executable, "-m", "scenegen_cli.main", "view", str(dataset), "--no-open", *flags]
    # A user's shell does not say that this is a test; told so, the library would not serve.
    shell = {name: value for name, value in os.environ.items() if name != "PYTEST_CURRENT_TEST"}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, text=True, env=shell, **pipes) as server:
        assert server.stdout is not None and server.stderr is not None
        where = server.stdout.readline().strip()
        try:
            _await(server, where)
            yield where
        finally:  # whatever became of the test: the block would wait for the server
            server.send_signal(signal.SIGINT)
            _, said = server.communicate(timeout=300)
        assert server.returncode in (0, 130)
        assert "Traceback" not in said


def _await(server: subprocess.Popen[str], where: str) -> None:
    """Until the page answers; a request that nobody hears is repeated."""
    while server.poll() is None:
        try:
            with urllib.request.urlopen(where, timeout=300):
                return
        except urllib.error.HTTPError:
            raise
        except (OSError, http.client.HTTPException):
            time.sleep(0.1)
    raise AssertionError(f"{where} does not answer: the command has ended")


@contextmanager
def looked_at(address: str, width: int = 1400, height: int = 1200) -> Iterator[Any]:
    """A page of headless Chromium that shows an address and has its first pictures."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(QUIET))
        page = browser.new_page(viewport={"width": width, "height": height})
        page.set_default_timeout(PATIENCE_MS)
        page.goto(address)
        await_pictures(page)
        yield page
        browser.close()
