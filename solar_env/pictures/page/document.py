"""Writer of a page as one HTML file that needs no network; compressing its scripts and data halves the file's size."""

import base64
import gzip
import html
import json
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from solar_env.pictures.page.content import Chart, Motion, Page, Table
from solar_env.pictures.style import COLOURS
from solar_env.support.files import write_text

_FOLDER = Path(__file__).parent
_DIGITS = 6  # significant digits of every number in the page
_PLACES = 4  # decimal places of coordinates in metres, which are drawn in steps of some millimetres
# Under this policy the browser refuses all content from elsewhere.
_POLICY = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:"


def write_page(page: Page, path: Path) -> None:
    """Write a page to a file atomically.

    Raises:
        OSError: if the file cannot be written.
    """
    write_text(path, page_text(page))


def page_text(page: Page) -> str:
    """Return the HTML text of a page."""
    from plotly.offline import get_plotlyjs

    data = {
        "colours": COLOURS,
        "motions": [_motion(m) for m in page.motions],
        "charts": [_chart(c) for c in page.charts],
    }
    answer = "".join(f"<p>{html.escape(line)}</p>" for line in page.answer)
    notes = "".join(f"<p>{html.escape(line)}</p>" for line in page.notes)
    unpack, program = ((_FOLDER / name).read_text(encoding="utf-8") for name in ("unpack.js", "page.js"))
    numbers = json.dumps(data, separators=(",", ":"), allow_nan=False)
    return f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{html.escape(page.title)}</title>
<meta http-equiv="Content-Security-Policy" content="{_POLICY}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>{(_FOLDER / "page.css").read_text(encoding="utf-8")}</style></head>
<body><h1>{html.escape(page.title)}</h1><section id="answer">{answer}</section>
<section id="player"><button id="play">play</button><select id="speed" aria-label="speed">
<option value="0.05">1/20 of real time</option><option value="0.25">1/4</option>
<option value="1" selected>real time</option><option value="4">4 times</option></select>
<input id="time" type="range" step="0.001" aria-label="time"><output id="clock"></output></section>
<section id="motions"></section><section id="charts"></section>
<section id="tables">{"".join(map(_table, page.tables))}</section><footer>{notes}</footer>
<script type="text/plain" id="data">{_packed(numbers)}</script>
<script type="text/plain" id="library">{_packed(get_plotlyjs())}</script>
<script type="text/plain" id="program">{_packed(program)}</script>
<script>{unpack}</script></body></html>
"""


def _packed(text: str) -> str:
    """Compress a text by gzip, and encode it in base64."""
    return base64.b64encode(gzip.compress(text.encode(), mtime=0)).decode()


def _numbers(values: ArrayLike) -> object:
    """Convert values to nested lists of numbers with six significant digits; nan and infinity become None."""
    array = np.asarray(values, dtype=float)
    flat = [float(f"{x:.{_DIGITS}g}") if np.isfinite(x) else None for x in array.ravel().tolist()]
    return np.array(flat, dtype=object).reshape(array.shape).tolist()


def _motion(motion: Motion) -> dict[str, object]:
    """Convert a motion to a dictionary for the page's JSON data, with each polyline flattened to x, y, x, y, ..."""
    body, *panels = (
        _numbers(np.round(line.reshape(len(motion.time), -1), _PLACES)) for line in (motion.body, *motion.panels)
    )
    return {
        "name": motion.name,
        "body": body,
        "panels": panels,
        **{
            name: _numbers(getattr(motion, name))
            for name in ("time", "eccentricity", "clearance", "force", "latch_times", "torque")
        },
    }


def _chart(chart: Chart) -> dict[str, object]:
    lines = [vars(line) | {"x": _numbers(line.x), "y": _numbers(line.y)} for line in chart.lines]
    return vars(chart) | {"lines": lines}


def _table(table: Table) -> str:
    head = "".join(f"<th>{html.escape(name)}</th>" for name in table.columns)
    rows = "".join(f"<tr>{''.join(f'<td>{html.escape(cell)}</td>' for cell in row)}</tr>" for row in table.rows)
    title = html.escape(table.title)
    body = f'<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table></div>'
    if table.folded:
        return f"<details><summary>{title}</summary>{body}</details>"
    return f"<h2>{title}</h2>{body}"
