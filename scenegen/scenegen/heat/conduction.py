"""Periodic heat conduction through layers: a complex admittance for each harmonic of the day."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Complex128, Float64

DAY_S = 86400.0


@dataclass(frozen=True)
class Layer:
    """One homogeneous layer.

    Attributes
    ----------
    conductivity_WmK, density_kgm3, heat_capacity_JkgK, thickness_m : float
    """

    conductivity_WmK: float
    density_kgm3: float
    heat_capacity_JkgK: float
    thickness_m: float

    def inertia(self, omega: Float64[np.ndarray, "harmonics"]) -> Complex128[np.ndarray, "harmonics"]:
        """Admittance of the material without end, ``k sqrt(i omega rho c / k)`` [W m^-2 K^-1]."""
        return np.sqrt(1j * omega * self.conductivity_WmK * self.density_kgm3 * self.heat_capacity_JkgK)

    def phase(self, omega: Float64[np.ndarray, "harmonics"]) -> Complex128[np.ndarray, "harmonics"]:
        """Complex thickness ``L sqrt(i omega rho c / k)``."""
        return self.thickness_m * np.sqrt(
            1j * omega * self.density_kgm3 * self.heat_capacity_JkgK / self.conductivity_WmK
        )


@dataclass(frozen=True)
class Stack:
    """Layers from outside to inside and what lies behind the last one.

    Attributes
    ----------
    layers : tuple of Layer
    inner_Wm2K : float
        Coefficient of heat exchange behind the last layer with a space of given temperature: 0 adiabatic, infinity
        when the last layer never ends.
    """

    layers: tuple[Layer, ...]
    inner_Wm2K: float

    @property
    def endless(self) -> bool:
        """Whether the last layer has no inner side."""
        return self.inner_Wm2K == float("inf")


def harmonics(samples: int) -> Float64[np.ndarray, "harmonics"]:
    """Angular frequencies [1/s] of the harmonics of a day sampled `samples` times."""
    return np.asarray(2.0 * np.pi * np.arange(samples // 2 + 1) / DAY_S)


def admittance(
    stack: Stack, omega: Float64[np.ndarray, "harmonics"]
) -> tuple[Complex128[np.ndarray, "harmonics"], Complex128[np.ndarray, "harmonics"]]:
    """Heat flux into the outer face per kelvin of outer and of inner temperature [W m^-2 K^-1].

    The flux is ``Y T_outer - B T_inner`` for each harmonic (Carslaw and Jaeger 1959, section 3.7; Pipes 1957). By
    reciprocity B is the flux that reaches the inner space per kelvin outside. Exponentials never overflow: only
    decaying ones are evaluated.

    Returns
    -------
    Y, B : complex128 (harmonics,)
    """
    layers = stack.layers
    if stack.endless:
        Y = layers[-1].inertia(omega)
        passed = np.zeros_like(Y)
        layers = layers[:-1]
    else:
        Y = np.full(omega.shape, complex(stack.inner_Wm2K))
        passed = Y.copy()
    for layer in reversed(layers):
        Y, passed = _behind(layer, omega, Y, passed)
    return Y, passed


def _behind(
    layer: Layer,
    omega: Float64[np.ndarray, "harmonics"],
    Y: Complex128[np.ndarray, "harmonics"],
    passed: Complex128[np.ndarray, "harmonics"],
) -> tuple[Complex128[np.ndarray, "harmonics"], Complex128[np.ndarray, "harmonics"]]:
    """Admittance and transfer in front of a layer, given those behind it."""
    steady = omega == 0.0
    safe = np.where(steady, 1.0, omega)
    kg, gL = layer.inertia(safe), layer.phase(safe)
    decay = np.exp(-2.0 * gL)
    tanh = (1.0 - decay) / (1.0 + decay)
    front = kg * (Y + kg * tanh) / (kg + Y * tanh)
    share = 2.0 * np.exp(-gL) / ((1.0 + decay) + Y / kg * (1.0 - decay))
    resistance = layer.thickness_m / layer.conductivity_WmK
    front = np.where(steady, Y / (1.0 + Y * resistance), front)
    share = np.where(steady, 1.0 / (1.0 + Y * resistance), share)
    return front, passed * share
