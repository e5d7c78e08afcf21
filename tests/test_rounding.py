"""What hangs on rounding shows on one processor and not on another: none of the answers may."""

import numpy as np

from bench.estimate.partial import PartialRegression


def test_what_rounding_leaves_of_a_column_explains_nothing():
    random = np.random.default_rng(3)
    rows, model = 120, random.normal(size=(120, 4))
    basis, _ = np.linalg.qr(model)
    target = random.normal(size=rows)
    left = PartialRegression(
        basis, target - basis @ (basis.T @ target), np.ones(2), np.ones((rows // 2, 2), bool)
    )
    new = random.normal(size=rows)
    alone, explained = left.explained(new.reshape(-1, 2, 1))
    taken_up = model @ random.normal(size=4)  # but for rounding
    both, with_it = left.explained(np.column_stack((taken_up, new)).reshape(-1, 2, 2))
    np.testing.assert_allclose(both, [0.0, alone[0]], rtol=1e-12)
    assert abs(with_it / explained - 1.0) < 1e-12
