"""The bar of costs in the studio: three choices, time on request, stale figures go."""

from tests.editor.studio_page import SETTLED, SLOW_MS, studio
from tests.editor.test_line_costs import HEAVY

FIGURES = (
    "() => [...document.querySelectorAll('.costs .runs')].map((e) => [e.textContent, e.title])"
)
NONE = "() => !document.querySelector('.costs .runs')"
SOME = "() => document.querySelector('.costs .runs')"


def figures(app):
    app.wait(SOME)
    return app.page.evaluate(FIGURES)


def about(app):
    return app.page.locator(".cost-about").inner_text()


def test_runs_work_and_time_are_shown_apart_and_go_when_something_changes(tmp_path):
    with studio(tmp_path, HEAVY) as app:
        page = app.page
        page.evaluate(SETTLED)
        page.get_by_role("button", name="Cost").click()
        runs = figures(app)
        assert all(title.startswith("Runs ") for _, title in runs)
        assert "150" in [text for text, _ in runs]
        assert page.get_by_role("button", name="Measure").count() == 0

        page.get_by_label("Work (estimated)").check()
        app.wait("() => /^(About|Computes) /.test(document.querySelector('.runs')?.title)")
        work = figures(app)
        assert all("estimate" in title or "once a frame" in title for _, title in work)
        page.evaluate("() => studio.editor.goTo(14)")
        assert about(app).startswith("Line 14: About ")
        assert page.locator(".runs.hot").count() <= 3

        page.get_by_label("Time (measured)").check()
        assert page.evaluate(NONE)
        assert about(app).startswith("The part of the picture's time")
        page.get_by_role("button", name="Measure").click()
        # Two compilations and fifteen draws a line: minutes where other work has the processor.
        page.wait_for_function("() => studio.costs.times", timeout=4 * SLOW_MS)
        # Which is the largest is tested by the time of the CPU: here other work may disturb it.
        lines = page.evaluate("() => studio.costs.times.lines.get('scene.py')")
        assert {line["line"] for line in lines} == {7, 12, 13, 14, 15, 16}
        assert all("ms ±" in title for _, title in figures(app))

        # A value, the camera or the text: what was measured is of another picture.
        page.evaluate("() => studio.picture.player.setTime(1.5)")
        app.wait(NONE)
        assert about(app) == "Something has changed since: measure again."
        page.get_by_label("Runs").check()
        figures(app)
        page.evaluate("() => studio.editor.goTo(1)")
        page.keyboard.type("# more\n")
        assert page.evaluate(NONE)
        app.idle()
        figures(app)
        page.get_by_role("button", name="Cost").click()
        assert not page.locator(".cost-bar").is_visible()


def test_measuring_can_be_stopped(tmp_path):
    with studio(tmp_path, HEAVY) as app:
        page = app.page
        page.evaluate(SETTLED)
        page.get_by_role("button", name="Cost").click()
        figures(app)
        page.get_by_label("Time (measured)").check()
        page.get_by_role("button", name="Measure").click()
        page.get_by_role("progressbar", name="Lines measured").wait_for()
        page.get_by_role("button", name="Stop").click()
        assert about(app) == "Stopped."
        assert page.get_by_role("button", name="Measure").is_visible()
        # The picture is drawn again.
        page.evaluate("() => studio.picture.player.setTime(2)")
        page.evaluate(SETTLED)
        assert page.evaluate("() => studio.costs.times") is None


def test_repetitions_change_no_byte_in_the_browser(tmp_path):
    drawn = """async () => {
      const files = { "scene.py": studio.editor.view.state.doc.toString() };
      const asked = { kind: "time", revision: 1, files, main: "scene.py" };
      const answer = await studio.client.ask(asked);
      const { program, choice, repeats, places } = answer.result;
      const { player } = studio.picture;
      const bytes = async (place, count) => {
        const fragment = program.fragment.replace(choice, choice.replace(/-1$/, place));
        const source = { ...program, fragment };
        const read = await player.drawn(source, { [repeats]: count }, [32, 24]);
        player.forget(source);
        return String(read);
      };
      const whole = await bytes(-1, 1);
      const changed = [];
      for (let n = 0; n < places.length; n++)
        for (const place of [n, -2 - n])
          if ((await bytes(place, 3)) !== whole) changed.push(place);
      return [changed, places.length, new Set(whole.split(",")).size];
    }"""
    with studio(tmp_path, HEAVY) as app:
        app.page.evaluate(SETTLED)
        changed, places, colors = app.page.evaluate(drawn)
    assert changed == []
    assert places >= 6 and colors > 20
