# SPDX-License-Identifier: Apache-2.0
"""The numbers behind the report's plots."""

import contextlib
import dataclasses
import math
import re
import sqlite3
import tempfile
import unittest
from pathlib import Path

import numpy as np
from bitspan_report import analysis, answer, data, expression, figures, page
from bitspan_report.database import load_study
from bitspan_report.study import Bound, BudgetRow, Constraint, Metric, Point, Register, SearchStep, Varied
from make_database import BASE, write_database

ERROR = Metric("span.u.max", "span.u", "maximum", "texel", False, "result", False, "")
DECIBELS = Metric("span.u.sqnr_db", "span.u", "SQNR [dB]", "dB", True, "result", False, "")


def metric_named(name):
    if name.endswith("_db"):
        return DECIBELS
    return dataclasses.replace(ERROR, name=name, squares_add=name.endswith(".rms"))


def dominated(costs, errors, i):
    """By the definition, one point at a time: the slow and plain way."""
    for j in range(len(costs)):
        no_worse = costs[j] <= costs[i] and errors[j] <= errors[i]
        if no_worse and (costs[j] < costs[i] or errors[j] < errors[i] or j < i):
            return True
    return False


class ParetoFront(unittest.TestCase):
    def test_a_small_one_by_hand(self):
        costs = np.array([3.0, 1.0, 2.0, 2.0, 4.0, 1.0])
        errors = np.array([1.0, 5.0, 3.0, 2.0, 1.0, 6.0])
        self.assertEqual(analysis.pareto_front(costs, errors), [1, 3, 0])

    def test_equals_the_definition_on_random_points(self):
        rng = np.random.default_rng(1)
        for _ in range(50):
            costs = rng.integers(0, 12, 40).astype(float)  # with ties
            errors = rng.integers(0, 12, 40).astype(float)
            front = analysis.pareto_front(costs, errors)
            self.assertEqual(sorted(front), [i for i in range(40) if not dominated(costs, errors, i)])
            self.assertTrue(all(costs[a] < costs[b] and errors[a] > errors[b] for a, b in zip(front, front[1:])))

    def test_a_point_that_fails_is_not_on_the_front_of_a_study(self):
        class Point:
            def __init__(self, holds):
                self.holds = holds

        class Study:
            points = [Point(True), Point(False), Point(None), Point(True)]

        costs, errors = np.array([3.0, 1.0, 2.0, 4.0]), np.array([1.0, 0.5, 2.0, 0.9])
        self.assertEqual(analysis.front_of(Study, costs, errors), [2, 0, 3])
        self.assertEqual(analysis.pareto_front(costs, errors), [1])

    def test_points_without_a_value_are_never_on_it(self):
        costs = np.array([1.0, 2.0, math.nan, 0.0])
        errors = np.array([math.nan, 3.0, 0.0, math.inf])
        self.assertEqual(analysis.pareto_front(costs, errors), [1])
        self.assertEqual(analysis.pareto_front(np.array([]), np.array([])), [])

    def test_decibels_are_to_be_high(self):
        values = np.array([40.0, 60.0])
        costs = np.array([1.0, 2.0])
        self.assertEqual(analysis.pareto_front(costs, analysis.to_minimise(DECIBELS, values)), [0, 1])
        self.assertEqual(analysis.pareto_front(costs, analysis.to_minimise(ERROR, values)), [0])


class Knee(unittest.TestCase):
    WIDTHS = np.arange(16.0, 29.0)

    def test_is_where_the_floor_begins(self):
        for floor_at in (18, 21, 25):
            errors = np.maximum(2.0**-self.WIDTHS, 2.0**-floor_at)
            at = analysis.knee(self.WIDTHS, analysis.octaves(ERROR, errors))
            self.assertEqual(self.WIDTHS[at], floor_at)

    def test_a_straight_line_has_none(self):
        self.assertIsNone(analysis.knee(self.WIDTHS, analysis.octaves(ERROR, 2.0**-self.WIDTHS)))
        self.assertIsNone(analysis.knee(self.WIDTHS, analysis.octaves(ERROR, np.zeros(13))))

    def test_a_shallow_bend_has_none(self):
        self.assertIsNone(analysis.knee(np.array([1.0, 2.0, 3.0]), np.array([2.0, 0.51, 0.0])))
        self.assertEqual(analysis.knee(np.array([1.0, 2.0, 3.0]), np.array([2.0, 0.49, 0.0])), 1)

    def test_two_points_have_none(self):
        self.assertIsNone(analysis.knee(np.array([1.0, 2.0]), np.array([2.0, 0.0])))

    def test_is_the_same_in_decibels(self):
        errors = np.maximum(2.0**-self.WIDTHS, 2.0**-20.0)
        decibels = -20 * np.log10(errors)
        by_errors = analysis.octaves(ERROR, errors)
        by_decibels = analysis.octaves(DECIBELS, decibels)
        np.testing.assert_allclose(by_decibels, by_errors, atol=1e-9)

    def test_a_zero_is_half_the_smallest_error(self):
        np.testing.assert_allclose(analysis.octaves(ERROR, np.array([8.0, 2.0, 0.0])), [3, 1, 0])


