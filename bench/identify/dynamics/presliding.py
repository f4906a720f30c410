"""Friction that turns late: over some travel after a joint turns round it goes from one level to the other.

Dahl's law (P. R. Dahl, "A solid friction model", The Aerospace Corporation TOR-0158(3107-18)-1, 1968), of which LuGre
(C. Canudas de Wit and others, IEEE Transactions on Automatic Control 40(3), 1995) and Leuven models (J. Swevers and
others, likewise 45(4), 2000) are extensions: friction is F_c z, not F_c sign(v), and

    dz/dq = (1 - z sign(v)) / s

with the presliding travel s, Coulomb friction over presliding stiffness. The column is z - sign(v): a pulse after each
turn. A low-pass spreads it over rows that count as moving, and there it looks like inertia, for it comes whenever the
acceleration is largest.

Where it is far shorter than a period of the cut-off only the area of that pulse shows, after a turn with acceleration a
sqrt(2 pi s / a). So if the factor of the column were u times the friction, the travel would be u^2 times the column's.
An element of `bench.friction`, whose force is linear in the way, has that area with a travel of 9 pi / 32 s = 0.88 s.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from bench.identify.dynamics.band import Band
from bench.identify.dynamics.equations import DRIVE_COLUMNS, Equations
from bench.identify.dynamics.normal import Normal, log_evidence
from bench.identify.dynamics.parameters import Layout
from bench.identify.dynamics.prior import Prior
from bench.identify.dynamics.rows import DriveRows
from bench.identify.dynamics.solve import Solution
from bench.record.campaign import Array

COULOMB, PRESLIDING = (DRIVE_COLUMNS.index(name) for name in ("coulomb", "presliding"))
# effort: [rad] or [m], travels that are tried; the factor of the column does the rest
TRAVELS = 1e-5 * 2.0 ** np.arange(10)
NEARER = np.linspace(-1.0, 1.0, 9)  # effort: steps from the best of these, tried beside the best of the other drives


def turned(position: Array, travel: Array) -> Array:
    """Return z along a path that begins without friction, shape (T, K, n).

    Args:
        position: Shape (T, n) [rad] or [m].
        travel: Shape (K, n), likewise, above zero.
    """
    gone = np.diff(position, axis=0)[:, None] / travel
    kept = np.exp(-np.abs(gone))
    added = np.sign(gone) * (1 - kept)
    found = np.zeros((len(position), *travel.shape))
    for before, share, more, after in zip(found, kept, added, found[1:], strict=False):
        np.multiply(before, share, out=after)
        after += more
    return found


def late(equations: Sequence[Equations], travel: Array, band: Band) -> tuple[Equations, ...]:
    """Return equations with the column of friction that turns late.

    Args:
        equations: Of stretches.
        travel: Shape (n,) [rad] or [m].
        band: The filter that they passed.
    """
    found = []
    for part, columns in zip(equations, _columns(equations, travel[None], band), strict=True):
        drives = part.drives.copy()
        drives[:, :, PRESLIDING] = columns[:, 0]
        found.append(replace(part, drives=drives))
    return tuple(found)


def likeliest_travel(
    equations: Sequence[Equations],
    layout: Layout,
    prior: Prior,
    band: Band,
    before: Solution,
    solved: Callable[[Sequence[Equations]], Solution],
) -> Array:
    """Return the travel of each drive's friction with which its torque is most likely, shape (n,) [rad] or [m].

    All of its friction turns over it here, for the area of a pulse does not tell its height from its length: Coulomb
    friction, and in proportion what the torque that is passed on adds in the mean.

    Args:
        equations: Of stretches.
        layout: Of the parameters.
        prior: Of the parameters.
        band: The filter that they passed.
        before: Parameters with friction that turns at once.
        solved: From equations to parameters, delay and weights.
    """

    def likeliest(tried: Array, beside: Array) -> Array:
        """Return the likeliest of K travels of each drive, shape (K, n), in even steps of their logarithm."""
        now, columns = (
            [share * added for added in _columns(equations, travel, band)] for travel in (beside[None], tried)
        )
        solution = solved([_turning(part, x[:, 0]) for part, x in zip(equations, now, strict=True)])
        best = np.zeros(layout.n)
        for j, (one, where) in enumerate(zip(solution.drives, coulomb, strict=True)):
            more = [(new - old)[part.moves[:, j], :, j] for part, new, old in zip(equations, columns, now, strict=True)]
            with_it = (_with_more(solution, one.rows, int(where), column) for column in np.concatenate(more).T)
            best[j] = _top(np.array([log_evidence(normal, prior, solution.widths) for normal in with_it]))
        return np.asarray(tried[0] * (tried[1] / tried[0]) ** best)

    coulomb = np.arange(layout.size)[layout.of_drives("coulomb")]
    share = np.array([_whole(before, layout, drive) for drive in range(layout.n)])
    first = likeliest(np.outer(TRAVELS, np.ones(layout.n)), np.zeros(layout.n))
    return likeliest(np.outer((TRAVELS[1] / TRAVELS[0]) ** NEARER, first), first)


def level_of(rows: DriveRows, layout: Layout) -> Array:
    """Return what a drive's friction is made of about its turns, shape (p,): Coulomb friction, and that by the load."""
    level = np.zeros(layout.size)
    coulomb, load = (np.arange(layout.size)[layout.of_drives(name)][rows.drive] for name in ("coulomb", "load"))
    level[coulomb] = 1.0
    level[load] = np.mean(np.abs(rows.constant[:, rows.index == load])) if len(rows) else 0.0
    return level


def _whole(solution: Solution, layout: Layout, drive: int) -> float:
    """Return a drive's friction about its turns, as a share of its Coulomb friction."""
    coulomb = float(solution.parameters[layout.of_drives("coulomb")][drive])
    whole = float(level_of(solution.drives[drive].rows, layout) @ solution.parameters)
    return whole / coulomb if coulomb > 0 else 1.0


def _top(values: Array) -> float:
    """Return where values are largest, from a parabola through the three there, in steps between them."""
    k = int(np.argmax(values))
    if not 0 < k < len(values) - 1:
        return float(k)
    before, here, after = values[k - 1 : k + 2]
    bend = before - 2 * here + after
    return float(k + (before - after) / (2 * bend)) if bend < 0 else float(k)


def _columns(equations: Sequence[Equations], travel: Array, band: Band) -> list[Array]:
    """Return z - sign(v) for K travels of each drive, shape (K, n): of each stretch shape (T, K, n), thinned.

    Without a travel, friction turns at once.
    """
    found = []
    for part in equations:
        position, velocity, _ = band.smooth(part.samples)
        late = turned(position, np.where(travel > 0, travel, 1.0)) - np.sign(velocity)[:, None]
        found.append(band.filtered(np.where(travel > 0, late, 0.0), part.samples))
    return found


def _turning(equations: Equations, columns: Array) -> Equations:
    """Return equations in which Coulomb friction turns late, with its column, shape (T, n)."""
    drives = equations.drives.copy()
    drives[:, :, COULOMB] += columns
    return replace(equations, drives=drives)


def _with_more(solution: Solution, rows: DriveRows, where: int, more: Array) -> Normal:
    """Return the normal equations with more in one column of a drive, shape (R,)."""
    one = solution.drives[rows.drive]
    gram, right = solution.normal.gram.copy(), solution.normal.right.copy()
    gained = one.weight * (one.factors.T @ more)
    gram[where, rows.index] += gained
    gram[rows.index, where] += gained
    gram[where, where] += one.weight * float(more @ more)
    right[where] += one.weight * float(more @ one.response(solution.delay))
    return Normal(gram, right)
