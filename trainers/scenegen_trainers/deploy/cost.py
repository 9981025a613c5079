"""What a network costs on a processor: parameters, multiplications, milliseconds from frame to depth."""

from __future__ import annotations

import importlib
import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Any

import numpy as np
import torch
from torch.utils.flop_counter import FlopCounterMode

from scenegen.foundation.errors import InputError
from scenegen.foundation.rng import stream
from scenegen_trainers.deploy.graph import example_inputs, takes_counts
from scenegen_trainers.inputs.look import compose, look
from scenegen_trainers.models.checkpoint import Checkpoint

FASTEST_MPS = 22.2
"""The highest speed of a drone, as the paper has it."""


@dataclass(frozen=True)
class Cost:
    """Of one network on one machine.

    Attributes
    ----------
    parameters : int
    macs : int
        Multiplications with addition for one frame: convolutions and matrix products.
    graph_bytes : int
    threads : int
    from_counts : bool
        Whether the graph takes counts and computes their gain itself; else it takes the embedded image.
    input_ms, torch_ms, onnx_ms : float
        Median milliseconds for one frame: gain, flow and embedding; the network by torch; the graph by onnxruntime.
    difference_m : float
        Largest difference between both networks' answers [m].
    """

    parameters: int
    macs: int
    graph_bytes: int
    threads: int
    from_counts: bool
    input_ms: float
    torch_ms: float
    onnx_ms: float
    difference_m: float

    @property
    def blind_m(self) -> float:
        """How far a drone at top speed flies while one frame is worked on, the network by onnxruntime [m]."""
        return FASTEST_MPS * 1e-3 * (self.onnx_ms + (0.0 if self.from_counts else self.input_ms))


def cost_of(checkpoint: Checkpoint, graph: bytes, threads: int = 1, repeats: int = 20) -> Cost:
    """Measure.

    Parameters
    ----------
    checkpoint : Checkpoint
    graph : bytes
        Of `onnx_graph`.
    threads : int
        Of both runtimes.
    repeats : int
        Runs of each; three more warm up.

    Raises
    ------
    InputError
        If onnxruntime is missing.
    """
    network, rng = checkpoint.network, stream(0, "cost")
    rows, columns = int(checkpoint.camera["height_px"]), int(checkpoint.camera["width_px"])
    session, before_threads = onnx_session(graph, threads), torch.get_num_threads()
    inputs = example_inputs(checkpoint, rng)
    image = torch.zeros((1, network.inputs.channels, rows, columns))
    now, before = rng.integers(3000, 9000, (2, rows, columns)).astype(np.uint16)
    flow = np.zeros((rows, columns, 2), np.float32) if network.inputs.flow == "truth" else None
    torch.set_num_threads(threads)
    try:
        with torch.inference_mode():
            return Cost(
                parameters=sum(p.numel() for p in network.model.parameters()),
                macs=_macs(network.model, image),
                graph_bytes=len(graph),
                threads=threads,
                from_counts=takes_counts(network.inputs),
                input_ms=_milliseconds(
                    lambda: compose(look(now, before, network.inputs, flow), network.inputs), repeats
                ),
                torch_ms=_milliseconds(lambda: network.metres(image), repeats),
                onnx_ms=_milliseconds(lambda: session.run(None, inputs), repeats),
                difference_m=_difference(checkpoint, session, inputs),
            )
    finally:
        torch.set_num_threads(before_threads)


def onnx_session(graph: bytes, threads: int) -> Any:
    """Open a graph on the CPU.

    Raises
    ------
    InputError
        If onnxruntime is missing.
    """
    try:
        runtime: Any = importlib.import_module("onnxruntime")
    except ImportError:
        raise InputError("this needs onnxruntime: pip install 'thermal-scenegen[onnx]'") from None
    options = runtime.SessionOptions()
    options.intra_op_num_threads, options.inter_op_num_threads = threads, 1
    options.log_severity_level = 4
    return runtime.InferenceSession(graph, options, providers=["CPUExecutionProvider"])


def _difference(checkpoint: Checkpoint, session: Any, inputs: dict[str, np.ndarray]) -> float:
    answer = session.run(None, inputs)[0]
    given = {name: torch.from_numpy(value) for name, value in inputs.items()}
    if "embedded" in given:
        wanted = checkpoint.network.metres(given["embedded"].float() * (2.0 / 255.0) - 1.0)
    else:
        wanted = checkpoint.network(given["counts"], given["previous"])
    return float(np.abs(answer - wanted.numpy()).max())


def _macs(model: Any, image: torch.Tensor) -> int:
    with FlopCounterMode(display=False) as counter:
        model(image)
    return int(counter.get_total_flops()) // 2


def _milliseconds(call: Callable[[], Any], repeats: int) -> float:
    for _ in range(3):
        call()
    times = []
    for _ in range(max(1, repeats)):
        began = time.perf_counter()
        call()
        times.append(time.perf_counter() - began)
    return 1e3 * median(times)
