"""Curves of error against time: medians over seeds, slopes, crossings, ratios. Pure functions of numbers.

A point is {"scene", "method", "budget", "seconds", "relmse", "trimmed", "reference_error", ...}; a curve is a list of
(seconds, error) sorted by time. Between its points a curve is a power law (a line in log-log), and it ends with them:
nothing is extrapolated.
"""

import math
import statistics

FLOORS = 4  # errors under so many times the reference's own say more of the reference than of the method


def spread(values):
    return {"median": statistics.median(values), "least": min(values), "largest": max(values)}


def curves(points, metric="relmse"):
    """By scene and method: a list over budgets of seconds and errors with their spread, by median time."""
    grouped = {}
    for point in points:
        by_budget = grouped.setdefault(point["scene"], {}).setdefault(point["method"], {})
        by_budget.setdefault(point["budget"], []).append(point)
    return {scene: {method: sorted((summary_of_budget(budget, same, metric) for budget, same in by_budget.items()),
                                   key=lambda entry: entry["seconds"]["median"])
                    for method, by_budget in methods.items()}
            for scene, methods in grouped.items()}


def summary_of_budget(budget, points, metric):
    return {"budget": budget, "spp": statistics.median(point["spp"] for point in points),
            "seconds": spread([point["seconds"] for point in points]),
            "error": spread([point[metric] for point in points])}


def line(curve):
    """(seconds, error) of the medians, sorted by time."""
    return sorted((entry["seconds"]["median"], entry["error"]["median"]) for entry in curve)


def slope(curve, floor=0.0):
    """Exponent of time in the error, by least squares in log-log; None with fewer than two points over the floor."""
    over = [(math.log(t), math.log(e)) for t, e in curve if e > FLOORS * floor]
    if len(over) < 2:
        return None
    x, y = statistics.fmean(t for t, _ in over), statistics.fmean(e for _, e in over)
    width = sum((t - x) ** 2 for t, _ in over)
    return sum((t - x) * (e - y) for t, e in over) / width if width > 0 else None


def error_at(curve, seconds):
    """The error at that time; None before the first point and after the last."""
    for (t0, e0), (t1, e1) in zip(curve, curve[1:]):
        if t0 <= seconds <= t1:
            share = 0.0 if t1 == t0 else math.log(seconds / t0) / math.log(t1 / t0)
            return math.exp((1 - share) * math.log(e0) + share * math.log(e1))
    return curve[0][1] if curve and curve[0][0] == seconds else None


def time_to_reach(curve, error):
    """The time from which on the curve stays at or under the error; None where it ends above it. A curve that never
    was above it reached it before its first point: that point's time, an upper bound."""
    if not curve or curve[-1][1] > error:
        return None
    for (t0, e0), (t1, e1) in reversed(list(zip(curve, curve[1:]))):
        if e0 > error:
            share = math.log(error / e0) / math.log(e1 / e0)
            return math.exp((1 - share) * math.log(t0) + share * math.log(t1))
    return curve[0][0]


def time_ratio(curve, other, floor=0.0):
    """How many times less time `curve` takes than `other` to reach the least error that both reach: {"error", "ratio",
    "at_least"}, the last where `curve` was under it from its first point. None where a curve is empty, and where
    `other` was under it from its first point: nobody knows since when."""
    if not curve or not other:
        return None
    error = max(min(e for _, e in curve), min(e for _, e in other), FLOORS * floor)
    mine, others = time_to_reach(curve, error), time_to_reach(other, error)
    if mine is None or others is None or other[0][1] < error:
        return None
    return {"error": error, "ratio": others / mine, "at_least": curve[0][1] < error}


def equal_time_ratio(curve, other):
    """How many times less error `curve` has than `other` at the longest time of both: {"seconds", "ratio"}. None where
    their times do not overlap."""
    if not curve or not other:
        return None
    seconds = min(curve[-1][0], other[-1][0])
    mine, others = error_at(curve, seconds), error_at(other, seconds)
    return {"seconds": seconds, "ratio": others / mine} if mine and others else None


def crossing(curve, other):
    """The last time from which on `curve` has less error than `other`, in the span of both. {"seconds", "error"}; None
    where it has not less at the end, or has less throughout."""
    if not curve or not other:
        return None
    first, last = max(curve[0][0], other[0][0]), min(curve[-1][0], other[-1][0])
    if first >= last:
        return None
    times = sorted({first, last, *(t for t, _ in curve + other if first < t < last)})
    ahead = [math.log(error_at(curve, t) / error_at(other, t)) for t in times]
    if ahead[-1] >= 0:
        return None
    for i in reversed(range(len(times) - 1)):
        if ahead[i] >= 0:
            share = ahead[i] / (ahead[i] - ahead[i + 1])
            seconds = math.exp((1 - share) * math.log(times[i]) + share * math.log(times[i + 1]))
            return {"seconds": seconds, "error": error_at(curve, seconds)}
    return None


def relation(curve, other):
    """In words that a table can hold: where `curve` has less error than `other`."""
    if not curve or not other or max(curve[0][0], other[0][0]) >= min(curve[-1][0], other[-1][0]):
        return "no common times"
    found = crossing(curve, other)
    if found:
        return f"less from {found['seconds']:.2g} s on"
    last = min(curve[-1][0], other[-1][0])
    if error_at(curve, last) < error_at(other, last):
        return f"less at all times measured, to {last:.2g} s"
    return f"more at {last:.2g} s, the longest of both"


def summaries(points, metric="relmse"):
    """For each scene and method: slope, time and error against pt, and where it has less error than pt denoised."""
    floors = {point["scene"]: point["reference_error"] for point in points}
    result = []
    for scene, methods in curves(points, metric).items():
        lines = {method: line(curve) for method, curve in methods.items()}
        for method, own in lines.items():
            entry = {"scene": scene, "method": method, "slope": slope(own, floors[scene])}
            if method != "pt" and "pt" in lines:
                entry["time"] = time_ratio(own, lines["pt"], floors[scene])
                entry["equal_time"] = equal_time_ratio(own, lines["pt"])
            if method != "denoised" and "denoised" in lines:
                entry["against_denoised"] = relation(own, lines["denoised"])
                entry["crosses_denoised"] = crossing(own, lines["denoised"])
            result.append(entry)
    return result
