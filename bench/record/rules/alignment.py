"""Clocks of two records against each other: an effect does not come before its cause."""

from collections.abc import Iterator

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from bench.record.campaign import Array
from bench.record.finding import Finding
from bench.record.rules.sheet import Sheet

# Encoder delay and sampling explain 5 ms, the phase lead of a good servo a few more. The motor of an ordinary drive is
# 20 to 100 ms behind its command, never ahead.
LEAD_S = 0.02
SEARCH_S = 0.5
SMALL = 1e5  # numbers; so few are compared directly
BLOCK = 4096  # samples of one Fourier transform
LOST = 1e-10  # of the variances, at most, that their difference loses to rounding
N_LAGS = 100  # at most; longer tables are thinned
BETTER = 0.7  # the shift must explain half of the variance of the difference, or the shapes differ for another reason


def leads(sheet: Sheet) -> Iterator[Finding]:
    """In a motion, no motor moves before its command, and both encoders of a joint move together."""
    time = sheet.get("time_s")
    if sheet.run.kind != "motion" or time is None or len(time) < 2 * N_LAGS:
        return
    step = float(np.median(np.diff(time)))
    for column, values in sheet.columns("q_motor", "q_link"):
        source = sheet.joint(column.index, "q_cmd" if column.channel.quantity == "q_motor" else "q_motor")
        if source is None or not sheet.moves(source[0].name) or not sheet.moves(column.name):
            continue
        ahead = _lead(values, source[1], step)
        if ahead > LEAD_S or (ahead < -LEAD_S and column.channel.quantity == "q_link"):
            order = "ahead of" if ahead > 0 else "behind"
            message = f"runs {abs(ahead):.2g} s {order} {source[0].name}"
            yield sheet.warning(column.name, message, "were both recorded by one clock, and is the command complete?")


def least_misfit(values: Array, source: Array, step: float) -> float:
    """Return the standard deviation of the difference that the best shift in time leaves, of half a second at most.

    Args:
        values: Shape (n,), an angle.
        source: Shape (n,), what it follows.
        step: From row to row [s].
    """
    misfits, _, _ = _misfits(values, source, step)
    return float(np.min(misfits))


def _lead(values: Array, source: Array, step: float) -> float:
    """Return by how much `values` is ahead of `source` [s]; 0 where a shift does not explain the difference."""
    misfits, span, step = _misfits(values, source, step)
    best = int(np.argmin(misfits))
    return (best - span) * step if bool(misfits[best] < BETTER * misfits[span]) else 0.0


def _misfits(values: Array, source: Array, step: float) -> tuple[Array, int, float]:
    """Return what shifts by -span, ..., span samples leave, shape (2 span + 1,), and the span and step [s] of those."""
    every = max(1, round(SEARCH_S / step / N_LAGS))
    values, source, step = values[::every], source[::every], step * every
    span = min(N_LAGS, int(SEARCH_S / step), len(values) // 4)
    middle = slice(span, len(values) - span)
    shifted = sliding_window_view(values, len(values) - 2 * span)[::-1]  # by -span, ..., span samples
    if shifted.size < SMALL:
        misfits = np.std(source[middle] - shifted, axis=1)
    else:
        misfits = np.full(len(shifted), np.inf)
        for lag in {*_likely(source[middle], shifted).tolist(), span}:
            misfits[lag] = np.std(source[middle] - shifted[lag])
    return misfits, span, step


def _likely(source: Array, shifted: Array) -> NDArray[np.intp]:
    """Return the lags at which the difference may be smallest; shapes (n,) and (n_lags, n).

    By var(s - v) = var(s) + var(v) - 2 cov(s, v): fast for all lags, but not exact where they nearly agree.
    """
    n_lags, n = shifted.shape
    line = np.concatenate([shifted[-1], shifted[:-1, -1][::-1]]) - shifted[-1].mean()  # as it was before it was shifted
    source = source - source.mean()
    sums, squares = (np.concatenate([[0.0], np.cumsum(part)]) for part in (line, line**2))
    mean, square = ((part[n:] - part[:-n])[::-1] / n for part in (sums, squares))
    variances = float(np.mean(source**2)) + square - mean**2
    misfits = variances - 2 * _products(source, line, n_lags)[::-1] / n
    return np.flatnonzero(misfits <= misfits.min() + LOST * square.max())


def _products(source: Array, line: Array, n_lags: int) -> Array:
    """Return sum_i source[i] line[i + k] for k = 0 to n_lags - 1, block by block through Fourier space."""
    step = BLOCK - n_lags
    n_blocks = -(-len(source) // step)
    sources = np.pad(source, (0, n_blocks * step - len(source))).reshape(n_blocks, step)
    lines = sliding_window_view(np.pad(line, (0, n_blocks * step + n_lags - len(line))), BLOCK)[::step][:n_blocks]
    spectrum = (np.fft.rfft(lines, axis=1) * np.fft.rfft(sources, BLOCK, axis=1).conj()).sum(axis=0)
    products: Array = np.fft.irfft(spectrum, BLOCK)[:n_lags]
    return products
