import io

from harness.runs.progress import Bars, Lines, Silent, clock_time, progress_for


def test_plain_lines_are_few_and_tell_the_time_left():
    out, now = io.StringIO(), [0.0]
    lines = Lines(out, clock=lambda: now[0])
    lines.begin(["a", "b"], [1.0, 1.0])
    for second in range(201):
        now[0] = float(second)
        lines.running(0, second / 200)
    lines.done(0, "a: completed")
    lines.end()
    assert out.getvalue().splitlines() == [
        "a: started",
        *[f"a: {s // 2}%, {clock_time(s)} elapsed, {clock_time(200 - s)} left" for s in range(20, 201, 20)],
        "[1/2] a: completed",
    ]


def test_a_slow_job_is_not_silent_for_long():
    out, now = io.StringIO(), [0.0]
    lines = Lines(out, clock=lambda: now[0])
    lines.begin(["a"], [1.0])
    for second in range(125):
        now[0] = float(second)
        lines.running(0, 0.0)
    assert out.getvalue().splitlines() == ["a: started", "a: 0%, 0:01:00 elapsed", "a: 0%, 0:02:00 elapsed"]


def test_bars_show_each_running_job_and_all():
    out = io.StringIO()
    bars = Bars(out, force_terminal=True, width=100)
    bars.begin(["box [x]", "ring"], [3.0, 1.0])
    bars.running(0, 0.5)
    bars._bars.refresh()
    assert "box [x]" in out.getvalue()
    assert "50%" in out.getvalue()
    assert "38%" in out.getvalue()  # (3 * 0.5) / 4 of all
    bars.done(1, "ring: completed [1]")
    bars.done(0, "box: completed")
    bars.end()
    assert "ring: completed [1]" in out.getvalue()
    assert "100%" in out.getvalue()


def test_a_terminal_gets_bars_and_a_file_lines():
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    assert isinstance(progress_for(Terminal()), Bars)
    assert isinstance(progress_for(io.StringIO()), Lines)


def test_silent_takes_all_calls():
    silent = Silent()
    silent.begin(["a"], [1.0])
    silent.running(0, 0.1)
    silent.done(0, "")
    silent.end()
