#!/usr/bin/env python3
"""Two threads against one: what a render gains, over what tracing the same rays alone gains.

    python3 bench/render/threads.py SCENE.xml:WxH [...] [--bench build/gradus-bench-render]

The thread count of an OpenCL device is fixed for a process, so each measurement is a process of its own; one and two
threads take turns. Target: the render gains at least 95 % of what the replay gains.
"""

import argparse
import json
import pathlib
import statistics
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import renders  # noqa: E402


def measure(arguments, scene, threads, folder):
    """Rays per second of the render and of the replay."""
    file = pathlib.Path(folder) / "floor.json"
    renders.run(arguments.bench, scene, "--parts", "floor", "--no-roulette-only", "--spp", arguments.spp,
                "--repeats", 1, "--nthreads", threads, "--json", file)
    record = json.loads(file.read_text())["floor"][0]
    return record["render_mrays_per_second"]["median"], record["replay_mrays_per_second"]["median"]


def main():
    parser = argparse.ArgumentParser(description="two threads against one")
    parser.add_argument("scenes", nargs="+", metavar="SCENE.xml:WxH")
    parser.add_argument("--bench", type=pathlib.Path, default=renders.ROOT / "build" / "gradus-bench-render")
    parser.add_argument("--spp", type=renders.at_least(1), default=32)
    parser.add_argument("--repeats", type=renders.at_least(1), default=5)
    parser.add_argument("--json", type=pathlib.Path, help="also write all figures to this file")
    arguments = parser.parse_args()
    results = []
    with tempfile.TemporaryDirectory() as folder:
        for scene in arguments.scenes:
            turns = []
            for _ in range(arguments.repeats):
                one = measure(arguments, scene, 1, folder)
                two = measure(arguments, scene, 2, folder)
                render, replay = two[0] / one[0], two[1] / one[1]
                turns.append({"render": render, "replay": replay, "ratio": render / replay})
            median = {key: statistics.median(turn[key] for turn in turns) for key in turns[0]}
            print(f"{scene}\n  two threads / one: render {median['render']:.2f}, replay {median['replay']:.2f}; "
                  f"render over replay {median['ratio']:.3f} (target 0.95)", flush=True)
            results.append({"scene": scene, "median": median, "turns": turns})
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=2) + "\n")


if __name__ == "__main__":
    main()
