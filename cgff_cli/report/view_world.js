"use strict";
// What the page of `cgff view` draws; view.js, which follows, is what its user does with it. Places are
// float32 about the middle of their frame, over its size: the world is about one unit large, and the
// user's numbers are middle + size * place. Names are only ever text.

const $ = (id) => document.getElementById(id);
const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;
const floats = (text) => new Float32Array(bytes(text));
const rows = (text) => new Uint32Array(bytes(text));

const page = JSON.parse($("data").textContent);
for (const r of page.results) {
  r.places = floats(r.places);
  r.start = r.start && floats(r.start);
  [r.pairs, r.owners, r.supports, r.loaded] = [r.pairs, r.owners, r.supports, r.loaded].map(rows);
  r.slack = new Uint8Array(bytes(r.slack));
  for (const own of [r.lengths, ...r.fields]) own.values = floats(own.values);
  for (const mode of r.modes) mode.shape = floats(mode.shape);
  r.shown = r.groups.map(() => true);
  r.counts = r.groups.map(() => [0, 0]); // taut, slack
  r.owners.forEach((group, i) => r.counts[group][r.slack[i]]++);
}

const TUBES = 5000; // members drawn as tubes; of more, lines
const BALLS = 2000; // nodes drawn as balls
const ARROWS = 150; // loads drawn; of more, evenly chosen ones
const REACH = 8; // pixels from the pointer to what it means
const INKS = {
  light: { push: [31, 95, 168], none: [180, 180, 180], pull: [200, 80, 30], paper: 0xffffff, start: 0xc9c9c9 },
  dark: { push: [91, 155, 230], none: [112, 118, 128], pull: [255, 132, 66], paper: 0x14171c, start: 0x4a505a },
};

let now, at; // the result shown, and where its nodes are at this moment
let field = "force";
let moving = -1; // the mode that moves, if any
let dark = matchMedia("(prefers-color-scheme: dark)").matches;
let parts = [], asked = false, fitted = null;
const extras = { supports: true, loads: true, start: false };

// ---- the world -------------------------------------------------------------------------------------------

const camera = new THREE.PerspectiveCamera(35, 1, 0.01, 100);
camera.up.set(0, 0, 1);
const light = new THREE.DirectionalLight(0xffffff, 0.6);
camera.add(light, light.target);
light.position.set(-0.5, 1, 0.5);
light.target.position.set(0, 0, -1);
const world = new THREE.Scene();
const structure = new THREE.Group();
world.add(camera, structure, new THREE.AmbientLight(0xffffff, 0.6));
const renderer = rendererOf($("view"));
const orbit = new THREE.OrbitControls(camera, $("view"));

function rendererOf(canvas) {
  try {
    return new THREE.WebGLRenderer({ canvas, antialias: true });
  } catch (error) {
    $("tip").hidden = false;
    $("tip").textContent = "this browser has no WebGL, and cannot draw the structure";
    return { setPixelRatio() {}, setSize() {}, render() {} };
  }
}

function ink() {
  return INKS[dark ? "dark" : "light"];
}

