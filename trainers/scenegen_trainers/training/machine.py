"""On what a training runs: devices, precision, threads. None of it changes what is taught."""

from __future__ import annotations

import importlib
import inspect
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import torch

from scenegen.foundation.errors import InputError

Precision = Literal["32-true", "bf16-mixed", "16-mixed"]


@dataclass(frozen=True)
class Machine:
    """Devices and arithmetic.

    Attributes
    ----------
    accelerator : "cpu", "gpu" or "auto"
    devices : int
        How many; more than one share every batch (distributed data parallel).
    precision : "32-true", "bf16-mixed" or "16-mixed"
    threads : int
        Of the CPU. Sums depend on it in their last digit, so it is fixed, not taken from the machine; small networks
        gain little from more, and lose much on a busy machine. Several trainings side by side use cores better.
    tensorboard : bool
        Log for TensorBoard, too.
    """

    accelerator: Literal["cpu", "gpu", "auto"] = "cpu"
    devices: int = 1
    precision: Precision = "32-true"
    threads: int = 1
    tensorboard: bool = False

    def settle(self) -> None:
        """Make this process compute the same result every time."""
        for flag, value in (("--threads", self.threads), ("--devices", self.devices)):
            if value < 1:
                raise InputError(f"{flag} {value}: at least 1")
        os.environ.setdefault("CUBLAS_WORKSPACE_CONFIG", ":4096:8")
        torch.set_num_threads(self.threads)
        # What has no deterministic form on a GPU is said in a warning there, and is an error on the CPU.
        torch.use_deterministic_algorithms(True, warn_only=self.accelerator != "cpu")
        # That mode also fills all fresh memory with NaN, to catch those who read it unwritten: a twentieth of the time.
        torch.utils.deterministic.fill_uninitialized_memory = False

    def device(self) -> str:
        """Where a single process computes.

        Raises
        ------
        InputError
            If a GPU is asked for and none is there.
        """
        self._need_gpu()
        return "cuda" if self.accelerator == "gpu" else "cpu"

    def _need_gpu(self) -> None:
        if self.accelerator == "gpu" and not torch.cuda.is_available():
            raise InputError("no GPU that torch can use; take --accelerator cpu")

    def fabric(self, out: Path) -> Any:
        """Lightning Fabric on these devices.

        Raises
        ------
        InputError
            If lightning or tensorboard is missing, or the devices are not there.
        """
        self.settle()
        self._need_gpu()
        try:
            lightning = importlib.import_module("lightning.fabric")
            strategies = importlib.import_module("lightning.fabric.strategies")
        except ImportError:
            raise InputError(
                "training needs torch and lightning: pip install 'thermal-scenegen[train]'"
            ) from None
        strategy = strategies.DDPStrategy(**_own_buffers()) if self.devices > 1 else "auto"
        try:
            return lightning.Fabric(
                accelerator=self.accelerator,
                devices=self.devices,
                strategy=strategy,
                precision=self.precision,
                loggers=self._loggers(out),
            )
        except (RuntimeError, ValueError, ImportError) as error:
            raise InputError(" ".join(str(error).split())[:200]) from None

    def _loggers(self, out: Path) -> Sequence[Any]:
        if not self.tensorboard:
            return []
        try:
            loggers = importlib.import_module("lightning.fabric.loggers")
            return [loggers.TensorBoardLogger(str(out), name="tensorboard", version="")]
        except (ImportError, ModuleNotFoundError):
            raise InputError("--tensorboard needs it installed: pip install tensorboard") from None


def is_first_process() -> bool:
    """Whether this process speaks and writes for all that share a training; true where there is only one."""
    return all(os.environ.get(name, "0") == "0" for name in ("LOCAL_RANK", "NODE_RANK", "GROUP_RANK"))


def _own_buffers() -> dict[str, bool]:
    """Every process normalises by its own part of a batch; its running means must not be overwritten between the two
    looks a discriminator takes. How that is said depends on torch."""
    known = inspect.signature(torch.nn.parallel.DistributedDataParallel).parameters
    return {"forward_sync_buffers" if "forward_sync_buffers" in known else "broadcast_buffers": False}
