// Stacked horizontal bars with their names before and their sums behind them.
(function () {
  const draw = report.draw;

  // spec: stages [{name, colour}], bars [{name, parts [value a stage]}], unit.
  report.barPlot = function (parent, spec) {
    spec.height = 62 + 30 * Math.max(1, spec.bars.length);
    spec.left = 12;
    const plot = draw.frame(parent, spec);
    if (!spec.bars.length) { draw.emptyNotice(plot); return; }
    const total = function (bar) { return d3.sum(bar.parts); };
    const x = d3.scale.linear().domain([0, d3.max(spec.bars, total) || 1]).range([0, plot.inner.width - 64]);
    draw.axis(plot, x, true, x.ticks(Math.max(3, plot.inner.width / 90)));
    spec.bars.forEach(function (bar, b) {
      const top = 2 + 30 * b;
      plot.area.append('text').attr({ x: 3, y: top + 10, fill: draw.INK, 'font-size': 11 }).text(bar.name);
      let at = 0;
      bar.parts.forEach(function (part, s) {
        plot.area.append('rect').attr({ class: 'bar-part', x: x(at), y: top + 14, width: Math.max(0, x(at + part) - x(at)), height: 11,
          fill: spec.stages[s].colour }).append('title').text(bar.name + ', ' + spec.stages[s].name + ': ' + report.digits(part) + ' ' + spec.unit);
        at += part;
      });
      plot.area.append('text').attr({ x: x(at) + 4, y: top + 24, fill: draw.INK, 'font-size': 11 }).text(report.digits(at) + ' ' + spec.unit);
    });
  };
})();
