"""Two OpenCL implementations in turn, for the benches that weigh one against the other.

A program opens one device, so each measurement is a process of its own.
"""

import contextlib
import sys
import tempfile

import second_device

DEVICES = {"PoCL": "portable computing", "Intel": second_device.SELECTOR}  # by name: what --device takes


@contextlib.contextmanager
def two_devices():
    """A folder for files, and the environment in which programs see both. Where there is no second implementation, says
    how to get one and that the bench is skipped, and ends the program with 0."""
    with tempfile.TemporaryDirectory() as folder:
        environment = second_device.environment(folder)
        if environment is None:
            print(second_device.HOW_TO_GET, file=sys.stderr)
            print("skipped: no second OpenCL implementation")
            sys.exit(0)
        yield folder, environment


def take_turns(count, measure):
    """So many turns, each {name: measure(what --device takes)}."""
    return [{name: measure(selector) for name, selector in DEVICES.items()} for _ in range(count)]


def by_device(turns, figure):
    """{name: that figure of what was measured, a list over the turns}."""
    return {name: [figure(turn[name]) for turn in turns] for name in DEVICES}


def ratios(figures):
    """Intel's over PoCL's, turn by turn."""
    return [intel / pocl for pocl, intel in zip(figures["PoCL"], figures["Intel"])]
