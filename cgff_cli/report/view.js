// The panel, the eye and the pointer of the page of `cgff view`; view_world.js, before it, draws.

// ---- the panel -------------------------------------------------------------------------------------------

function number(value) {
  return Number.isFinite(value) ? String(Number(value.toPrecision(6))) : "none";
}

function element(tag, own, ...children) {
  const made = Object.assign(document.createElement(tag), own);
  made.append(...children);
  return made;
}

function choices(select, names, chosen) {
  const option = (name, i) => element("option", { value: i, textContent: name, selected: i === chosen });
  select.replaceChildren(...names.map(option));
  select.parentNode.hidden = names.length < 2;
}

function tick(words, more, checked, act) {
  const box = element("input", { type: "checkbox", checked });
  box.addEventListener("change", () => { act(box.checked); toggle(); });
  return element("label", {}, box, ` ${words} `, element("small", { textContent: more }));
}

function legend() {
  const groups = now.groups.map(({ name, struts }, i) => {
    const [taut, slack] = now.counts[i];
    const kind = (struts ? "strut" : "cable") + (taut + slack === 1 ? "" : "s");
    const dashed = slack ? `; ${slack} slack, dashed` : "";
    const more = `${taut + slack} ${kind}${struts ? ", thick" : ""}${dashed}`;
    return tick(name, more, now.shown[i], (on) => (now.shown[i] = on));
  });
  const loads = now.loads.length > ARROWS ? `${ARROWS} of ${now.loads.length}` : now.loads.length;
  const there = { supports: now.supports.length, loads, start: now.start && " " };
  const others = Object.keys(extras).filter((name) => there[name]).map((name) =>
    tick(name, name === "start" ? "grey" : String(there[name]), extras[name], (on) => (extras[name] = on)));
  $("legend").replaceChildren($("legend").firstElementChild, ...groups, ...others);
}

function show(chosen) {
  now = page.results[chosen];
  at = now.places.slice();
  moving = Math.min(moving, now.modes.length - 1);
  if (!now.fields.some((own) => own.name === field)) field = "force";
  document.title = $("title").textContent = now.title;
  $("told").textContent = now.told;
  choices($("field"), now.fields.map((own) => own.name), now.fields.findIndex((own) => own.name === field));
  choices($("mode"), ["still", ...now.modes.map((mode) => mode.name)], moving + 1);
  $("reach").parentNode.hidden = !now.modes.length;
  $("tip").hidden = true;
  legend();
  build();
  if (fitted !== now.frame) fit();
}

// ---- the eye ---------------------------------------------------------------------------------------------

function draw() {
  if (asked) return;
  asked = true;
  requestAnimationFrame((time) => {
    asked = false;
    if (moving >= 0) swing(Math.sin(time / 400) * $("reach").value);
    renderer.render(world, camera);
  });
}

function swing(share) {
  const { shape } = now.modes[moving];
  for (let k = 0; k < at.length; k++) at[k] = now.places[k] + share * shape[k];
  place();
}

// Pixels that the panel takes of the width, where there is enough of it.
function beside() {
  return innerWidth > 700 ? 254 : 0;
}

// Back off from the middle until every node is within the field of view.
function fit() {
  fitted = now.frame;
  const back = new THREE.Vector3(...page.frames[fitted].eye);
  const across = new THREE.Vector3().crossVectors(camera.up, back).normalize();
  const up = new THREE.Vector3().crossVectors(back, across);
  const tall = Math.tan((camera.fov * Math.PI) / 360) * 0.9;
  const wide = (tall * (innerWidth - beside())) / innerHeight;
  let far = 0.1;
  const p = new THREE.Vector3();
  eachNode((n) => {
    p.fromArray(now.places, 3 * n);
    far = Math.max(far, p.dot(back) + Math.max(Math.abs(p.dot(across)) / wide, Math.abs(p.dot(up)) / tall));
  });
  orbit.target.set(0, 0, 0);
  camera.position.copy(back).multiplyScalar(far);
  orbit.update();
  draw();
}

function resize() {
  renderer.setPixelRatio(devicePixelRatio);
  renderer.setSize(innerWidth, innerHeight, false);
  camera.aspect = innerWidth / innerHeight;
  camera.setViewOffset(innerWidth, innerHeight, -beside() / 2, 0, innerWidth, innerHeight);
  draw();
}

// Keys: turn about the target, zoom, or move it.
function key(event) {
  const ways = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  const [across, up] = ways[event.key] || [0, 0];
  const offset = camera.position.clone().sub(orbit.target);
  if (event.key === "Home") return fit();
  if (event.key === "+" || event.key === "=") offset.multiplyScalar(0.9);
  else if (event.key === "-") offset.multiplyScalar(1 / 0.9);
  else if (!across && !up) return;
  else if (event.shiftKey) {
    const step = new THREE.Vector3(across, up, 0).multiplyScalar(0.05 * offset.length());
    orbit.target.add(step.applyQuaternion(camera.quaternion));
  } else {
    const angle = Math.min(Math.max(offset.angleTo(camera.up) - 0.08 * up, 0.01), 3.13);
    const axis = new THREE.Vector3().crossVectors(camera.up, offset).normalize();
    const far = offset.length();
    offset.copy(camera.up).multiplyScalar(far).applyAxisAngle(axis, angle);
    offset.applyAxisAngle(camera.up, 0.08 * across);
  }
  camera.position.copy(orbit.target).add(offset);
  event.preventDefault();
  orbit.update();
  draw();
}

