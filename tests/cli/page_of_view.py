"""The page of `cgff view` taken apart, and its own script run without a browser: on a document of stubs."""

import base64
import html.parser
import json
from typing import Any

import numpy as np

STUBS = """
var window = globalThis, self = globalThis, innerWidth = 1200, innerHeight = 800, devicePixelRatio = 1;
var queue = [];
var requestAnimationFrame = (act) => queue.push(act), addEventListener = () => {};
var matchMedia = () => ({ matches: false }), console = { log() {}, warn() {}, error() {} };
var atob = (text) => {
  const letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  let out = "", bits = 0, held = 0;
  for (const letter of text.replace(/=/g, "")) {
    bits = (bits << 6) | letters.indexOf(letter);
    held += 6;
    if (held >= 8) out += String.fromCharCode((bits >> (held -= 8)) & 255);
  }
  return out;
};
var made = (tag) => ({
  tag, style: {}, children: [], listeners: {}, hidden: false, parentNode: { hidden: false },
  ownerDocument: document,
  append(...more) { this.children.push(...more); }, replaceChildren(...all) { this.children = all; },
  get firstElementChild() { return this.children[0]; },
  addEventListener(name, act) { this.listeners[name] = act; },
  removeEventListener() {}, setPointerCapture() {},
  fire(name, event = {}) { this.listeners[name]({ target: this, ...event }); },
});
var elements = {}, document = {
  documentElement: {}, addEventListener() {}, removeEventListener() {},
  createElement: (tag) => made(tag), createElementNS: (space, tag) => made(tag),
  getElementById: (id) => (elements[id] = elements[id] || made(id)),
};
document.getElementById("scale-ends").children = [made("span"), made("span"), made("span")];
document.getElementById("legend").children = [made("legend")];
document.getElementById("reach").value = 0.1;
// the pixel of a place along a member, or of a node
var pixel = (a, b = a, share = 0) => {
  camera.updateMatrixWorld();
  const p = new THREE.Vector3().fromArray(at, 3 * a).lerp(new THREE.Vector3().fromArray(at, 3 * b), share);
  p.project(camera);
  return [(p.x + 1) * 600, (1 - p.y) * 400];
};
var frame = (time = 0) => { const all = queue; queue = []; all.forEach((act) => act(time)); };
"""


class Page(html.parser.HTMLParser):
    """A page's tags with their attributes, and what its scripts hold."""

    def __init__(self, text: str):
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.scripts: list[str] = []
        self.words = ""
        self.feed(text)
        self.close()
        self.data: dict[str, Any] = json.loads(self.scripts[0])

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag == "script":
            self.scripts.append("")

    def handle_data(self, data: str) -> None:
        if self.cdata_elem == "script":
            self.scripts[-1] += data
        else:
            self.words += data

    @property
    def policy(self) -> str:
        """What the browser may fetch and run."""
        return next(own["content"] or "" for tag, own in self.tags if own.get("http-equiv"))


def floats(text: str) -> np.ndarray:
    """Return what stands in a page as float32."""
    return np.frombuffer(base64.b64decode(text), dtype="<f4").astype(float)


def rows(text: str) -> list[int]:
    """Return what stands in a page as whole numbers."""
    return np.frombuffer(base64.b64decode(text), dtype="<u4").tolist()


class Stage:
    """The page's own script, run on stubs: `ask` evaluates one expression of JavaScript."""

    def __init__(self, page: Page):
        from py_mini_racer import MiniRacer

        self.engine = MiniRacer()
        self.engine.eval(STUBS)
        self.engine.eval(f"elements.data = {{ textContent: {json.dumps(page.scripts[0])} }}")
        for script in page.scripts[1:]:
            self.engine.eval(script)
        self.engine.eval("frame()")

    def ask(self, expression: str) -> Any:
        return json.loads(self.engine.eval(f"JSON.stringify((() => ({expression}))() ?? null)"))

    def do(self, *statements: str) -> None:
        for statement in statements:
            self.engine.eval(f"{{ {statement} }}")
