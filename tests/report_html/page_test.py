# SPDX-License-Identifier: Apache-2.0
"""The page as a person uses it: opened and clicked in headless Chromium."""

import json
import shutil
import tempfile
import time
import unittest
from pathlib import Path

from bitspan_report import analysis
from bitspan_report.database import load_study
from bitspan_report.report import write_report
from make_database import add_many, write_database

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.support.ui import Select
except ImportError:
    webdriver = None

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
MISSING = [
    name
    for name, there in (("chromium", CHROMIUM), ("chromium-driver", DRIVER), ("python3-selenium", webdriver))
    if not there
]

# Where the plot draws a point: (x, y) from the plot's top left corner, in pixels.
PLACE_OF_POINT = """
const plot = document.getElementById(arguments[0]), index = arguments[1], full = plot._fullLayout;
for (const trace of plot.data) {
  const at = (trace.customdata || []).indexOf(index);
  if (at >= 0) {
    const x = full.xaxis, y = full.yaxis;
    return [x._offset + x.d2p(trace.x[at]), y._offset + y.d2p(trace.y[at])];
  }
}
return null;
"""


def open_browser():
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1300,900"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(service=Service(DRIVER), options=options)


@unittest.skipIf(MISSING, f"not installed: {', '.join(MISSING)}")
class Browsing(unittest.TestCase):
    """A study's report in a browser, which must not complain of anything, nor ask anybody for anything."""

    STUDY = "spans"
    MANY = 0  # points beside those of the small study

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        root = Path(folder.name)
        write_database(root / "t.db")
        if cls.MANY:
            add_many(root / "t.db", cls.MANY)
        cls.study = load_study(str(root / "t.db"), cls.STUDY)
        write_report(cls.study, str(root / "out"))
        cls.address = (root / "out" / "report.html").as_uri()
        cls.browser = open_browser()
        cls.addClassCleanup(cls.browser.quit)

    def setUp(self):
        self.browser.get(self.address)

    def tearDown(self):
        self.assertEqual([entry["message"] for entry in self.browser.get_log("browser")], [])
        requested = [
            message["params"]["request"]["url"]
            for entry in self.browser.get_log("performance")
            if (message := json.loads(entry["message"])["message"])["method"] == "Network.requestWillBeSent"
        ]
        self.assertGreaterEqual(requested.count(self.address), 1)
        self.assertEqual(
            [url for url in requested if url != self.address and not url.startswith(("data:", "blob:"))], []
        )

    def script(self, text, *arguments):
        return self.browser.execute_script(text, *arguments)

    def wait(self, condition, seconds=20):
        end = time.monotonic() + seconds
        while not condition():
            self.assertLess(time.monotonic(), end, "the page did not get there")
            time.sleep(0.05)

    def find(self, selector):
        return self.browser.find_element(By.CSS_SELECTOR, selector)

    def shown_text(self, selector):
        return self.find(selector).get_property("textContent")


class EmptyPage(Browsing):
    STUDY = "empty"

    def test_opens_and_says_what_is_missing(self):
        self.assertIn("No point was measured", self.shown_text("#pareto"))
        self.assertEqual(self.script("return data.count"), 0)


class Clicking(Browsing):
    def setUp(self):
        super().setUp()
        self.wait(lambda: self.script("return document.querySelectorAll('.main-svg').length") > 5)

    def click_in(self, element, x, y):
        """A real click (x, y) pixels from the element's top left corner."""
        self.script("arguments[0].scrollIntoView({block: 'center'})", element)
        box = element.rect
        dx, dy = round(x - box["width"] / 2), round(y - box["height"] / 2)
        ActionChains(self.browser).move_to_element_with_offset(element, dx - 3, dy).pause(0.1).move_by_offset(
            3, 0
        ).pause(0.2).click().perform()

    def shows(self, index):
        return self.find("#detail").get_attribute("data-hash") == self.study.points[index].hash

    def click_point(self, plot, index, shows=None):
        place = self.script(PLACE_OF_POINT, plot, index)
        self.assertIsNotNone(place, f"point {index} is not drawn")
        self.click_in(self.find(f"#{plot}"), *place)
        self.wait(lambda: self.shows(index if shows is None else shows))

    def front(self):
        return self.script("return frontOf(shown.x, shown.y)")


