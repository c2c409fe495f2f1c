import threading

import pytest

from hyperleg_design.gap.inference.threads import spread


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_results_stand_in_the_order_of_the_items(threads):
    later = threading.Event()

    def job(number):
        if threads > 1 and number == 0:
            later.wait(5.0)  # the first item ends last
        elif number == 1:
            later.set()
        return number**2

    assert spread(job, range(4), threads) == [0, 1, 4, 9]


def test_an_error_of_one_item_is_raised():
    with pytest.raises(ZeroDivisionError):
        spread(lambda number: 1 / number, [1, 0, 2], 2)
