"""Three stores for one square matrix: dense, LAPACK band, compressed columns. Each maps an entry (row, column) to a slot of a flat
buffer, so that assembling is the same bincount for all, and factorises a filled buffer.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import lapack

Index = NDArray[np.intp]
Solve = Callable[[NDArray], NDArray]


class Singular(ArithmeticError):
    """A matrix without inverse, to working precision."""


def dense(rows: Index, cols: Index, values: NDArray, shape: tuple[int, int]) -> NDArray:
    """The matrix [..., *shape] of values [..., entries] on a pattern; repeated entries are summed."""
    out = np.zeros((*values.shape[:-1], *shape))
    np.add.at(out, (..., rows, cols), values)  # type: ignore[arg-type]  # the stubs do not know an ellipsis
    return out


class Format(Protocol):
    name: str
    slots: int

    def slot(self, rows: Index, cols: Index) -> Index:
        """Where entries go in the buffer [slots]."""

    def factor(self, buffer: NDArray) -> Solve:
        """The solver for right sides [size] or [size, k], which it may overwrite; raises Singular on a zero pivot."""

    def norm(self, buffer: NDArray) -> float:
        """The largest column sum of magnitudes."""


def _norm(columns: NDArray) -> float:
    lange = lapack.zlange if np.iscomplexobj(columns) else lapack.dlange
    return float(lange("1", columns))


def _check(info: int) -> None:
    if info > 0:
        raise Singular(f"zero pivot {info}")
    assert info == 0, f"LAPACK refused argument {-info}"


INVERTED = 64
"""Unknowns up to which several right sides are multiplied by the inverse: one call in place of one for each."""


class Dense:
    name = "dense"

    def __init__(self, size: int):
        self.size, self.slots = size, size * size

    def slot(self, rows: Index, cols: Index) -> Index:
        return cols * self.size + rows

    def factor(self, buffer: NDArray) -> Solve:
        complex_ = np.iscomplexobj(buffer)
        getrf, getrs, getri = (getattr(lapack, ("z" if complex_ else "d") + name) for name in ("getrf", "getrs", "getri"))
        lu, pivots, info = getrf(buffer.reshape(self.size, self.size).T, overwrite_a=1)
        _check(info)
        inverse: NDArray | None = None

        def solve(b: NDArray) -> NDArray:
            nonlocal inverse
            if b.ndim == 1:
                return getrs(lu, pivots, b, overwrite_b=1)[0]
            if self.size > INVERTED:
                # Column by column: OpenBLAS starts threads for several right sides of any size, which costs milliseconds on a busy machine.
                return np.stack([getrs(lu, pivots, column)[0] for column in b.T], axis=1)
            if inverse is None:
                inverse, info = getri(lu, pivots)
                _check(info)
            return inverse.dot(b)

        return solve

    def norm(self, buffer: NDArray) -> float:
        return _norm(buffer.reshape(self.size, self.size).T)


class Band:
    name = "band"

    def __init__(self, size: int, half: int):
        self.size, self.half = size, half
        self.height = 3 * half + 1
        self.slots = size * self.height

    def slot(self, rows: Index, cols: Index) -> Index:
        return cols * self.height + 2 * self.half + rows - cols

    def factor(self, buffer: NDArray) -> Solve:
        complex_ = np.iscomplexobj(buffer)
        gbtrf, gbtrs = (lapack.zgbtrf, lapack.zgbtrs) if complex_ else (lapack.dgbtrf, lapack.dgbtrs)
        k = self.half
        lu, pivots, info = gbtrf(buffer.reshape(self.size, self.height).T, k, k, overwrite_ab=1)
        _check(info)
        return lambda b: gbtrs(lu, k, k, b, pivots, overwrite_b=1)[0]

    def norm(self, buffer: NDArray) -> float:
        return _norm(buffer.reshape(self.size, self.height).T)


class Sparse:
    name = "sparse"

    def __init__(self, size: int, rows: Index, cols: Index):
        self.size = size
        self.keys = np.unique(cols * size + rows)
        self.slots = self.keys.size
        self.rows = (self.keys % size).astype(np.int32)
        self.starts = np.searchsorted(self.keys, np.arange(size + 1) * size).astype(np.int32)

    def slot(self, rows: Index, cols: Index) -> Index:
        return np.searchsorted(self.keys, cols * self.size + rows)

    def _matrix(self, buffer: NDArray) -> Any:
        from scipy.sparse import csc_array

        return csc_array((buffer, self.rows, self.starts), shape=(self.size, self.size))

    def factor(self, buffer: NDArray) -> Solve:
        from scipy.sparse.linalg import splu

        try:
            lu = splu(self._matrix(buffer), permc_spec="COLAMD")
        except RuntimeError as error:
            raise Singular(str(error)) from None
        return lambda b: lu.solve(np.asarray(b, dtype=buffer.dtype))

    def norm(self, buffer: NDArray) -> float:
        return float(np.add.reduceat(np.abs(buffer), self.starts[:-1]).max())


DENSE_FLOPS, BAND_FLOPS = 4e9, 2.5e9  # sustained, of dgetrf and dgbtrf at the sizes that matter here
CALL, SPARSE_CALL, SPARSE_EACH = 5e-6, 1.2e-4, 8e-7  # seconds: a LAPACK call, a SuperLU call, its time for an unknown


def cheapest(size: int, half: int, rows: Index, cols: Index) -> Format:
    """The format whose factorisation should take the least time, from the measured constants above."""
    seconds = {
        "dense": CALL + 2.0 / 3.0 * size**3 / DENSE_FLOPS,
        "band": CALL + 4.0 * size * half * (half + 2.0) / BAND_FLOPS + 5e-8 * size,
        "sparse": SPARSE_CALL + SPARSE_EACH * size,
    }
    best = min(seconds, key=seconds.__getitem__)
    if best == "dense":
        return Dense(size)
    return Band(size, half) if best == "band" else Sparse(size, rows, cols)
