"""The page as one HTML document that asks for nothing else."""

from pathlib import Path

from saddlewalk.paths import built

WEB = Path(__file__).with_name("web")
SCRIPTS = ("ticks.js", "geometry.js", "scene.js", "charts.js", "words.js", "app.js")


def document(nonce: str) -> str:
    """index.html with styles and scripts in place. nonce: by which the browser knows them."""
    styles = built("web/uPlot.min.css").read_text() + (WEB / "style.css").read_text()
    sources = [built("web/uPlot.iife.js"), *(WEB / name for name in SCRIPTS)]
    scripts = "".join(
        f'<script nonce="{nonce}">{source.read_text()}</script>\n' for source in sources
    )
    page = (WEB / "index.html").read_text()
    return page.replace("<!--styles-->", f"<style>{styles}</style>").replace(
        "<!--scripts-->", scripts
    )
