"""Spectra of discrepancy columns against inverse matrices."""

from __future__ import annotations

import numpy as np
import pytest

from hyperleg_design.gap.inference.channels.spectrum import Spectrum


@pytest.mark.parametrize(("known", "steady"), [(0, 0), (0, 2), (1, 2)])
def test_what_is_left_of_the_products_is_that_of_the_inverse(known, steady):
    rng = np.random.default_rng(3)
    roots = rng.standard_normal((3, 5, 4))
    products = roots @ roots.swapaxes(1, 2)
    tested = np.array([True, False, False])
    spectrum = Spectrum(products, tested, steady, known)
    standing = np.where(np.arange(5) < known, 1.0, 0.7)
    changing = np.diag(np.arange(5) >= steady).astype(float)
    cross = rng.standard_normal((3, 5, 2))
    for new in (1.0, 3.0):
        change = np.where(tested, 0.4 * new, 0.4)
        inverse = np.linalg.inv(np.eye(5) + products @ (change[:, None, None] ** 2 * changing))
        expected = (inverse @ products).sum(0)
        np.testing.assert_allclose(spectrum.gram(change), expected, atol=1e-10)
        factor = spectrum.factor(change, np.log(0.7))
        whole = np.eye(5) + standing[:, None] * expected * standing
        np.testing.assert_allclose(factor @ factor.T, whole, atol=1e-10)
        left = spectrum.left(change, cross, spectrum.turned(cross))
        np.testing.assert_allclose(left, (inverse @ cross).sum(0), atol=1e-10)