class ManyPoints(Clicking):
    """More points than plotly.js draws in a moment: they stand on a canvas behind the plot."""

    MANY = 4000
    # Where the cloud has a point: (x, y) from the plot's top left corner, in pixels.
    PLACE = """const plot = document.getElementById('pareto-plot'), x = plot._fullLayout.xaxis, y = plot._fullLayout.yaxis;
      return [x._offset + x.d2p(places.x[arguments[0]]), y._offset + y.d2p(places.y[arguments[0]])];"""
    DRAWN = """const c = document.querySelector('canvas.cloud'), p = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
      let drawn = 0; for (let i = 3; i < p.length; i += 4) drawn += p[i] > 0; return drawn;"""

    def lonely_point(self):
        """A point of the cloud with no other within 15 pixels."""
        return self.script("""const plot = document.getElementById('pareto-plot'), x = plot._fullLayout.xaxis, y = plot._fullLayout.yaxis;
          const at = [...places.x].map((v, i) => [x.d2p(v), y.d2p(places.y[i])]);
          const apart = (i) => at.every((p, k) => k === i || !(Math.hypot(p[0] - at[i][0], p[1] - at[i][1]) < 15));
          return at.findIndex((p, i) => Number.isFinite(p[0]) && Number.isFinite(p[1]) && i > 200 && apart(i)
            && !frontOf(shown.x, shown.y).includes(i));""")

    def test_all_points_are_there_and_the_axes_show_them(self):
        self.assertEqual(self.script("return data.count"), len(self.study.points))
        self.assertGreater(self.script(self.DRAWN), 5000)
        names = self.script("return document.getElementById('pareto-plot').data.map(t => t.name)")
        self.assertTrue({"point", "fails a constraint"} <= set(names))
        for axis, name in (("x", "cost.register_bits"), ("y", "span.u.p999, worst scene")):
            low, high = self.script(
                f"const a = document.getElementById('pareto-plot')._fullLayout.{axis}axis; "
                "return a.range.map(v => a.type === 'log' ? 10 ** v : v)"
            )
            column = self.study.metrics[name]
            column = column[column == column]
            self.assertLess(low, column.min())
            self.assertGreater(high, column.max())

    def test_a_click_and_the_pointer_find_a_point_of_the_cloud(self):
        index = self.lonely_point()
        self.assertGreater(index, 0)
        self.click_in(self.find("#pareto-plot"), *self.script(self.PLACE, index))
        self.wait(lambda: self.shows(index))
        point = self.study.points[index]
        tip = self.find("#pareto-plot .tip")
        ActionChains(self.browser).move_by_offset(1, 0).perform()
        self.assertTrue(tip.is_displayed())
        for key, value in point.settings.items():
            self.assertIn(f"{key}{value}", self.shown_text("#detail"))
            self.assertIn(f"{key} = {value}", tip.text)
        self.assertIn(f" on {self.study.worst_scenes['span.u.p999, worst scene'][index]}\n", tip.text)
        self.assertIn(f"--replay {point.hash}", self.shown_text("#detail .replay"))
        self.assertIn("keeps the TOML of the base and of recommended points only", self.shown_text("#detail"))

    def test_the_legend_hides_points_of_the_cloud(self):
        found = "return clouds.get(document.getElementById('pareto-plot')).at.filter(i => i >= 0).length"
        before = self.script(found)
        self.script("""const plot = document.getElementById('pareto-plot');
          return Plotly.restyle(plot, {visible: 'legendonly'}, [plot.data.findIndex(t => t.name === 'point')]);""")
        self.wait(lambda: 0 < self.script(found) < before)

    def test_the_front_is_that_of_the_files(self):
        for x in ("cost.register_bits", "cost.product_bits"):
            for y in ("span.u.p999", "span.h.max", "picture.wrong_order", "span.u.sqnr_db"):
                lows = [analysis.column_to_minimise(self.study, name) for name in (x, y)]
                self.assertEqual(
                    self.script("return frontOf(arguments[0], arguments[1])", x, y), analysis.front_of(self.study, *lows), y
                )

    def test_columns_arrive_as_they_were(self):
        for name in ("span.u.p999", "span.u.p999, worst scene", "cost.register_bits", "picture.psnr_db", "registers.wraps"):
            told = self.script("return Array.from(columnOf(arguments[0]), String)", name)
            for text, value in zip(told, self.study.metrics[name], strict=True):
                if value == value:
                    self.assertAlmostEqual(float(text.replace("Infinity", "inf")), value, delta=1e-7 * abs(value))
                else:
                    self.assertEqual(text, "NaN")
        self.assertEqual(
            self.script("return Array.from({length: data.count}, (_, i) => hashOf(i))"), [p.hash for p in self.study.points]
        )


