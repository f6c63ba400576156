"""Laws of strength for `solver.py`: yield stress over plastic strain, rate and temperature.

A law has two functions of arrays: `thermal(T)`, what the temperature (K) makes of it, once a step; and `stress(strain, increment,
dt, thermal)`, the yield stress at the end of a step in which the plastic strain grows from `strain` by `increment`, and its slope
against `increment`.
"""

import numpy as np


class JohnsonCook:
    """(A + B strain^n) (1 + C ln rate) (1 - T*^m), the rate over 1/s and no less than that."""

    def __init__(self, A, B, n, C, m, T0, Tm):
        self.A, self.B, self.n, self.C, self.m, self.T0, self.Tm = A, B, n, C, m, T0, Tm

    def thermal(self, T):
        return 1 - np.clip((T - self.T0) / (self.Tm - self.T0), 0, 1) ** self.m

    def stress(self, strain, increment, dt, softening):
        reached = strain + increment
        hardening = self.B * reached**self.n
        rate = 1 + self.C * np.log(np.maximum(increment / dt, 1))
        by_strain = hardening * self.n / np.maximum(reached, 1e-30) * rate
        by_rate = (self.A + hardening) * self.C / np.maximum(increment, dt) * (increment > dt)
        return (self.A + hardening) * rate * softening, (by_strain + by_rate) * softening


class ZerilliArmstrongFcc:
    """C0 + C2 strain^(1/2) exp(-C3 T + C4 T ln rate), the exponent no more than 0 and the rate (1/s) no less than `lowest`."""

    def __init__(self, C0, C2, C3, C4, lowest=1e-3):
        self.C0, self.C2, self.C3, self.C4, self.lowest = C0, C2, C3, C4, lowest

    def thermal(self, T):
        return np.maximum(T, 0)

    def stress(self, strain, increment, dt, T):
        root = np.sqrt(strain + increment)
        exponent = T * (self.C4 * np.log(np.maximum(increment / dt, self.lowest)) - self.C3)
        hardening = self.C2 * root * np.exp(np.minimum(exponent, 0))
        by_strain = 0.5 * hardening / np.maximum(strain + increment, 1e-30)
        free = (increment > self.lowest * dt) & (exponent < 0)
        return self.C0 + hardening, by_strain + hardening * self.C4 * T / np.maximum(increment, self.lowest * dt) * free
