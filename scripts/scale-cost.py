#!/usr/bin/env python3
"""What many pairs cost: machine hours, days and money, from a measured time per pair and a price.

    scripts/scale-cost.py --pairs 1000000 --machines 20 'c7i.4xlarge,3.92,16,0.714' 'one GPU,0.1,1,1.20'

Each machine is NAME,SECONDS,WORKERS,PRICE: seconds per pair of one worker, workers per machine, and the price of a machine per hour. The
seconds are measured on the machine: of CPUs, core-seconds per pair and cores; of GPUs, the wall-clock time per pair of `hsad batch` on a
hundred of your own pairs, with all its reading and writing, and the number of GPUs.
"""

import argparse


def machine(text: str) -> tuple[str, float, float, float]:
    """The parts of NAME,SECONDS,WORKERS,PRICE."""
    name, *numbers = text.rsplit(",", 3)
    seconds, workers, price = (float(number) for number in numbers)
    if seconds <= 0 or workers <= 0 or price < 0:
        raise ValueError(text)
    return name, seconds, workers, price


def cost(pairs: float, seconds: float, workers: float, price: float, overhead: float) -> tuple[float, float]:
    """Machine hours and money."""
    hours = pairs * seconds * (1 + overhead) / workers / 3600
    return hours, hours * price


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("machine", nargs="+", type=machine, metavar="NAME,SECONDS,WORKERS,PRICE")
    parser.add_argument("--pairs", type=float, default=1e6)
    parser.add_argument("--machines", type=float, default=1, help="machines at work at once (default: 1)")
    parser.add_argument("--overhead", type=float, default=0.1, help="share of the time in which workers do not match (default: 0.1)")
    given = parser.parse_args()
    print(f"{given.pairs:,.0f} pairs on {given.machines:g} machines, {given.overhead:.0%} overhead")
    print(f"{'machine':24} {'s/pair':>8} {'workers':>8} {'pairs/h':>12} {'machine h':>12} {'days':>8} {'cost':>10}")
    for name, seconds, workers, price in given.machine:
        hours, money = cost(given.pairs, seconds, workers, price, given.overhead)
        days = hours / given.machines / 24
        print(f"{name:24} {seconds:8.3g} {workers:8g} {given.pairs / hours:12,.0f} {hours:12,.0f} {days:8.2f} {money:10,.0f}")


if __name__ == "__main__":
    main()
