"""Work beside work: order, bounds, failures on either side."""

import threading
import time

import pytest

from distal.video.overlap import WAITING, made_ahead, taking


def test_all_items_are_taken_in_order_elsewhere():
    taken, threads = [], set()

    def take(item):
        taken.append(item)
        threads.add(threading.current_thread())

    with taking(take) as taker:
        for i in range(50):
            taker.put(i)
    assert taken == list(range(50))
    assert threading.current_thread() not in threads


def test_only_a_few_wait():
    gate, put = threading.Event(), []

    def fill(taker):
        for i in range(20):
            taker.put(i)
            put.append(i)

    with taking(lambda item: gate.wait()) as taker:
        feeder = threading.Thread(target=fill, args=(taker,))
        feeder.start()
        time.sleep(0.3)
        assert len(put) == WAITING + 1  # those that wait, and one being worked on
        gate.set()
        feeder.join()


def test_both_sides_work_at_once():
    working, go_on = threading.Event(), threading.Event()

    def take(item):
        working.set()
        assert go_on.wait(10), "who puts waits for who takes"

    with taking(take) as taker:
        taker.put(0)
        assert working.wait(10)
        go_on.set()  # said by who puts, amid the other's work


def test_a_failure_of_the_taker_reaches_who_puts():
    def take(item):
        if item == 3:
            raise OSError("disk full")

    with pytest.raises(OSError, match="disk full"), taking(take) as taker:
        for i in range(1000):
            taker.put(i)


def test_a_failure_with_the_last_item_is_not_lost():
    def take(item):
        raise OSError("disk full")

    with pytest.raises(OSError, match="disk full"), taking(take) as taker:
        taker.put(1)


def test_a_failure_of_the_maker_drops_what_waits():
    taken, gate = [], threading.Event()

    def take(item):
        gate.wait(0.05)
        taken.append(item)

    before = threading.active_count()
    with pytest.raises(KeyboardInterrupt), taking(take) as taker:
        for i in range(4):
            taker.put(i)
        raise KeyboardInterrupt
    assert len(taken) <= 1
    assert threading.active_count() == before


def test_several_take_at_once():
    together = threading.Barrier(3, timeout=60.0)
    with taking(lambda item: together.wait(), workers=3) as taker:
        for i in range(3):
            taker.put(i)


def test_what_is_made_ahead_comes_in_order():
    gate = threading.Event()

    def make(i):
        if i == 0:
            assert gate.wait(60.0)  # the first is ready last
        else:
            gate.set()
        return i * i

    stopped = []
    assert list(made_ahead(make, range(7), 3, lambda: stopped.append(1))) == [
        0, 1, 4, 9, 16, 25, 36
    ]  # fmt: skip
    assert stopped == []


def test_no_more_is_made_ahead_than_was_asked_for():
    begun = []
    made = made_ahead(lambda i: begun.append(i) or i, range(100), 2, lambda: None)
    assert next(made) == 0
    assert sorted(begun) in ([0], [0, 1])
    made.close()


def test_leaving_early_ends_what_is_being_made():
    ended = threading.Event()

    def make(i):
        assert i == 0 or ended.wait(10.0)
        return i

    made = made_ahead(make, range(50), 2, ended.set)
    assert next(made) == 0
    made.close()  # would wait for ten seconds
    assert ended.is_set()


def test_a_failure_comes_in_its_turn_and_ends_the_rest():
    def make(i):
        if i == 3:
            raise TimeoutError("of its own")  # not the wait's
        return i

    found, stopped = [], []
    with pytest.raises(TimeoutError, match="of its own"):
        for i in made_ahead(make, range(10), 3, lambda: stopped.append(1)):
            found.append(i)
    assert found == [0, 1, 2] and stopped == [1]
