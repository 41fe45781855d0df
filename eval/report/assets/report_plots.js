// The kinds of plots: a quantity over time, the top view, and boxes.
(function () {
  const draw = report.draw;
  const INK = draw.INK, SOFT = draw.SOFT, AXIS = draw.AXIS, MINUS = draw.minus;
  const frame = draw.frame, drawAxis = draw.axis, logTicks = draw.logTicks, path = draw.path, zip = draw.zip;
  const emptyNotice = draw.emptyNotice, showTooltip = draw.showTooltip;

  // Range of what is visible in the time range.
  function valueDomain(spec, domain) {
    const values = [];
    const take = function (t, v) {
      for (let i = 0; i < t.length; ++i) {
        const ok = v[i] !== null && v[i] !== undefined && t[i] >= domain[0] && t[i] <= domain[1] && (!spec.log || v[i] > 0);
        if (ok) { values.push(v[i]); }
      }
    };
    spec.lines.forEach(function (line) { take(line.t, line.v); });
    // A band far wider than the error would flatten it: it may take three times the error's range, and is cut there.
    const reach = 3 * d3.max(values.map(Math.abs).concat(0));
    const lines = values.length;
    (spec.bands || []).forEach(function (band) { take(band.t, band.hi); take(band.t, band.lo); });
    for (let i = lines; i < values.length; ++i) {
      values[i] = reach > 0 ? Math.max(-reach, Math.min(reach, values[i])) : values[i];
    }
    (spec.regions || []).forEach(function (region) { values.push(region.lo, region.hi); });
    (spec.means || []).forEach(function (mean) { values.push(mean.value); });
    if (spec.zero) { values.push(0); }
    if (!values.length) { return spec.log ? [0.1, 10] : [-1, 1]; }  // nothing in the zoomed range
    const low = d3.min(values), high = d3.max(values);
    if (spec.log) { return [low / 1.3, high * 1.3]; }
    const pad = 0.06 * (high - low) || Math.abs(high) * 0.1 || 1;
    return [spec.zero && low >= 0 ? 0 : low - pad, high + pad];
  }

  function drawGround(plot, spec, x, y) {
    (spec.regions || []).forEach(function (region) {
      plot.area.append('rect').attr({ x: 0, width: plot.inner.width, y: y(region.hi), height: y(region.lo) - y(region.hi),
        fill: '#dfeee6', 'clip-path': plot.clip });
    });
    (spec.bands || []).forEach(function (band) {
      const points = band.t.map(function (t, i) { return [t, band.lo[i], band.hi[i]]; });
      const shape = d3.svg.area().defined(function (p) { return p[1] !== null && p[2] !== null && p[1] !== undefined && p[2] !== undefined; })
        .x(function (p) { return x(p[0]).toFixed(1); }).y0(function (p) { return y(p[1]).toFixed(1); })
        .y1(function (p) { return y(p[2]).toFixed(1); });
      plot.area.append('path').attr({ class: 'band', d: shape(points), fill: band.style.colour, 'fill-opacity': spec.bands.length > 3 ? 0.04 : 0.1,
        stroke: band.style.colour, 'stroke-opacity': 0.45, 'stroke-width': 0.8, 'clip-path': plot.clip });
    });
  }

  // Of many lines only the one whose value is nearest to `value`.
  function readLines(spec, time, value) {
    if (spec.lines.length <= 12 || value === null) { return spec.lines.slice(0, 12); }
    const off = function (line) {
      const i = report.nearest(line.t, time);
      return i < 0 || line.v[i] === null ? Infinity : Math.abs(line.v[i] - value);
    };
    return [spec.lines.reduce(function (a, b) { return off(b) < off(a) ? b : a; })];
  }

  function readout(spec, time, value) {
    const rows = readLines(spec, time, value).map(function (line) {
      const i = report.nearest(line.t, time);
      const value = i < 0 ? null : line.v[i];
      return '<tr><td>' + report.swatch(line.style) + report.escape(line.name) + '</td><td>' +
        MINUS(report.digits(value)) + ' ' + report.escape(spec.unit) + '</td></tr>';
    });
    return '<b>t = ' + time.toFixed(2) + ' s</b><table>' + rows.join('') + '</table>';
  }

  // Cursor, readout, drag to zoom and double click to undo.
  function attachPointer(plot, spec, x, y) {
    const cursor = plot.area.append('line').attr({ class: 'cursor', y1: 0, y2: plot.inner.height, stroke: SOFT,
      'stroke-dasharray': '3 3', visibility: 'hidden' });
    const span = plot.area.append('rect').attr({ class: 'cursor', y: 0, height: plot.inner.height, fill: '#0b5cad',
      'fill-opacity': 0.12, visibility: 'hidden' });
    const overlay = plot.area.append('rect').attr({ class: 'overlay', width: plot.inner.width, height: plot.inner.height,
      fill: 'none', 'pointer-events': 'all' });
    let start = null;
    const place = function () { return Math.max(0, Math.min(plot.inner.width, d3.mouse(overlay.node())[0])); };
    overlay.on('mousedown', function () { start = place(); d3.event.preventDefault(); })
      .on('mousemove', function () {
        const at = place();
        const time = x.invert(at);
        report.view.plots.forEach(function (other) { other.hover(time); });
        showTooltip(readout(spec, time, y.invert(d3.mouse(overlay.node())[1])), d3.event);
        if (start !== null) {
          span.attr({ x: Math.min(start, at), width: Math.abs(at - start), visibility: 'visible' });
        }
      })
      .on('mouseup', function () {
        const at = place();
        const from = start;
        start = null;
        span.attr('visibility', 'hidden');
        if (from !== null && Math.abs(at - from) > 6) {
          report.view.onZoom([x.invert(Math.min(from, at)), x.invert(Math.max(from, at))]);
        }
      })
      .on('mouseleave', function () {
        start = null;
        span.attr('visibility', 'hidden');
        report.view.plots.forEach(function (other) { other.hover(null); });
        report.hideTooltip();
      })
      .on('dblclick', function () { report.view.onZoom(null); });
    attachKeys(plot, spec, x);
    report.view.plots.push({ hover: function (time) {
      const inside = time !== null && time >= x.domain()[0] && time <= x.domain()[1];
      cursor.attr('visibility', inside ? 'visible' : 'hidden');
      if (inside) { cursor.attr({ x1: x(time), x2: x(time) }); }
    } });
  }

  // Arrows move the time that is read off, Home goes to the start, Escape ends it.
  function attachKeys(plot, spec, x) {
    const range = x.domain();
    let time = null;
    plot.svg.on('keydown', function () {
      const step = { ArrowLeft: -0.01, ArrowRight: 0.01 }[d3.event.key] * (d3.event.shiftKey ? 10 : 1) * (range[1] - range[0]);
      if (d3.event.key === 'Home') { time = range[0]; }
      else if (d3.event.key === 'Escape') { time = null; }
      else if (step) { time = Math.max(range[0], Math.min(range[1], (time === null ? range[0] : time) + step)); }
      else { return; }
      d3.event.preventDefault();
      report.view.plots.forEach(function (other) { other.hover(time); });
      const box = plot.svg.node().getBoundingClientRect();
      if (time === null) { report.hideTooltip(); }
      else { showTooltip(readout(spec, time, null), { clientX: box.left + 54 + x(time), clientY: box.top }); }
    }).on('blur', function () { time = null; report.hideTooltip(); });
  }

  // A quantity over time. spec: lines [{name, style, t, v}], bands [{style, t, lo, hi}], regions [{lo, hi}], log, zero,
  // unit, means [{style, value}].
  report.timePlot = function (parent, spec) {
    const plot = frame(parent, spec);
    const times = d3.merge(spec.lines.map(function (line) { return [line.t[0], line.t[line.t.length - 1]]; }));
    const any = spec.lines.some(function (line) { return line.v.some(function (v) { return v !== null && (!spec.log || v > 0); }); });
    if (!any) { emptyNotice(plot); return; }
    const domain = report.view.domain || d3.extent(times);
    const x = d3.scale.linear().domain(domain).range([0, plot.inner.width]);
    const y = (spec.log ? d3.scale.log() : d3.scale.linear()).domain(valueDomain(spec, domain)).range([plot.inner.height, 0]);
    y.log = spec.log;
    drawAxis(plot, x, true, x.ticks(Math.max(3, plot.inner.width / 80)));
    drawAxis(plot, y, false, spec.log ? logTicks(y.domain()) : y.ticks(5));
    drawGround(plot, spec, x, y);
    spec.lines.forEach(function (line) { path(plot, zip(line.t, line.v), x, y, line.style, line.width); });
    (spec.means || []).forEach(function (mean) {
      plot.area.append('line').attr({ x1: 0, x2: plot.inner.width, y1: y(mean.value), y2: y(mean.value),
        stroke: mean.style.colour, 'stroke-width': 1.2, 'stroke-dasharray': mean.dash || '8 4', 'clip-path': plot.clip });
    });
    attachPointer(plot, spec, x, y);
  };

  // Top view with equal scales. spec: lines [{name, style, t, x, y}]. Only the zoomed time range is drawn.
  report.topView = function (parent, spec) {
    const plot = frame(parent, spec);
    const domain = report.view.domain;
    const lines = spec.lines.map(function (line) {
      const keep = line.t.map(function (t, i) { return i; }).filter(function (i) {
        return line.x[i] !== null && (!domain || (line.t[i] >= domain[0] && line.t[i] <= domain[1]));
      });
      return { name: line.name, label: line.label, passive: line.passive, style: line.style, width: line.width, t: keep.map(function (i) { return line.t[i]; }),
        points: keep.map(function (i) { return [line.x[i], line.y[i]]; }) };
    }).filter(function (line) { return line.points.length; });
    if (!lines.length) { emptyNotice(plot); return; }
    const all = d3.merge(lines.map(function (line) { return line.points; }));
    const ex = d3.extent(all, function (p) { return p[0]; }), ey = d3.extent(all, function (p) { return p[1]; });
    const scale = 1.08 * Math.max((ex[1] - ex[0]) / plot.inner.width, (ey[1] - ey[0]) / plot.inner.height) || 0.01;
    const centred = function (extent, pixels) {
      const middle = (extent[0] + extent[1]) / 2;
      return [middle - scale * pixels / 2, middle + scale * pixels / 2];
    };
    const x = d3.scale.linear().domain(centred(ex, plot.inner.width)).range([0, plot.inner.width]);
    const y = d3.scale.linear().domain(centred(ey, plot.inner.height)).range([plot.inner.height, 0]);
    drawAxis(plot, x, true, x.ticks(Math.max(3, plot.inner.width / 80)));
    drawAxis(plot, y, false, y.ticks(6));
    lines.forEach(function (line) { path(plot, line.points, x, y, line.style, line.width); });
    drawLabels(plot, lines.filter(function (line) { return line.label; }), x, y);
    if (!spec.noStart) { markStart(plot, lines[0].points[0], x, y); }
    const dots = lines.map(function (line) {
      return plot.area.append('circle').attr({ class: 'cursor', r: 4.5, fill: line.style.colour, stroke: '#fff', visibility: 'hidden' });
    });
    const move = function (time) {
      lines.forEach(function (line, k) {
        const i = time === null || line.passive ? -1 : report.nearest(line.t, time);
        dots[k].attr('visibility', i < 0 ? 'hidden' : 'visible');
        if (i >= 0) { dots[k].attr({ cx: x(line.points[i][0]), cy: y(line.points[i][1]) }); }
      });
    };
    report.view.plots.push({ hover: move });
    attachTopPointer(plot, spec, lines.filter(function (line) { return !line.passive; }), x, y);
  };

  // Names at the ends of lines: right of the end, or left, below or above of it where another name is in the way.
  function drawLabels(plot, lines, x, y) {
    const taken = [];
    lines.forEach(function (line) {
      const last = line.points[line.points.length - 1], at = [x(last[0]), y(last[1])], width = 7 * line.label.length;
      plot.area.append('circle').attr({ cx: at[0], cy: at[1], r: 3, fill: line.style.colour });
      const places = [[5, 4], [-5 - width, 4], [-width / 2, 16], [-width / 2, -7]].map(function (d) { return [at[0] + d[0], at[1] + d[1]]; });
      const free = places.filter(function (p) {
        return taken.every(function (q) { return Math.abs(p[0] - q[0]) > Math.max(width, q[2]) || Math.abs(p[1] - q[1]) > 11; });
      });
      const place = free[0] || places[0];
      taken.push([place[0], place[1], width]);
      halo(plot, place[0], place[1], line.label);
    });
  }

  function halo(plot, x, y, text) {
    plot.area.append('text').attr({ x: x, y: y, fill: INK, 'paint-order': 'stroke', stroke: '#fff', 'stroke-width': 3 }).text(text);
  }

  function markStart(plot, first, x, y) {
    plot.area.append('circle').attr({ cx: x(first[0]), cy: y(first[1]), r: 4, fill: '#fff', stroke: INK, 'stroke-width': 1.5 });
    halo(plot, x(first[0]) + 7, y(first[1]) - 6, 'start');
  }

  // Hovering finds the nearest drawn point and shows its time in all plots.
  function attachTopPointer(plot, spec, lines, x, y) {
    const overlay = plot.area.append('rect').attr({ class: 'overlay', width: plot.inner.width, height: plot.inner.height,
      fill: 'none', 'pointer-events': 'all' });
    overlay.on('mousemove', function () {
      const at = d3.mouse(overlay.node());
      let nearest = { d: Infinity };
      lines.forEach(function (line) {
        line.points.forEach(function (p, i) {
          const d = Math.pow(x(p[0]) - at[0], 2) + Math.pow(y(p[1]) - at[1], 2);
          if (d < nearest.d) { nearest = { d: d, line: line, i: i }; }
        });
      });
      const p = nearest.line.points[nearest.i];
      report.view.plots.forEach(function (other) { other.hover(nearest.line.t[nearest.i]); });
      showTooltip('<b>t = ' + nearest.line.t[nearest.i].toFixed(2) + ' s</b>' + report.swatch(nearest.line.style) +
        report.escape(nearest.line.name) + '<br>' + (spec.describe ? spec.describe(nearest.line, nearest.i) :
        'x ' + MINUS(p[0].toFixed(3)) + ' m, y ' + MINUS(p[1].toFixed(3)) + ' m'), d3.event);
    }).on('mouseleave', function () {
      report.view.plots.forEach(function (other) { other.hover(null); });
      report.hideTooltip();
    });
  }

  function boxTooltip(shape, box, unit) {
    shape.attr('pointer-events', 'all').on('mousemove', function () {
      const names = ['5 %', '25 %', 'median', '75 %', '95 %'];
      showTooltip('<b>' + report.escape(box.name) + '</b><table>' + names.map(function (name, i) {
        return '<tr><td>' + name + '</td><td>' + report.digits(box.q[i]) + ' ' + report.escape(unit) + '</td></tr>';
      }).join('') + '</table>' + (box.note ? report.escape(box.note) : ''), d3.event);
    }).on('mouseleave', report.hideTooltip);
  }

  // Boxes from the 25th to the 75th percentile with whiskers to the 5th and 95th. spec: groups [{name, boxes [{name, style,
  // q, note}]}], unit. log. Groups stand side by side; without log, values start at zero.
  report.boxPlot = function (parent, spec) {
    const plot = frame(parent, spec);
    const boxes = d3.merge(spec.groups.map(function (group) { return group.boxes; }));
    if (!boxes.length) { emptyNotice(plot); return; }
    const inner = plot.inner;
    const least = d3.min(boxes, function (box) { return box.q[0]; }), most = d3.max(boxes, function (box) { return box.q[4]; });
    const y = (spec.log && least > 0 ? d3.scale.log().domain([least / 1.3, most * 1.3]) :
      d3.scale.linear().domain([0, 1.06 * most || 1])).range([inner.height, 0]);
    drawAxis(plot, y, false, spec.log ? logTicks(y.domain()) : y.ticks(5));
    const step = inner.width / spec.groups.length;
    spec.groups.forEach(function (group, g) {
      const slot = Math.min(spec.named ? 60 : 46, 0.86 * step / Math.max(1, group.boxes.length));
      const from = step * (g + 0.5) - slot * group.boxes.length / 2;
      if (group.name) {
        plot.area.append('text').attr({ x: step * (g + 0.5), y: inner.height + 15, 'text-anchor': 'middle', fill: SOFT }).text(group.name);
      }
      group.boxes.forEach(function (box, b) {
        if (spec.named) {  // slanted: names are longer than boxes are wide
          const label = box.name.length > 18 ? box.name.slice(0, 17) + '\u2026' : box.name;
          plot.area.append('text').attr({ transform: 'translate(' + (from + slot * (b + 0.5) + 4) + ',' + (inner.height + 13) + ') rotate(-40)',
            'text-anchor': 'end', fill: INK, 'font-size': 11 }).text(label);
        }
        const middle = from + slot * (b + 0.5), half = Math.max(1.5, slot * 0.34);
        const line = function (x1, x2, v1, v2, width) {
          plot.area.append('line').attr({ x1: x1, x2: x2, y1: y(v1), y2: y(v2), stroke: box.style.colour, 'stroke-width': width });
        };
        line(middle, middle, box.q[0], box.q[4], 1.2);
        line(middle - half / 2, middle + half / 2, box.q[0], box.q[0], 1.2);
        line(middle - half / 2, middle + half / 2, box.q[4], box.q[4], 1.2);
        plot.area.append('rect').attr({ class: 'box', x: middle - half, width: 2 * half, y: y(box.q[3]),
          height: Math.max(1, y(box.q[1]) - y(box.q[3])), fill: '#fff', stroke: box.style.colour, 'stroke-width': 1.4,
          'stroke-dasharray': box.style.dash });
        plot.area.append('rect').attr({ x: middle - half, width: 2 * half, y: y(box.q[3]),
          height: Math.max(1, y(box.q[1]) - y(box.q[3])), fill: box.style.colour, 'fill-opacity': 0.18 });
        line(middle - half, middle + half, box.q[2], box.q[2], 2.4);
        boxTooltip(plot.area.append('rect').attr({ x: middle - slot / 2, width: slot, y: 0, height: inner.height, fill: 'none' }),
          box, spec.unit);
      });
    });
    plot.area.append('line').attr({ x1: 0, x2: inner.width, y1: inner.height, y2: inner.height, stroke: AXIS });
  };
})();
