"""Where the time of a sample goes, scene by scene and method by method, from the JSON of bench/render/profile.py."""

import plotting

# What a stage's name begins with: the part that it is counted to. The first that fits counts.
PARTS = [
    ("primary", "camera"), ("camera", "camera"),
    ("shade", "shading"), ("material", "shading"),
    ("light paths, ", "light paths"),
    ("photon_shift", "shifts"), ("photon_reconnect", "shifts"), ("photon_arrive", "shifts"), ("walk", "walks"),
    ("photon", "photons"), ("pair", "photons"), ("gather", "photons"), ("bias", "photons"), ("travel", "photons"), ("sort", "photons"),
    ("shift", "shifts"), ("evaluate", "shifts"), ("weigh", "shifts"), ("advance", "shifts"), ("join", "shifts"),
    ("gradient_begin", "shifts"), ("gradient_connect", "shifts"), ("gradient escape", "shifts"),
    ("gradient emission", "shifts"),
    ("frame", "film"), ("gradient_frame", "film"), ("accumulate", "film"), ("gradient_accumulate", "film"),
    ("gradient_combine", "film"), ("gradient_gather", "film"), ("gradient_carry", "film"),
]
COLOURS = {
    "Embree alone (floor)": plotting.GREY,
    "tracing beside Embree": plotting.SKY,
    "camera": plotting.YELLOW,
    "shading": plotting.BLUE,
    "light paths": plotting.GREEN,
    "photons": plotting.ORANGE,
    "walks": plotting.BROWN,
    "shifts": plotting.VERMILLION,
    "film": plotting.PURPLE,
    "reconstruction": plotting.INK,
    "other": plotting.GRID,
}
HATCHES = {"Embree alone (floor)": "////", "shifts": "....", "film": "xxxx"}


def part_of(stage):
    return next((part for prefix, part in PARTS if stage.startswith(prefix)), "other")


def parts_of(profile):
    """Seconds by part, in the order of COLOURS. Time outside of all stages counts as other."""
    parts = dict.fromkeys(COLOURS, 0.0)
    for stage in profile["stages"]:
        if stage["name"] == "trace":
            floor = min(profile["embree_seconds"] or 0.0, stage["seconds"])
            parts["Embree alone (floor)"] += floor
            parts["tracing beside Embree"] += stage["seconds"] - floor
        else:
            parts[part_of(stage["name"])] += stage["seconds"]
    parts["other"] += max(0.0, profile["render_seconds"] - sum(stage["seconds"] for stage in profile["stages"]))
    parts["reconstruction"] = profile["reconstruction_seconds"]
    return parts


def bars(profiles):
    """[(scene, method, seconds by part over pt's time by sample)]; over the first method's where pt is missing."""
    result = []
    for scene in dict.fromkeys(profile["scene"] for profile in profiles):
        own = [profile for profile in profiles if profile["scene"] == scene]
        unit = next((profile for profile in own if profile["method"] == "pt"), own[0])
        unit_seconds = unit["render_seconds"] / unit["spp"]
        for profile in own:
            parts = {part: seconds / profile["spp"] / unit_seconds for part, seconds in parts_of(profile).items()}
            result.append((scene, profile["method"], parts))
    return result


def headline(found):
    """What the chart says: the cost of a sample, the reconstruction left out as it is done once."""
    costs = [sum(parts.values()) - parts["reconstruction"] for _, method, parts in found if method == "gpt"]
    if not costs:
        return "Where the time of a sample goes"
    least, largest = f"{min(costs):.2g}", f"{max(costs):.2g}"
    return (f"A sample of gpt costs {least if least == largest else f'{least} to {largest}'} samples of pt, "
            "the reconstruction left out")


def draw(pyplot, results):
    found = bars(results["profiles"])
    used = [part for part in COLOURS if any(parts[part] > 0.002 for _, _, parts in found)]
    figure, axes = pyplot.subplots(figsize=(9.5, 0.34 * len(found) + 2.2))
    places, labels, place, scene_before = [], [], 0.0, None
    for scene, method, parts in found:
        place += 0.35 if scene_before not in (None, scene) else 0
        left = 0.0
        for part in used:
            axes.barh(place, parts[part], left=left, height=0.8, color=COLOURS[part], edgecolor=plotting.PAPER,
                      linewidth=0.5, hatch=HATCHES.get(part))
            left += parts[part]
        axes.text(left, place, f"  {left:.2f}", va="center", fontsize=7.5)
        places.append(place)
        labels.append(f"{scene}  {method}")
        place, scene_before = place + 1, scene
    axes.set_yticks(places, labels, fontsize=8)
    axes.invert_yaxis()
    axes.margins(x=0.07)
    axes.set_xlabel("wall time of a sample (path tracing of the same scene = 1)", fontsize=8.5)
    axes.tick_params(axis="x", labelsize=8)
    axes.grid(True, axis="x", color=plotting.GRID, linewidth=0.6)
    axes.set_axisbelow(True)
    handles = [pyplot.Rectangle((0, 0), 1, 1, facecolor=COLOURS[part], edgecolor=plotting.PAPER, linewidth=0.5,
                                hatch=HATCHES.get(part)) for part in used]
    samples = ", ".join(sorted({f"{profile['spp']:g}" for profile in results["profiles"]}))
    plotting.frame(figure, headline(found), handles, used, f"{plotting.machine_line(results)}\n{samples} samples a "
                   "pixel; floor: rays x time of a ray when Embree alone traces path tracing's rays of the scene again",
                   5)
    return figure
