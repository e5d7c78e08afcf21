"""Numbers in sentences."""

import pytest

from bench.identification.wording import with_error


@pytest.mark.parametrize(
    ("value", "std", "said"),
    [
        (3.30119, 0.00149, "3.3012 ± 0.0015"),
        (-0.0018, 0.13, "0.00 ± 0.13"),
        (2.4721, 0.27, "2.47 ± 0.27"),
        (0.0018, 8.7e-7, "0.00180000 ± 0.00000087"),
        (3.5, 0.0996, "3.50 ± 0.10"),
        (1234.5, 67.8, "1234 ± 68"),
        (3.1234567, 0.0, "3.123"),
        (3.1234567, float("inf"), "3.123"),
    ],
)
def test_a_value_has_the_digits_of_its_error(value: float, std: float, said: str) -> None:
    assert with_error(value, std) == said
