"""What Python can do to the module meanwhile: threads, signals, arrays that change, results that live on."""
import gc
import signal
import threading

import numpy as np
import pytest
from test_python import CLEAR, detector, states

import collision_pairs as cp


def test_results_outlive_what_they_were_made_from():
    given = states()
    result = detector().check(given, alarm_distance=1.0, gradient=True)
    expected = [array.copy() for array in (result.pairs, result.min_distance, result.gradient)]
    kept = result.pairs, result.min_distance, result.gradient
    del result, given
    gc.collect()
    detector().check(states(2000), alarm_distance=1.0, gradient=True)  # what writes where it may not
    for array, copied in zip(kept, expected):
        np.testing.assert_array_equal(array, copied)


def test_two_threads_on_one_detector_both_get_their_own_answers():
    tested, given, wrong = detector(), states(2000), []

    def check(low):
        part = given[low::2]
        for _ in range(20):
            result = tested.check(part, alarm_distance=1.0)
            if not np.allclose(result.min_distance, part[:, 1] - 0.15, atol=1e-12):
                wrong.append(low)
    threads = [threading.Thread(target=check, args=(low,)) for low in (0, 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong == []


def test_other_threads_run_during_a_batch():
    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1
    thread = threading.Thread(target=count)
    tested, given = detector(threads=1), np.tile(states(1000), (200, 1))
    thread.start()
    before = counted[0]
    tested.check(given)
    during = counted[0] - before
    done.set()
    thread.join()
    assert during > 0


def during_a_check(given, action):
    """Runs the action as a signal handler, which Python does in the middle of the check."""
    done = []
    before = signal.signal(signal.SIGALRM, lambda *_: done.append(action()))
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.01)
        result = None
        while not done:
            result = DETECTOR_IN_USE.check(given)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)
    return result


DETECTOR_IN_USE = detector(threads=1)


def test_a_check_can_be_interrupted_and_repeated():
    def stop():
        raise KeyboardInterrupt
    with pytest.raises(KeyboardInterrupt):
        during_a_check(np.tile(states(1000), (1500, 1)), stop)
    assert DETECTOR_IN_USE.check([0, CLEAR]).verdict == cp.Verdict.FREE


def test_the_detector_that_is_in_use_cannot_be_used_by_a_signal_handler():
    with pytest.raises(cp.InputError, match="already in use by this thread"):
        during_a_check(np.tile(states(1000), (1500, 1)), lambda: DETECTOR_IN_USE.check([0, CLEAR]))
    assert DETECTOR_IN_USE.check([0, CLEAR]).verdict == cp.Verdict.FREE


@pytest.mark.parametrize("view", (lambda a: a, lambda a: a[::2], lambda a: a.T[::-1].T))
def test_an_array_that_is_being_checked_cannot_be_resized(view):
    given = np.tile(states(1000), (1500, 1)) + 0.0
    with pytest.raises(ValueError, match="cannot resize"):
        during_a_check(view(given), lambda: given.resize((1, 2), refcheck=False))


def test_numbers_written_during_a_check_are_read_or_not_and_nan_is_found():
    given, stop = np.tile(states(1000), (20, 1)), threading.Event()

    def write():
        while not stop.is_set():
            given[:, 1] = 0.3
            given[:, 1] = np.nan
    thread = threading.Thread(target=write)
    thread.start()
    refused = 0
    try:
        for _ in range(20):
            try:
                result = detector().check(given, alarm_distance=1.0)
                assert not np.isnan(result.min_distance).any()
            except cp.InputError as error:
                refused += "not finite" in str(error)
    finally:
        stop.set()
        thread.join()
    assert refused > 0
