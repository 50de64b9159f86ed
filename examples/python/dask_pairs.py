"""Many pairs with Dask: python dask_pairs.py pairs.parquet out

pairs.parquet has the columns left and right, paths or URIs; out becomes a folder of Parquet files with maps and reports.
"""

import sys

import dask.dataframe
import pandas
import pyarrow

import hsad.ray


def main(pairs: str, out: str) -> None:
    match = hsad.ray.Disparity()
    table = dask.dataframe.read_parquet(pairs).repartition(npartitions=8)
    types = {name: pandas.ArrowDtype(getattr(pyarrow, kind)()) for name, kind in hsad.ray.COLUMNS.items()}
    empty = table._meta.assign(**{name: pandas.Series(dtype=kind) for name, kind in types.items()})
    maps = table.map_partitions(lambda part: pandas.DataFrame(match(part)).astype(types), meta=empty)
    maps.to_parquet(out, write_index=False)


if __name__ == "__main__":
    main(*sys.argv[1:])
