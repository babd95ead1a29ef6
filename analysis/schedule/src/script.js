"use strict";
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const raw = Uint8Array.from(atob(data.bars), c => c.charCodeAt(0));
  const view = new DataView(raw.buffer);
  const NONE = 0xffffffff, PART = 0x80000000, BYTES = 14, ROW = 20, LEFT = 130, HEAD = 34;
  const el = id => document.getElementById(id);
  document.querySelector(".bar").hidden = false;

  // Bars by machine, in the order of time.
  const rows = data.machines.map(() => ({ from: [], to: [], state: [], who: [] }));
  for (let at = 0; at < raw.length; at += BYTES) {
    const packed = view.getUint16(at + 8, true), row = rows[packed & 4095];
    const from = view.getUint32(at, true) / 10;
    row.from.push(from);
    row.to.push(from + view.getUint32(at + 4, true) / 10);
    row.state.push(packed >> 12);
    row.who.push(view.getUint32(at + 10, true));
  }
  const groups = [];
  data.machines.forEach((machine, index) => {
    const last = groups[groups.length - 1];
    if (last && last.name === machine.group) last.members.push(index);
    else groups.push({ name: machine.group, members: [index], folded: false });
  });

  const DAY = 86400, WEEK = 7 * DAY;
  let from = data.from, to = Math.min(data.from + WEEK, data.horizon), lit = null, hover = null;
  const chart = el("chart"), strip = el("strip");
  let inks = {};
  const readInks = () => {
    const style = getComputedStyle(document.documentElement);
    inks = {};
    for (const name of ["--ink", "--paper", "--line", "--soft", "--off", "--mark"]) inks[name] = style.getPropertyValue(name).trim();
  };
  const css = name => inks[name];
  const hue = index => `hsl(${(index * 137.508) % 360} 55% 52%)`;
  const partOf = who => who === NONE ? -1 : who & PART ? who & ~PART : data.orders[who].part;
  let by = "state";
  const colour = (state, who) => {
    if (data.states[state].off) return css("--off");
    if (by === "state" || who === NONE || !data.states[state].job) return data.states[state].colour;
    if (by === "part") return hue(partOf(who));
    if (who & PART) return "#9aa5b1";
    const late = data.orders[who].late;
    return late === null ? "#7b3294" : late > 0 ? "#c2410c" : late > -DAY ? "#d9a400" : "#2e8b57";
  };

  // Times as dates, or as hours since the start.
  const two = n => String(n).padStart(2, "0");
  const shown = (time, short) => {
    if (data.start === null) return `${+(time / 3600).toFixed(2)} h`;
    const d = new Date((data.start + time) * 1000);
    const day = `${d.getUTCFullYear()}-${two(d.getUTCMonth() + 1)}-${two(d.getUTCDate())}`;
    const clock = `${two(d.getUTCHours())}:${two(d.getUTCMinutes())}`;
    return short === "clock" ? clock : short === "day" ? day : `${day} ${clock}`;
  };
  const STEPS = [60, 300, 900, 3600, 3 * 3600, 6 * 3600, 12 * 3600, DAY, WEEK, 4 * WEEK, 13 * WEEK];
  const ticks = width => {
    const step = STEPS.find(own => (to - from) / own * 96 < width) || 52 * WEEK;
    // Weeks begin on Mondays: 1970-01-05 was one.
    const base = data.start === null ? 0 : data.start - (step >= WEEK ? 4 * DAY : 0);
    const all = [];
    for (let time = Math.ceil((from + base) / step) * step - base; time <= to; time += step) all.push(time);
    return { step, all };
  };
  const lines = () => {
    const all = [];
    for (const group of groups) {
      if (groups.length > 1 && group.members.length > 1) all.push({ group });
      if (!group.folded || group.members.length === 1) group.members.forEach(machine => all.push({ machine, group }));
    }
    return all;
  };
  const x = (time, width) => LEFT + (time - from) / (to - from) * (width - LEFT);
  const first = (row, time) => {
    let low = 0, high = row.to.length;
    while (low < high) {
      const mid = low + high >> 1;
      if (row.to[mid] <= time) low = mid + 1; else high = mid;
    }
    return low;
  };

  // Hands out rectangles of a row: bars of two pixels and more as they are, narrower ones as density by pixel.
  const rectangles = (machines, width, put) => {
    const sums = new Float32Array(Math.ceil(width) + 1), most = new Float32Array(sums.length), fills = [];
    for (const machine of machines) {
      const row = rows[machine];
      for (let i = first(row, from); i < row.from.length && row.from[i] < to; i++) {
        const a = Math.max(x(row.from[i], width), LEFT), b = Math.min(x(row.to[i], width), width);
        const faded = lit !== null && row.who[i] !== lit && !data.states[row.state[i]].off;
        if (b - a >= 2 && machines.length === 1) {
          put(a, b - a, colour(row.state[i], row.who[i]), faded ? 0.18 : 1, i);
        } else if (!data.states[row.state[i]].off) {
          for (let p = Math.floor(a); p < b; p++) {
            const share = (Math.min(b, p + 1) - Math.max(a, p)) / machines.length;
            const weight = faded ? share * 0.18 : share;
            sums[p] += weight;
            if (weight > most[p]) { most[p] = weight; fills[p] = colour(row.state[i], row.who[i]); }
          }
        }
      }
    }
    for (let p = 0; p < sums.length; p++) if (sums[p] > 0) put(p, 1, fills[p], Math.min(1, sums[p]), null);
  };
  const fit = (canvas, height) => {
    const ratio = devicePixelRatio || 1, width = canvas.clientWidth;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      canvas.style.height = `${height}px`;
    }
    const pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = "12px system-ui, sans-serif";
    pen.textBaseline = "middle";
    return [pen, width];
  };
  const cut = (pen, text, room) => {
    if (pen.measureText(text).width <= room) return text;
    while (text.length > 1 && pen.measureText(`${text}…`).width > room) text = text.slice(0, -1);
    return `${text}…`;
  };
  const name = who => who === NONE ? "" : who & PART ? data.parts[who & ~PART] : data.orders[who].id;

  const draw = () => {
    const all = lines(), height = HEAD + all.length * ROW + 4;
    const [pen, width] = fit(chart, height);
    const { step, all: at } = ticks(width - LEFT);
    pen.fillStyle = css("--ink");
    let day = "";
    for (const time of at) {
      const px = x(time, width);
      if (px < LEFT) continue;
      const date = shown(time, "day");
      pen.fillStyle = css("--line");
      pen.fillRect(px, 18, step >= DAY || date !== day ? 1.5 : 0.7, height);
      pen.fillStyle = css("--ink");
      if (data.start === null) pen.fillText(shown(time), px + 3, 26);
      else {
        if (step < DAY) pen.fillText(shown(time, "clock"), px + 3, 26);
        if (date !== day || step >= DAY) pen.fillText(date, px + 3, step < DAY ? 10 : 26);
      }
      day = date;
    }
    // Rows that are scrolled out of sight are drawn when they come into it.
    const high = el("frame").scrollTop, low = high + el("frame").clientHeight;
    all.forEach((line, place) => {
      const top = HEAD + place * ROW;
      if (top + ROW < high || top > low) return;
      const machines = line.machine === undefined ? line.group.folded ? line.group.members : [] : [line.machine];
      rectangles(machines, width, (left, wide, fill, alpha, bar) => {
        pen.globalAlpha = alpha;
        pen.fillStyle = fill;
        pen.fillRect(left, top + 2, Math.max(wide - (wide > 4 ? 0.6 : 0), 0.6), ROW - 4);
        if (bar !== null && wide > 34) {
          const row = rows[line.machine];
          if (data.states[row.state[bar]].job && row.who[bar] !== NONE) {
            pen.fillStyle = "#fff";
            pen.fillText(cut(pen, name(row.who[bar]), wide - 6), left + 3, top + ROW / 2 + 0.5);
          }
        }
      });
      pen.globalAlpha = 1;
      pen.fillStyle = css("--paper");
      pen.fillRect(0, top, LEFT - 2, ROW);
      pen.fillStyle = css("--ink");
      const inner = line.machine !== undefined && line.group.members.length > 1 && groups.length > 1;
      const label = line.machine === undefined ? `${line.group.folded ? "▸" : "▾"} ${line.group.name} (${line.group.members.length})` : data.machines[line.machine].name;
      pen.font = line.machine === undefined ? "bold 12px system-ui, sans-serif" : "12px system-ui, sans-serif";
      pen.fillText(cut(pen, label, LEFT - 14), inner ? 20 : 8, top + ROW / 2);
      pen.font = "12px system-ui, sans-serif";
      pen.fillStyle = css("--soft");
      pen.fillRect(0, top + ROW - 0.5, width, 0.5);
    });
    if (lit !== null && !(lit & PART) && data.orders[lit].due !== null) {
      const px = x(data.orders[lit].due, width);
      if (px >= LEFT && px <= width) {
        pen.fillStyle = css("--mark");
        pen.fillRect(px - 1, HEAD - 6, 2, height);
        pen.fillText("due", px + 4, HEAD - 4);
      }
    }
    drawStrip();
  };
  const drawStrip = () => {
    const [pen, width] = fit(strip, 46);
    const scale = (width - LEFT) / data.horizon;
    if (!strip.load || strip.load.length !== Math.max(1, Math.floor(width - LEFT))) {
      const load = new Float32Array(Math.max(1, Math.floor(width - LEFT)));
      rows.forEach(row => row.from.forEach((start, i) => {
        if (!data.states[row.state[i]].busy) return;
        const a = start * scale, b = row.to[i] * scale;
        for (let p = Math.floor(a); p < b && p < load.length; p++) load[p] += Math.min(b, p + 1) - Math.max(a, p);
      }));
      strip.load = load;
    }
    pen.fillStyle = "#4c78a8";
    strip.load.forEach((sum, p) => {
      const tall = 34 * sum / rows.length;
      pen.fillRect(LEFT + p, 42 - tall, 1, tall);
    });
    pen.strokeStyle = css("--mark");
    pen.lineWidth = 1.5;
    pen.strokeRect(LEFT + from * scale, 2, Math.max(3, (to - from) * scale), 42);
    pen.fillStyle = css("--ink");
    pen.fillText("machines busy", 8, 23);
  };
  let due = false;
  const redraw = () => {
    if (due) return;
    due = true;
    requestAnimationFrame(() => { due = false; draw(); });
  };
  const show = (a, b) => {
    const long = Math.min(Math.max(b - a, 60), data.horizon);
    from = Math.min(Math.max(a, 0), data.horizon - long);
    to = from + long;
    redraw();
  };
  const zoom = (factor, centre = (from + to) / 2) => show(centre - (centre - from) * factor, centre + (to - centre) * factor);
  const timeAt = px => from + (px - LEFT) / (chart.clientWidth - LEFT) * (to - from);
  const found = event => {
    const box = chart.getBoundingClientRect(), px = event.clientX - box.left;
    const line = lines()[Math.floor((event.clientY - box.top - HEAD) / ROW)];
    if (!line) return null;
    if (px < LEFT) return { line };
    if (line.machine === undefined) return { line, within: true };
    const row = rows[line.machine], time = timeAt(px), i = first(row, time);
    return i < row.from.length && row.from[i] <= time ? { line, row, i, within: true } : { line, within: true };
  };
  const tell = text => { el("told").textContent = text; };
  const aboutOrder = who => {
    if (who & PART) return data.parts[who & ~PART];
    const own = data.orders[who];
    const parts = [`order ${own.id}`, data.parts[own.part], own.customer, `due ${shown(own.due)}`];
    parts.push(own.finish === null ? "not finished in this run" : `finished ${shown(own.finish)}`);
    if (own.late !== null) parts.push(own.late > 0 ? `${(own.late / 3600).toFixed(1)} h late` : "in time");
    return parts.filter(Boolean).join(", ");
  };
  const light = who => {
    lit = who;
    tell(who === null ? "" : aboutOrder(who));
    redraw();
  };

  chart.addEventListener("wheel", event => {
    if (!event.ctrlKey && event.shiftKey) return;
    event.preventDefault();
    if (Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
      const by = event.deltaX / chart.clientWidth * (to - from);
      show(from + by, to + by);
    } else zoom(Math.exp(event.deltaY * 0.0015), timeAt(event.clientX - chart.getBoundingClientRect().left));
  }, { passive: false });
  let drag = null;
  chart.addEventListener("pointerdown", event => {
    drag = { px: event.clientX, from, to, moved: false };
    chart.setPointerCapture(event.pointerId);
  });
  chart.addEventListener("pointermove", event => {
    if (drag) {
      const by = (drag.px - event.clientX) / (chart.clientWidth - LEFT) * (drag.to - drag.from);
      if (Math.abs(event.clientX - drag.px) > 3) drag.moved = true;
      if (drag.moved) show(drag.from + by, drag.to + by);
      return;
    }
    const at = found(event);
    if (at && at.row) {
      const state = data.states[at.row.state[at.i]].name, who = at.row.who[at.i];
      const span = `${shown(at.row.from[at.i])} to ${shown(at.row.to[at.i])}`;
      tell([data.machines[at.line.machine].name, state, span, who === NONE ? "" : aboutOrder(who)].filter(Boolean).join(" · "));
    } else if (lit !== null) tell(aboutOrder(lit));
  });
  chart.addEventListener("pointerup", event => {
    const moved = drag && drag.moved;
    drag = null;
    if (moved) return;
    const at = found(event);
    if (at && !at.within && at.line.machine === undefined) {
      at.line.group.folded = !at.line.group.folded;
      redraw();
    } else light(at && at.row && at.row.who[at.i] !== NONE ? at.row.who[at.i] : null);
  });
  chart.addEventListener("keydown", event => {
    const by = (to - from) / 5;
    const act = {
      "+": () => zoom(0.6), "=": () => zoom(0.6), "-": () => zoom(1 / 0.6), ArrowLeft: () => show(from - by, to - by),
      ArrowRight: () => show(from + by, to + by), Home: () => show(data.from, data.from + WEEK), "0": () => show(0, data.horizon), Escape: () => light(null),
    }[event.key];
    if (act) { event.preventDefault(); act(); }
  });
  const jump = event => {
    const time = (event.clientX - strip.getBoundingClientRect().left - LEFT) / (strip.clientWidth - LEFT) * data.horizon;
    show(time - (to - from) / 2, time + (to - from) / 2);
  };
  strip.addEventListener("pointerdown", event => { strip.setPointerCapture(event.pointerId); jump(event); });
  strip.addEventListener("pointermove", event => { if (event.buttons) jump(event); });
  el("in").onclick = () => zoom(0.6);
  el("out").onclick = () => zoom(1 / 0.6);
  el("week").onclick = () => show(data.from, data.from + WEEK);
  el("all").onclick = () => show(0, data.horizon);
  el("by").onchange = () => { by = el("by").value; legend(); redraw(); };
  el("frame").addEventListener("scroll", redraw);
  for (const entry of [...data.orders.map(own => own.id), ...data.machines.map(own => own.name)]) {
    const option = document.createElement("option");
    option.value = entry;
    el("names").append(option);
  }
  el("find").onchange = () => {
    const text = el("find").value.trim();
    const order = data.orders.findIndex(own => own.id === text);
    if (order >= 0) {
      let [a, b] = [Infinity, -Infinity];
      for (const row of rows) row.who.forEach((who, i) => { if (who === order) { a = Math.min(a, row.from[i]); b = Math.max(b, row.to[i]); } });
      light(order);
      if (a < b) show(a - (b - a) * 0.05, b + (b - a) * 0.05);
      return;
    }
    const place = lines().findIndex(line => line.machine !== undefined && data.machines[line.machine].name === text);
    if (place >= 0) { light(null); el("frame").scrollTop = place * ROW; tell(`machine ${text}`); }
    else tell(text === "" ? "" : `there is no order and no machine ${text}`);
  };
  const legend = () => {
    const box = el("legend");
    box.replaceChildren();
    const add = (fill, text) => {
      const span = document.createElement("span"), chip = document.createElement("i");
      chip.style.background = fill;
      span.append(chip, text);
      box.append(span);
    };
    if (by === "late") [["#2e8b57", "a day early or more"], ["#d9a400", "within a day of its due date"], ["#c2410c", "late"], ["#7b3294", "not finished in this run"]].forEach(([fill, text]) => add(fill, text));
    if (by === "part") data.parts.slice(0, 40).forEach((part, index) => add(hue(index), part));
    data.states.forEach(state => { if (state.used && (by === "state" || !state.job)) add(state.off ? css("--off") : state.colour, state.name); });
  };

  // On paper: the stretch in view as SVG.
  addEventListener("beforeprint", () => {
    const all = lines(), width = 1000, height = HEAD + all.length * ROW;
    const text = value => value.replace(/[&<>"]/g, c => `&#${c.charCodeAt(0)};`);
    const out = [`<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${width} ${height}" font-family="sans-serif" font-size="11">`];
    for (const time of ticks(width - LEFT).all) {
      out.push(`<line x1="${x(time, width)}" x2="${x(time, width)}" y1="20" y2="${height}" stroke="#bbb"/><text x="${x(time, width) + 2}" y="16">${text(shown(time))}</text>`);
    }
    all.forEach((line, place) => {
      const top = HEAD + place * ROW;
      rectangles(line.machine === undefined ? line.group.members : [line.machine], width, (left, wide, fill, alpha) => {
        out.push(`<rect x="${left.toFixed(1)}" y="${top + 2}" width="${wide.toFixed(1)}" height="${ROW - 4}" fill="${fill}" fill-opacity="${alpha.toFixed(2)}"/>`);
      });
      out.push(`<text x="4" y="${top + ROW / 2 + 4}">${text(line.machine === undefined ? line.group.name : data.machines[line.machine].name)}</text>`);
    });
    el("paper").innerHTML = `${out.join("")}</svg>`;
  });
  addEventListener("resize", redraw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { readInks(); legend(); redraw(); });
  readInks();
  by = el("by").value;
  legend();
  draw();
})();