class Scales(unittest.TestCase):
    def test_logarithmic_only_where_it_helps(self):
        floor = analysis.log_floor
        self.assertIsNone(floor(np.array([1.0, 2.0, 7.0])))
        self.assertIsNone(floor(np.array([-1.0, 2.0, 2000.0])))
        self.assertIsNone(floor(np.array([0.0, 0.0])))
        self.assertIsNone(floor(np.array([0.0, 1.0, 2.0])))
        self.assertAlmostEqual(floor(np.array([0.01, 2.0, math.nan, math.inf])), 0.01 / math.sqrt(10))
        self.assertAlmostEqual(floor(np.array([0.0, 1.0, 16.0])), 1 / math.sqrt(10))


class Registers(unittest.TestCase):
    def register(self, word, integer, signed, octaves):
        counts = [0] * 128
        for exponent, count in octaves.items():
            counts[exponent + 64] = count
        return Register("r", "", word, integer, signed, sum(counts), 0, 0, 0, 0, 0, 0, 0, counts)

    def test_range_of_a_format(self):
        self.assertEqual(self.register(16, 16, False, {}).range_log2, (0, 16))  # 1 .. 65535
        self.assertEqual(self.register(25, 17, True, {}).range_log2, (-8, 16))  # 2^-8 .. 2^16
        self.assertEqual(self.register(8, 0, False, {}).range_log2, (-8, 0))  # 2^-8 .. 1

    def test_the_format_of_a_range_keeps_the_fraction_bits(self):
        def from_range(word, integer, signed, used, count=1):
            return Register("r", "", word, integer, signed, count, 0, 0, used, 0, 0, 0, 0, [0] * 128).from_range

        self.assertEqual(from_range(42, 34, True, 20), ("s20.8", 28))
        self.assertEqual(from_range(19, 1, False, 0), ("u0.18", 18))
        self.assertEqual(from_range(19, 1, False, -3), ("u-3.18", 15))
        self.assertEqual(from_range(16, 8, True, 11), ("s11.8", 19))  # the values overflowed
        self.assertEqual(from_range(8, 4, False, -4), ("u-3.4", 1))  # zeros alone
        self.assertEqual(from_range(8, 4, False, 0, count=0), ("u4.4", 8))

    def test_bars_stand_at_their_octaves(self):
        bars = list(figures.octave_bars(self.register(16, 16, False, {-64: 1, 3: 9, 63: 99})))
        self.assertEqual([(e, c) for e, c, _ in bars], [(-64, 1), (3, 9), (63, 99)])
        self.assertAlmostEqual(bars[2][2], 1)
        self.assertAlmostEqual(bars[1][2], 0.5)  # log(10) / log(100)
        self.assertEqual(list(figures.octave_bars(self.register(16, 16, False, {}))), [])


class Budget(unittest.TestCase):
    def test_powers_of_independent_errors_fill_the_bar(self):
        rows = [
            BudgetRow("a", "span.u.rms", 5, 4, 3),
            BudgetRow("b", "span.u.rms", 5, 3, 4),
            BudgetRow("nothing", "span.u.rms", 5, 5, 0),
            BudgetRow("a", "span.u.max", 10, 4, 6),
            BudgetRow("b", "span.u.max", 10, 9, 1),
            BudgetRow("a", "span.u.sqnr_db", 50, 60, 55),
            BudgetRow("a", "span.v.max", 0, 0, 0),
            BudgetRow("a", "span.v.rms", 1, 1, math.nan),
        ]
        power, largest = analysis.budget_stacks(metric_named, rows)
        self.assertEqual((power.metric, power.powers, power.common), ("span.u.rms", True, 0))
        self.assertEqual([name for name, _ in power.shares], ["b", "a", "nothing"])
        self.assertAlmostEqual(sum(share for _, share in power.shares), 1)
        self.assertEqual((largest.metric, largest.powers, largest.common), ("span.u.max", False, 0.1))
        self.assertEqual(largest.shares, [("a", 0.5), ("b", 0)])

    def test_what_all_have_in_common_is_told_once(self):
        # 40 registers of which two matter, above an output rounding of 3: power 9 + 16 + 11 = 36.
        alone = [math.sqrt(9 + 16), math.sqrt(9 + 11), *[3.0] * 38]
        rows = [BudgetRow(f"r{i}", "picture.colour.rms", 6, 6, value) for i, value in enumerate(alone)]
        (stack,) = analysis.budget_stacks(metric_named, rows)
        self.assertAlmostEqual(stack.common, 9 / 36)
        self.assertAlmostEqual(stack.common + sum(share for _, share in stack.shares), 1)

    def test_names_are_the_heaviest(self):
        stack = analysis.Stack("m", 1, False, [(name, 0.1 * i) for i, name in enumerate("abcdefgh")], 0)
        self.assertEqual(figures.stack_names([stack]), list("hgfedc"))


