"""Errors of the shifts of chains over passes, as figure 4 of Hua et al. 2017 has them, from gradus-bench-render."""

import plotting

# Estimate and what it is of: (colour, marker, line), text.
ESTIMATES = {
    "image": {"throughput": ((plotting.INK, "o", "-"), "throughput"),
              "reconstruction": ((plotting.ORANGE, "X", "-"), "reconstruction, L2")},
    "differences": {"throughput_differences": ((plotting.INK, "o", "-"), "differences of the throughput"),
                    "gradients": ((plotting.ORANGE, "X", "-"), "gradients")},
}


def caption(results):
    said = []
    for job in results["chains"]:
        last = job["points"][-1]
        said.append(f"{job['job'].split(',')[0]}, after {last['passes']} passes: error of the reconstruction "
                    f"{last['reconstruction'] / last['throughput']:.2f} of the throughput's, of the gradients "
                    f"{last['gradients'] / last['throughput_differences']:.2f} of its differences'; "
                    f"{job['failed_shifts']:.0%} of the shifts fail")
    return "; ".join(said) + "."


def draw(pyplot, results):
    """The figure: a row for each scene, images on the left and differences on the right."""
    jobs = results["chains"]
    figure, grid = pyplot.subplots(len(jobs), 2, figsize=(8, 3.2 * len(jobs)), squeeze=False)
    for row, job in zip(grid, jobs):
        for axes, (kind, estimates) in zip(row, ESTIMATES.items()):
            for name, ((colour, marker, line), text) in estimates.items():
                axes.plot([point["passes"] for point in job["points"]], [point[name] for point in job["points"]],
                          marker + line, color=colour, label=text)
            axes.set_xscale("log")
            axes.set_yscale("log")
            axes.set_xlabel("passes")
            axes.set_ylabel(f"L2 error of the {kind}, relative")
            axes.set_title(job["job"].split(",")[0], fontsize=9)
            plotting.grid(axes)
            axes.legend(fontsize=8)
    figure.tight_layout()
    return figure