// ---- what the pointer means ------------------------------------------------------------------------------

// (4 n) pixels across and down, depth, and whether some member shown ends there.
function seen() {
  camera.updateMatrixWorld();
  const m = new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).elements;
  const spots = new Float32Array((at.length / 3) * 4);
  const row = (k, n) => m[k] * at[n] + m[k + 4] * at[n + 1] + m[k + 8] * at[n + 2] + m[k + 12];
  eachNode((n) => {
    const w = row(3, 3 * n);
    spots[4 * n] = (1 + row(0, 3 * n) / w) * 0.5 * innerWidth;
    spots[4 * n + 1] = (1 - row(1, 3 * n) / w) * 0.5 * innerHeight;
    spots[4 * n + 2] = w;
  });
  return spots;
}

// The member or node at a pixel: {member} or {node}, {} for none; of members as near, the one in front.
function pick(x, y) {
  const spots = seen();
  let found = {}, nearest = REACH, front = Infinity;
  for (const part of parts.filter((own) => own.members && own.mesh.visible))
    for (const i of part.members) {
      const [a, b] = [4 * now.pairs[2 * i], 4 * now.pairs[2 * i + 1]];
      if (spots[a + 2] < camera.near || spots[b + 2] < camera.near) continue;
      spots[a + 3] = spots[b + 3] = 1;
      const [dx, dy] = [spots[b] - spots[a], spots[b + 1] - spots[a + 1]];
      const along = ((x - spots[a]) * dx + (y - spots[a + 1]) * dy) / (dx * dx + dy * dy || 1);
      const t = Math.min(Math.max(along, 0), 1);
      const off = Math.hypot(spots[a] + t * dx - x, spots[a + 1] + t * dy - y);
      const depth = spots[a + 2] + t * (spots[b + 2] - spots[a + 2]);
      const wide = (part.radius * innerHeight) / (2 * depth * Math.tan((camera.fov * Math.PI) / 360));
      const distance = Math.max(off - wide, 0);
      if (distance >= REACH || distance > nearest + 1 || (distance > nearest - 1 && depth > front)) continue;
      [found, nearest, front] = [{ member: i }, distance, depth];
    }
  let close = REACH;
  eachNode((n) => {
    const off = Math.hypot(spots[4 * n] - x, spots[4 * n + 1] - y);
    if (spots[4 * n + 3] && off < close) [found, close] = [{ node: n }, off];
  });
  return found;
}

function words({ member, node }) {
  const { names, middle, size, columns } = page.frames[now.frame];
  if (node !== undefined) {
    const place = columns.map((column) => number(middle[column] + size * now.places[3 * node + column]));
    const load = now.loads[now.loaded.indexOf(node)];
    const told = [names[node], ...place.map((own, axis) => `${"xyz"[axis]} ${own}`)];
    if (load) told.push(`load ${load.map(number).join(", ")}`);
    if (now.supports.includes(node)) told.push("supported");
    return told.join("\n");
  }
  const [a, b] = [names[now.pairs[2 * member]], names[now.pairs[2 * member + 1]]];
  const group = now.groups[now.owners[member]];
  const kind = `${group.struts ? "strut" : "cable"}${now.slack[member] ? ", slack" : ""}`;
  const told = [...now.fields, { name: "length", ...now.lengths }];
  const values = told.map((own) => `${own.name} ${number(own.values[member] * own.most)}`);
  return [`${a} - ${b}`, `${group.name}: ${kind}`, ...values].join("\n");
}

function hover(event) {
  const found = event.buttons ? {} : pick(event.clientX, event.clientY);
  const tip = $("tip");
  tip.hidden = found.member === undefined && found.node === undefined;
  if (tip.hidden) return;
  tip.textContent = words(found);
  tip.style.left = `${Math.max(0, Math.min(event.clientX + 14, innerWidth - tip.offsetWidth - 4))}px`;
  tip.style.top = `${Math.max(0, Math.min(event.clientY + 14, innerHeight - tip.offsetHeight - 4))}px`;
}

// ---- what the controls do --------------------------------------------------------------------------------

choices($("result"), page.results.map((r) => r.title), 0);
$("result").addEventListener("change", (event) => show(Number(event.target.value)));
$("field").addEventListener("change", (event) => {
  field = now.fields[event.target.value].name;
  recolour();
});
$("mode").addEventListener("change", (event) => {
  moving = Number(event.target.value) - 1;
  at.set(now.places);
  place();
});
$("theme").addEventListener("click", () => { dark = !dark; recolour(); });
$("fit").addEventListener("click", fit);
$("view").addEventListener("keydown", key);
$("view").addEventListener("pointermove", hover);
$("view").addEventListener("pointerleave", () => ($("tip").hidden = true));
addEventListener("resize", resize);
orbit.addEventListener("change", draw);
resize();
show(0);