class BoundsAndSearch(unittest.TestCase):
    def test_what_was_reached_is_told_as_the_command_line_does(self):
        self.assertEqual(Bound("p", "u", 3, 1.5).reached, "50.0 %")
        self.assertEqual(Bound("p", "u", 3, 4).reached, "133.3 %")
        self.assertEqual(Bound("p", "u", 3, 0).reached, "0.0 %")
        self.assertEqual(Bound("p", "u", 0, 0).reached, "0.0 %")
        self.assertEqual(Bound("p", "u", 0, 1).reached, "inf %")
        (axes,) = figures.bounds([Bound("p", "u", 3, 1.5), Bound("q", "u", 3, 4)]).axes
        self.assertEqual([text.get_text() for text in axes.texts], ["50.0 %", "ABOVE ITS BOUND"])
        self.assertFalse(Bound("p", "u", 3, 3).broken)
        self.assertTrue(Bound("p", "u", 3, 3.1).broken)

    def test_best_so_far_ignores_what_fails_and_what_costs_more(self):
        steps = [
            SearchStep(i, "", cost, holds, False)
            for i, (cost, holds) in enumerate(
                [(9, False), (8, True), (3, False), (8.5, True), (6, True), (math.nan, False), (7, True)]
            )
        ]
        self.assertEqual(figures.best_so_far(steps), [(1, 8), (4, 6), (6, 6)])
        self.assertEqual(figures.best_so_far(steps[:1]), [])


class Expressions(unittest.TestCase):
    METRICS = {"a.b": np.array([1.0, 2.0, math.nan]), "m0": np.array([4.0, 0.0, 8.0]), "x.in_2": np.array([3.0, 3.0, 3.0])}

    def test_values_are_those_of_docs_study(self):
        for text, expected in (
            ("a.b", (1, 2, math.nan)),
            ("a.b + 2 * m0 - 1", (8, 1, math.nan)),
            ("(a.b + 2) * -m0 / .5", (-24, 0, math.nan)),
            ("x.in_2/m0 - 2e0", (-1.25, math.nan, -1.625)),
            ("min(m0, a.b, x.in_2)", (1, 0, math.nan)),
            ("max(a.b, m0)+max(x.in_2)", (7, 5, math.nan)),
            ("8 / m0 / 2 - 1 - 1", (-1, math.nan, -1.5)),
        ):
            np.testing.assert_array_equal(expression.value_of(text, self.METRICS), expected, text)
        self.assertEqual(expression.metrics_of("min(m0, a.b) / 1e3 + m0"), ["m0", "a.b"])

    def test_nothing_else_is_evaluated(self):
        for text in ("a.b ** m0", "a.b if m0 else 1", "abs(a.b)", "a.b[0]", "min(*m0)", "'a'", "a.b, m0", "", "(" * 9999 + "m0"):
            with self.assertRaises((ValueError, KeyError), msg=text):
                expression.value_of(text, {**self.METRICS, "abs": self.METRICS["m0"]})


class WorstScene(unittest.TestCase):
    def judged(self, constraint, values, there=None):
        values = np.array(values, dtype=float)[:, None]
        there = np.ones_like(values, dtype=bool) if there is None else np.array(there)[:, None]
        found, scene = analysis.decisive(constraint, analysis.SceneColumn(values, there), np.array([7.0]))
        return float(found[0]), int(scene[0])

    def test_is_the_nearest_to_the_limit_or_farthest_beyond_it(self):
        most, least, both = (Constraint("m", *limits, False) for limits in ((5, None), (None, 2), (5, 2)))
        self.assertEqual(self.judged(most, [1, 3, 2]), (3, 1))
        self.assertEqual(self.judged(least, [9, 3, 4]), (3, 1))
        self.assertEqual(self.judged(both, [4, 2.5, 3]), (2.5, 1))
        self.assertEqual(self.judged(both, [7, 1, 3]), (7, 0))
        self.assertEqual(self.judged(most, [3, 3]), (3, 0))
        self.assertEqual(self.judged(least, [math.inf, math.inf]), (math.inf, 0))
        self.assertEqual(self.judged(least, [0, math.inf], [False, True]), (math.inf, 1))
        self.assertEqual(self.judged(most, [0, -math.inf, 4], [False, True, False]), (-math.inf, 1))
        self.assertEqual(self.judged(most, [9, 9], [False, False]), (7, -1))
        found, scene = self.judged(most, [9, math.nan, math.nan])
        self.assertTrue(math.isnan(found))
        self.assertEqual(scene, 1)


