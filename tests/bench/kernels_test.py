#!/usr/bin/env python3
"""The kernel benchmark on tiny queues: the fields of its JSON, bytes against those counted by hand, errors against
bounds that are derived here.

    python3 tests/bench/kernels_test.py build/gradus-bench-kernels
"""

import json
import pathlib
import subprocess
import sys
import tempfile

REAL = 4
# Columns that these kernels read and write, counted in kernels/stages.
BYTES = {
    # shadow: open, value; path: slot; radiance: read and written
    "connect": REAL * (1 + 3 + 1 + 2 * 3),
    # ray: primitive; bin: written
    "classify": REAL * 2,
    # index; ray: origin, direction and primitive are read; path: slot, depth, keys and throughput are read; path: these
    # and pdf, ray: all, shadow: all are written
    "shade roughconductor_ggx": REAL * (1 + 7 + 7 + 8 + 7 + 10),
    # radiance: read; film: six sums, read and written. That nothing is added to a seventh column is not seen.
    "accumulate": REAL * (3 + 2 * 6),
}
# Of photons: position; key and line: written. Index and line; line: written.
PHOTON_BYTES = {"photon_cells": REAL * (3 + 2), "photon_lines": REAL * 3}
# Of the solver's `advance`: direction, image, u, residual; u, residual.
SOLVER_ADVANCE = REAL * 6

# Largest relative errors of the float build, inside of the domain; the relaxed build, whose operations may be off by
# some units in the last place in place of half a one, gets ten times as much. Float rounds to 6e-8.
BOUNDS = {
    # A half vector longer than 0.1 is known to 1e-6, and the logarithm of D changes by up to 10 / alpha a radian, with
    # alpha of at least 0.01 by 1000: 1e-3 if all that came together. tests/kernels/precision_test.cpp holds the host's
    # float build to the same.
    ("roughconductor_ggx", "eval"): 3e-4,
    ("roughconductor_ggx", "pdf"): 3e-4,
    # The square of eta times the transmitted cosine is at least 0.01 and known to two roundings: 1.2e-5, half of it
    # for the root.
    ("fresnel dielectric", "transmitted cosine"): 1.2e-5,
    # Its derivative with respect to that root, relative, is below 10 there.
    ("fresnel dielectric", "reflectance"): 2e-5,
    # Some ten roundings.
    ("fresnel conductor", "reflectance"): 1.2e-6,
    ("microfacet ggx", "density"): 1.5e-6,
    ("microfacet ggx", "projected area"): 1.2e-6,
    # An exponent of up to 9 with four roundings of it.
    ("microfacet beckmann", "density"): 5e-6,
    # Sine and cosine have an error of 1e-7, a root two roundings.
    ("warp", "cosine hemisphere"): 4e-7,
    ("warp", "uniform sphere"): 4e-7,
    ("warp", "uniform triangle"): 2e-7,
    # Two cosines of at least 0.01, known to 1e-7 of the distance.
    ("reconnection", "Jacobian"): 1e-4,
    # As tests/kernels/shift_precision_test.cpp, which says why.
    ("half-vector copy", "Jacobian"): 1e-4,
    ("half-vector copy", "direction"): 1e-4,
    ("specular copy", "direction"): 1e-5,
    # Some thirty roundings of terms of order 1, which cancel down to the floor of 0.01.
    ("chain vertex", "spread"): 2e-4,
    # The half vector's cosine is at least 0.3 there, and some ten roundings.
    ("chain vertex", "turn"): 4e-6,
    ("chain vertex", "direction"): 1e-6,
}


def expect(condition, message):
    if not condition:
        sys.exit(f"FAILED: {message}")


