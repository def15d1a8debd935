"""The page of `cgff view` in a real browser: drawn, turned, hovered, and nothing asked of a network."""

import io
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from cgff_cli.cli import main
from tests.browser import CHROMIUM, DRAWN, Browser
from tests.cli.conftest import STRUCTURES

HOSTILE = "</script><img src=x onerror=document.title='gone'>"
SPOT = """(() => {
  camera.updateMatrixWorld();
  const place = new THREE.Vector3().fromArray(at, 3 * now.pairs[22]);
  place.lerp(new THREE.Vector3().fromArray(at, 3 * now.pairs[23]), 0.35).project(camera);
  return [((place.x + 1) * innerWidth) / 2, ((1 - place.y) * innerHeight) / 2];
})()"""

pytestmark = [
    pytest.mark.needs_jupyter_threejs_sage,
    pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium here"),
]


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Write the page of a prism whose names would like to do harm, and of a bracket."""
    folder = tmp_path_factory.mktemp("page")
    text = (STRUCTURES / "prism.yaml").read_text()
    (folder / "prism.yaml").write_text(re.sub(r"\bn6\b", f'"{HOSTILE}"', text))
    scenes = [str(folder / "prism.yaml"), str(STRUCTURES / "bracket.yaml")]
    ended = CliRunner().invoke(main, ["view", *scenes, "-o", str(folder / "page.html")])
    assert ended.exit_code == 0, ended.stderr
    return folder / "page.html"


@pytest.fixture(scope="module")
def alone() -> Iterator[Browser]:
    """Start one browser for all."""
    pytest.importorskip("websocket")
    with Browser() as browser:
        yield browser


@pytest.fixture
def browser(alone: Browser, page: Path) -> Browser:
    """Open the page anew."""
    alone.open(page)
    return alone


def coloured(browser: Browser) -> np.ndarray:
    """Return the number of pixels, right of the panel, that blue and orange members take."""
    image = pytest.importorskip("PIL.Image")
    browser.ask(DRAWN)
    picture = np.asarray(image.open(io.BytesIO(browser.picture())).convert("RGB"), dtype=int)[:680, 260:]
    red, blue = picture[..., 0], picture[..., 2]
    return np.array([(blue > red + 40).sum(), (red > blue + 40).sum()])


def test_struts_and_cables_are_drawn_and_no_network_is_asked(browser: Browser):
    pushed, pulled = coloured(browser)
    assert min(pushed, pulled) > 1500
    assert "Log.entryAdded" not in browser.heard()
    assert "Runtime.exceptionThrown" not in browser.heard()
    asked = [event["params"]["request"]["url"] for event in browser.events if "request" in event["params"]]
    assert [url for url in asked if not url.startswith("file:")] == []
    assert len(asked) == 1


def test_hovering_tells_a_member_whatever_its_name(browser: Browser):
    browser.mouse("mouseMoved", *browser.ask(SPOT))
    told = browser.ask("document.getElementById('tip').textContent").splitlines()
    assert told[:3] == [f"n3 - {HOSTILE}", "struts: strut", "force -7"]
    assert browser.ask("document.images.length") == 0
    assert browser.ask("document.title") == "Triangular prism, Table IV"
    browser.mouse("mouseMoved", 1190, 10)
    assert browser.ask("document.getElementById('tip').hidden")


def test_the_legend_hides_a_group(browser: Browser):
    browser.ask("[...document.querySelectorAll('#legend input')][2].click()")
    pushed, pulled = coloured(browser)
    assert pushed == 0
    assert pulled > 1500


def test_dragging_wheel_and_keys_move_the_eye(browser: Browser):
    eyes = [browser.ask("camera.position.toArray()")]
    browser.mouse("mousePressed", 700, 400, button="left", buttons=1, clickCount=1)
    browser.mouse("mouseMoved", 800, 430, button="left", buttons=1)
    browser.mouse("mouseReleased", 800, 430, button="left", clickCount=1)
    eyes.append(browser.ask("camera.position.toArray()"))
    browser.mouse("mouseWheel", 700, 400, deltaX=0, deltaY=240)
    eyes.append(browser.ask("camera.position.toArray()"))
    browser.ask("document.getElementById('view').focus()")
    browser.press("ArrowLeft")
    eyes.append(browser.ask("camera.position.toArray()"))
    far = np.linalg.norm(eyes, axis=1)
    assert far[1] == pytest.approx(far[0])
    assert far[2] > 1.05 * far[0]
    assert far[3] == pytest.approx(far[2])
    assert min(np.linalg.norm(np.diff(eyes, axis=0), axis=1)) > 0.05
    browser.press("Home")
    assert browser.ask("camera.position.toArray()") == pytest.approx(eyes[0])


def test_a_mode_moves_dark_is_dark_and_another_structure_can_be_shown(browser: Browser):
    def choose(what: str, value: int) -> None:
        change = "this.dispatchEvent(new Event('change'))".replace(
            "this", f"document.getElementById('{what}')"
        )
        browser.ask(f"document.getElementById('{what}').value = {value}; {change}; {DRAWN}")

    choose("mode", 1)
    assert browser.ask("at.some((own, k) => own !== now.places[k])")
    browser.ask(f"document.getElementById('theme').click(); {DRAWN}")
    assert browser.ask("getComputedStyle(document.body).backgroundColor") == "rgb(20, 23, 28)"
    choose("result", 1)
    assert browser.ask("document.getElementById('title').textContent") != "Triangular prism, Table IV"
    assert browser.ask("camera.position.toArray().map(Math.sign)[1]") == -1
