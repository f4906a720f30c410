"""Read one instant at a time, as the environment does: the same readings as `Instruments.read`, several times faster.

But for noise, resolution and the nests of reflectors a reading is a linear function of the truth. `Glance` finds its
matrix by showing unit truths to the instruments, once for a set of systematic errors.
"""

from collections.abc import Callable, Mapping, Sequence
from math import hypot

import numpy as np
from numpy.typing import NDArray

from bench.simulate.instruments import VERTICAL_TOLERANCE, Array, Instruments, small_rotation
from bench.simulate.trace import Trace


class Glance:
    """Reads records of one instant.

    Args:
        instruments: No perfect ones, which show the truth to the last digit; their systematic errors may change.
        trace_of: From records, shape (K, width), to the truth that they hold; linear.
        width: Numbers in a record.
        names: Fields of `Reading` to read, whose instruments there are.
    """

    def __init__(
        self, instruments: Instruments, trace_of: Callable[[Array], Trace], width: int, names: Sequence[str]
    ) -> None:
        self.instruments, self._trace_of, self._width, self._names = instruments, trace_of, width, tuple(names)
        self._errors: object = None

    def read(self, record: Array) -> dict[str, Array]:
        """Return the readings of an instant by name, each of the shape that `Reading` says but for the first axis.

        Args:
            record: Shape (width,).
        """
        if self.instruments.errors is not self._errors:
            self._look_up()
            self._errors = self.instruments.errors
            self._turn = small_rotation(self.instruments.errors.frame_rotation)
        shown: Array = self._upright @ record
        shown += self._offset
        x, y, z = shown[self._force].tolist()
        if hypot(x, y) > VERTICAL_TOLERANCE * abs(z):
            shown = self._slanting @ record + self._offset
        if self._noisy:
            noise = self.instruments.draw(len(self._order))[self._order]
            if self._away:
                away = shown[self._away].reshape(-1, 3)
                distance = np.sqrt(np.add.reduce(away * away, axis=1, keepdims=True))
                np.multiply(distance, self._relative, out=self._scale_of_reflectors)
            noise *= self._scale
            noisy = shown[self._noisy]  # a view: `shown[...] += noise` would write it once more
            noisy += noise
        rounded = shown[: len(self._steps)]
        rounded /= self._steps
        np.rint(rounded, out=rounded)
        rounded *= self._steps
        found = {name: shown[here] for name, here in self._shown}
        if "reflectors" in found:
            nests = self.instruments.nests_at(shown[self._theta], self._turn)
            found["reflectors"] = found["reflectors"].reshape(-1, 3) + nests
        return found

    def _look_up(self) -> None:
        """Find the linear map, and which of its results are rounded and noisy."""
        instruments = self.instruments
        spreads, steps = instruments.spreads(), instruments.resolutions()
        # What is rounded stands first, and what is noisy stands together.
        order = sorted(self._names, key=lambda name: (name not in steps, (name in spreads) == (name in steps)))
        truth = self._trace_of(np.concatenate([np.zeros((1, self._width)), np.eye(self._width)]))
        maps = []
        for slants in (False, True):
            seen = instruments.linear(truth, slants)
            seen["q_link"] = np.nan_to_num(seen["q_link"]) if "q_link" in seen else np.zeros((len(truth), 0))
            blocks = {name: seen[name].reshape(len(truth), -1) for name in order}
            blocks["force of load"], blocks["joints"] = truth.wrench[:, :3], truth.theta
            if "reflectors" in spreads:
                blocks["away"] = instruments.away(truth.reflectors).reshape(len(truth), -1)
            maps.append(np.concatenate([*blocks.values()], axis=1))
        self._offset = maps[0][0]
        self._upright, self._slanting = (np.ascontiguousarray((one[1:] - one[0]).T) for one in maps)
        places = _places({name: block.shape[1] for name, block in blocks.items()})
        self._force, self._theta = places.pop("force of load"), places.pop("joints")
        self._away = places.pop("away", None)
        self._places = places
        self._shown = [(name, places[name]) for name in self._names]
        self._steps = _filled(places, {name: steps[name] for name in order if name in steps})
        self._arrange_noise(spreads)

    def _arrange_noise(self, spreads: Mapping[str, Array | float]) -> None:
        """Note where noise goes: it is drawn in the order of `spreads`."""
        noisy = [name for name in self._places if name in spreads]
        self._noisy = slice(self._places[noisy[0]].start, self._places[noisy[-1]].stop) if noisy else None
        drawn = _places({name: _length(self._places[name]) for name in spreads})
        columns = [column for name in noisy for column in range(drawn[name].start, drawn[name].stop)]
        self._order: NDArray[np.intp] = np.array(columns, dtype=np.intp)
        within = _places({name: _length(self._places[name]) for name in noisy})
        self._scale = _filled(within, {name: spreads[name] for name in noisy})
        if self._away:
            self._relative = float(spreads["reflectors"])
            self._scale_of_reflectors = self._scale[within["reflectors"]].reshape(-1, 3)


def _length(place: slice) -> int:
    return int(place.stop - place.start)


def _places(lengths: Mapping[str, int]) -> dict[str, slice]:
    """Return where blocks of these lengths lie end to end."""
    ends = np.cumsum([*lengths.values()], dtype=np.intp).tolist()
    return {name: slice(end - length, end) for (name, length), end in zip(lengths.items(), ends, strict=True)}


def _filled(places: Mapping[str, slice], values: Mapping[str, Array | float]) -> Array:
    """Return a value for each number of the blocks that have one; they stand first."""
    filled = [np.broadcast_to(value, _length(places[name])) for name, value in values.items()]
    return np.concatenate([np.zeros(0), *filled])
