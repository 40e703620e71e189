"""Seconds of a pass of the photon methods over its photons and its gather points, from bench/render/photons.py."""

import plotting

TITLES = {"photons": "photons a pass", "gather_points": "gather points a pass"}


def draw(pyplot, results):
    """The figure: measured passes as points, the lines that were fitted."""
    methods = results["scaling"]["methods"]
    figure, grid = pyplot.subplots(1, len(TITLES), figsize=(8, 3.4))
    for axes, (name, title) in zip(grid, TITLES.items()):
        for method, (colour, marker, _) in plotting.method_styles(methods).items():
            own = methods[method]
            numbers = [point[name] for point in own[name]]
            fit = own[f"{name}_fit"]
            axes.plot(numbers, [point["seconds"] for point in own[name]], marker, color=colour, label=method)
            axes.plot(numbers, [fit["start"] + fit["slope"] * number for number in numbers], "-", color=colour)
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_xlabel(title)
        axes.set_ylabel("seconds a pass")
        axes.legend()
    figure.tight_layout()
    return figure
