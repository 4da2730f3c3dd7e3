"""Pages as one HTML document each, which asks for nothing else."""

from collections.abc import Sequence
from pathlib import Path

from saddlewalk.paths import built

WEB = Path(__file__).with_name("web")
SCRIPTS = ("ticks.js", "geometry.js", "scene.js", "charts.js", "words.js", "app.js")


def document(nonce: str) -> str:
    """The live page. nonce: by which the browser knows its scripts."""
    return assembled("index.html", [WEB / name for name in SCRIPTS], nonce=nonce)


def assembled(page: str, sources: Sequence[Path], data: str = "", nonce: str = "") -> str:
    """A page with its styles, its data and its scripts in place."""
    styles = built("web/uPlot.min.css").read_text() + (WEB / "style.css").read_text()
    of = f' nonce="{nonce}"' if nonce else ""
    scripts = "".join(
        f"<script{of}>{source.read_text()}</script>\n"
        for source in (built("web/uPlot.iife.js"), *sources)
    )
    text = (WEB / page).read_text().replace("<!--styles-->", f"<style>{styles}</style>")
    return text.replace("<!--scripts-->", data + scripts)
