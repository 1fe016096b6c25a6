"""Headless Chromium, and the explorer in it: one browser for all tests, and pages that are used again, which takes half the time."""

import pytest
from explorer_page import CHROMIUM, DESKTOP, PAGE
from playwright.sync_api import sync_playwright

# SwiftShader draws WebGL, without smoothed edges, and the processor draws the page directly: with SwiftShader that takes twice as long.
FLAGS = """--no-sandbox --disable-gpu-compositing --disable-quic --no-first-run --disable-background-networking --disable-component-update --disable-sync
--use-angle=swiftshader --enable-unsafe-swiftshader --ignore-gpu-blocklist --webgl-antialiasing-mode=none""".split()


@pytest.fixture(scope="session")
def browser():
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS, timeout=120_000)
        yield chromium
        chromium.close()


class Opened:
    """A page, what it has written to the console and what it has requested."""

    def __init__(self, browser, size, theme):
        context = browser.new_context(viewport=size, color_scheme=theme, accept_downloads=True)
        self.console, self.asked, self.size = [], [], size
        self.page = context.new_page()
        self.page.set_default_timeout(120_000)
        self.page.on("console", lambda message: self.console.append(message.text))
        self.page.on("pageerror", lambda error: self.console.append(str(error)))
        self.page.on("dialog", lambda dialog: self.console.append(f"dialog: {dialog.message}"))
        context.on("request", lambda request: self.asked.append(request.url))

    def goto(self, address):
        self.page.set_viewport_size(self.size)
        self.console.clear()
        self.asked.clear()
        self.page.goto(address)


@pytest.fixture(scope="session")
def unused():
    """Pages by size and theme."""
    return {}


@pytest.fixture
def opener(browser, unused):
    """Opens an address in a page that no other test uses; and what it has opened."""
    used = []

    def open_page(address, size, theme="light"):
        key = (size["width"], size["height"], theme)
        kept = unused.setdefault(key, [])
        opened = kept.pop() if kept else Opened(browser, size, theme)
        used.append((key, opened))
        opened.goto(address)
        return opened.page

    yield open_page, used
    for key, opened in used:
        # The same file with another posture after the # would not be loaded again.
        opened.page.goto("about:blank")
        unused[key].append(opened)


@pytest.fixture
def explorer(opener):
    """Opens the explorer; at the end it must have requested only itself, and have written nothing to the console."""
    open_page, used = opener
    yield lambda address=PAGE.as_uri(), size=DESKTOP, theme="light": open_page(address, size, theme)
    # Messages of the graphics emulation, and of a library on a mesh file's version and axes, are not the page's.
    others = ("GPU stall", "GL Driver", "THREE.ColladaLoader: ")
    said = [words for _, opened in used for words in opened.console if not any(other in words for other in others)]
    assert said == [], said
    asked = [url for _, opened in used for url in opened.asked]
    strangers = [url for url in asked if not url.startswith(("file:", "blob:", "data:", "http://127.0.0.1:"))]
    assert strangers == [], strangers
    assert sum(url.startswith(("file:", "http:")) for url in asked) == len(used), asked
