"""``python -m hsad.ray pairs.parquet -o out/``: many pairs on a cluster."""

import argparse
import sys
import time
from typing import Any

import hsad

from . import Summary, run


def main(arguments: list[str] | None = None) -> int:
    """Runs the command; the exit code is 1 if nothing could be done, 3 if pairs have failed, and 0 otherwise."""
    parser = _parser()
    given = vars(parser.parse_args(arguments))
    address = given.pop("address")
    options = {option["name"]: given.pop(option["name"]) for option in hsad.options()}
    options = {name: value for name, value in options.items() if value is not None}
    try:
        import ray
        import ray.data
        import ray.exceptions
    except ImportError as error:
        print(f"hsad.ray: {error}: pip install 'hsad[ray]'", file=sys.stderr)
        return 1
    try:
        ray.init(address=address, log_to_driver=True)
        start = time.monotonic()
        summary = run(**given, told=lambda _: None, **options)
    except (hsad.Error, OSError, ray.exceptions.RayError) as error:
        print(f"hsad.ray: {error}", file=sys.stderr)
        return 1
    print(_told(summary, time.monotonic() - start))
    return 3 if summary.failed else 0


def _told(summary: Summary, seconds: float) -> str:
    """The end of a run in a line."""
    worked_on = summary.done + summary.failed
    return (
        f"{summary.pairs} pairs: {summary.done} done ({summary.not_trusted} of them not to be trusted), {summary.failed} failed, "
        f"{summary.earlier} by an earlier run; {seconds:.0f} s, {worked_on / max(seconds, 1e-9):.2f} pairs per second"
    )


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        "python -m hsad.ray", description="Match the pairs of a Parquet file on a cluster. The same command goes on with a run that ended."
    )
    parser.add_argument("pairs", help="a Parquet file, or a folder of them, with the columns left and right, maybe name, calib, focal, baseline, doffs")
    parser.add_argument("-o", "--output", dest="folder", required=True, metavar="FOLDER", help="folder or URI for the Parquet files of the maps")
    parser.add_argument("--address", help="Ray's cluster, such as auto; a new one on this machine by default")
    parser.add_argument("--device", help="device of all workers; by default the GPU that Ray assigns to each, or the best device")
    parser.add_argument("--workers", type=int, metavar="N", help="number of workers; as many as there is room for by default")
    parser.add_argument("--cpus", type=float, default=1, metavar="N", help="CPUs per worker (default: 1)")
    parser.add_argument("--gpus", type=float, metavar="N", help="GPUs per worker, also parts of one (default: 1 where there are any)")
    parser.add_argument("--rows", type=int, default=16, metavar="N", help="pairs per file (default: 16)")
    parser.add_argument("--jobs", type=int, default=2, metavar="N", help="pairs at work at once per worker (default: 2)")
    matching = parser.add_argument_group("matching, as for hsad match")
    for option in hsad.options():
        details: dict[str, Any] = {"help": option["help"].replace("%", "%%"), "dest": option["name"]}
        if option["kind"] == "flag":
            details |= {"action": "store_true", "default": None}
        elif option["kind"] == "choice":
            details |= {"choices": option["choices"]}
        else:
            details |= {"type": int if option["kind"] == "whole" else float, "metavar": option["unit"] or "N"}
        matching.add_argument(f"--{option['name'].replace('_', '-')}", **details)
    return parser


if __name__ == "__main__":
    sys.exit(main())
