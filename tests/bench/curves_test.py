#!/usr/bin/env python3
"""Slopes, crossings and ratios of curves whose answers are known in closed form."""

import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "bench" / "render"))
import curves  # noqa: E402
import ratios  # noqa: E402

TIMES = [0.5, 1, 2, 4, 8]


def power_law(factor, exponent, times=TIMES):
    return [(t, factor * t**exponent) for t in times]


def points(method, curve, scatter=(1.0,), floor=0.0):
    """A point for each seed, its error scattered by a factor."""
    return [{"scene": "box", "method": method, "budget": f"{number}", "spp": 4**number, "seconds": t,
             "relmse": e * factor, "trimmed": e * factor / 2, "reference_error": floor}
            for number, (t, e) in enumerate(curve) for factor in scatter]


class Slope(unittest.TestCase):
    def test_of_a_power_law_is_its_exponent(self):
        self.assertAlmostEqual(curves.slope(power_law(0.3, -1)), -1)
        self.assertAlmostEqual(curves.slope(power_law(7, -2 / 3)), -2 / 3)

    def test_leaves_out_what_is_near_the_floor(self):
        bent = [(t, max(e, 0.2)) for t, e in power_law(1, -1)]  # flat from 5 s on
        self.assertGreater(curves.slope(bent), -0.95)
        self.assertAlmostEqual(curves.slope(bent, floor=0.06), -1)

    def test_needs_two_points_over_the_floor(self):
        self.assertIsNone(curves.slope(power_law(1, -1, [1])))
        self.assertIsNone(curves.slope(power_law(1, -1), floor=1))
        self.assertIsNone(curves.slope([(1, 0.5), (1, 0.4)]))


class Interpolation(unittest.TestCase):
    def test_is_a_power_law_between_points(self):
        self.assertAlmostEqual(curves.error_at([(1, 1), (4, 0.25)], 2), 0.5)
        self.assertAlmostEqual(curves.time_to_reach([(1, 1), (4, 0.25)], 0.5), 2)

    def test_ends_with_the_points(self):
        curve = [(1, 1), (4, 0.25)]
        self.assertIsNone(curves.error_at(curve, 0.9))
        self.assertIsNone(curves.error_at(curve, 4.1))
        self.assertIsNone(curves.time_to_reach(curve, 0.2))
        self.assertEqual(curves.time_to_reach(curve, 2), 1)
        self.assertIsNone(curves.time_to_reach([], 1))

    def test_a_curve_that_rises_again_has_not_arrived(self):
        curve = [(1, 1), (2, 0.1), (4, 1), (8, 0.25)]
        self.assertAlmostEqual(curves.time_to_reach(curve, 0.5), math.sqrt(4 * 8))


class Ratios(unittest.TestCase):
    def test_of_time_for_parallel_curves_is_that_of_error(self):
        found = curves.time_ratio(power_law(0.25, -1), power_law(1, -1))
        self.assertAlmostEqual(found["ratio"], 4)
        self.assertAlmostEqual(found["error"], 1 / 8)
        self.assertFalse(found["at_least"])
        slower = curves.time_ratio(power_law(1, -1), power_law(0.25, -1))
        self.assertAlmostEqual(slower["ratio"], 1 / 4)

    def test_of_time_is_a_bound_where_the_first_point_is_better_than_the_others_last(self):
        found = curves.time_ratio(power_law(0.001, -1), power_law(1, -1))
        self.assertTrue(found["at_least"])
        self.assertAlmostEqual(found["ratio"], 8 / 0.5)

    def test_of_time_is_none_where_the_other_was_better_from_the_first_point_on(self):
        self.assertIsNone(curves.time_ratio([(1, 0.01), (2, 0.005)], [(4, 0.01), (8, 0.005)], floor=1))

    def test_of_time_stays_over_the_floor(self):
        self.assertAlmostEqual(curves.time_ratio(power_law(0.25, -1), power_law(1, -1), 0.05)["error"], 0.2)

    def test_of_error_at_the_longest_common_time(self):
        found = curves.equal_time_ratio(power_law(0.25, -1), power_law(1, -1, [1, 4]))
        self.assertAlmostEqual(found["ratio"], 4)
        self.assertEqual(found["seconds"], 4)
        self.assertIsNone(curves.equal_time_ratio([(1, 1), (2, 1)], [(3, 1), (4, 1)]))


