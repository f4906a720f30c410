"""Readings that hold nothing but a shape, for units that look at one thing only."""

import numpy as np

from bench.identify.readings import StaticReadings, Systematic


def bare_readings(m, n, series=None, approach=0, **given):
    series = np.zeros(m, dtype=np.int64) if series is None else np.array(series)
    first = np.array([np.flatnonzero(series == s)[0] for s in series])
    fields = {
        "series": series,
        "is_reference": first == np.arange(m),
        "q_motor": np.zeros((m, n)),
        "current_torque": np.zeros((m, n)),
        "reflectors": np.zeros((m, 1, 3)),
        "wrench": np.zeros((m, 6)),
        "is_vertical": np.ones(m, dtype=bool),
        "n_repeats": np.full(m, 10),
        "sigma_current_torque": np.full(n, 1.0),
        "sigma_reflector": 30e-6,
        "sigma_wrench": np.ones(6),
        "reflector_names": ("reflector_1",),
        "load_point": "load",
        "systematic": Systematic(np.full(n, 0.02)),
        "approach": np.full(m, approach),
    }
    return StaticReadings(**(fields | given))