def check_throughput(rows, has_double):
    names = {row["kernel"] for row in rows}
    for kernel in ("camera", "classify", "emission", "connect", "accumulate", "shade roughconductor_ggx", "shift",
                   "weigh", "join roughconductor_ggx", "direction", "advance", "descend", "ascend", "residual",
                   "prolong"):
        expect(kernel in names, f"kernel {kernel} was not measured")
    # A stage and a kernel of the solver have that name.
    advance = {row["file"].split("/")[1]: row["bytes_per_item"] for row in rows if row["kernel"] == "advance"}
    expect(set(advance) == {"stages", "solver"}, "one of two kernels `advance` was not measured")
    expect(advance["solver"] == SOLVER_ADVANCE, f"{advance['solver']} bytes of the solver's `advance`")
    for row in rows:
        name = row["kernel"]
        builds = {"float", "relaxed"} | ({"double"} if has_double else set())
        expect(set(row["items_per_second"]) == builds, f"{name}: builds {sorted(row['items_per_second'])}")
        expect(row["items"] > 1 and all(rate > 0 for rate in row["items_per_second"].values()), f"{name}: no rate")
        expect(all(s["least"] <= s["median"] <= s["largest"] for s in row["seconds"].values()), f"{name}: spread")
        if row["bytes_per_item"] is not None:
            expect(row["bytes_per_item"] > 0 and row["bandwidth_over_triad"] > 0, f"{name}: bytes")
        else:
            expect(name.startswith("partition"), f"{name} has no bytes")
        if name in BYTES:
            expect(row["bytes_per_item"] == BYTES[name], f"{name}: {row['bytes_per_item']} bytes, not {BYTES[name]}")
    whole = [row["items"] for row in rows if row["kernel"] in ("camera", "classify")]
    expect(all(items == 256 for items in whole), f"queues of {whole} in place of 256")


def check_photons(rows):
    """With a kind at which nothing is gathered before one that gathers: of the latter, kernels of photons."""
    found = {row["kernel"]: row["bytes_per_item"] for row in rows}
    expect("shade conductor" in found, "the smooth kind was not measured")
    for kernel, size in PHOTON_BYTES.items():
        expect(found.get(kernel) == size, f"{kernel}: {found.get(kernel)} bytes, not {size}")
    # An item looks at any number of photons, or takes a chunk of rows.
    for kernel in ("photon_pairs list", "photons count"):
        expect(kernel in found and found[kernel] is None, f"{kernel}: {found.get(kernel)} bytes are not known")
    expect(all(size is None or size > 0 for size in found.values()), "kernels of no bytes")


def check_accuracy(rows):
    seen = set()
    for row in rows:
        what = f"{row['function']}, {row['result']}, {row['domain']}, {row['build']}"
        expect(row["non_finite"] == 0, f"{what}: {row['non_finite']} results are not finite")
        expect(0 <= row["relative_99.9"] <= row["relative_largest"], f"{what}: quantiles")
        expect(0 <= row["ulp_99.9"] <= row["ulp_largest"], f"{what}: quantiles")
        key = (row["function"], row["result"])
        if row["is_edge"] or key not in BOUNDS:
            continue
        seen.add((*key, row["build"]))
        expect(row["cases"] > 300, f"{what}: {row['cases']} cases")
        bound = BOUNDS[key] * (10 if row["build"] == "relaxed" else 1)
        expect(row["relative_largest"] <= bound, f"{what}: {row['relative_largest']:.1e} > {bound:.1e}")
    for key in BOUNDS:
        for build in ("float", "relaxed"):
            expect((*key, build) in seen, f"{key}, {build} was not measured")
    # A comparison of a build with itself would pass all of the above.
    expect(any(row["relative_largest"] > 1e-8 for row in rows), "there are no errors at all")


def main():
    program = pathlib.Path(sys.argv[1])
    if not program.exists():
        print(f"skipped: {program} was not built")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "kernels.json"
        subprocess.run([program, "--parts", "throughput,accuracy", "--kinds", "roughconductor_ggx", "--methods",
                        "pt,gpt", "--queue-bits", "8", "--cases", "4000", "--repeats", "1", "--no-vectoriser", "--json",
                        file], check=True)
        results = json.loads(file.read_text())
        # --json is looked at first.
        wrong = subprocess.run([program, "--json", pathlib.Path(folder) / "none" / "kernels.json"], capture_output=True,
                               text=True, timeout=60)
        expect(wrong.returncode != 0 and "cannot write" in wrong.stderr, f"a file without a folder: {wrong.stderr}")
        subprocess.run([program, "--parts", "throughput", "--kinds", "conductor,diffuse", "--methods", "pt,sppm",
                        "--queue-bits", "6", "--repeats", "1", "--no-vectoriser", "--json", file], check=True)
        check_photons(json.loads(file.read_text())["throughput"])
    for key in ("device", "platform", "driver", "repeats"):
        expect(key in results, f"no {key}")
    check_throughput(results["throughput"], "accuracy" in results)
    if "accuracy" not in results:
        print("no double precision on this device: the errors are not checked")
        return
    check_accuracy(results["accuracy"]["errors"])
    expect(all(rate["items_per_second"]["double"] > 0 for rate in results["accuracy"]["rates"]), "no rates")


if __name__ == "__main__":
    main()
