// The frame of every plot: size, axes, readout, "save SVG". What must survive "save SVG" is an attribute, not a rule of a
// style sheet.
(function () {
  const FONT = 'system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", "Liberation Sans", Arial, sans-serif';
  const INK = '#1b2430', SOFT = '#5b6675', GRID = '#e6eaef', AXIS = '#b9c2cd';
  let clips = 0;

  // The time range and the time under the pointer are shared by all plots of the page.
  report.view = { domain: null, plots: [], onZoom: function () {} };

  const tooltip = document.getElementById('tooltip');
  function showTooltip(html, event) {
    tooltip.innerHTML = html;
    tooltip.hidden = false;
    const box = tooltip.getBoundingClientRect();
    const right = event.clientX + 16 + box.width < window.innerWidth;
    const x = right ? event.clientX + 16 : Math.max(4, event.clientX - 16 - box.width);
    tooltip.style.left = x + 'px';
    tooltip.style.top = Math.max(4, Math.min(event.clientY + 12, window.innerHeight - box.height - 4)) + 'px';
  }
  report.hideTooltip = function () { tooltip.hidden = true; };

  report.escape = function (text) {
    return String(text).replace(/[&<>"]/g, function (c) {
      return { '&': '&amp;', '<': '&lt;', '>': '&gt;', '"': '&quot;' }[c];
    });
  };
  // A name that may wrap after its underscores.
  report.name = function (text) { return report.escape(text).replace(/_/g, '_<wbr>'); };
  report.swatch = function (style) {
    return '<svg class="swatch" width="22" height="8" aria-hidden="true"><line x1="0" y1="4" x2="22" y2="4" stroke="' +
      style.colour + '" stroke-width="3"' + (style.dash ? ' stroke-dasharray="' + style.dash + '"' : '') + '/></svg>';
  };

  report.legendHtml = function (legend) {
    return legend.map(function (entry) {
      return '<span class="legend">' + report.swatch(entry.style) + report.escape(entry.name) + '</span>';
    }).join(' ');
  };

  function saveSvg(svg, spec) {
    const copy = svg.cloneNode(true);
    const width = svg.getBoundingClientRect().width, height = svg.getBoundingClientRect().height;
    const head = 24 + 16 * spec.legend.length;
    d3.select(copy).selectAll('.overlay, .cursor').remove();
    const group = document.createElementNS('http://www.w3.org/2000/svg', 'g');
    group.setAttribute('transform', 'translate(0,' + head + ')');
    while (copy.firstChild) { group.appendChild(copy.firstChild); }
    const root = d3.select(copy).attr({ xmlns: 'http://www.w3.org/2000/svg', width: width, height: height + head,
      viewBox: '0 0 ' + width + ' ' + (height + head) });
    root.append('rect').attr({ width: width, height: height + head, fill: '#fff' });
    root.append('text').attr({ x: 8, y: 17, 'font-size': 13, 'font-weight': 600, fill: INK }).text(spec.title);
    spec.legend.forEach(function (entry, i) {
      const y = 32 + 16 * i;
      root.append('line').attr({ x1: 8, x2: 30, y1: y, y2: y, stroke: entry.style.colour, 'stroke-width': 2.5,
        'stroke-dasharray': entry.style.dash });
      root.append('text').attr({ x: 36, y: y + 4, 'font-size': 11.5, fill: INK }).text(entry.name);
    });
    copy.appendChild(group);
    const link = document.createElement('a');
    link.href = URL.createObjectURL(new Blob([new XMLSerializer().serializeToString(copy)], { type: 'image/svg+xml' }));
    link.download = spec.file + '.svg';
    link.click();
    setTimeout(function () { URL.revokeObjectURL(link.href); }, 1000);
  }

  // A figure with caption, legend, "save SVG" and an empty plot area; `spec` needs id, title, file, legend, height.
  function frame(parent, spec) {
    const figure = d3.select(parent).append('figure');
    const caption = figure.append('figcaption');
    caption.append('span').text(spec.title);
    figure.append('p').attr('class', 'plot-legend').html(report.legendHtml(spec.legend));
    const margin = { left: spec.left || 54, right: 12, top: 8, bottom: spec.bottom || 38 };
    const width = Math.max(240, figure.node().getBoundingClientRect().width);
    const height = spec.height;
    const svg = figure.append('svg').attr({ class: 'plot', id: 'plot-' + spec.id, role: 'img', tabindex: spec.passive ? null : 0, width: width,
      height: height, viewBox: '0 0 ' + width + ' ' + height, 'font-family': FONT, 'font-size': 11.5,
      'aria-label': spec.title + ' (' + spec.x + '; ' + spec.y + ')' });
    caption.append('button').attr({ type: 'button', class: 'save' }).text('save SVG')
      .on('click', function () { saveSvg(svg.node(), spec); });
    const inner = { width: width - margin.left - margin.right, height: height - margin.top - margin.bottom };
    const area = svg.append('g').attr('transform', 'translate(' + margin.left + ',' + margin.top + ')');
    const clip = 'clip-' + (++clips);
    area.append('clipPath').attr('id', clip).append('rect').attr({ width: inner.width, height: inner.height });
    area.append('text').attr({ x: inner.width / 2, y: inner.height + margin.bottom - 5, 'text-anchor': 'middle', fill: SOFT }).text(spec.x);
    if (spec.y) {
      area.append('text').attr({ transform: 'translate(' + (11 - margin.left) + ',' + inner.height / 2 + ') rotate(-90)',
        'text-anchor': 'middle', fill: SOFT }).text(spec.y);
    }
    return { svg: svg, area: area, inner: inner, clip: 'url(#' + clip + ')' };
  }

  const MINUS = function (text) { return text.replace(/^-/, '\u2212'); };
  function tickText(value) {
    const magnitude = Math.abs(value);
    return MINUS(magnitude >= 1e5 || (magnitude > 0 && magnitude < 1e-3) ? value.toExponential(0) : String(Number(value.toPrecision(5))));
  }

  // Grid, ticks and labels of the horizontal (`below`) or vertical axis.
  function drawAxis(plot, scale, below, ticks) {
    const span = Math.max.apply(null, ticks.map(Math.abs));
    const inner = plot.inner;
    const group = plot.area.append('g').attr('class', 'axis');
    ticks.forEach(function (value) {
      const at = Math.round(scale(value)) + 0.5;
      group.append('line').attr(below ? { x1: at, x2: at, y1: 0, y2: inner.height } : { x1: 0, x2: inner.width, y1: at, y2: at })
        .attr('stroke', GRID);
      group.append('text').attr(below ? { x: at, y: inner.height + 15, 'text-anchor': 'middle' }
        : { x: -7, y: at + 4, 'text-anchor': 'end' }).attr('fill', SOFT).text(tickText(Math.abs(value) < 1e-9 * span ? 0 : value));
    });
    group.append('line').attr(below ? { x1: 0, x2: inner.width, y1: inner.height, y2: inner.height }
      : { x1: 0, x2: 0, y1: 0, y2: inner.height }).attr({ stroke: AXIS, 'shape-rendering': 'crispEdges' });
  }

  function logTicks(domain) {
    const all = [];
    for (let e = Math.floor(Math.log10(domain[0])); e <= Math.log10(domain[1]) + 1e-9; ++e) {
      [1, 2, 5].forEach(function (m) { all.push(Number((m * Math.pow(10, e)).toPrecision(3))); });
    }
    const inside = all.filter(function (v) { return v >= domain[0] * 0.999 && v <= domain[1] * 1.001; });
    const decades = inside.filter(function (v) { return Math.abs(Math.log10(v) - Math.round(Math.log10(v))) < 1e-9; });
    const every = Math.ceil(decades.length / 8);
    if (every > 1) { return decades.filter(function (v) { return Math.round(Math.log10(v)) % every === 0; }); }
    return inside.length <= 7 ? inside : decades.length >= 2 ? decades : inside.filter(function (v, i) { return i % 2 === 0; });
  }

  function path(plot, points, x, y, style, width) {
    const line = d3.svg.line().defined(function (p) { return p[0] !== null && p[1] !== null && !(y.log && p[1] <= 0); })
      .x(function (p) { return x(p[0]).toFixed(1); }).y(function (p) { return y(p[1]).toFixed(1); });
    plot.area.append('path').attr({ class: 'line', d: line(points), fill: 'none', stroke: style.colour,
      'stroke-width': width || 1.5, 'stroke-dasharray': style.dash, 'stroke-linejoin': 'round', 'clip-path': plot.clip });
  }

  const zip = function (t, v) { return t.map(function (time, i) { return [time, v[i] === undefined ? null : v[i]]; }); };

  function emptyNotice(plot) {
    plot.area.append('text').attr({ x: plot.inner.width / 2, y: plot.inner.height / 2, 'text-anchor': 'middle', fill: SOFT })
      .text('no data for this selection');
  }

  // What the kinds of plots in report_plots.js share.
  report.draw = { INK: INK, SOFT: SOFT, AXIS: AXIS, minus: MINUS, frame: frame, axis: drawAxis, logTicks: logTicks, path: path,
    zip: zip, emptyNotice: emptyNotice, showTooltip: showTooltip };
})();
