"""Measure the page of `cgff view` in a headless Chromium: its size, how long it takes to load, and a frame.

python tests/studies/view.py [--pictures FOLDER]
"""

import argparse
import sys
import tempfile
import time
from pathlib import Path

from click.testing import CliRunner

sys.path.insert(0, str(Path(__file__).parents[2]))
from cgff_cli.cli import main
from tests.browser import Browser

SCENES = {
    "tower of 8 stages": ("tower", "--stages", "8"),
    "net of 49 a side": ("net", "--side", "49", "--start", "saddle"),
    "net of 72 a side": ("net", "--side", "72", "--start", "saddle"),
    "net of 225 a side": ("net", "--side", "225", "--start", "saddle"),
}
RENDERER = """(() => {
  const gl = renderer.getContext();
  return gl.getParameter(gl.getExtension("WEBGL_debug_renderer_info").UNMASKED_RENDERER_WEBGL);
})()"""
MEASURE = """(() => {
  const gl = renderer.getContext(), pixel = new Uint8Array(4);
  const drawn = () => {
    renderer.render(world, camera);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); // waits for the picture
  };
  const median = (act) => {
    const times = [];
    for (let k = 0; k < 9; k++) {
      const begun = performance.now();
      act(k);
      times.push(performance.now() - begun);
    }
    return times.sort((a, b) => a - b)[4];
  };
  const turned = median(() => { key({ key: "ArrowLeft", preventDefault() {} }); drawn(); });
  const met = median((k) => pick(600 + 10 * k, 400));
  moving = 0;
  const swung = median((k) => { swing(0.01 * k); drawn(); });
  moving = -1;
  return [now.owners.length, turned, met, swung];
})()"""


def measure(browser: Browser, name: str, folder: Path, pictures: Path | None) -> None:
    """Print a line of figures for one scene."""
    scene, page = folder / "scene.yaml", folder / "page.html"
    for arguments in (
        ["new", *SCENES[name], "-o", str(scene)],
        ["view", str(scene), "--as-given", "--modes", "1", "-q", "-o", str(page)],
    ):
        ended = CliRunner().invoke(main, arguments)
        assert ended.exit_code == 0, ended.stderr
    begun = time.perf_counter()
    browser.open(page)
    loaded = time.perf_counter() - begun
    members, turned, met, swung = browser.ask(MEASURE)
    size = page.stat().st_size / 1e6
    print(f"{name:18}  {members:6}  {size:5.2f} MB  load {loaded:5.2f} s  turn {turned:6.1f} ms", end="")
    print(f"  swing {swung:6.1f} ms  hover {met:5.1f} ms")
    if pictures is not None:
        browser.ask("fit()")
        (pictures / f"{members}.png").write_bytes(browser.picture())


def run() -> None:
    """Measure all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pictures", type=Path)
    pictures = parser.parse_args().pictures
    with tempfile.TemporaryDirectory() as folder, Browser() as browser:
        for number, name in enumerate(SCENES):
            measure(browser, name, Path(folder), pictures)
            if number == 0:
                print(browser.ask(RENDERER))


if __name__ == "__main__":
    run()
