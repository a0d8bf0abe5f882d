"""Pages: whole, self-contained, and alive in a browser (`pytest -m browser`, which needs Chromium)."""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from helpers import page_data

from solar_env.pictures.page import document
from solar_env.pictures.page.content import Chart, Line, Motion, Page, Table
from solar_env.pictures.page.document import page_text, write_page

TIME = np.linspace(0.0, 2.0, 21)
ANGLE = np.arange(0.0, 360.0, 5.0)
# Deep everywhere but about 112.5 degrees.
ROUND = Line("round", ANGLE, np.where(np.abs(ANGLE - 112.5) < 30.0, 1.0, 57.0), "#0072b2")


def motion(name="array"):
    corner = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    panel = np.stack([np.array([[1.0, 0.0], [1.0 + t, 2.0 - t]]) for t in TIME])
    offset = np.stack([np.cos(TIME), np.sin(TIME)], axis=-1)[:, None].repeat(2, axis=1)
    return Motion(
        name=name,
        time=TIME,
        body=np.broadcast_to(corner, (21, 4, 2)),
        panels=[panel, panel + 1.0],
        eccentricity=offset,
        clearance=np.array([1e-4, 0.0]),
        force=np.outer(TIME, [10.0, 20.0]),
        latch_times=np.array([1.0, math.nan]),
        torque=0.1 * TIME[:, None],
    )


def page():
    lines = [Line("one", TIME, TIME**2, "#0072b2"), Line("two", TIME, np.where(TIME > 1.0, np.nan, TIME), "#d55e00")]
    charts = [
        Chart("It grows", "time [s]", "height [m]", lines),
        Chart("Spectrum", "frequency [Hz]", "force [N]", lines[:1], over_time=False, logarithmic="xy"),
        Chart("Round", "", "fm", [ROUND], over_time=False, polar=True),
    ]
    table = Table("Figures & <signs>", ["name", "value"], [["a < b", "1"]])
    return Page("A title </script>", ["The answer & more."], [motion(), motion("other")], charts, [table], ["made by"])


def test_a_page_holds_what_it_was_given_and_fetches_nothing():
    text = page_text(page())
    data = page_data(text)
    assert [m["name"] for m in data["motions"]] == ["array", "other"]
    assert data["motions"][0]["latch_times"] == [1.0, None]
    assert len(data["motions"][0]["panels"][1][0]) == 4
    assert data["charts"][0]["lines"][1]["y"][-1] is None
    assert "The answer &amp; more." in text
    assert "Figures &amp; &lt;signs&gt;" in text
    assert "<title>A title &lt;/script&gt;</title>" in text
    assert "default-src 'none'" in text
    own = text[text.index("<body>") :]
    assert not re.search(r"""(src|href)\s*=|url\(|https?://""", own)


def test_a_page_is_written_whole_or_not_at_all(tmp_path):
    target = tmp_path / "page.html"
    write_page(page(), target)
    before = target.read_text(encoding="utf-8")
    broken = page()
    object.__setattr__(broken.motions[0], "time", np.array(["x"], dtype=object))
    with pytest.raises(ValueError, match="could not convert"):
        write_page(broken, target)
    assert target.read_text(encoding="utf-8") == before
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]


def test_a_folded_table_opens_at_its_title_and_wide_ones_scroll_by_themselves():
    tables = [Table("Open", ["a"], [["1"]]), Table("Folded", ["b"], [["2"]], folded=True)]
    text = page_text(replace(page(), tables=tables))
    assert '<h2>Open</h2><div class="wide"><table>' in text
    assert re.search(r'<details><summary>Folded</summary><div class="wide"><table>.*?</table></div></details>', text)


def test_no_box_is_wider_than_a_narrow_screen():
    style = (document._FOLDER / "page.css").read_text(encoding="utf-8")
    assert not re.search(r"minmax\(\d+px", style), "a column that is wider than the page would overflow"
    assert 'name="viewport" content="width=device-width' in page_text(page())


@pytest.mark.browser
def test_on_a_narrow_screen_nothing_overflows(tmp_path):
    probe = """<script>
    ready.then(() => {
      const result = document.createElement("pre");
      result.id = "told";
      result.textContent = `${document.documentElement.scrollWidth - window.innerWidth}`;
      document.body.append(result);
    });
    </script></body>"""
    target = tmp_path / "page.html"
    wide = Table("Wide", [f"column {k}" for k in range(30)], [["1.234567"] * 30])
    target.write_text(page_text(replace(page(), tables=[wide])).replace("</body>", probe), encoding="utf-8")
    shown = in_chromium(tmp_path, target.as_uri(), "--window-size=400,900", "--dump-dom")
    assert int(re.search(r'<pre id="told">(-?\d+)</pre>', shown)[1]) <= 0


AXES = """<script>
ready.then(() => {
  const result = document.createElement("pre");
  const labels = (axis) => axis._vals.map((value) => value.text).filter(Boolean);
  result.id = "told";
  result.textContent = JSON.stringify({
    axes: charts.filter((view) => !view.chart.polar).map((view) => labels(view.plot._fullLayout.yaxis)),
    radial: charts.filter((view) => view.chart.polar).map(({plot}) => plot.layout.polar.radialaxis),
  });
  document.body.append(result);
});
</script></body>"""


