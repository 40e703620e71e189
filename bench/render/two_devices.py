"""Two OpenCL implementations in turn, for the benches that weigh one against the other.

A program opens one device, so each measurement is a process of its own.
"""

import contextlib
import sys
import tempfile

import second_device

FIRST = "PoCL"


@contextlib.contextmanager
def two_devices(gradus):
    """A folder for files, the environment in which programs see both, and {name: what --device takes}, PoCL first.
    Where there is no second implementation, says how to get one and that the bench is skipped, and ends the program
    with 0."""
    with tempfile.TemporaryDirectory() as folder:
        environment = second_device.environment(folder)
        second = environment and second_device.selector(gradus, environment)
        if not second:
            print(second_device.HOW_TO_GET, file=sys.stderr)
            print("skipped: no second OpenCL implementation")
            sys.exit(0)
        yield folder, environment, {FIRST: "portable computing", second: second}


def take_turns(devices, count, measure):
    """So many turns, each {name: measure(what --device takes)}."""
    return [{name: measure(selector) for name, selector in devices.items()} for _ in range(count)]


def by_device(turns, figure):
    """{name: that figure of what was measured, a list over the turns}."""
    return {name: [figure(turn[name]) for turn in turns] for name in turns[0]}


def ratios(figures):
    """The second's over PoCL's, turn by turn."""
    pocl, second = figures.values()
    return [of_second / of_pocl for of_pocl, of_second in zip(pocl, second)]
