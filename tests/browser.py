"""A real browser without a window, spoken to by the DevTools protocol: Chromium, where there is one."""

import base64
import json
import re
import subprocess
import tempfile
from pathlib import Path
from shutil import which
from typing import Any
from urllib.request import urlopen

CHROMIUM = which("chromium") or which("chromium-browser") or which("google-chrome")
FLAGS = (
    *("--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"),
    *("--remote-debugging-port=0", "--remote-allow-origins=*", "--disable-background-networking"),
)
DRAWN = "new Promise((then) => requestAnimationFrame(() => requestAnimationFrame(() => then(true))))"


class Browser:
    """One tab; ended by the end of a `with` block. What it was told of meanwhile is in `events`."""

    def __init__(self, width: int = 1200, height: int = 800):
        import websocket

        self.folder = tempfile.TemporaryDirectory(prefix="cgff-browser-", ignore_cleanup_errors=True)
        command = [str(CHROMIUM), *FLAGS, f"--user-data-dir={self.folder.name}", "about:blank"]
        self.process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        assert self.process.stderr
        ports = (re.search(r"ws://127.0.0.1:(\d+)/", line) for line in self.process.stderr)
        port = next(found[1] for found in ports if found)
        with urlopen(f"http://127.0.0.1:{port}/json") as answer:
            tab = next(one for one in json.load(answer) if one["type"] == "page")
        self.socket = websocket.create_connection(tab["webSocketDebuggerUrl"], timeout=120)
        self.number, self.events = 0, []
        for domain in ("Page", "Runtime", "Network", "Log"):
            self.send(f"{domain}.enable")
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.send("Emulation.setDeviceMetricsOverride", **size)

    def __enter__(self) -> "Browser":
        return self

    def __exit__(self, *raised: object) -> None:
        self.send("Browser.close")
        self.socket.close()
        self.process.wait(30)
        self.folder.cleanup()

    def send(self, method: str, **parameters: Any) -> Any:
        """Return the answer to a command of the protocol."""
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": parameters}))
        while True:
            heard = json.loads(self.socket.recv())
            if heard.get("id") == self.number:
                return heard["result"]
            self.events.append(heard)

    def open(self, path: Path) -> None:
        """Open a page and wait for its first picture."""
        self.events.clear()
        self.send("Page.navigate", url=path.absolute().as_uri())
        while "Page.loadEventFired" not in self.heard():
            self.events.append(json.loads(self.socket.recv()))
        self.ask(DRAWN)

    def heard(self) -> list[str]:
        """Return the names of what happened since the page was opened."""
        return [event["method"] for event in self.events]

    def ask(self, expression: str) -> Any:
        """Return the value of an expression of JavaScript, awaited."""
        how = {"returnByValue": True, "awaitPromise": True}
        answer = self.send("Runtime.evaluate", expression=expression, **how)
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    def mouse(self, kind: str, x: float, y: float, **more: Any) -> None:
        """Move, press or release the pointer, or turn its wheel."""
        self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def press(self, key: str) -> None:
        """Press a key and let it go."""
        self.send("Input.dispatchKeyEvent", type="keyDown", key=key)
        self.send("Input.dispatchKeyEvent", type="keyUp", key=key)

    def picture(self) -> bytes:
        """Return a PNG of the tab."""
        return base64.b64decode(self.send("Page.captureScreenshot")["data"])
