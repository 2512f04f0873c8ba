// Makes the figures zoomable. Without it, the drawings stand as they are.
(() => {
  "use strict";

  const dark = matchMedia("(prefers-color-scheme: dark)");
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
  const COLOURS = { before: "before", after: "after", effect: "effect", rest: "rest", window: "window" };
  const FONT = "12px system-ui, sans-serif";

  /// Columns as uPlot takes them: null ends a line, undefined does not.
  function columns(data) {
    let place = 0;
    const places = data.places.map((difference) => (place += difference) * data.x.step);
    const value = (cell) => (cell === "-" ? null : cell === null ? undefined : cell * data.y.step);
    return [places, ...data.series.map((series) => series.values.map(value))];
  }

  /// The ends of all values with a margin: before and after are compared on one axis.
  function heights(all) {
    const values = all.slice(1).flat().filter((value) => typeof value === "number");
    const [low, high] = values.reduce(([low, high], value) => [Math.min(low, value), Math.max(high, value)], [0, 0]);
    const margin = 0.05 * (high - low);
    return [low - margin, high + margin];
  }

  const text = (value) => String(+value.toPrecision(10)).replace("-", "−");

  /// The recording at a place of the time axis.
  const panelAt = (data, place) => data.panels.findLast((panel) => place >= panel.at - 1e-9) ?? data.panels[0];

  /// Ticks of a time axis that runs through several recordings, round on each one's own clock.
  function ticks(data) {
    return (plot, axis, from, to, step) =>
      data.panels.flatMap((panel) => {
        const first = Math.max(panel.from, from - panel.at + panel.from);
        const last = Math.min(panel.from + panel.length, to - panel.at + panel.from);
        const list = [];
        for (let k = Math.ceil(first / step - 1e-6); k * step <= last + 1e-9; k++) list.push(k * step - panel.from + panel.at);
        return list;
      });
  }

  /// The background: joints at rest, stretches with a large residual, the recordings' frames and names.
  function background(data) {
    return (plot) => {
      const { ctx, bbox } = plot;
      ctx.save();
      ctx.beginPath();
      ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
      ctx.clip();
      for (const [from, to, kind] of data.shades) {
        const [left, right] = [from, to].map((place) => plot.valToPos(place, "x", true));
        ctx.globalAlpha = kind === "window" ? 0.45 : 1;
        ctx.fillStyle = colour(COLOURS[kind]);
        ctx.fillRect(left, bbox.top, Math.max(right - left, 2), bbox.height);
      }
      ctx.restore();
    };
  }

  function names(data) {
    return (plot) => {
      const { ctx, bbox } = plot;
      const ratio = devicePixelRatio;
      ctx.save();
      ctx.font = `${12 * ratio}px system-ui, sans-serif`;
      ctx.textAlign = "left";
      ctx.textBaseline = "bottom";
      ctx.fillStyle = colour("soft");
      ctx.strokeStyle = colour("line");
      for (const panel of data.panels) {
        const ends = [panel.at, panel.at + panel.length].map((place) => plot.valToPos(place, "x", true));
        const left = Math.max(ends[0], bbox.left);
        const right = Math.min(ends[1], bbox.left + bbox.width);
        if (right - left < 4) continue;
        ctx.strokeRect(left, bbox.top, right - left, bbox.height);
        const number = panel.name.split(" · ")[0];
        const fits = [panel.name, number].find((name) => ctx.measureText(name).width < right - left);
        if (fits) ctx.fillText(fits, left, bbox.top - 4 * ratio);
      }
      ctx.restore();
    };
  }

  /// One figure of `data` in `slot`.
  function plot(data, all, number, slot, share) {
    const shown = data.series.map((series, k) => [series, k + 1]).filter(([series]) => series.on.includes(number));
    const isTime = data.panels.length > 0;
    const axis = { stroke: colour("soft"), font: FONT, labelFont: FONT, grid: { stroke: colour("line"), width: 1 }, ticks: { stroke: colour("faint"), width: 1 } };
    const series = shown.map(([series]) => ({
      label: series.name,
      stroke: colour(COLOURS[series.colour]),
      width: series.colour === "effect" ? 1.8 : 1.2,
      paths: series.dots ? () => null : undefined,
      points: { show: series.dots, size: 4, width: 0, fill: colour(COLOURS[series.colour]) },
      value: (u, value) => (value == null ? "–" : text(+value.toPrecision(3))),
    }));
    const time = (place) => {
      const panel = panelAt(data, place);
      return `${text(+(place - panel.at + panel.from).toFixed(3))} s of ${panel.name}`;
    };
    const narrow = slot.clientWidth < 500;
    const options = {
      width: slot.clientWidth,
      height: isTime ? 250 : narrow ? 250 : 290,
      padding: [isTime ? 18 : 8, 8, 0, 0],
      scales: { x: { time: false }, y: isTime ? {} : { range: () => heights(all) } },
      cursor: { drag: { x: true, y: !isTime, uni: 24 }, points: { size: 6 } },
      legend: { live: true, markers: { width: 0, fill: (u, k) => u.series[k].stroke() } },
      series: [
        { label: isTime ? "time" : data.x.title.replace(/ \(.*/, ""), value: (u, place) => (place == null ? "–" : isTime ? time(place) : text(+place.toPrecision(4))) },
        ...series,
      ],
      axes: [
        {
          ...axis,
          label: data.x.title,
          labelSize: 20,
          space: isTime && !narrow ? 70 : 44,
          splits: isTime ? ticks(data) : undefined,
          values: (u, places) => places.map((place) => { const panel = isTime && panelAt(data, place); return text(panel ? place - panel.at + panel.from : place); }),
        },
        { ...axis, label: data.y.title, labelSize: 20, size: 52, values: (u, values) => values.map(text) },
      ],
      hooks: {
        drawClear: [background(data)],
        draw: [names(data)],
        setScale: [(u, key) => key === "x" && share(u)],
      },
    };
    if (shown.filter(([series]) => series.colour === "effect").length === 2) {
      const [from, to] = shown.flatMap(([series], k) => (series.colour === "effect" ? [k + 1] : []));
      options.bands = [{ series: [to, from], fill: colour("effect") + "28" }];
      for (const k of [from, to]) options.series[k].spanGaps = false;
    }
    return new uPlot(options, [all[0], ...shown.map(([, k]) => all[k])], slot);
  }

  /// Zooms and moves all plots of a figure.
  function buttons(plots, ends, all) {
    const bar = document.createElement("div");
    bar.className = "zoom";
    const set = (change) => {
      const { min, max } = plots[0].scales.x;
      let [from, to] = change(min, max);
      const room = ends[1] - ends[0];
      const span = Math.min(Math.max(to - from, room / 1000), room);
      from = Math.min(Math.max(from, ends[0]), ends[1] - span);
      const [first, last] = span === room ? ends : [from, from + span];
      for (const one of plots) one.setScale("x", { min: first, max: last });
      if (span === room && plots.length > 1) {
        const [min, max] = heights(all);
        for (const one of plots) one.setScale("y", { min, max });
      }
    };
    const actions = [
      ["+", "zoom in", (from, to) => [from + (to - from) / 4, to - (to - from) / 4]],
      ["−", "zoom out", (from, to) => [from - (to - from) / 2, to + (to - from) / 2]],
      ["‹", "earlier", (from, to) => [from - (to - from) / 4, to - (to - from) / 4]],
      ["›", "later", (from, to) => [from + (to - from) / 4, to + (to - from) / 4]],
      ["whole", "show all", () => ends],
    ];
    for (const [sign, words, change] of actions) {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = sign;
      button.title = words;
      button.setAttribute("aria-label", words);
      button.addEventListener("click", () => set(change));
      bar.append(button);
    }
    return bar;
  }

  function live(figure) {
    const data = JSON.parse(figure.querySelector("script").textContent);
    const all = columns(data);
    const ends = [all[0][0], all[0].at(-1)];
    let plots = [];
    let bar = null;
    let width = 0;
    const draw = () => {
      const view = plots[0] && { ...plots[0].scales.x };
      for (const one of plots) one.destroy();
      bar?.remove();
      width = figure.clientWidth;
      let busy = true;
      const share = (source) => {
        if (busy) return;
        busy = true;
        const { min, max } = source.scales.x;
        for (const one of plots) if (one !== source) one.setScale("x", { min, max });
        busy = false;
      };
      figure.classList.add("live");
      plots = [...figure.querySelectorAll(".plot")].map((slot, number) => plot(data, all, number, slot, share));
      busy = false;
      if (view) for (const one of plots) one.setScale("x", { min: view.min, max: view.max });
      bar = buttons(plots, ends, all);
      figure.append(bar);
    };
    draw();
    dark.addEventListener("change", draw);
    new ResizeObserver(() => { if (Math.abs(figure.clientWidth - width) > 2 && figure.clientWidth > 0) draw(); }).observe(figure);
  }

  const watcher = new IntersectionObserver(
    (entries) => {
      for (const entry of entries.filter((entry) => entry.isIntersecting)) {
        watcher.unobserve(entry.target);
        live(entry.target);
      }
    },
    { rootMargin: "600px" },
  );
  for (const figure of document.querySelectorAll(".zoomable")) watcher.observe(figure);
})();
