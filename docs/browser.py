"""The book in a browser: for ``make pdf`` and for the tests that look at its pages."""

from __future__ import annotations

import functools
import shutil
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
FIREFOX = ("firefox-esr", "firefox")
TIMEOUT = 300_000.0  # milliseconds for a page with all its formulas, on a busy machine


def find() -> str | None:
    """The browser of this machine, or that of playwright; None where there is neither."""
    for name in NAMES:
        if found := shutil.which(name):
            return found
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        return None
    with sync_playwright() as driver:
        own = Path(driver.chromium.executable_path)
    return str(own) if own.exists() else None


def find_firefox() -> str | None:
    """Firefox of this machine, or None. Its playwright needs none of its own: it drives a released one."""
    return next(filter(None, map(shutil.which, FIREFOX)), None)


class Silent(SimpleHTTPRequestHandler):
    def log_message(self, *_: Any) -> None:
        pass


class Reader:
    """
    A browser that reads the pages of a folder.

    Attributes
    ----------
    address : str
        Where the folder is served.
    outside : list of str
        Requests that left this machine.
    """

    def __init__(self, browser: Any, address: str) -> None:
        self.address, self.outside = address, list[str]()
        self.page = browser.new_page()
        self.page.set_default_timeout(TIMEOUT)
        self.page.on("request", self._note)

    def _note(self, request: Any) -> None:
        if not request.url.startswith((self.address, "data:", "blob:")):
            self.outside.append(request.url)

    def open(self, name: str) -> Any:
        """A page by its path in the folder, its formulas set."""
        self.page.goto(f"{self.address}/{name}")
        if self.page.evaluate("() => Boolean(window.MathJax)"):
            self.page.wait_for_function("() => window.MathJax.startup?.promise")
            self.page.evaluate("() => MathJax.startup.promise.then(() => true)")
        return self.page


@contextmanager
def reading(folder: Path, browser: str) -> Iterator[Reader]:
    """Serve a folder on this machine and open a browser on it."""
    from playwright.sync_api import sync_playwright

    handler = functools.partial(Silent, directory=str(folder))
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as server, sync_playwright() as driver:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        own = driver.chromium.launch(executable_path=browser, args=["--no-sandbox"])
        try:
            yield Reader(own, f"http://127.0.0.1:{server.server_port}")
        finally:
            own.close()
            server.shutdown()
