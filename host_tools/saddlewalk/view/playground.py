"""The playground: the core in WebAssembly and its page as one HTML file.

usage: python -m saddlewalk.view.playground CORE.wasm OUT.html
"""

import base64
import json
import sys
from pathlib import Path

from saddlewalk import __version__
from saddlewalk.contract import LEVELS, REASONS
from saddlewalk.verdict import reason_words
from saddlewalk.view.page import WEB, assembled
from saddlewalk.view.words import WITHOUT_REASON, sentence

SCRIPTS = ("geometry.js", "scene.js", "words.js", "playground.js")


def document(core: bytes) -> str:
    """core: a WebAssembly module."""
    words = {
        "version": __version__,
        "levels": LEVELS,
        "reasons": [sentence(reason_words(number)) for number in range(len(REASONS))],
        "without_reason": WITHOUT_REASON,
    }
    data = f'<script type="application/wasm" id="core">{base64.b64encode(core).decode()}</script>\n'
    data += f"<script>const WORDS = {json.dumps(words)};</script>\n"
    return assembled("playground.html", [WEB / name for name in SCRIPTS], data)


def main() -> None:
    core, out = map(Path, sys.argv[1:])
    out.write_text(document(core.read_bytes()))


if __name__ == "__main__":
    main()
