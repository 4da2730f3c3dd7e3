"""Self-contained HTML pages, written as Markdown: tables, pictures, one file, no scripts."""

import base64
import html
from collections.abc import Iterable, Mapping, Sequence

from markdown_it import MarkdownIt

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 68em; margin: 2em auto; padding: 0 1em;
       color: #222; }
img { max-width: 100%; }
table { border-collapse: collapse; margin: 1em 0; font-size: 14px; }
th, td { padding: .25em .7em; border-bottom: 1px solid #ddd; text-align: left;
         vertical-align: top; }
th { border-bottom: 2px solid #888; }
td strong { color: #b03000; }
@page { size: A4; margin: 12mm; }
@media print {
    body { font-size: 11px; line-height: 1.35; max-width: none; margin: 0; padding: 0; }
    h1 { font-size: 18px; margin: 0; }
    h2 { font-size: 14px; margin: 1em 0 .3em; break-after: avoid; }
    table { font-size: 10px; margin: .5em 0; }
    tr, img { break-inside: avoid; }
    img { display: block; max-height: 82mm; margin: 0 auto; }
    .on-screen { display: none; }
}
"""


def page(title: str, markdown: str, pictures: Mapping[str, bytes]) -> str:
    """The HTML of a page. Bold text in a table cell is highlighted.

    pictures: PNG by the name under which the Markdown shows it; embedded.
    """
    body = MarkdownIt("commonmark").enable("table").render(markdown)
    for name, png in pictures.items():
        data = base64.b64encode(png).decode("ascii")
        body = body.replace(f'src="{name}"', f'src="data:image/png;base64,{data}"')
    head = f"<meta charset='utf-8'><title>{html.escape(title)}</title><style>{_STYLE}</style>"
    return f"<!doctype html>\n<html lang='en'><head>{head}</head>\n<body>\n{body}</body></html>\n"


def table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table; cells are Markdown."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join(f"| {' | '.join(map(_cell, line))} |" for line in lines) + "\n"


def on_screen(markdown: str) -> str:
    """A part that is not printed."""
    return f'<div class="on-screen">\n\n{markdown}\n\n</div>\n'


def picture(name: str, caption: str) -> str:
    """A picture with its caption under it."""
    return f"![{caption}]({name})\n\n*{caption}*\n"


def _cell(text: str) -> str:
    return text.replace("|", "&#124;").replace("\n", " ")
