"""Many pairs with Daft: python daft_pairs.py pairs.parquet out

pairs.parquet has the columns left and right, paths or URIs; out becomes a folder of Parquet files with maps and reports.
"""

import sys

import daft

import hsad.ray

ANSWER = daft.DataType.struct({name: getattr(daft.DataType, kind)() for name, kind in hsad.ray.COLUMNS.items()})


@daft.cls
class Match:
    """A device per process."""

    def __init__(self) -> None:
        self.match = hsad.ray.Disparity()

    @daft.method.batch(return_dtype=ANSWER, batch_size=16)
    def pairs(self, left: daft.Series, right: daft.Series):
        found = self.match({"left": left.to_pylist(), "right": right.to_pylist()})
        return [dict(zip(hsad.ray.COLUMNS, row)) for row in zip(*(found[name].tolist() for name in hsad.ray.COLUMNS))]


def main(pairs: str, out: str) -> None:
    table = daft.read_parquet(pairs)
    found = table.with_column("found", Match().pairs(table["left"], table["right"]))
    columns = [daft.col("found").get(name).alias(name) for name in hsad.ray.COLUMNS]
    found.select(*(daft.col(name) for name in table.column_names), *columns).write_parquet(out)


if __name__ == "__main__":
    main(*sys.argv[1:])
