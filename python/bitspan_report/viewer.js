// SPDX-License-Identifier: Apache-2.0
"use strict";
// Shows pictures of one scene side by side. All show the same part, and are moved and enlarged together. A heat map has
// its colour bar below the scene's rows; the bar stands still beneath its picture.

const MOST_ZOOM = 64;  // screen pixels per picture pixel, at most about
const viewers = [];

function decode(png) {
  const picture = new Image();
  picture.src = `data:image/png;base64,${png}`;
  return picture.decode().then(() => picture);
}

async function startViewer(root) {
  const canvases = [...root.querySelectorAll("canvas")];
  const pictures = await Promise.all(canvases.map((canvas) => decode(canvas.dataset.png)));
  const scene = pictures[canvases.findIndex((c) => c.dataset.name === "ideal" || c.dataset.name === "model")] || pictures[0];
  const viewer = { root, width: scene.naturalWidth, height: scene.naturalHeight, x: 0, y: 0, zoom: 1,
    panels: canvases.map((canvas, i) => panelOf(canvas, pictures[i], scene)) };
  for (const panel of viewer.panels) listen(viewer, panel);
  root.viewer = viewer;
  viewers.push(viewer);
  drawViewer(viewer);
}

function panelOf(canvas, picture, scene) {
  const source = make("canvas", { width: picture.naturalWidth, height: picture.naturalHeight });
  const pixels = source.getContext("2d", { willReadFrequently: true });
  pixels.drawImage(picture, 0, 0);
  const barHeight = picture.naturalHeight - scene.naturalHeight;
  if (barHeight > 0) {
    const bar = make("canvas", { className: "bar", width: picture.naturalWidth, height: barHeight });
    bar.getContext("2d").drawImage(picture, 0, -scene.naturalHeight);
    canvas.after(bar);
  }
  return { canvas, source, pixels, reading: canvas.parentElement.querySelector("figcaption .mono") };
}

// Shows the part with the top left corner (x, y) and a zoom, 1 for the whole picture. The part stays inside the
// picture.
function moveTo(viewer, x, y, zoom) {
  viewer.zoom = Math.min(Math.max(zoom, 1), Math.max(1, MOST_ZOOM * viewer.width / 400));
  viewer.x = Math.min(Math.max(x, 0), viewer.width * (1 - 1 / viewer.zoom));
  viewer.y = Math.min(Math.max(y, 0), viewer.height * (1 - 1 / viewer.zoom));
  drawViewer(viewer);
}

// Enlarges around (fx, fy), fractions of the panel.
function zoomAt(viewer, fx, fy, factor) {
  const px = viewer.x + fx * viewer.width / viewer.zoom, py = viewer.y + fy * viewer.height / viewer.zoom;
  const zoom = Math.min(Math.max(viewer.zoom * factor, 1), Math.max(1, MOST_ZOOM * viewer.width / 400));
  moveTo(viewer, px - fx * viewer.width / zoom, py - fy * viewer.height / zoom, zoom);
}

function drawViewer(viewer) {
  const shownWidth = viewer.width / viewer.zoom, shownHeight = viewer.height / viewer.zoom;
  for (const { canvas, source } of viewer.panels) {
    const width = Math.max(1, Math.round(canvas.clientWidth * devicePixelRatio)) || viewer.width;
    canvas.width = width;
    canvas.height = Math.round(width * viewer.height / viewer.width);
    const context = canvas.getContext("2d");
    context.imageSmoothingEnabled = canvas.width < shownWidth;  // shrunk: smooth; enlarged: whole pixels
    context.drawImage(source, viewer.x, viewer.y, shownWidth, shownHeight, 0, 0, canvas.width, canvas.height);
  }
}

// Shows the place and colour of the pixel under the pointer, in every panel.
function readPixel(viewer, fx, fy) {
  const x = Math.min(Math.floor(viewer.x + fx * viewer.width / viewer.zoom), viewer.width - 1);
  const y = Math.min(Math.floor(viewer.y + fy * viewer.height / viewer.zoom), viewer.height - 1);
  viewer.panels.forEach(({ pixels, reading, canvas }, i) => {
    const [red, green, blue] = pixels.getImageData(x, y, 1, 1).data;
    const value = ["ideal", "model", "difference"].includes(canvas.dataset.name) ? `${red} ${green} ${blue}` : "";
    reading.textContent = (i === 0 ? `(${x}, ${y}) ` : "") + value;
  });
}

function listen(viewer, { canvas }) {
  const fraction = (event) => [event.offsetX / canvas.clientWidth, event.offsetY / canvas.clientHeight];
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoomAt(viewer, ...fraction(event), event.deltaY < 0 ? 1.3 : 1 / 1.3);
  }, { passive: false });
  let last = null;
  canvas.addEventListener("pointerdown", (event) => {
    last = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointerup", () => { last = null; });
  canvas.addEventListener("pointercancel", () => { last = null; });
  canvas.addEventListener("pointermove", (event) => {
    if (last) {
      const scale = viewer.width / viewer.zoom / canvas.clientWidth;
      moveTo(viewer, viewer.x - (event.clientX - last[0]) * scale, viewer.y - (event.clientY - last[1]) * scale, viewer.zoom);
      last = [event.clientX, event.clientY];
    }
    readPixel(viewer, ...fraction(event));
  });
  canvas.addEventListener("dblclick", () => moveTo(viewer, 0, 0, 1));
}

// Starts the visible viewers that did not start, and draws the others anew (their size may have changed).
function refreshViewers() {
  for (const root of document.querySelectorAll(".viewer")) {
    if (root.closest("[hidden]")) continue;
    if (root.viewer) drawViewer(root.viewer);
    else if (!root.dataset.started) {
      root.dataset.started = "yes";
      startViewer(root);
    }
  }
}

function startViewers() {
  for (const block of document.querySelectorAll("#pictures .variant")) {
    const visible = () => block.querySelector(".viewer:not([hidden])").viewer;
    const onClick = (name, action) => block.querySelector(name).addEventListener("click", () => visible() && action(visible()));
    onClick(".zoom-in", (viewer) => zoomAt(viewer, 0.5, 0.5, 2));
    onClick(".zoom-out", (viewer) => zoomAt(viewer, 0.5, 0.5, 0.5));
    onClick(".zoom-reset", (viewer) => moveTo(viewer, 0, 0, 1));
    block.querySelector("select.scenes").addEventListener("change", (event) => {
      for (const viewer of block.querySelectorAll(".viewer")) viewer.hidden = viewer.dataset.scene !== event.target.value;
      refreshViewers();
    });
  }
  window.addEventListener("resize", refreshViewers);
  refreshViewers();
}
