"use strict";
// One explorer: points, table and robot of a sweep. `data` is what sweep/explorer.py makes.
function explorer(place, data) {
  const columns = data.columns, count = data.front.length;
  const numeric = columns.filter((c) => c.values.some((v) => typeof v === "number"));
  const byName = (name) => columns.find((c) => c.name === name);
  const find = (selector) => place.querySelector(selector);
  const state = { order: columns[columns.length - 1].name, down: false, chosen: -1 };
  const fill = (select, options, value) => {
    select.innerHTML = "";
    options.forEach((c) => select.add(new Option(c.label, c.name)));
    select.value = value;
  };
  const axes = numeric.filter((c) => c.axis), measured = numeric.filter((c) => !c.axis);
  const firstView = data.views[0] || {
    x: (measured[0] || axes[0]).name, y: (measured[1] || measured[0] || axes[0]).name, colour: "variant" };
  const variants = [...new Set(byName("variant").values)];
  const offered = columns.filter((c) => c.name !== "variant");
  const listed = variants.length > 1 ? columns : offered;
  fill(find(".x"), offered, firstView.x);
  fill(find(".y"), offered, firstView.y);
  fill(find(".colour"), columns, firstView.colour);
  fill(find(".variant"), [{ label: "all", name: "" }, ...variants.map((v) => ({ label: v, name: v }))], "");
  find(".variant").parentElement.hidden = variants.length < 2;
  // Variants of a map of two parameters lie on each other, so that one is shown at a time.
  const showView = (view) => {
    for (const key of ["x", "y", "colour"]) find("." + key).value = view[key];
    find(".variant").value = byName(view.colour).axis || view.colour === "variant" ? "" : variants[0];
  };
  showView(firstView);
  fill(find(".filter"), numeric, numeric[numeric.length - 1].name);
  data.views.forEach((view) => {
    const button = document.createElement("button");
    button.textContent = view.text;
    button.onclick = () => {
      showView(view);
      draw();
    };
    find(".views").append(button);
  });
  find(".others").parentElement.hidden = !data.grid;
  find(".front").parentElement.hidden = !data.front.some((v) => v);
  // Viridis without its darkest fifth, which a dark page swallows.
  const scale = ["#414487", "#2a788e", "#22a884", "#7ad151", "#fde725"].map((c, i) => [i / 4, c]);
  const dark = matchMedia("(prefers-color-scheme: dark)");

  // Parameters that are held: where none is on an axis of the plot, every design belongs to it.
  function heldColumns() {
    const used = [find(".x").value, find(".y").value, find(".colour").value];
    return find(".others").checked && data.grid && used.some((name) => byName(name).axis)
      ? columns.filter((c) => c.axis && !used.includes(c.name)) : [];
  }

  function shown() {
    const low = parseFloat(find(".low").value), high = parseFloat(find(".high").value);
    const filter = byName(find(".filter").value).values;
    const held = heldColumns();
    const variant = find(".variant").value;
    const near = (c, v) => v === c.base || Math.abs(v - c.base) <= 1e-4 * Math.abs(c.base);
    const rows = [];
    for (let i = 0; i < count; i++) {
      if (find(".front").checked && !data.front[i]) continue;
      if (variant && byName("variant").values[i] !== variant) continue;
      if (filter[i] < low || filter[i] > high) continue;
      if (held.some((c) => !near(c, c.values[i]))) continue;
      rows.push(i);
    }
    return rows;
  }

  function hover(i) {
    return listed.map((c) => `${c.label}: ${c.values[i] ?? "–"}`).join("<br>");
  }

  function draw() {
    const x = byName(find(".x").value), y = byName(find(".y").value);
    const colour = byName(find(".colour").value), rows = shown();
    const style = getComputedStyle(document.documentElement);
    const ink = style.getPropertyValue("--ink"), line = style.getPropertyValue("--line");
    const groups = numeric.includes(colour) ? [null] : [...new Set(colour.values)];
    const traces = groups.map((group) => {
      const own = rows.filter((i) => (group === null || colour.values[i] === group)
        && x.values[i] !== null && y.values[i] !== null);
      const pick = (values) => own.map((i) => values[i]);
      const trace = {
        type: "scatter", mode: "markers", x: pick(x.values), y: pick(y.values),
        text: own.map(hover), hoverinfo: "text", customdata: own,
        name: group === null ? colour.label : group.replaceAll("_", " "),
        showlegend: group !== null && groups.length > 1,
        marker: {
          size: own.map((i) => (i === state.chosen ? 17 : data.front[i] ? 11 : 8)),
          symbol: own.map((i) => (data.front[i] ? "diamond" : "circle")),
          line: { width: own.map((i) => (i === state.chosen ? 3 : 0.5)), color: ink },
          opacity: group === null ? 1 : 0.85,
        },
      };
      if (group !== null) trace.marker.color = data.colours[group]; // plotly's own where there is none
      else Object.assign(trace.marker, { color: pick(colour.values), colorscale: scale,
        showscale: true, colorbar: { title: { text: colour.label, side: "right" }, thickness: 12 } });
      if (y.low) trace.error_y = { type: "data", symmetric: false, thickness: 1,
        array: own.map((i) => y.high[i] - y.values[i]), arrayminus: own.map((i) => y.values[i] - y.low[i]) };
      return trace;
    });
    const axis = (c) => ({ title: { text: c.label },
      type: !numeric.includes(c) ? "category" : c.log ? "log" : "linear",
      gridcolor: line, zerolinecolor: line, automargin: true });
    Plotly.react(find(".plot"), traces, {
      xaxis: axis(x), yaxis: axis(y), font: { color: ink, size: 12 }, hovermode: "closest",
      dragmode: matchMedia("(pointer: coarse)").matches ? false : "zoom",
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
      margin: { l: 50, r: 10, t: 10, b: 40 }, legend: { orientation: "h", y: 1.12 },
    }, { responsive: true, displayModeBar: false });
    drawTable(rows);
  }

  function drawTable(rows) {
    const order = byName(state.order).values, sign = state.down ? -1 : 1;
    const missing = (v) => v === null || v === undefined;
    rows.sort((a, b) => {
      if (missing(order[a]) || missing(order[b])) return missing(order[a]) - missing(order[b]);
      return sign * (order[a] < order[b] ? -1 : order[a] > order[b] ? 1 : a - b);
    });
    const head = find(".scroll thead"), body = find(".scroll tbody");
    head.innerHTML = body.innerHTML = "";
    const top = head.insertRow();
    listed.forEach((c) => {
      const cell = document.createElement("th"), button = document.createElement("button");
      const mark = c.name === state.order ? (state.down ? " ▼" : " ▲") : "";
      button.textContent = c.label + mark;
      button.onclick = () => {
        state.down = c.name === state.order && !state.down;
        state.order = c.name;
        drawTable(shown());
      };
      cell.setAttribute("aria-sort", mark ? (state.down ? "descending" : "ascending") : "none");
      cell.append(button);
      top.append(cell);
    });
    rows.slice(0, 50).forEach((i) => {
      const row = body.insertRow();
      row.dataset.row = i;
      row.className = i === state.chosen ? "chosen" : "";
      row.onclick = () => choose(i);
      listed.forEach((c) => {
        const cell = row.insertCell();
        cell.textContent = c.values[i] ?? "–";
        if (typeof c.values[i] === "number") cell.className = "num";
      });
    });
    find(".count").textContent = `${rows.length} of ${data.shown}`
      + (rows.length > 50 ? "; the first 50 in the table" : "")
      + (heldColumns().length ? "; in the others, further parameters are changed" : "");
  }

  function choose(i) {
    state.chosen = i;
    const lines = data.drawings[data.robot[i]], svg = find("svg.robot"), all = data.drawings.flat();
    const xs = all.flatMap((l) => [l[0], l[2]]), zs = all.flatMap((l) => [l[1], l[3]]);
    // One scale for all robots of the page, so that a longer leg looks longer.
    const low = Math.min(...xs) - 60, width = Math.max(...xs) + 60 - low, high = Math.max(...zs) + 60;
    svg.setAttribute("viewBox", `${low} ${-high} ${width} ${high + 60}`);
    svg.innerHTML = `<line class="floor" x1="${low}" y1="20" x2="${low + width}" y2="20"/>` + lines.map(
      (l) => `<line x1="${l[0]}" y1="${-l[1]}" x2="${l[2]}" y2="${-l[3]}"/>`
        + `<circle cx="${l[0]}" cy="${-l[1]}" r="16"/>`).join("");
    find(".look").textContent = data.look[i];
    find(".values").innerHTML = "";
    listed.forEach((c) => {
      const row = find(".values").insertRow();
      row.insertCell().textContent = c.label;
      const cell = row.insertCell();
      cell.textContent = c.values[i] ?? "–";
      cell.className = "num";
    });
    find(".detail").hidden = false;
    draw();
  }

  place.querySelectorAll("select, input").forEach((control) => { control.oninput = draw; });
  dark.addEventListener("change", draw);
  draw();
  find(".plot").on("plotly_click", (event) => choose(event.points[0].customdata));
}
