"""Times by callee, on a clock that only goes on when a function says so."""

from __future__ import annotations

import sys
import threading
import time
from functools import partial

import pytest

from mala_drake.errors import BadInput
from mala_drake.experiments import callee_times as mut


@pytest.fixture
def spent():
    """Seconds that have been spent: `append` is compiled, so it is nobody's callee."""
    return []


@pytest.fixture
def write(spent):
    """Makes a function out of its body, which stands in a file of its own."""

    def make(file, *body, **names):
        names["spend"] = spent.append
        exec(compile("\n    ".join(("def function(*arguments):", *body)), file, "exec"), names)
        return names["function"]

    return make


@pytest.fixture
def measure(spent):
    return partial(mut.time_callees, clock=lambda: sum(spent))


def test_what_a_callee_calls_counts_for_it_and_what_compiled_code_calls_is_a_callee(write, measure):
    inner = write("inner.py", "spend(4)")
    outer = write("outer.py", "spend(2)", "inner()", inner=inner)
    function = write(
        "function.py", "spend(1)", "outer()", "list(map(inner, 'ab'))", "return 7", outer=outer, inner=inner
    )
    result, times = measure(function)
    assert result == 7
    assert times == mut.CalleeTimes(1 + 6 + 8, {"outer.py": 6, "inner.py": 8})


def test_a_partial_is_not_a_call_of_its_own(write, measure):
    function = write("function.py", "spend(1)", "return arguments")
    assert measure(partial(function, 2, 3)) == ((2, 3), mut.CalleeTimes(1, {}))


def test_the_count_of_calls_comes_out_right_after_exceptions_and_generators(write, measure):
    fail = write("fail.py", "spend(1)", "1 / 0")
    count = write("count.py", "spend(2)", "yield", "spend(4)", "yield", "spend(8)")
    fails = write(
        "fails.py",
        "try: fail()",
        "except ZeroDivisionError: pass",
        "steps = [count() for _ in range(3)]",
        "for each in steps: next(each)",
        "try: steps[0].throw(KeyError)",
        "except KeyError: pass",
        "steps[1].close()",
        "list(steps[2])",
        "spend(100)",
        "fail()",
        fail=fail,
        count=count,
    )
    around = write("around.py", "try: fails()", "except ZeroDivisionError: spend(1000)", fails=fails)
    _, times = measure(around)
    assert times == mut.CalleeTimes(1 + 3 * 2 + 4 + 8 + 100 + 1 + 1000, {"fails.py": 120})
    _, times = measure(write("step.py", "list(count())", "spend(100)", count=count))
    assert times == mut.CalleeTimes(114, {"count.py": 14})


def test_a_thread_that_leaves_and_one_that_enters_a_function_meanwhile_change_nothing(write, measure):
    inside, leave, inside_too, end = (threading.Event() for _ in range(4))

    def wait_in_a_function(entered, event):
        entered.set()
        event.wait()

    first = threading.Thread(target=wait_in_a_function, args=(inside, leave))
    second = threading.Thread(target=wait_in_a_function, args=(inside_too, end))
    first.start()
    inside.wait()

    def others():
        leave.set()
        first.join()
        second.start()
        inside_too.wait()

    callee = write("callee.py", "spend(1)")
    function = write("function.py", "callee()", "others()", "callee()", "spend(2)", callee=callee, others=others)
    try:
        _, times = measure(function)
    finally:
        end.set()
        second.join()
    assert times == mut.CalleeTimes(4, {"callee.py": 2, __file__: 0})


def test_the_clock_is_the_processor_time_of_this_thread():
    before = time.thread_time()
    _, times = mut.time_callees(lambda: sum(range(100_000)))
    assert 0.0 < times.whole <= time.thread_time() - before


def test_an_error_comes_through_and_no_profiler_stays(measure):
    with pytest.raises(ZeroDivisionError):
        measure(lambda: 1 / 0)
    assert sys.getprofile() is None


def test_two_profilers_in_one_thread_are_refused(measure):
    def other(*_):
        pass

    sys.setprofile(other)
    try:
        with pytest.raises(BadInput, match="profiler: this thread is being profiled already"):
            measure(int)
        assert sys.getprofile() is other
    finally:
        sys.setprofile(None)


def test_times_that_are_not_whole_are_an_error(measure):
    with pytest.raises(RuntimeError, match="taken away before the call ended"):
        measure(lambda: sys.setprofile(None))
