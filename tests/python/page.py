"""The page of `saddlewalk view` in a real browser, headless."""

import contextlib
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, Request, sync_playwright

SADDLEWALK = [
    sys.executable,
    "-c",
    "from saddlewalk.cli import main; raise SystemExit(main())",
]
TIMEOUT_MS = 30_000
QUIET = ["--no-sandbox", "--disable-background-networking", "--no-first-run"]


@contextlib.contextmanager
def chromium() -> Iterator[Browser]:
    """Skips the test where there is none. It runs without the sanitizers of the tests."""
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        pytest.skip("a browser: apt install chromium")
    args = [*QUIET, "--enable-precise-memory-info", "--js-flags=--expose-gc"]
    with contextlib.ExitStack() as stack:
        with pytest.MonkeyPatch.context() as environment:
            environment.delenv("LD_PRELOAD", raising=False)
            playwright = stack.enter_context(sync_playwright())
            browser = playwright.chromium.launch(executable_path=program, args=args)
        yield browser
        browser.close()


@contextlib.contextmanager
def opened(browser: Browser, url: str, width: int = 1280, height: int = 1000) -> Iterator[Page]:
    """A page of `saddlewalk view` at its first tick, watched."""
    with watched(browser, url.split("?")[0], width, height) as page:
        page.goto(url)
        until(page, "document.body.dataset.tick !== undefined")
        yield page


@contextlib.contextmanager
def watched(browser: Browser, here: str, width: int = 1200, height: int = 1200) -> Iterator[Page]:
    """A page that must write nothing to the console, nor ask for what is not below `here`."""
    page = browser.new_page(viewport={"width": width, "height": height})
    page.set_default_timeout(TIMEOUT_MS)
    complaints: list[str] = []
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))

    def note(asked: Request) -> None:
        if not asked.url.startswith((here, "data:")):
            complaints.append(asked.url)

    page.on("request", note)
    yield page
    page.close()
    assert complaints == []


@contextlib.contextmanager
def command(*options: str) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """`saddlewalk` with these options, as a process, and the URL that is its first line."""
    process = subprocess.Popen(
        [*SADDLEWALK, *options, "--no-browser"], stdout=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout
        yield process, process.stdout.readline().strip()
    finally:
        process.terminate()
        process.communicate(timeout=20)


def until(page: Page, expression: str) -> None:
    """Wait for a JavaScript expression to hold: the page's policy forbids Playwright's own way."""
    deadline_s = time.monotonic() + TIMEOUT_MS / 1000
    while not page.evaluate(expression):
        assert time.monotonic() < deadline_s, f"waited in vain for {expression}"
        page.wait_for_timeout(30)


def go_to(page: Page, tick: int) -> None:
    page.evaluate(f"goTo({tick})")
    until(page, f"document.body.dataset.tick === '{tick}'")


def table(page: Page, name: str) -> dict[str, str]:
    """What a table of the page shows, by the keys of its rows."""
    read = (
        "rows => Object.fromEntries(rows.map(row => [row.dataset.key, row.cells[1].textContent]))"
    )
    return page.eval_on_selector_all(f"#{name}-table tr", read)