function build() {
  for (const old of [...structure.children]) {
    structure.remove(old);
    old.geometry.dispose();
    old.material.dispose();
  }
  const lists = now.groups.map(() => [[], []]);
  now.owners.forEach((group, i) => lists[group][now.slack[i]].push(i));
  const lengths = [...now.lengths.values].sort((a, b) => a - b);
  const usual = (lengths[lengths.length >> 1] * now.lengths.most) / page.frames[now.frame].size;
  const thick = Math.max(Math.min(0.008, usual / 18), 0.002); // a cable is about a pixel wide at least
  parts = lists.flatMap((both, group) => both.flatMap((members, slack) =>
    members.length ? [partOf(group, members, slack, now.groups[group].struts ? thick : thick * 0.4)] : []));
  if (now.owners.length <= TUBES && at.length <= 3 * BALLS) {
    const ball = 1.2 * Math.max(...parts.map((part) => part.radius), thick * 0.4);
    const balls = solid(new THREE.SphereGeometry(1, 12, 8), at.length / 3, 0x8a8f98);
    const put = (n) => stick(balls, n, at, 3 * n, at, 3 * n, ball);
    parts.push({ mesh: balls, group: -1, place: () => eachNode(put) });
  }
  const h = 0.02 * Math.min(1, Math.sqrt(60 / (now.supports.length || 1)));
  const feet = solid(new THREE.ConeGeometry(0.6, 1, 4), now.supports.length, 0x7b8089);
  const foot = (n) => [at[3 * n], at[3 * n + 1], at[3 * n + 2] - h];
  now.supports.forEach((n, i) => stick(feet, i, foot(n), 0, at, 3 * n, h));
  parts.push({ mesh: feet, extra: "supports" });
  parts.push(...arrowsOf());
  if (now.start) parts.push({ mesh: lines(now.start, now.owners.map((_, i) => i), {}), extra: "start" });
  recolour();
  place();
  toggle();
}

function partOf(group, members, slack, radius) {
  if (slack || now.owners.length > TUBES) {
    const mesh = lines(at, members, slack ? { dashSize: 0.012, gapSize: 0.009 } : {});
    mesh.geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(6 * members.length), 3));
    mesh.material.vertexColors = true;
    const colours = mesh.geometry.attributes.color;
    return { group, members, mesh, radius: 0, colours, ends: 2, place: () => follow(mesh, members) };
  }
  const many = now.owners.length > 1000; // then without caps
  const mesh = solid(new THREE.CylinderGeometry(1, 1, 1, many ? 5 : 12, 1, many), members.length, 0xffffff);
  mesh.instanceColor = new THREE.InstancedBufferAttribute(new Float32Array(3 * members.length), 3);
  const put = (i, k) => stick(mesh, k, at, 3 * now.pairs[2 * i], at, 3 * now.pairs[2 * i + 1], radius);
  const colours = mesh.instanceColor;
  return { group, members, mesh, radius, colours, ends: 1, place: () => members.forEach(put) };
}

function solid(geometry, count, color) {
  const mesh = new THREE.InstancedMesh(geometry, new THREE.MeshLambertMaterial({ color }), count);
  mesh.frustumCulled = false;
  structure.add(mesh);
  return mesh;
}

function lines(places, members, dash) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(6 * members.length), 3));
  const Material = dash.dashSize ? THREE.LineDashedMaterial : THREE.LineBasicMaterial;
  const mesh = new THREE.LineSegments(geometry, new Material(dash));
  mesh.frustumCulled = false;
  structure.add(mesh);
  follow(mesh, members, places);
  if (dash.dashSize) mesh.computeLineDistances();
  return mesh;
}

function follow(mesh, members, places = at) {
  const { array } = mesh.geometry.attributes.position;
  let k = 0;
  for (const i of members)
    for (const end of [3 * now.pairs[2 * i], 3 * now.pairs[2 * i + 1]])
      for (let axis = 0; axis < 3; axis++) array[k++] = places[end + axis];
  mesh.geometry.attributes.position.needsUpdate = true;
}

// Lay instance k, one unit high along its y, from a[i..] to b[j..]; of no length it stands as a ball.
function stick(mesh, k, a, i, b, j, radius) {
  let [x, y, z] = [b[j] - a[i], b[j + 1] - a[i + 1], b[j + 2] - a[i + 2]];
  const length = Math.hypot(x, y, z);
  const high = length || radius;
  [x, y, z] = length ? [x / length, y / length, z / length] : [0, 0, 1];
  const side = Math.abs(z) < 0.9 ? [-y, x, 0] : [0, -z, y]; // z or x, times (x, y, z)
  const wide = radius / Math.hypot(...side);
  const [p, q, r] = side.map((own) => own * wide);
  const m = mesh.instanceMatrix.array;
  m.set([p, q, r, 0, x * high, y * high, z * high, 0], 16 * k);
  m.set([q * z - r * y, r * x - p * z, p * y - q * x, 0], 16 * k + 8);
  for (let axis = 0; axis < 3; axis++) m[16 * k + 12 + axis] = (a[i + axis] + b[j + axis]) / 2;
  m[16 * k + 15] = 1;
  mesh.instanceMatrix.needsUpdate = true;
}