def told_axes(tmp_path, charts):
    target = tmp_path / "page.html"
    target.write_text(page_text(replace(page(), charts=charts)).replace("</body>", AXES), encoding="utf-8")
    shown = in_chromium(tmp_path, target.as_uri(), "--dump-dom")
    return json.loads(re.search(r'<pre id="told">(.*?)</pre>', shown)[1])


@pytest.mark.browser
@pytest.mark.parametrize("span", [0.5, 1.0, 1.7, 2.4, 5.0])
def test_a_logarithmic_axis_has_three_labels_or_more_and_not_too_many(span, tmp_path):
    line = Line("force", TIME + 1.0, 30.0 * 10.0 ** (span * np.sin(TIME * np.pi / 4.0)), "#0072b2")
    (labels,) = told_axes(tmp_path, [Chart("Force", "f", "N", [line], over_time=False, logarithmic="xy")])["axes"]
    assert 3 <= len(labels) <= 12
    assert [float(label) for label in labels] == sorted(float(label) for label in labels)


@pytest.mark.browser
def test_limits_of_a_logarithmic_axis_are_labelled_at_their_decades(tmp_path):
    line = Line("force", TIME, np.full(21, 5.0), "#0072b2")
    chart = Chart("Force", "t", "N", [line], logarithmic="y", limits=(0.01, 1000.0))
    assert told_axes(tmp_path, [chart])["axes"] == [["0.01", "0.1", "1", "10", "100", "1000"]]


@pytest.mark.browser
def test_depths_round_a_bearing_are_labelled_with_their_unit_where_curves_are_shallow(tmp_path):
    chart = Chart("Round", "", "fm", [ROUND], over_time=False, polar=True)
    (axis,) = told_axes(tmp_path, [chart])["radial"]
    assert axis["angle"] == 112.5
    assert axis["ticktext"] == ["20 fm", "40 fm"]


WATCH = """<body><script>
const refused = [];
document.addEventListener("securitypolicyviolation", (event) => refused.push(event.blockedURI));
</script>"""
PROBE = """<script>
ready.then(() => {
const told = {};
const cursor = () => document.querySelector(".cursor").style.left;
const picture = () => document.querySelector("canvas").toDataURL();
told.opened = clock.textContent;
const [before, drawn] = [cursor(), picture()];
slider.value = 1.75;
slider.dispatchEvent(new Event("input"));
told.moved = clock.textContent;
told.cursor = cursor() !== before && document.querySelector(".cursor").style.display === "block";
told.picture = picture() !== drawn;
told.plots = document.querySelectorAll(".js-plotly-plot").length;
charts[0].plot.emit("plotly_click", {points: [{x: 0.5}]});
told.clicked = clock.textContent;
Plotly.relayout(charts[0].plot, {"xaxis.range[0]": 0.2, "xaxis.range[1]": 0.4}).then(() => {
  told.fetched = [...refused, ...performance.getEntriesByType("resource").map((entry) => entry.name)];
  told.hidden = document.querySelector(".cursor").style.display;
  const result = document.createElement("pre");
  result.id = "told";
  result.textContent = JSON.stringify(told);
  document.body.append(result);
});
});
</script></body>"""


def in_chromium(tmp_path, path, *options):
    browser = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if browser is None:
        pytest.skip("no Chromium is installed")
    usual = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--virtual-time-budget=8000")
    command = [browser, *usual, f"--user-data-dir={tmp_path / 'profile'}", "--window-size=1300,2000", *options, path]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=True).stdout


@pytest.mark.browser
def test_in_a_browser_the_slider_moves_everything_and_nothing_is_fetched(tmp_path):
    target = tmp_path / "page.html"
    target.write_text(page_text(page()).replace("</body>", PROBE).replace("<body>", WATCH), encoding="utf-8")
    address = f"{target.as_uri()}#t=0.25"
    shown = in_chromium(tmp_path, address, "--dump-dom")
    told = json.loads(re.search(r'<pre id="told">(.*?)</pre>', shown)[1])
    assert told == {
        "opened": "0.250 s",
        "moved": "1.750 s",
        "cursor": True,
        "picture": True,
        "plots": 3,
        "clicked": "0.500 s",
        "hidden": "none",
        "fetched": [],
    }


@pytest.mark.browser
def test_what_a_page_would_fetch_is_refused_and_noticed(tmp_path):
    """Lest the test above pass because nothing would be noticed."""
    target = tmp_path / "page.html"
    text = page_text(page()).replace("</body>", '<img src="https://example.org/x.png">' + PROBE)
    target.write_text(text.replace("<body>", WATCH), encoding="utf-8")
    shown = in_chromium(tmp_path, target.as_uri(), "--dump-dom")
    assert "https://example.org" in json.loads(re.search(r'<pre id="told">(.*?)</pre>', shown)[1])["fetched"][0]