class Crossing(unittest.TestCase):
    def test_of_two_power_laws(self):
        # 1 / t and 0.5 / sqrt(t) meet at t = 4.
        found = curves.crossing(power_law(1, -1), power_law(0.5, -0.5))
        self.assertAlmostEqual(found["seconds"], 4)
        self.assertAlmostEqual(found["error"], 0.25)
        self.assertIsNone(curves.crossing(power_law(0.5, -0.5), power_law(1, -1)))

    def test_between_unlike_times(self):
        found = curves.crossing(power_law(1, -1, [0.7, 3, 11]), power_law(0.5, -0.5, [0.2, 5, 9]))
        self.assertAlmostEqual(found["seconds"], 4)

    def test_the_last_one_counts(self):
        found = curves.crossing([(1, 2), (2, 0.5), (4, 2), (8, 0.5)], [(1, 1), (8, 1)])
        self.assertAlmostEqual(found["seconds"], math.sqrt(4 * 8))

    def test_in_words(self):
        steep, flat = power_law(1, -1), power_law(0.5, -0.5)
        self.assertEqual(curves.relation(steep, flat), "less from 4 s on")
        self.assertEqual(curves.relation(flat, steep), "more at 8 s, the longest of both")
        self.assertEqual(curves.relation(power_law(0.1, -1), flat), "less at all times measured, to 8 s")
        self.assertEqual(curves.relation([(1, 1)], flat), "no common times")


class Summaries(unittest.TestCase):
    def test_of_points_take_medians_over_seeds(self):
        measured = points("pt", power_law(1, -1), (0.5, 1, 9)) + points("gpt", power_law(0.1, -1), (0.2, 1, 3))
        curve = curves.curves(measured)["box"]["pt"]
        self.assertEqual([entry["seconds"]["median"] for entry in curve], TIMES)
        self.assertAlmostEqual(curve[0]["error"]["median"], 2)
        self.assertAlmostEqual(curve[0]["error"]["least"], 1)
        self.assertAlmostEqual(curve[0]["error"]["largest"], 18)
        found = {entry["method"]: entry for entry in curves.summaries(measured)}
        self.assertAlmostEqual(found["gpt"]["time"]["ratio"], 10)
        self.assertAlmostEqual(found["gpt"]["equal_time"]["ratio"], 10)
        self.assertNotIn("time", found["pt"])
        self.assertAlmostEqual(curves.curves(measured, "trimmed")["box"]["pt"][0]["error"]["median"], 1)

    def test_against_denoised(self):
        measured = points("gpt", power_law(1, -1)) + points("denoised", power_law(0.5, -0.5))
        found = {entry["method"]: entry for entry in curves.summaries(measured)}
        self.assertAlmostEqual(found["gpt"]["crosses_denoised"]["seconds"], 4)
        self.assertNotIn("against_denoised", found["denoised"])

    def test_ratios_leave_out_the_references_own_error(self):
        truth = {"pt": power_law(1, -1), "gpt": power_law(0.1, -1)}
        measured = [point for method, curve in truth.items()
                    for point in points(method, [(t, e + 0.05) for t, e in curve], floor=0.05)]
        methods = curves.curves(ratios.without_reference_error(measured), "relmse")["box"]
        for found in ratios.ratios(methods, "pt", "time").values():
            self.assertAlmostEqual(found["gpt"], 0.1)
        self.assertEqual(ratios.without_reference_error(points("gpt", [(1, 0.04)], floor=0.05)), [])

    def test_ratios_keep_seeds_with_less_error_than_the_reference(self):
        seeds = points("gpt", [(1, 1.0)], scatter=(0.9, 0.95, 1.05, 1.1, 1.2), floor=1.0)
        left = ratios.without_reference_error(seeds)
        self.assertEqual(len(left), 5)
        self.assertAlmostEqual(curves.curves(left, "relmse")["box"]["gpt"][0]["error"]["median"], 0.05)


class TablesOfRatios(unittest.TestCase):
    def of(self, *options):
        """Two seconds leave pt as many samples as one, and more light."""
        measured = [{"scene": "box", "method": method, "budget": f"{seconds} seconds", "spp": spp, "seconds": seconds,
                     "relmse": error, "trimmed": error, "reference_error": 0.0}
                    for method, spp, errors in (("pt", 8, (2.0, 1.0)), ("gpt:guided:denoiser", 4, (0.5, 0.125)))
                    for seconds, error in zip((1, 2), errors)]
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "convergence.json"
            file.write_text(json.dumps({"points": measured}))
            return subprocess.run([sys.executable, ratios.__file__, "--json", file, *options], capture_output=True,
                                  text=True)

    def test_have_a_row_for_each_budget_and_whole_names(self):
        found = self.of("--over", "denoised", "pt")
        self.assertEqual(found.returncode, 0, found.stderr)
        head, title, *rows = found.stdout.splitlines()
        self.assertIn("over that of pt", head)
        self.assertEqual(title.split(), ["scene", "budget", "gpt:guided:denoiser"])
        self.assertEqual([row.split() for row in rows[:2]], [["box", "1", "seconds", "0.25"],
                                                             ["box", "2", "seconds", "0.12"]])
        self.assertTrue(all(len(row) == len(title) for row in rows))

    def test_over_what_was_not_measured_are_an_error(self):
        found = self.of("--over", "gpt:g")
        self.assertEqual(found.returncode, 2)
        self.assertIn("which has pt, gpt:guided:denoiser", found.stderr)


if __name__ == "__main__":
    unittest.main()
