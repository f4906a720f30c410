"""What of each background error is another one in the next recording of the same machine.

One table for both sides: hidden machines are drawn by it (`hide/recordings.py`), and a joint diagnosis expects it
(`diagnose/replay/nuisances.py`, `levels.py`). Names of instruments' errors are the fields of `SystematicErrors`.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from bench.effects.effect import Between
from bench.robot.figures import Figures

Array = NDArray[np.float64]

# assumed: from one recording to another. Drives that are cold in one and warmed up in another differ by some 20 K, and
# the air of a workshop adds to it: 10 K as a standard deviation, assumed. Both rates lie in the ranges of the effects
# that look for them (`torque_constant_temperature`, `friction_temperature`, with their sources).
DAY_K = 10.0  # [K]
REMANENCE = 0.001  # derived: [1/K], by which a torque constant falls with the remanence of NdFeB magnets
VISCOUS = 0.015  # derived: [1/K], by which viscous friction falls: 30 % over 20 K
# assumed: [1/K], of Coulomb friction: a third of viscous friction's. Bittencourt and Gunnarsson (2012) find that it
# hardly follows temperature; preload of bearings, grease that lay overnight and wear change it all the same.
COULOMB = 0.005  # a joint diagnosis expects it; hidden machines keep theirs
# assumed: [K], standard deviation of the air of an unheated workshop from recording to recording; the gas follows it
AIR_DAY_K = 5.0
# derived: ISO 376:2011, Table 2: a force transducer of class 2, the loosest, that is mounted three times, turned in
# between, reads within 0.40 % of itself; the range of three normal numbers is 1.69 standard deviations on average.
# Temperature adds 0.05 % over 10 K (data sheets of strain gauge transducers), which is nothing beside it.
MOUNTED_ANEW = 0.004 / 1.69
# assumed: of the variance of a channel's zero as stated, the part that is another one in each recording: data sheets
# state the zero of a sensor and its drift with temperature and time of the same order. The halves are assumed. What is
# known to drift by less does so.
DRIFTING = 0.5

BETWEEN: Mapping[str, Between] = {
    "current_gain": "drifts",
    "current_offset": "drifts",
    "torque_gain": "drifts",
    "torque_offset": "drifts",
    "force_gain": "drifts",  # its calibration
    "force_tilt": "anew",  # it is hung in anew
    "frame_shift": "anew",
    "frame_rotation": "anew",
    "frame_drift": "anew",
    "drift_direction": "anew",
    "placement": "anew",  # reflectors are put into their nests again; where nests are is geometry
    "encoder_offset": "same",  # but for the part that figures say is found anew
    "link_encoder_offset": "anew",  # but for the part that figures say is not zeroed anew
}


def own_part(name: str, sigma: float) -> float:
    """Return the standard deviation of the part of an instrument's error that is another one in each recording.

    Args:
        name: Field of `SystematicErrors`.
        sigma: Of the whole error, as stated.
    """
    if BETWEEN[name] == "drifts":
        most = {"current_gain": REMANENCE * DAY_K, "torque_gain": REMANENCE * DAY_K, "force_gain": MOUNTED_ANEW}
        return min(most.get(name, np.inf), float(np.sqrt(DRIFTING)) * sigma)
    return sigma if BETWEEN[name] == "anew" else 0.0


def own_shares(figures: Figures) -> dict[str, Array | float]:
    """Return which share of the variance of each instrument's error is another one in each recording, by names.

    Shapes are those of the fields of `SystematicErrors`, or one number for all.
    """
    instruments = figures.instruments
    found: dict[str, Array | float] = {name: float(between == "anew") for name, between in BETWEEN.items()}
    stated: dict[str, list[float]] = {}
    if current := instruments.current:
        gains = [float(np.hypot(drive.torque_constant_error, current.gain_sigma)) for drive in figures.drives]
        stated |= {"current_gain": gains, "current_offset": [current.offset_sigma_a]}
    if torque := instruments.torque:
        stated |= {
            "torque_gain": [torque.gain_sigma],
            "torque_offset": list(torque.offset_sigma_of(len(figures.drives))),
        }
    if force := instruments.force:
        stated["force_gain"] = [force.gain_sigma]
    for name, sigmas in stated.items():
        shares = np.array([(own_part(name, sigma) / sigma) ** 2 if sigma else 0.0 for sigma in sigmas])
        found[name] = shares if len(shares) > 1 else float(shares[0])
    for name, encoder in (("encoder_offset", instruments.encoder), ("link_encoder_offset", instruments.link_encoder)):
        if encoder and encoder.zeroing_sigma_rad is not None and encoder.offset_sigma_rad:
            found[name] = min(1.0, (encoder.zeroing_sigma_rad / encoder.offset_sigma_rad) ** 2)
    return found
