"""Pairs by the thousand on a cluster, by Ray Data.

:class:`Disparity` matches batches of pairs: ``ds.map_batches(hsad.ray.Disparity, concurrency=8, num_gpus=1)``. :func:`run`, which is
``python -m hsad.ray pairs.parquet -o out/``, writes Parquet files and goes on where an earlier run ended. Ray is needed by :func:`run`
alone: ``pip install 'hsad[ray]'``.
"""

from ._disparity import COLUMNS, Disparity
from ._run import Summary, run
from ._tiles import CutTiles, MergeTiles, TileDisparity

__all__ = ["COLUMNS", "CutTiles", "Disparity", "MergeTiles", "Summary", "TileDisparity", "run"]
