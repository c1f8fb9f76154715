"""A lesson's page in a browser: buttons, sliders, layers, goals, keys, themes, phones."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path

import pytest

from distal.lessons.page import LessonLinks, write
from tests.accessibility import needs_axe, violations
from tests.browser import BrowserUnavailableError, offline_page

ROOT = Path(__file__).parents[2]
DESK = {"viewport": {"width": 1280, "height": 860}}
PHONE = {"viewport": {"width": 390, "height": 844}, "has_touch": True, "is_mobile": True}
STILL_MS = 60_000  # software WebGL on a loaded machine

_READY = "() => document.querySelector('.picture [data-distal]')?.distal"
_SETTLE = "() => document.querySelector('.picture [data-distal]').distal.settled()"
_VALUES = "() => document.querySelector('.picture [data-distal]').distal.parameters()"
_VIEW = "() => document.querySelector('.picture [data-distal]').distal.view"


@pytest.fixture(scope="module")
def pages(tmp_path_factory) -> dict[int, Path]:
    folder = tmp_path_factory.mktemp("lessons")
    links = LessonLinks("index.html", ("5.html", "Normals"), ("7.html", "Materials"), "edit.html")
    made = {}
    for file in sorted((ROOT / "lessons").glob("0[69]_*/lesson.md")):
        number = int(file.parent.name[:2])
        made[number] = write(file, folder / f"{number}.html", links).path
    return made


@contextmanager
def opened(path: Path, **options):
    try:
        with offline_page(path, **{"reduced_motion": "reduce", **options}) as watched:
            watched.page.wait_for_function(_READY)
            watched.page.evaluate(_SETTLE)
            yield watched.page
            watched.settle()
            assert watched.complaints == []
            assert watched.requests == []
    except BrowserUnavailableError as error:
        pytest.skip(str(error))


def test_an_experiment_shows_the_state_before_and_goes_back(pages):
    with opened(pages[6], **DESK) as page:
        card = page.locator(".try").first
        card.locator(".act").click()
        page.wait_for_function(
            "() => document.querySelector('.picture [data-distal]').distal.parameters()"
            ".max_steps === 16"
        )
        card.locator(".before img").wait_for()
        assert card.locator(".before img").get_attribute("src").startswith("blob:")
        assert "Watch for" in card.inner_text()
        assert card.locator(".act").get_attribute("aria-expanded") == "true"
        assert page.locator(".announcer").inner_text() == "Max steps: 16"
        card.locator(".back").click()
        assert page.evaluate(_VALUES)["max_steps"] == 64
        assert not card.locator(".outcome").is_visible()
        assert card.locator(".act").evaluate("button => button === document.activeElement")


def test_a_phrase_visibly_moves_its_slider(pages):
    with opened(pages[6], reduced_motion="no-preference", **DESK) as page:
        page.get_by_role("button", name="melt the shapes together").click()
        row = page.locator(".row.moved")
        assert "Blend softness" in row.inner_text()
        seen = set()
        for _ in range(40):
            seen.add(page.evaluate(_VALUES)["blend_softness"])
            if 0.6 in seen:
                break
            page.wait_for_timeout(40)
        assert 0.6 in seen
        slider = page.get_by_role("slider", name="Blend softness")
        assert slider.get_attribute("aria-valuetext") == "0.6"


def test_layers_enlarge_and_follow_the_sliders(pages):
    with opened(pages[6], **DESK) as page:
        first = page.locator(".layer img").first.get_attribute("src")
        # The page holds its first picture once.
        poster = page.locator(".picture [data-distal] > img").get_attribute("src")
        assert page.locator(".layer[aria-pressed=true] img").get_attribute("src") == poster
        assert pages[6].read_text(encoding="utf-8").count(poster) == 1
        page.get_by_role("button", name="Signal").click()
        assert page.evaluate(_VIEW) == "local:t"
        assert page.locator(".caption").inner_text().startswith("Signal")
        assert page.locator(".layer[aria-pressed=true]").inner_text() == "Signal"
        page.get_by_role("slider", name="Blend softness").fill("80")
        page.wait_for_function(
            "first => document.querySelector('.layer img').src !== first",
            arg=first,
            timeout=STILL_MS,
        )


def test_a_goal_is_measured_and_reached_by_its_solution(pages):
    with opened(pages[9], **DESK) as page:
        goal = page.locator(".goal")
        page.wait_for_function(
            "() => Number(document.querySelector('.goal').dataset.difference) > 0.03",
            timeout=STILL_MS,
        )
        assert "The goal is reached at 0.6 %" in goal.inner_text()
        goal.get_by_role("button", name="Show the solution").click()
        page.wait_for_function(
            "() => document.querySelector('.goal').classList.contains('reached')", timeout=STILL_MS
        )
        assert "reached." in goal.inner_text()


def test_a_goal_is_measured_while_time_plays(pages):
    try:
        with offline_page(pages[9], **DESK) as watched:
            watched.page.wait_for_function(
                "() => document.querySelector('.picture [data-distal]')?.distal?.playing"
                " && Number(document.querySelector('.goal').dataset.difference) > 0.03",
                timeout=STILL_MS,
            )
            assert "The goal is reached at 0.6 %" in watched.page.locator(".goal").inner_text()
    except BrowserUnavailableError as error:
        pytest.skip(str(error))


def test_the_keyboard_alone_is_enough(pages):
    with opened(pages[6], **DESK) as page:
        page.keyboard.press("Tab")
        assert page.evaluate("document.activeElement.className") == "skip"
        names = []
        for _ in range(40):
            page.keyboard.press("Tab")
            names.append(
                page.evaluate(
                    "(document.activeElement.getAttribute('aria-label')"
                    " ?? document.activeElement.textContent).trim()"
                )
            )
        assert {"Present", "Signal", "Allow only 16 steps", "Reset all"} <= set(names)
        page.locator(".act").first.focus()
        page.keyboard.press("Enter")
        page.wait_for_function(
            "() => document.querySelector('.picture [data-distal]').distal.parameters()"
            ".max_steps === 16"
        )
        page.get_by_role("slider", name="Max steps").focus()
        page.keyboard.press("ArrowRight")
        assert page.evaluate(_VALUES)["max_steps"] == 17


def test_presentation_turns_sections_with_keys(pages):
    with opened(pages[6], **DESK) as page:
        page.get_by_role("button", name="Present").click()
        sections = page.locator("article > section")
        count = sections.count()
        assert page.locator(".count").inner_text() == f"1 of {count}"
        page.keyboard.press("ArrowRight")
        assert [i for i in range(count) if sections.nth(i).is_visible()] == [1]
        page.keyboard.press("End")
        assert page.locator(".count").inner_text() == f"{count} of {count}"
        page.keyboard.press("Escape")
        assert all(sections.nth(i).is_visible() for i in range(count))


def test_on_a_phone_the_picture_and_a_slider_stay_in_view(pages):
    with opened(pages[6], **PHONE) as page:
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        page.evaluate("scrollTo(0, 3000)")
        page.wait_for_timeout(100)
        picture = page.locator(".picture").bounding_box()
        assert picture["y"] == pytest.approx(0.0, abs=1.0)
        assert picture["height"] <= 0.45 * 844
        bench = page.locator(".bench").bounding_box()
        assert bench["height"] <= 0.6 * 844
        row = page.locator(".row").first.bounding_box()
        assert 0.0 < row["y"] < 844


@needs_axe
@pytest.mark.parametrize("number", [6, 9])
@pytest.mark.parametrize("size", [DESK, PHONE], ids=["desk", "phone"])
def test_axe_finds_nothing_in_light_and_dark(pages, number, size):
    with opened(pages[number], bypass_csp=True, **size) as page:
        page.locator(".act").first.click()
        page.wait_for_timeout(300)
        assert violations(page) == []
