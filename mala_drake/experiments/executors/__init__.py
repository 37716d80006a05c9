"""Where the episodes of an experiment are computed: in this process, in others, or on a Dask cluster."""

from mala_drake.experiments.executors.abstract_executor import AbstractExecutor, Finished
from mala_drake.experiments.executors.choice import EXECUTOR_NAMES, make_executor

__all__ = ["EXECUTOR_NAMES", "AbstractExecutor", "Finished", "make_executor"]
