"use strict";
const key = document.querySelector('meta[name="key"]').content;
const by = id => document.getElementById(id);
const columns = {};
let shownFrame = "", asking = false;

function call(path, method = "GET") {
  return fetch(path, { method, headers: { "X-Pfemcut-Key": key }, cache: "no-store" });
}

function clock(seconds) {
  if (seconds === null) return "?";
  const s = Math.round(seconds), pad = n => String(n).padStart(2, "0");
  return `${Math.floor(s / 3600)}:${pad(Math.floor(s / 60) % 60)}:${pad(s % 60)}`;
}

function digits(value, n) {
  return value === null || value === undefined ? "–" : Number(value.toPrecision(n)).toLocaleString("en", { maximumFractionDigits: 6, useGrouping: false });
}

function made(tag, text, attributes = {}) {
  const drawn = ["svg", "path", "line", "text"].includes(tag);
  const element = drawn ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.textContent = text;
  return element;
}

function ticks(low, high) {
  const raw = (high - low) / 4 || 1, decade = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map(m => m * decade).find(s => s >= raw);
  const found = [];
  for (let at = Math.ceil(low / step) * step; at <= high + 1e-9 * step; at += step) found.push(at);
  return found;
}

function plot(id, curves, end, fromZero) {
  const svg = by(id), [w, h, left, right, top, bottom] = [480, 220, 46, 10, 8, 32];
  svg.setAttribute("viewBox", `0 0 ${w} ${h}`);
  const x = columns.travel || [], finite = v => v !== null && Number.isFinite(v);
  // The 99th percentile: a single bad row may not flatten the curve.
  const sorted = curves.flatMap(c => columns[c.column] || []).filter(finite).sort((a, b) => a - b);
  if (x.length < 2 || !sorted.length) return;
  const robust = sorted[Math.floor(0.995 * (sorted.length - 1))];
  const low = fromZero ? Math.min(0, sorted[Math.floor(0.005 * (sorted.length - 1))]) : sorted[0];
  const high = Math.max(robust + 0.1 * Math.max(robust - low, 1e-12), low + 1e-9);
  const far = Math.max(end || 0, x[x.length - 1], 1e-12);
  const px = v => left + v / far * (w - left - right), py = v => h - bottom - (Math.min(v, high) - low) / (high - low) * (h - bottom - top);
  const parts = [];
  for (const v of ticks(low, high)) {
    parts.push(made("line", "", { x1: left, x2: w - right, y1: py(v), y2: py(v), stroke: "#d9dfe5" }));
    parts.push(made("text", digits(v, 4), { x: left - 5, y: py(v) + 4, "text-anchor": "end" }));
  }
  for (const v of ticks(0, far)) parts.push(made("text", digits(v, 3), { x: px(v), y: h - bottom + 14, "text-anchor": "middle" }));
  parts.push(made("text", "travel (mm)", { x: (left + w - right) / 2, y: h - 3, "text-anchor": "middle" }));
  curves.forEach(curve => {
    let path = "", pen = "M";
    (columns[curve.column] || []).forEach((v, i) => {
      if (!finite(v)) { pen = "M"; return; }
      path += `${pen}${px(x[i]).toFixed(1)} ${py(v).toFixed(1)}`;
      pen = "L";
    });
    parts.push(made("path", "", { d: path, fill: "none", stroke: curve.colour, "stroke-width": 1.4 }));
  });
  svg.replaceChildren(...parts);
}

async function history(present) {
  // A run that was resumed has fewer rows than before.
  if ((columns.step || []).at(-1) > (present ?? -1)) for (const name of Object.keys(columns)) delete columns[name];
  const last = (columns.step || []).at(-1) ?? -1;
  const answer = await call(`history.json?after=${last}`);
  if (!answer.ok) return;
  for (const [name, values] of Object.entries((await answer.json()).columns)) columns[name] = (columns[name] || []).concat(values);
}

async function picture(frame) {
  const name = by("field").value, wanted = `${name} ${frame}`;
  if (frame < 0 || wanted === shownFrame) return;
  shownFrame = wanted;
  const answer = await call(`field.png?name=${encodeURIComponent(name)}`);
  if (!answer.ok) { shownFrame = ""; return; }
  const image = by("picture"), old = image.src;
  image.src = URL.createObjectURL(await answer.blob());
  image.hidden = false;
  if (old.startsWith("blob:")) URL.revokeObjectURL(old);
  by("frame").textContent = `step ${frame}`;
}

function show(state) {
  const finished = state.words.startsWith("finished") ? "finished" : state.status, ended = state.status === "ended", row = state.latest;
  by("words").textContent = state.words;
  by("words").className = `words ${finished}`;
  by("done").style.width = `${100 * (state.share ?? 0)}%`;
  const far = state.travel_end === null ? "" : ` of ${digits(state.travel_end, 4)}`;
  by("progress").textContent = row.step === undefined ? "" : `travel ${row.travel.toFixed(4)}${far} mm, step ${row.step}`;
  by("togo").textContent = ended ? "" : `to go ${clock(state.to_go)}`;
  const age = state.checkpoint_age === null ? "none yet" : `${clock(state.checkpoint_age)} ago`;
  const tiles = [["Cutting force", digits(row.cutting_force, 4), "N/mm"], ["Thrust (feed) force", digits(row.thrust_force, 4), "N/mm"],
    ["Highest temperature", digits(row.max_temperature, 4), "K"], ["Particles", digits(row.nodes, 8), ""], ["Last checkpoint", age, ""]];
  by("tiles").replaceChildren(...tiles.map(([label, value, unit]) => {
    const tile = made("li", "");
    tile.append(made("span", label), made("b", value), made("small", ` ${unit}`));
    return tile;
  }));
  by("warnings").hidden = !(ended && state.warnings.length);
  by("warnings").replaceChildren(...state.warnings.map(text => made("li", text)));
  by("checkpoint").disabled = by("stop").disabled = ended || state.requests.length > 0;
  by("report").hidden = !state.report;
  if (state.requests.length) by("said").textContent = `asked: ${state.requests.join(", ")}; done after the present step`;
  else if (asking) { asking = false; by("said").textContent = "done"; }
}

async function look() {
  try {
    const answer = await call("state.json");
    if (!answer.ok) throw new Error(await answer.text());
    const state = await answer.json();
    show(state);
    await history(state.latest.step);
    plot("forces", [{ column: "cutting_force", colour: "#0b5c8c" }, { column: "thrust_force", colour: "#b3261e" }], state.travel_end, true);
    plot("temperature", [{ column: "max_temperature", colour: "#c96f00" }], state.travel_end, false);
    plot("nodes", [{ column: "nodes", colour: "#2a8a2a" }], state.travel_end, true);
    plot("newton", [{ column: "newton_iterations", colour: "#5b3a8c" }], state.travel_end, true);
    await picture(state.frame);
  } catch (error) {
    by("words").textContent = `no answer from pfemcut watch (${error.message})`;
    by("words").className = "words lost";
  }
  setTimeout(look, 2000);
}

async function ask(what) {
  by("said").textContent = "asking";
  const answer = await call(what, "POST");
  by("said").textContent = await answer.text();
  asking = answer.ok;
}

by("checkpoint").addEventListener("click", () => ask("checkpoint"));
by("stop").addEventListener("click", () => { if (confirm("Stop the run after the present step? It can be resumed.")) ask("stop"); });
by("field").addEventListener("change", () => { shownFrame = ""; });
look();