function arrowsOf() {
  const { columns } = page.frames[now.frame];
  const most = now.loads.reduce((so, load) => Math.max(so, Math.hypot(...load)), 0);
  const step = Math.max(1, now.loads.length / ARROWS);
  const drawn = Array.from({ length: Math.min(ARROWS, now.loads.length) }, (_, k) => Math.floor(k * step));
  const long = step > 1 ? 0.06 : 0.1;
  const vectors = drawn.map((row) => {
    const vector = [0, 0, 0];
    now.loads[row].forEach((own, axis) => (vector[columns[axis]] = (own / most) * long));
    return vector;
  });
  const shafts = solid(new THREE.CylinderGeometry(1, 1, 1, 6), vectors.length, 0x2a7f62);
  const heads = solid(new THREE.ConeGeometry(1, 1, 10), vectors.length, 0x2a7f62);
  const put = (mesh, from, to, radius) => vectors.forEach((v, k) => {
    const n = 3 * now.loaded[drawn[k]];
    const back = (share) => v.map((own, axis) => at[n + axis] - own * share);
    stick(mesh, k, back(from), 0, back(to), 0, radius * Math.hypot(...v));
  });
  return [
    { mesh: shafts, extra: "loads", place: () => put(shafts, 1, 0.3, 0.02) },
    { mesh: heads, extra: "loads", place: () => put(heads, 0.35, 0, 0.09) },
  ];
}

function eachNode(act) {
  for (let n = 0; n < at.length / 3; n++) act(n);
}

function place() {
  for (const part of parts) part.place?.();
  draw();
}

function toggle() {
  for (const { mesh, extra, group } of parts)
    mesh.visible = extra ? extras[extra] : group < 0 || now.shown[group];
  draw();
}

// ---- colour ----------------------------------------------------------------------------------------------

// Grey is 0; each sign has its own end, as strong as the other.
function colourOf(value, own) {
  const end = value < 0 ? own.least : own.greatest;
  const share = end && Number.isFinite(value) ? value / end : 0;
  return ink().none.map((none, i) => none + (ink()[value < 0 ? "push" : "pull"][i] - none) * share);
}

function recolour() {
  const own = now.fields.find((one) => one.name === field);
  for (const { members, colours, ends } of parts.filter((part) => part.colours)) {
    members.forEach((i, k) => {
      const colour = own ? colourOf(own.values[i] * own.most, own) : ink().none;
      for (let c = 0; c < 3 * ends; c++) colours.array[3 * ends * k + c] = colour[c % 3] / 255;
    });
    colours.needsUpdate = true;
  }
  for (const { mesh } of parts.filter((part) => part.extra === "start")) mesh.material.color.set(ink().start);
  world.background = new THREE.Color(ink().paper);
  document.documentElement.className = dark ? "dark" : "";
  $("scale").hidden = !own;
  if (own) scaleOf(own);
  draw();
}

function scaleOf(own) {
  const [least, greatest] = [Math.min(own.least, 0), Math.max(own.greatest, 0)];
  const stops = least < 0 && greatest > 0 ? [least, 0, greatest] : [least, greatest];
  const colours = stops.map((value) => `rgb(${colourOf(value, own).map(Math.round)})`);
  $("scale-name").textContent = own.name + (own.name === "force" ? ", tension > 0" : "");
  $("scale-bar").style.background = `linear-gradient(90deg, ${colours})`;
  const ends = [least, least < 0 && greatest > 0 ? 0 : null, greatest];
  [...$("scale-ends").children].forEach((span, i) => {
    span.textContent = ends[i] === null ? "" : number(ends[i]);
  });
}
