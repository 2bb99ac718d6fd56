// SPDX-License-Identifier: Apache-2.0
"use strict";
// Draws thousands of points of a plot on a canvas behind it, and finds the one under the pointer. plotly.js would make
// an element of each, which takes tens of seconds for 100,000.

const CLOUD_REACH = 6;  // pixels from a point in which the pointer means it
const clouds = new WeakMap();  // by the element of the plot

// Shows a cloud {x, y, groups: [{name, indices, colour, cross}], hover(index), choose(index)} behind the plot from now
// on, or none. x and y are the places of all points. A group is hidden with the trace of its name.
function setCloud(element, cloud) {
  if (!clouds.has(element)) {
    if (!cloud) return;
    clouds.set(element, { canvas: make("canvas", { className: "cloud" }), tip: make("div", { className: "tip", hidden: true }) });
    element.on("plotly_afterplot", () => drawCloud(element));
    element.on("plotly_relayouting", () => drawCloud(element));
    listenToCloud(element);
  }
  const state = clouds.get(element);
  state.cloud = cloud;
  drawCloud(element);
}

function drawCloud(element) {
  const { canvas, tip, cloud } = clouds.get(element);
  canvas.hidden = !cloud;
  tip.hidden = true;
  if (!cloud) return;
  const box = element.querySelector(".svg-container"), { xaxis, yaxis } = element._fullLayout;
  const width = Math.round(xaxis._length), height = Math.round(yaxis._length), sharp = window.devicePixelRatio || 1;
  if (canvas.parentNode !== box) box.prepend(canvas);
  if (tip.parentNode !== element) element.append(tip);
  Object.assign(canvas.style, { left: `${xaxis._offset}px`, top: `${yaxis._offset}px`, width: `${width}px`, height: `${height}px` });
  Object.assign(canvas, { width: width * sharp, height: height * sharp });  // clears it, too
  const pen = canvas.getContext("2d");
  pen.scale(sharp, sharp);
  const at = new Int32Array(width * height).fill(-1);  // the point at each pixel
  for (const group of cloud.groups) {
    const trace = element.data.find((t) => t.name === group.name);
    if (!trace || trace.visible === "legendonly" || trace.visible === false) continue;
    pen.fillStyle = pen.strokeStyle = group.colour;
    pen.beginPath();
    for (const i of group.indices) {
      const x = xaxis.d2p(cloud.x[i]), y = yaxis.d2p(cloud.y[i]);
      if (!(x >= 0 && y >= 0 && x < width && y < height)) continue;
      const pixel = Math.floor(y) * width + Math.floor(x);
      if (at[pixel] < 0) {  // else it would be drawn over itself
        if (group.cross) {
          pen.moveTo(x - 2, y - 2); pen.lineTo(x + 2, y + 2);
          pen.moveTo(x - 2, y + 2); pen.lineTo(x + 2, y - 2);
        } else {
          pen.rect(x - 2, y - 2, 4, 4);
        }
      }
      at[pixel] = i;
    }
    if (group.cross) pen.stroke();
    else pen.fill();
  }
  Object.assign(clouds.get(element), { at, width, height });
  canvas.dataset.drawn = "yes";
}

// Returns the point of the cloud that is nearest to the pointer, null for none.
function cloudPointAt(element, event) {
  const { at, width, height, cloud, canvas } = clouds.get(element);
  if (!cloud || !at) return null;
  const box = canvas.getBoundingClientRect();
  const x = Math.floor(event.clientX - box.left), y = Math.floor(event.clientY - box.top);
  let nearest = null, least = CLOUD_REACH * CLOUD_REACH + 1;
  for (let v = Math.max(0, y - CLOUD_REACH); v <= Math.min(height - 1, y + CLOUD_REACH); ++v) {
    for (let u = Math.max(0, x - CLOUD_REACH); u <= Math.min(width - 1, x + CLOUD_REACH); ++u) {
      const distance = (u - x) ** 2 + (v - y) ** 2;
      if (at[v * width + u] >= 0 && distance < least) [nearest, least] = [at[v * width + u], distance];
    }
  }
  return nearest;
}

function listenToCloud(element) {
  const state = clouds.get(element);
  let onTrace = false, pressed = null;
  element.on("plotly_hover", () => { onTrace = true; state.tip.hidden = true; });
  element.on("plotly_unhover", () => { onTrace = false; });
  element.addEventListener("mousemove", (event) => {
    const index = onTrace || event.buttons ? null : cloudPointAt(element, event);
    state.tip.hidden = index === null;
    if (index === null) return;
    state.tip.innerHTML = state.cloud.hover(index);
    const box = element.getBoundingClientRect(), left = event.clientX - box.left;
    Object.assign(state.tip.style, { top: `${event.clientY - box.top + 12}px`,
      left: left < box.width / 2 ? `${left + 12}px` : "", right: left < box.width / 2 ? "" : `${box.width - left + 12}px` });
  });
  element.addEventListener("mouseleave", () => { state.tip.hidden = true; });
  // plotly.js covers the page while a button is down, so that no click reaches the plot.
  element.addEventListener("mousedown", (event) => { pressed = event.button === 0 && !onTrace ? event : null; }, true);
  window.addEventListener("mouseup", (event) => {
    const moved = pressed && Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY);
    const index = pressed && moved < 4 ? cloudPointAt(element, event) : null;
    pressed = null;
    if (index !== null) showPoint(state.cloud.choose(index));
  }, true);
}