class Curves(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.database = Path(folder.name) / "t.db"
        write_database(cls.database)
        cls.study = load_study(str(Path(folder.name) / "t.db"), "spans")

    def test_units_are_those_of_the_database(self):
        for metric, unit in (
            ("span.u.p999", "texel"),
            ("span.u.max_ulp", "ULP"),
            ("span.u.sqnr_db", "dB"),
            ("cost.register_bits", "bits"),
            ("area.ice40.luts", "LUTs"),
            ("span.x.max", ""),
            ("picture.wrong_texel_rate", "of the pixels"),
        ):
            self.assertEqual(self.study.unit_of(metric), unit, metric)
        self.assertEqual(analysis.axis_title(self.study.metric("span.u.rms")), "span.u.rms [texel]")

    def test_axes_are_those_of_the_plan(self):
        axes = analysis.read_axes(self.study)
        self.assertEqual([axis.keys[0] for axis in axes], list(BASE))
        self.assertEqual([axis.values[self.study.base] for axis in axes], list(BASE.values()))
        self.assertEqual(axes[1].keys, ["formats.span.uv.word", "formats.edge.uv.word"])
        self.assertEqual(axes[1].label, "formats.span.uv.word with formats.edge.uv.word")
        refused = [p.hash for p in self.study.points if p.refused]
        self.assertTrue(refused)
        self.assertFalse(any(self.study.points[i].refused for axis in axes for i in axis.slice))

    def test_linked_keys_show_what_tells_their_values_apart(self):
        def axes_of(*settings, name="", offsets=(0, 0), base=(None, None)):
            points = [
                Point(str(i), "", "", "", False, "", 0, i, dict(zip("ab", values))) for i, values in enumerate(settings)
            ]
            study = dataclasses.replace(
                self.study, points=points, base=None, axes=[Varied(name, ["a", "b"], list(offsets))],
                base_settings=dict(zip("ab", base)),
            )
            return analysis.read_axes(study)

        (axis,) = axes_of((1, 5), (2, 5), (3, 6))
        self.assertEqual((axis.shown, axis.values, axis.numeric, axis.label), ("a", [1, 2, 3], True, "a with b"))
        (axis,) = axes_of(("lut", 5), ("lut", 6), ("exact", 0))
        self.assertEqual((axis.shown, axis.values, axis.numeric, axis.label), ("b", [5, 6, 0], True, "b with a"))
        (axis,) = axes_of(("lut", 5), ("lut", 6), ("newton", 6))
        self.assertEqual((axis.shown, axis.values, axis.numeric), ("a, b", ["lut 5", "lut 6", "newton 6"], False))
        self.assertEqual(axes_of((1, 5), (1, 5)), [])
        # A name stands for its keys. Its values are what the keys follow from, but for a base that follows from none.
        points = ((12, 14), (13, 15), (14, 16), (20, 20))
        (axis,) = axes_of(*points, name="depth", offsets=(2, 4), base=(20, 20))
        self.assertEqual((axis.shown, axis.values, axis.numeric, axis.label), ("depth", [10, 11, 12, None], True, "depth"))
        (axis,) = axes_of(("lut", 5), ("lut", 6), name="unit")
        self.assertEqual((axis.shown, axis.values, axis.numeric, axis.label), ("unit", [5, 6], True, "unit"))
        (axis,) = axes_of(("lut", 5), ("lut", 6), ("newton", 6), name="unit")
        self.assertEqual((axis.shown, axis.values), ("unit", ["lut 5", "lut 6", "newton 6"]))

    def test_keys_that_share_a_prefix_say_it_once(self):
        together = analysis._together
        self.assertEqual(together(["reciprocal.pixel.kind", "reciprocal.pixel.steps"]), "reciprocal.pixel: kind, steps")
        self.assertEqual(together(["depth.bits", "fog.mode"]), "depth.bits, fog.mode")
        self.assertEqual(together(["a.b", "a.b.c"]), "a: b, b.c")

    def changed(self, *statements):
        """The study after some SQL."""
        path = self.database.with_name("changed.db")
        path.write_bytes(self.database.read_bytes())
        with contextlib.closing(sqlite3.connect(path)) as connection:
            for statement in statements:
                connection.execute(statement)
            connection.commit()
        return load_study(str(path), "spans")

    def test_a_point_holds_where_its_worst_scenes_do(self):
        def within(column):
            return [all(c.margins(column(c))[i] >= 0 for c in self.study.constraints) for i in judged]

        judged = [i for i, point in enumerate(self.study.points) if point.holds is not None]
        holds = [self.study.points[i].holds for i in judged]
        self.assertEqual(within(lambda c: self.study.metrics[c.judged]), holds)
        self.assertNotEqual(within(lambda c: self.study.metrics[c.metric]), holds)
        self.assertEqual(
            analysis.error_metrics(self.study)[:2], ["span.u.p999, worst scene", "picture.wrong_order, worst scene"]
        )
        self.assertEqual(self.study.unit_of("span.u.p999, worst scene"), "texel")

    def test_the_worst_scene_is_that_of_the_database(self):
        scenes = self.study.worst_scenes["span.u.p999, worst scene"]
        with contextlib.closing(sqlite3.connect(self.database)) as connection:
            for i, point in enumerate(self.study.points):
                rows = connection.execute(
                    "SELECT value, scene FROM scene_metrics WHERE hash = ? AND name = 'span.u.p999'", (point.hash,)
                ).fetchall()
                if not rows:
                    self.assertTrue(point.refused)
                    continue
                value, scene = max(rows)
                self.assertEqual(self.study.metrics["span.u.p999, worst scene"][i], value)
                self.assertEqual(scenes[i], ("demo", "extreme")[scene])
        self.assertEqual(set(scenes), {"", "demo", "extreme"})

    def test_pooled_constraints_and_single_scenes_have_no_worst(self):
        for statement in (
            "UPDATE constraints SET over = 'pooled'",
            """UPDATE points SET scenes = '[{"name": "demo"}]'""",
            "DELETE FROM scene_metrics",
        ):
            study = self.changed(statement)
            self.assertEqual(study.worst_scenes, {})
            self.assertEqual([c.judged for c in study.constraints], [c.metric for c in study.constraints])
            self.assertEqual(analysis.error_metrics(study)[0], "span.u.p999")
        self.assertEqual(
            str(self.changed("UPDATE constraints SET over = 'pooled'").constraints[0]),
            "span.u.p999 at most 0.25, over all scenes together",
        )

    def test_an_expression_and_a_second_limit_have_their_own_worst(self):
        text = "span.u.p999 * cost.register_bits"
        study = self.changed(
            f"INSERT INTO expressions SELECT hash, '{text}', 1 FROM metrics WHERE name = 'span.u.p999'",
            f"INSERT INTO constraints VALUES('spans', 2, '{text}', 500, NULL, 'worst')",
            "INSERT INTO constraints VALUES('spans', 3, 'span.u.p999', NULL, 0.001, 'worst')",
            "INSERT INTO constraints VALUES('spans', 4, 'cost.register_bits', 5000, NULL, 'worst')",
        )
        expected = study.metrics["span.u.p999, worst scene"] * study.metrics["cost.register_bits"]
        np.testing.assert_array_equal(study.metrics[f"{text}, worst scene"], expected)
        self.assertEqual(study.worst_scenes[f"{text}, worst scene"], study.worst_scenes["span.u.p999, worst scene"])
        second = study.constraints[3].judged
        self.assertEqual(second, "span.u.p999, worst scene, at least 0.001")
        np.testing.assert_allclose(
            study.metrics[second] * 1.25 / 0.8, study.metrics["span.u.p999, worst scene"], rtol=1e-12
        )
        self.assertEqual(study.constraints[4].judged, "cost.register_bits")  # no scene has a share in it

    def test_measured_costs_stand_beside_their_estimates(self):
        self.assertIn("Nothing was synthesised at the end of a search", answer.measured(self.study))
        found, base = self.study.recommended[0].hash, self.study.points[self.study.base].hash
        study = self.changed(
            f"INSERT INTO measured_costs VALUES('spans', 1, '{base}', 4512.4, 160.3, 4352.1, '')",
            f"INSERT INTO measured_costs VALUES('spans', 0, '{found}', 4600, 61.2, 4300, '')",
            "INSERT INTO measured_costs VALUES('spans', 2, 'x', 5000.26, 1.234, NULL, '<no> tool')",
            f"INSERT INTO measured_costs VALUES('another', 0, '{found}', 1, 1, 1, '')",
        )
        text = answer.measured(study)
        self.assertIn("cost.register_bits: measured within the ± at 1 of 2 points.", text)
        rows = [re.sub(r"<[^>]*>", "|", row).split("|") for row in re.findall(r"<tr>.*?</tr>", text, re.DOTALL)[1:]]
        rows = [[cell.strip() for cell in row if cell.strip()] for row in rows]
        self.assertEqual(
            rows,
            [
                ["1", "2", found[:12], "recommended", "4600 ± 61", "4300", "-6.5 %", "outside the ±"],
                ["2", "1", base[:12], "4512 ± 160", "4352", "-3.6 %", "within the ±"],
                ["3", "3", "x", "5000.3 ± 1.2", "–", "–", "failed", ": &lt;no&gt; tool"],
            ],
        )
        without = self.changed("DROP TABLE measured_costs")  # a database of an earlier bitspan
        self.assertIn("Nothing was synthesised at the end of a search", answer.measured(without))
        self.assertEqual(answer.estimate_text(4512.25, 0), "4512.25")
        self.assertEqual(answer.estimate_text(6485.59, 995.6), "6486 ± 1000")

    def test_axes_that_do_not_move_the_cost_are_named(self):
        def idle_of(study):
            return [(axis.label, count) for axis, count in analysis.idle_axes(study, analysis.read_axes(study))]

        self.assertEqual(idle_of(self.study), [])
        other = "UPDATE studies SET cost = 'cost.product_bits' WHERE name = 'spans'"  # it counts the output alone
        study = self.changed(other)
        h, uv = "formats.span.h.word", "formats.span.uv.word with formats.edge.uv.word"
        self.assertEqual(idle_of(study), [(h, 5 * 5), (uv, 6 * 5)])
        text = page.studied(study, analysis.read_axes(study))
        self.assertIn(f"{h} does not move cost.product_bits: 25 sets of points differ in it alone", text)
        one = self.study.points[self.study.index_of(self.study.recommended[0].hash)].hash
        value = "UPDATE metrics SET value = value + 1 WHERE name = 'cost.product_bits' AND hash = "
        self.assertEqual(idle_of(self.changed(other, f"{value}'{one}'")), [])

        def of_points(costs, *settings):
            points = [Point(str(i), "", "", "", False, "", 0, i, dict(zip("ab", s))) for i, s in enumerate(settings)]
            return idle_of(
                dataclasses.replace(
                    self.study, points=points, base=None, metrics={"cost.register_bits": np.array(costs)},
                    axes=[Varied("", [key], [0]) for key in "ab"], base_settings={"a": None, "b": None},
                )
            )  # fmt: skip

        self.assertEqual(of_points([5.0, 5.0, 6.0], (1, 1), (2, 1), (2, 2)), [("a", 1)])
        self.assertEqual(of_points([5.0, 5.0], (1, 1), (2, 2)), [])  # no two differ in one alone
        self.assertEqual(of_points([5.0, math.nan, 6.0], (1, 1), (2, 1), (1, 2)), [])

    def test_words_from_ranges_stand_beside_the_found_ones(self):
        base, found = self.study.points[self.study.base].hash, self.study.recommended[0].hash
        register = "UPDATE registers SET format = 's{}.{} SC_RND SC_SAT', word = {}, int = {}, signed = 1, used_bits = {}"
        study = self.changed(
            register.format(16, 18, 34, 16, 13) + f" WHERE name = 'span.h' AND hash = '{base}'",
            register.format(17, 8, 25, 17, 12) + f" WHERE name = 'span.uv' AND hash = '{base}'",
            register.format(16, 10, 26, 16, 0) + f" WHERE name = 'span.h' AND hash = '{found}'",
            register.format(17, 6, 23, 17, 0) + f" WHERE name = 'span.uv' AND hash = '{found}'",
            f"DELETE FROM registers WHERE name LIKE 'reciprocal%' AND hash = '{base}'",
        )
        rows = [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in re.findall(r"<tr>.*?</tr>", answer.ranges(study))[1:]]
        self.assertEqual(
            rows,
            [
                ["span.h", "13", "s16.18", "34", "s13.18", "31", "s16.10", "26"],
                ["span.uv", "12", "s17.8", "25", "s12.8", "20", "s17.6", "23"],
                ["all of these", "–", "", "59", "", "51", "", "49"],
            ],
        )
        self.assertIn("This needs a register", answer.ranges(self.changed("DELETE FROM recommended")))
        self.assertIn("This needs a register", answer.ranges(self.changed("DELETE FROM registers")))

    def test_unseen_views_are_counted_and_drawn(self):
        h = self.study.recommended[0].hash
        (title, constraint, views), (_, _, orders) = analysis.unseen_panels(self.study, h)
        self.assertEqual((title, constraint), ("span.u.p999 [texel]", self.study.constraints[0]))
        self.assertEqual([view.scene for view in views], [f"demo@{i}" for i in range(2, 10)])
        self.assertEqual([sum(view.holds for view in of) for of in (views, orders)], [7, 8])
        text = answer.unseen(self.study)
        self.assertIn('<p class="bad">All constraints hold on 7 of 8 views.</p>', text)
        self.assertIn("at most 0.25: 7 of 8 hold<", text)
        self.assertIn("at most 0: 8 of 8 hold<", text)

        study = self.changed("UPDATE validation SET value = NULL, holds = 0 WHERE scene = 'demo@2'")
        panels = analysis.unseen_panels(study, h)
        self.assertIn('<p class="bad">All constraints hold on 6 of 8 views.</p>', answer.unseen(study))
        axes = figures.unseen(panels).axes[0]
        self.assertEqual(axes.get_title("left"), "at most 0.25: 6 of 8 hold; 1 without a finite value")
        curve, limit = axes.lines[1], axes.lines[0]
        np.testing.assert_allclose(curve.get_ydata(), [0, 12.5, 25, 37.5, 50, 62.5, 75, 87.5])
        np.testing.assert_allclose(curve.get_xdata(), [0.0125 * 2 ** (i / 2) for i in (3, 3, 4, 5, 6, 7, 8, 9)])
        self.assertEqual(list(limit.get_xdata()), [0.25, 0.25])

        study = self.changed("UPDATE validation SET value = 0.1, holds = 1 WHERE i = 0")
        self.assertIn('<p class="ok">All constraints hold on 8 of 8 views.</p>', answer.unseen(study))
        self.assertIn("No view was kept from the choice", answer.unseen(self.changed("DELETE FROM validation")))

    def test_expressions_of_the_plan_are_metrics(self):
        cost, limited = "2 * cost.register_bits", "1 / span.u.max"
        study = self.changed(
            f"UPDATE studies SET cost = '{cost}'",
            f"INSERT INTO constraints VALUES('spans', 9, '{limited}', NULL, 4, 'worst')",
            f"INSERT INTO expressions SELECT hash, '{cost}', 2 * value FROM metrics WHERE name = 'cost.register_bits'",
            f"INSERT INTO expressions SELECT hash, '{limited}', 5 FROM metrics WHERE name = 'cost.register_bits'",
            "INSERT INTO expressions SELECT hash, 'of another study', 5 FROM metrics WHERE name = 'cost.register_bits'",
        )
        self.assertEqual(analysis.cost_metrics(study)[0], cost)
        np.testing.assert_array_equal(study.metrics[cost], 2 * np.array(study.metrics["cost.register_bits"]))
        self.assertIn(limited, analysis.error_metrics(study))
        self.assertTrue(study.metric(limited).high)
        self.assertNotIn("of another study", study.metrics)
        self.assertIn(cost, analysis.told_metrics(study))

    def test_a_point_of_the_certificate_alone_has_its_settings(self):
        row = "hash = (SELECT hash FROM certificate WHERE key = 'formats.span.h.word')"
        study = self.changed(
            f"DELETE FROM study_points WHERE {row}", f"UPDATE certificate SET settings = '{{\"x\": 7}}' WHERE {row}"
        )
        (alone,) = [point for point in study.points if point.number is None]
        self.assertEqual(alone.settings, {"x": 7})

    def test_combinations_stand_beside_their_certificates(self):
        self.assertNotIn("Combinations", page.search(self.study))
        found = self.study.recommended[0].hash
        study = self.changed(
            "UPDATE certificate SET combination = 'kind = a'",
            f"INSERT INTO combinations VALUES('spans', 1, 'kind = b', '', NULL, 1, 'done', 0, 'refused: <narrow>'),"
            f"('spans', 0, 'kind = a', '{found}', 91, 12, 'evaluations', 1, '')",
        )
        self.assertEqual([c.name for c in study.combinations], ["kind = a", "kind = b"])
        self.assertEqual(study.combinations[0].hash, found)
        self.assertTrue(math.isnan(study.combinations[1].cost))
        text = page.search(study)
        self.assertIn("<td class=\"long\">kind = a</td><td class=\"n\">91</td><td class=\"n\">12</td>", text)
        self.assertIn("refused: &lt;narrow&gt;", text)
        self.assertEqual(text.count("kind = a"), 1 + len(study.certificate))

    def test_the_base_has_the_values_that_the_database_gives(self):
        self.assertEqual(self.study.base_settings, {**BASE, "formats.edge.uv.word": BASE["formats.span.uv.word"]})
        study = self.changed("UPDATE axes SET base = NULL WHERE key = 'formats.span.h.word'")
        self.assertIsNone(study.base_settings["formats.span.h.word"])
        study = self.changed("UPDATE studies SET base_hash = 'unmeasured'")
        self.assertEqual(set(study.base_settings.values()), {None})

    def test_the_best_of_all_is_the_lower_edge(self):
        axis = analysis.read_axes(self.study)[0]
        column = self.study.metrics["span.u.p999"]
        curve = analysis.curve(axis, self.study.metric("span.u.p999"), column)
        self.assertFalse(curve.one_at_a_time)
        self.assertEqual([value for value, _, _ in curve.samples], [26, 28, 30, 32, 34, 36])
        for value, error, index in curve.samples:
            same = [column[i] for i, v in enumerate(axis.values) if v == value and not math.isnan(column[i])]
            self.assertEqual(error, min(same))
            self.assertEqual(error, column[index])
        self.assertEqual(curve.samples[curve.knee][0], 32)

    def test_one_at_a_time_keeps_all_else_as_in_the_base(self):
        axis = analysis.Axis(["k"], "k", [1, 2, 3, 3], True, [0, 1, 2])
        curve = analysis.curve(axis, ERROR, np.array([4.0, 2.0, 1.0, 0.5]))
        self.assertTrue(curve.one_at_a_time)
        self.assertEqual([error for _, error, _ in curve.samples], [4, 2, 1])  # the fourth point differs elsewhere too

    def test_names_as_values_have_no_knee(self):
        axis = analysis.Axis(["kind"], "kind", ["lut", "restoring", "lut_newton"], False, [])
        curve = analysis.curve(axis, ERROR, np.array([9.0, 1.0, 1.0]))
        self.assertEqual([value for value, _, _ in curve.samples], ["lut", "restoring", "lut_newton"])
        self.assertIsNone(curve.knee)

    def test_numbers_that_are_none_survive(self):
        self.assertTrue(all(math.isnan(v) for v in self.study.metrics["span.b.rms"]))
        self.assertIn(math.inf, self.study.metrics["picture.psnr_db"])
        self.assertEqual(
            [data.json_number(v) for v in (math.nan, math.inf, -math.inf, 1 / 3)], [None, "inf", "-inf", 0.33333]
        )

    def test_metrics_without_room_in_the_page_are_named(self):
        columns, left_out = data.told_columns(self.study)
        self.assertEqual((set(columns), left_out), (set(analysis.told_metrics(self.study)), []))
        columns, left_out = data.told_columns(self.study, room=2500)
        self.assertIn("cost.register_bits", columns)  # what the page opens with comes first
        self.assertGreater(len(left_out), 3)
        self.assertEqual({*columns, *left_out}, set(analysis.told_metrics(self.study)))

    def test_a_configuration_comes_back_from_its_difference(self):
        base, other = self.study.points[self.study.base].config, self.study.points[50].config
        lines = base.split("\n")
        delta = data.config_delta(lines, other)
        self.assertNotEqual(base, other)
        self.assertEqual("\n".join(delta.get(str(i), line) for i, line in enumerate(lines)), other)
        self.assertEqual(data.config_delta(lines, other + "\nmore"), other + "\nmore")

    def test_placed_areas_replace_synthesised_ones(self):
        found = self.study.index_of(self.study.recommended[0].hash)
        self.assertEqual(self.study.metrics["area.ice40.fmax_mhz"][found], 38.4)
        self.assertTrue(math.isnan(self.study.metrics["area.ice40.fmax_mhz"][self.study.base]))
        self.assertEqual(self.study.metrics["area.ice40.luts"][self.study.base], 8810)

    def test_areas_of_pixel_stages_are_metrics_of_their_own(self):
        base = self.study.points[self.study.base]
        with contextlib.closing(sqlite3.connect(self.database)) as connection:
            (columns,) = connection.execute("SELECT sql FROM sqlite_master WHERE name = 'areas'").fetchone()
        study = self.changed(
            columns.replace("areas", "pixel_areas", 1),
            f"INSERT INTO pixel_areas VALUES('{base.config_hash}', 'key', 'ecp5', 0, 'ok', '', 'Yosys 0.23', 7123, 7700, 22, "
            "110592, NULL, 40)",
        )
        self.assertEqual(study.metrics["area.ecp5.pixel_luts"][study.base], 7123)
        self.assertNotEqual(study.metrics["area.ecp5.luts"][study.base], 7123)
        self.assertNotIn("area.ecp5.pixel_fmax_mhz", study.metrics)
        self.assertIn("ecp5, pixel stages", page.areas(study))


if __name__ == "__main__":
    unittest.main()
