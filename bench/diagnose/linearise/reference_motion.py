"""One motion for all campaigns of a session: signatures on disk belong to the motion they were simulated along.

The encoders of two campaigns of one session differ by microns, so a key by measured motion would never be met again. A
campaign therefore borrows the motion of an earlier one where the two agree within the tolerances below, and its
signatures are simulated along that. Only derivatives are: predictions and fits use the campaign's own motion.

A signature is a smooth function of the motion, so a relative deviation of the motion changes it by about as much. What
depends on the angle most steeply is periodic, up to 120 cycles per turn: `SAME_ANGLE` is 1.2 % of its phase.
"""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.replay.segments import Segment
from bench.record.campaign import Array
from bench.simulate.prescribed import Motion
from bench.store.digest import digest
from bench.store.store import Store

SAME_INSTANT = 1e-6  # rounding: [s]; instants come from control periods, so they agree or they do not
SAME_ANGLE = 1e-4  # rounding: [rad] or [m]
SAME_VELOCITY = 1e-3  # rounding: of a joint's top speed in the campaign
SAME_ACCELERATION = 0.02  # rounding: of a joint's largest acceleration in the campaign
# rounding: of the largest force, moment or payload in the campaign: as well as weights are usually known
SAME_LOAD = 1e-3
COMPARED = ("time", "q", "velocity", "acceleration", "wrench")  # of a motion; its other fields have to be equal
MOST_MOTIONS = 8  # effort: of sessions with the same runs that are looked at, those used last


@dataclass(frozen=True)
class Session:
    """Segments of a campaign with the motion that their signatures belong to.

    Attributes:
        segments: The campaign's, with a motion that may be another campaign's.
        key: Of that motion.
        is_own: Whether it is the campaign's own and is not known yet.
    """

    segments: tuple[Segment, ...]
    key: str
    is_own: bool


def session_of(segments: Sequence[Segment], store: Store) -> Session:
    """Return a campaign with the nearest motion that the store knows for it, its own if there is none near enough."""
    own = _arrays_of(segments)
    equal = [name for name in (field.name for field in fields(Motion)) if name not in COMPARED]
    group = digest(
        [
            (s.run, s.recording, s.label, s.is_static, len(s.motion), *(getattr(s.motion, name) for name in equal))
            for s in segments
        ]
    )
    key = group + digest(own)
    known = store.known(group)
    if key in known:
        store.get(key)  # it was used
        return Session(tuple(segments), key, is_own=False)
    found: tuple[float, str, dict[str, Array]] | None = None
    for other in known[:MOST_MOTIONS]:
        arrays = store.get(other)
        distance = _distance(own, arrays) if arrays else np.inf
        if arrays and distance <= 1.0 and (found is None or distance < found[0]):
            found = distance, other, arrays
    if found is None:
        return Session(tuple(segments), key, is_own=True)
    return Session(_with_motion(segments, found[2]), found[1], is_own=False)


def remember(session: Session, store: Store, label: str) -> None:
    """Let other campaigns of the session use its motion."""
    if session.is_own:
        store.put(session.key, _arrays_of(session.segments), label)


def _arrays_of(segments: Sequence[Segment]) -> dict[str, Array]:
    """Return the motion of all segments, one after the other, and the payload of each, shape (segments,) [kg]."""
    arrays = {name: np.concatenate([getattr(segment.motion, name) for segment in segments]) for name in COMPARED}
    return arrays | {"payload": np.array([segment.conditions.payload_kg for segment in segments])}


def _with_motion(segments: Sequence[Segment], arrays: dict[str, Array]) -> tuple[Segment, ...]:
    edges = np.cumsum([len(segment.motion) for segment in segments])[:-1]
    time, q, velocity, acceleration, wrench = (np.split(arrays[name], edges) for name in COMPARED)
    return tuple(
        replace(
            segment,
            motion=replace(
                segment.motion,
                time=time[i],
                q=q[i],
                velocity=velocity[i],
                acceleration=acceleration[i],
                wrench=wrench[i],
            ),
            conditions=replace(segment.conditions, payload_kg=float(arrays["payload"][i])),
        )
        for i, segment in enumerate(segments)
    )


def _distance(own: dict[str, Array], other: dict[str, NDArray[np.float64]]) -> float:
    """Return the largest deviation of two motions in tolerances; infinite where joints move another way."""
    if {name: values.shape for name, values in own.items()} != {name: v.shape for name, v in other.items()}:
        return np.inf
    if np.any(np.sign(own["velocity"]) != np.sign(other["velocity"])):  # friction would have the other sign
        return np.inf
    top = {name: np.max(np.abs(values), axis=0, initial=0.0) for name, values in own.items()}
    wrench = np.repeat([np.max(top["wrench"][:3]), np.max(top["wrench"][3:])], 3)
    tolerances = {
        "time": SAME_INSTANT,
        "q": SAME_ANGLE,
        "velocity": SAME_VELOCITY * top["velocity"],
        "acceleration": SAME_ACCELERATION * top["acceleration"],
        "wrench": SAME_LOAD * wrench,
        "payload": SAME_LOAD * top["payload"],
    }
    ratios = []
    for name, tolerance in tolerances.items():
        off = np.abs(own[name] - other[name])
        within = np.broadcast_to(tolerance, off.shape)
        if np.any((off > 0) & (within == 0)):
            return np.inf
        ratios.append(np.max(off / np.where(within > 0, within, 1.0), initial=0.0))
    return float(max(ratios))
