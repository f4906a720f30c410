"""What instruments of the second plant get wrong all campaign long, and what of it another recording has anew."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Self

import numpy as np

from bench.robot.instruments import Instruments
from bench.second.figures import Array


@dataclass(frozen=True, eq=False)
class Errors:
    """One draw of errors that stay over a campaign; n drives, r reflectors. Those of a missing instrument are zero.

    Attributes:
        encoder_offset: Shape (n,) [rad].
        current_gain: Shape (n,), relative; of the sensor and of the torque constant together.
        current_offset: Shape (n,) [A].
        force_gain: Relative.
        force_tilt: Shape (3,) [rad], of the sensor's axes against a slanting load.
        placement: Shape (r, 3) [m], of reflectors in their nests, in the frame of the joint that carries them.
        drift_direction: Shape (3,), along which the tracker creeps; its length does not count.
        frame_rotation, frame_shift: Shape (3,) [rad] and [m], of the tracker's frame.
    """

    encoder_offset: Array
    current_gain: Array
    current_offset: Array
    force_gain: float
    force_tilt: Array
    placement: Array
    drift_direction: Array
    frame_rotation: Array
    frame_shift: Array

    @classmethod
    def draw(cls, fitted: Instruments, constants: Array, reflectors: int, rng: np.random.Generator) -> Self:
        """Draw normal errors.

        Args:
            fitted: Which instruments there are, and how good.
            constants: Shape (n,), relative standard deviations of torque constants.
            reflectors: How many.
            rng: Random numbers.
        """
        n, encoder, current, force, tracker = (
            len(constants),
            fitted.encoder,
            fitted.current,
            fitted.force,
            fitted.tracker,
        )
        gains = np.hypot(current.gain_sigma, constants) if current else np.zeros(n)
        return cls(
            encoder_offset=(encoder.offset_sigma_rad if encoder else 0.0) * rng.standard_normal(n),
            current_gain=gains * rng.standard_normal(n),
            current_offset=(current.offset_sigma_a if current else 0.0) * rng.standard_normal(n),
            force_gain=(force.gain_sigma if force else 0.0) * float(rng.standard_normal()),
            force_tilt=(force.direction_sigma_rad if force else 0.0) * rng.standard_normal(3),
            placement=(tracker.placement_sigma_m if tracker else 0.0) * rng.standard_normal((reflectors, 3)),
            drift_direction=rng.standard_normal(3),
            frame_rotation=(tracker.frame_sigma_rad if tracker else 0.0) * rng.standard_normal(3),
            frame_shift=(tracker.frame_sigma_m if tracker else 0.0) * rng.standard_normal(3),
        )

    @classmethod
    def none(cls, n: int, reflectors: int) -> Self:
        """Return those of instruments that are right."""
        drives, vector, nests = np.zeros(n), np.zeros(3), np.zeros((reflectors, 3))
        return cls(drives, drives, drives, 0.0, vector, nests, vector, vector, vector)

    def in_recording(self, own: "Errors", shares: Mapping[str, Array | float]) -> Self:
        """Return the errors of the same machine in another recording.

        Args:
            own: Drawn for that recording alone.
            shares: Attribute -> share of its variance that is another one in each recording, 0 to 1; (n,) or one.
        """
        found = {}
        for field in fields(self):
            share = np.asarray(shares[field.name])
            found[field.name] = np.sqrt(1 - share) * getattr(self, field.name) + np.sqrt(share) * getattr(
                own, field.name
            )
        return type(self)(**found)
