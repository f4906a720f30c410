"""What readings have in common, taken out of values and put back.

Values whose covariance is I + C C' are white after I - U diag(s) U', with the left singular vectors U of C, its
singular values c, and s = 1 - 1 / sqrt(1 + c^2).
"""

import numpy as np
from scipy.linalg import svd

from bench.record.campaign import Array

TINY = 1e-9  # rounding: of the largest mode; smaller ones are none


def modes_of(common: Array) -> tuple[Array, Array]:
    """Return orthonormal modes U, shape (m, r), and by how much each is taken back, s, shape (r,).

    Args:
        common: C, shape (m, k).
    """
    if not np.any(common):
        return np.zeros((len(common), 0)), np.zeros(0)
    modes, size = left_modes(common)
    kept = size > TINY * size[0]
    return modes[:, kept], 1 - 1 / np.sqrt(1 + size[kept] ** 2)


def left_modes(matrix: Array) -> tuple[Array, Array]:
    """Return the left singular vectors of a matrix, shape (m, r), and its singular values, falling, shape (r,).

    Args:
        matrix: Shape (m, k); r is the lesser of both.
    """
    try:
        modes, size, _ = np.linalg.svd(matrix, full_matrices=False)
    except np.linalg.LinAlgError:  # LAPACK's gesdd, which is fast, gives up on some matrices of finite numbers
        modes, size, _ = svd(matrix, full_matrices=False, lapack_driver="gesvd")
    return modes, size


def take_out(white: Array, modes: Array, shrink: Array) -> None:
    """Take what is common out of values, shape (m, k), in place."""
    if len(shrink):
        white -= modes @ (shrink[:, None] * (modes.T @ white))


def put_back(white: Array, modes: Array, shrink: Array) -> None:
    """Put what is common back into values, shape (m, k), in place."""
    if len(shrink):
        stretch = shrink / (1 - shrink)
        white += modes @ (stretch[:, None] * (modes.T @ white))
