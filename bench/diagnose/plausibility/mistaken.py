"""Drive channels taken for something else: turned in sign, in another unit, of another joint.

Each is tried, and told where the nominal model with friction, payload and gas then fits by far better, and well. A
model that fits badly either way says nothing, and no effect of the catalogue makes one fit by far better upside down.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from bench.diagnose.plausibility.drive_picture import DrivePicture
from bench.diagnose.plausibility.physical_fit import FAR_BETTER, FITS, misfit
from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.units import STANDARD_GRAVITY

FACTORS = np.geomspace(1e-4, 1e4, 65)  # effort: that are tried, eight in a decade
# derived: a factor nearer to 1 is no unit: the least, of kilograms, less half a step of the factors that are tried
PLAIN = STANDARD_GRAVITY * (FACTORS[0] / FACTORS[1]) ** 0.5
ALIKE = 1e-3  # rounding: of the mean square; factors that leave the same within this are as good
POUND_N = 0.45359237 * STANDARD_GRAVITY  # exact: [N], a pound-force
# derived: of a factor's logarithm: half way between the units that are most alike, pounds and kilograms
NEAR = float(np.log(STANDARD_GRAVITY / POUND_N)) / 2
UNITS: Mapping[float, str] = {
    1e3: "milliamperes or mNm?",
    1e-3: "kiloamperes or kNm?",
    10.0: "tenths?",
    STANDARD_GRAVITY: "kilogram-force metres?",
}


@dataclass(frozen=True, eq=False)
class Mistake:
    """One way to misread.

    Attributes:
        drives: Whose channels fit better without it.
        columns: That it is about.
        message, remedy: Of the finding.
        picture: The readings as they would be without it.
    """

    drives: tuple[int, ...]
    columns: tuple[str, ...]
    message: str
    remedy: str
    picture: DrivePicture


def mistakes_in(
    picture: DrivePicture,
    of_loads: Iterable[Mistake] = (),
    of_joints: Callable[[], Iterable[Mistake]] = lambda: (),
    *,
    of_units: bool = True,
) -> Iterator[Finding]:
    """Yield what the drives' channels are taken for, the mistake that explains most first.

    Args:
        picture: What drives did.
        of_loads: Mistakes about loads, tried once.
        of_joints: Mistakes about angles too, tried once, where nothing else leaves all drives well.
        of_units: Whether a channel may be in another unit; few readings may be small for other reasons.
    """
    picture = _without_idle(picture)
    for i, _ in enumerate(picture.names):
        before = misfit(picture)
        if np.max(before) < FITS:
            return
        likely = _likely((*_mistakes(picture, before, of_units=of_units), *(of_loads if i == 0 else ())), before)
        if i == 0 and not any(np.max(after) < FITS for after, _ in likely):
            likely += _likely(of_joints(), before)
        if not likely:
            return
        _, found = min(likely, key=lambda one: float(one[0].sum()))
        for column in found.columns:
            yield doubt(column, found.message, found.remedy)
        picture = found.picture


def _without_idle(picture: DrivePicture) -> DrivePicture:
    """Return a picture without what drives read that stand all along, and that friction may hold, while others move.

    What is carried is told by those that move; where it sits, and so what the others hold, it leaves open.
    """
    stands = np.all(picture.standing, axis=0) & ~np.all(picture.standing)
    idle = stands & np.all(~(np.abs(picture.observed - picture.model) > picture.slack), axis=0)
    return replace(picture, observed=np.where(idle, np.nan, picture.observed))


def _likely(mistakes: Iterable[Mistake], before: Array) -> list[tuple[Array, Mistake]]:
    """Return the mistakes without which the model fits by far better, with the misfit then."""
    tried = [(misfit(mistake.picture), mistake) for mistake in mistakes]
    return [(after, mistake) for after, mistake in tried if _explains(before, after, mistake.drives)]


def _explains(before: Array, after: Array, drives: tuple[int, ...]) -> bool:
    own = list(drives)
    is_better = after[own].sum() < FAR_BETTER * before[own].sum() and after.sum() < before.sum()
    return bool(is_better and np.all(after[own] < np.maximum(FITS, before[own])))


def doubt(column: str, message: str, remedy: str) -> Finding:
    """Return a doubt about a channel of a whole campaign."""
    return Finding("doubt", "all runs", None, column, message, remedy)


def _mistakes(picture: DrivePicture, before: Array, *, of_units: bool) -> Iterator[Mistake]:
    there = [j for j in range(len(picture.names)) if np.any(np.isfinite(picture.observed[:, j]))]
    bad = [j for j in there if before[j] > FITS]
    for drives in [*((j,) for j in bad), tuple(bad)]:
        columns = tuple(picture.names[j] for j in drives)
        yield Mistake(
            drives,
            columns,
            "has the wrong sign",
            "turn the sign of this channel, or of the angle",
            turned(picture, drives),
        )
        if of_units:
            yield from _other_unit(picture, drives)
    for j in bad:
        yield from _without_signs(picture, j)
    for i, j in combinations(there, 2):
        if before[i] > FITS or before[j] > FITS:
            one, other = picture.names[i], picture.names[j]
            message = f"{one} and {other} are exchanged"
            yield Mistake((i, j), (one,), message, "look at the order of the joints", _swapped(picture, i, j))


def _other_unit(picture: DrivePicture, drives: tuple[int, ...]) -> Iterator[Mistake]:
    """Yield the factor with which these channels fit best, if no lack of the model makes it."""
    left = np.array([misfit(_scaled(picture, drives, 1 / factor))[list(drives)].sum() for factor in FACTORS])
    factor = float(np.exp(np.mean(np.log(FACTORS[left < left.min() + ALIKE]))))
    if 1 / PLAIN < factor < PLAIN:
        return
    guess = next((word for unit, word in UNITS.items() if abs(np.log(factor / unit)) < NEAR), "another unit?")
    if factor < 1:
        guess = "on the motor side of the gear? multiply by the gear ratio; or " + guess
    size = f"{factor:.2g} times larger" if factor > 1 else f"{1 / factor:.2g} times smaller"
    message = f"is about {size} than the model needs"
    columns = tuple(picture.names[j] for j in drives)
    yield Mistake(drives, columns, message, f"{guess} give SI units", _scaled(picture, drives, 1 / factor))


def _without_signs(picture: DrivePicture, j: int) -> Iterator[Mistake]:
    """Yield a channel that is nowhere negative as it would be with the signs of friction, or of the nominal model."""
    observed = picture.observed[:, j]
    if np.nanmin(observed) < 0:
        return
    message, remedy = "is nowhere negative; the model needs both signs", "an absolute value? log it with its sign"
    for signs in (np.sign(picture.velocity[:, j]), np.sign(picture.model[:, j])):
        if np.ptp(signs[np.isfinite(observed)]) > 1:
            signed = picture.observed.copy()
            signed[:, j] *= np.where(signs < 0, -1.0, 1.0)
            yield Mistake((j,), (picture.names[j],), message, remedy, replace(picture, observed=signed))


def turned(picture: DrivePicture, drives: tuple[int, ...]) -> DrivePicture:
    """Return the picture with the sign of some drives' readings turned."""
    return _scaled(picture, drives, -1.0)


def _scaled(picture: DrivePicture, drives: tuple[int, ...], factor: float) -> DrivePicture:
    observed = picture.observed.copy()
    observed[:, list(drives)] *= factor
    return replace(picture, observed=observed)


def _swapped(picture: DrivePicture, i: int, j: int) -> DrivePicture:
    """Return the picture with two channels exchanged, as they were read."""
    observed = picture.observed.copy()
    observed[:, [i, j]] = picture.observed[:, [j, i]] / picture.unit[[j, i]] * picture.unit[[i, j]]
    return replace(picture, observed=observed)