class Page(Clicking):
    def check_detail(self, index):
        point = self.study.points[index]
        panel = self.find("#detail")
        self.assertEqual(panel.get_attribute("data-hash"), point.hash)
        self.assertEqual(self.shown_text("#detail .toml"), point.config)
        self.assertIn(f"--replay {point.hash}", self.shown_text("#detail .replay"))
        text = panel.get_property("textContent")
        for key, value in point.settings.items():
            self.assertIn(f"{key}{value}", text)

    def test_opens_on_what_is_recommended(self):
        self.check_detail(self.study.index_of(self.study.recommended[0].hash))
        self.assertIn("holds all constraints", self.shown_text("#detail"))

    def test_click_on_a_point_shows_its_configuration(self):
        front = self.front()
        for index in (front[1], front[-2]):
            self.click_point("pareto-plot", index)
            self.check_detail(index)
            rows = self.script(
                "return [...document.querySelectorAll('#detail .scroll tr')].map(r => r.cells[0].textContent)"
            )
            self.assertIn("span.u.p999", rows)
        self.assertNotIn("fails a constraint", self.shown_text("#detail"))

    def test_opens_on_what_the_constraint_judges(self):
        limits = """return document.getElementById('pareto-plot').layout.shapes.filter(s => s.line.dash === 'dash').map(s => s.y0)"""
        name = "span.u.p999, worst scene"
        self.assertEqual(self.find("#pareto-y").get_attribute("value"), name)
        self.assertEqual(self.script(limits), [0.25])
        self.assertIn("what a constraint judges", self.shown_text("#pareto"))
        index = next(
            i for i, p in enumerate(self.study.points)
            if p.holds is False and self.study.metrics["span.u.p999"][i] < 0.25 < self.study.metrics[name][i]
        )  # fmt: skip
        scene, value = self.study.worst_scenes[name][index], self.study.metrics[name][index]
        self.assertIn(
            f"<b>{name}</b> {value:.4g} texel on {scene}<br>", self.script("return hoverOf(arguments[0], shown.x, shown.y)", index)
        )
        self.script("showPoint(arguments[0])", index)
        rows = self.script("return [...document.querySelector('#detail table').rows].map(r => [...r.cells].map(c => c.textContent))")
        self.assertEqual(rows[:2], [["constraint", "judged", "scene"], ["span.u.p999 at most 0.25", f"{value:.4g}", scene]])
        Select(self.find("#pareto-y")).select_by_value("span.u.p999")
        self.assertEqual(self.script(limits), [])

    def test_other_metrics_move_the_points_and_the_front(self):
        before = self.front()
        Select(self.find("#pareto-y")).select_by_value("span.h.max")
        Select(self.find("#pareto-x")).select_by_value("cost.product_bits")
        after = self.front()
        self.assertNotEqual(before, after)
        drawn = self.script(
            "return document.getElementById('pareto-plot').data.find(t => t.name === 'Pareto front').customdata"
        )
        self.assertEqual(drawn, after)
        title = self.shown_text("#pareto-plot .ytitle")
        self.assertEqual(title, "span.h.max [depth code]")
        self.click_point("pareto-plot", after[0])
        self.check_detail(after[0])

    def test_further_clicks_show_what_lies_at_the_same_place(self):
        Select(self.find("#pareto-y")).select_by_value("span.h.max")
        Select(self.find("#pareto-x")).select_by_value("cost.product_bits")
        index = self.front()[-1]
        same = self.script("return pointsAtPlace(arguments[0])", index)
        column = [self.study.metrics[name] for name in ("span.h.max", "cost.product_bits")]
        self.assertEqual(
            sorted(same), [i for i in range(len(self.study.points)) if all(c[i] == c[index] for c in column)]
        )
        self.assertGreater(len(same), 1)
        self.assertEqual(same[0], index)
        self.click_point("pareto-plot", index)
        self.assertIn(f"1 of {len(same)} points", self.shown_text("#detail"))
        self.click_point("pareto-plot", index, shows=same[1])
        self.check_detail(same[1])

    def test_buttons_walk_along_the_front(self):
        front = self.front()
        self.click_point("pareto-plot", front[2])
        self.find("#pareto-next").click()
        self.check_detail(front[3])
        self.find("#pareto-previous").click()
        self.check_detail(front[2])

    def test_filter_of_the_metrics(self):
        self.find("#detail input").send_keys("picture.")
        names = self.script(
            "return [...document.querySelectorAll('#detail .scroll tbody tr')].map(r => r.cells[0].textContent)"
        )
        self.assertEqual(
            names,
            ["picture.psnr_db", "picture.wrong_order", "picture.wrong_order, worst scene", "picture.wrong_texel_rate"],
        )

    def test_unseen_views_stand_beside_the_limit(self):
        curve, holds, fails = self.script("return document.querySelector('[data-plot=unseen]').data.map(t => [t.x, t.y, t.text])")
        values = [0.0125 * 2 ** (view / 2) for view in range(2, 10)]
        for x, value in zip(curve[0], [values[0], *values], strict=True):
            self.assertAlmostEqual(x, value, delta=1e-4 * value)
        self.assertEqual(curve[1], [100 * i / 8 for i in range(9)])
        self.assertEqual((len(holds[0]), fails[1:]), (7, [[100], ["<b>demo@9</b> 0.2828: fails"]]))
        shapes = self.script("return document.querySelector('[data-plot=unseen]').layout.shapes.map(s => [s.x0, s.line.dash])")
        self.assertEqual(shapes, [[0.25, "dash"]])

    def test_bounds_tell_how_much_of_them_was_reached(self):
        texts = self.script(
            "return document.querySelector('.variant:not([hidden]) > [data-plot=bounds]').data[1].text"
        )
        self.assertEqual(texts[0], "<b>span.h [depth code]</b><br>observed 0.0207<br>bound 0.0419<br>49.4 % of the bound")

    def test_copied_toml_is_the_configuration(self):
        self.script(
            "window.copied = null; navigator.clipboard.writeText = (text) => { window.copied = text; return Promise.resolve(); }"
        )
        index = self.study.index_of(self.study.recommended[0].hash)
        self.find(".card [data-copy=toml]").click()
        self.assertEqual(self.script("return window.copied"), self.study.points[index].config)
        self.find(".card [data-copy=replay]").click()
        self.assertIn(self.study.points[index].hash, self.script("return window.copied"))
        self.wait(lambda: "copied" in self.shown_text(".card"))

    def test_knees_are_marked(self):
        self.assertEqual(self.script("return document.querySelectorAll('#widths-plots .chart').length"), 3)
        self.assertIn("knee at 32", self.shown_text("#widths-plots"))
        rings = self.script("return document.querySelectorAll('#widths-plots .chart')[0].data[1]")
        self.assertEqual(rings["x"], [32])
        Select(self.find("#widths-y")).select_by_value("picture.wrong_order")
        self.assertIn("picture.wrong_order [pixels]", self.shown_text("#widths-plots .ytitle"))

    def test_histograms_show_what_was_held(self):
        index = self.study.index_of(self.study.recommended[0].hash)
        registers = self.study.registers[self.study.points[index].hash]
        ranges, spare, bars = self.script("return document.querySelector('[data-plot=registers]').data.map(t => t.x)")
        self.assertEqual(len(ranges), len(registers))
        self.assertEqual(len(spare), sum(r.headroom > 0 for r in registers))
        self.assertEqual(len(bars), sum(count > 0 for r in registers for count in r.octaves))
        base = self.study.points[self.study.base].hash
        Select(self.find("#registers select.variants")).select_by_value(base)
        self.assertEqual(
            self.script(
                "return [...document.querySelectorAll('#registers .variant')].filter(b => !b.hidden).map(b => b.dataset.hash)"
            ),
            [base],
        )
        self.assertGreater(
            self.script("return document.querySelector('#registers .variant:not([hidden]) .chart').data.length"), 0
        )

    def test_certificate_leads_to_the_points_that_fail(self):
        row = self.study.certificate[0]
        link = self.find("#search td button")
        self.script("arguments[0].scrollIntoView({block: 'center'})", link)
        link.click()
        self.check_detail(self.study.index_of(row.hash))
        self.assertIn("fails a constraint", self.shown_text("#detail"))

    def test_refused_points_say_why(self):
        self.script("document.querySelector('#refused td button').click()")
        refused = next(p for p in self.study.points if p.refused)
        self.assertEqual(self.find("#detail").get_attribute("data-hash"), refused.hash)
        self.assertIn(refused.message, self.shown_text("#detail"))  # markup in it is text
        self.assertEqual(self.script("return document.querySelectorAll('img[src=x]').length"), 0)

    def panel_pixels(self):
        """A hash of each visible picture panel's pixels."""
        return self.script("""return [...document.querySelectorAll('#pictures .variant:not([hidden]) .viewer:not([hidden]) canvas')]
          .map(c => [c.dataset.name || 'bar', c.toDataURL().split('').reduce((h, c) => (h * 31 + c.charCodeAt(0)) | 0, 7)])""")

    def test_pictures_zoom_and_move_together(self):
        self.script("document.getElementById('pictures').scrollIntoView()")
        self.wait(lambda: len(self.panel_pixels()) == 9)
        viewer = "document.querySelector('#pictures .viewer').viewer"
        whole = self.panel_pixels()
        self.assertEqual(
            [name for name, _ in whole if name != "bar"],
            ["ideal", "model", "difference", "u_error", "depth_error", "dominant"],
        )
        canvas = self.find("#pictures canvas[data-name=model]")
        self.script(
            """arguments[0].dispatchEvent(new WheelEvent('wheel', {deltaY: -100, clientX: 0, clientY: 0, bubbles: true,
          cancelable: true}))""",
            canvas,
        )
        self.find("#pictures .zoom-in").click()
        zoom, x, y = self.script(f"const v = {viewer}; return [v.zoom, v.x, v.y]")
        self.assertAlmostEqual(zoom, 2.6)
        near = self.panel_pixels()
        for (name, before), (_, after) in zip(whole, near):
            self.assertEqual(before == after, name == "bar", name)  # the bars of the heat maps stand still
        ActionChains(self.browser).drag_and_drop_by_offset(canvas, 40, 20).perform()
        moved_x, moved_y = self.script(f"const v = {viewer}; return [v.x, v.y]")
        scale = 96 / zoom / canvas.rect["width"]
        self.assertAlmostEqual(x - moved_x, 40 * scale, delta=1.5 * scale)
        self.assertAlmostEqual(y - moved_y, 20 * scale, delta=1.5 * scale)
        self.assertRegex(self.shown_text("#pictures figcaption .mono"), r"\(\d+, \d+\) \d+ \d+ \d+")
        self.find("#pictures .zoom-reset").click()
        self.assertEqual(self.panel_pixels(), whole)

    def test_dark_is_dark(self):
        self.browser.execute_cdp_cmd(
            "Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": "dark"}]}
        )
        self.addCleanup(self.browser.execute_cdp_cmd, "Emulation.setEmulatedMedia", {"features": []})
        self.assertEqual(self.script("return getComputedStyle(document.body).backgroundColor"), "rgb(20, 24, 27)")
        self.wait(
            lambda: self.script("return document.getElementById('pareto-plot')._fullLayout.font.color") == "#e4e9ec"
        )


if __name__ == "__main__":
    unittest.main()
