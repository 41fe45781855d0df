// Which value is best, and which differences to it are significant.
(function () {
  const data = report.data;
  // Columns of an entry of data.pairs; see eval/report_data.cc.
  const SEQUENCE = 0, FIGURE = 1, FIRST = 2, SECOND = 3, COUNT = 4, LOST = 5, DIFFERENCE = 6, HALF = 7, VERDICT = 8, P = 9, HOLM = 10;
  const ACROSS = -1;

  const byPlace = {};
  data.pairs.forEach(function (p) {
    byPlace[[p[SEQUENCE], p[FIGURE], p[FIRST], p[SECOND]].join(' ')] = p;
  });

  // The paired difference of figure `i`, `row` minus `column`, on a sequence (null: over all of them); null when there are
  // too few pairs. verdict: -1 lower, 0 no significant difference, 1 higher.
  report.pair = function (row, column, sequence, i) {
    const s = sequence === null ? ACROSS : data.sequences.indexOf(sequence);
    const r = data.estimators.indexOf(row), c = data.estimators.indexOf(column);
    const direct = byPlace[[s, i, r, c].join(' ')];
    const found = direct || byPlace[[s, i, c, r].join(' ')];
    if (!found) { return null; }
    const sign = direct ? 1 : -1;
    return { count: found[COUNT], lost: found[LOST], difference: sign * found[DIFFERENCE], half: found[HALF],
      verdict: sign * found[VERDICT], p: found[P], holm: found[HOLM] };
  };

  // 'p = 0.02' of a p-value rounded to two digits.
  report.pText = function (name, p) { return p < 0.001 ? name + ' < 0.001' : name + ' = ' + p; };

  report.verdictWord = function (verdict, figure) {
    if (verdict === 0) { return 'no difference'; }
    return figure.ideal === 'low' ? (verdict < 0 ? 'better' : 'worse') : (verdict < 0 ? 'lower' : 'higher');
  };

  function badness(figure, value) {
    if (value === null || value === undefined || figure.ideal === 'none') { return Infinity; }
    if (figure.ideal === 'low') { return value; }
    return figure.target <= 1 ? Math.abs(value - figure.target) : Math.abs(Math.log(value / figure.target));
  }

  // Names of the best of `entries` [{name, value, lost}]: among those that lost the fewest runs, where at least two
  // have a value. A smoothed estimate uses later data and is no rival.
  report.best = function (entries, figure) {
    const open = entries.filter(function (entry) { return !report.smoothed(entry.name); });
    const fewest = d3.min(open, function (entry) { return entry.lost; });
    const rivals = open.filter(function (entry) { return entry.lost === fewest && isFinite(badness(figure, entry.value)); });
    const least = d3.min(rivals, function (entry) { return badness(figure, entry.value); });
    return rivals.length < 2 ? [] : rivals.filter(function (entry) { return badness(figure, entry.value) === least; })
      .map(function (entry) { return entry.name; });
  };

  // The result of a test against `other`, as a line below a value; empty without a test.
  report.testLine = function (name, other, sequence, i) {
    const figure = data.figures[i];
    const pair = other && other !== name ? report.pair(name, other, sequence, i) : null;
    if (!pair) { return ''; }
    const sign = pair.verdict === 0 ? '\u2248 ' : pair.verdict < 0 ? '\u25bc ' : '\u25b2 ';
    const detail = 'difference to ' + other + ': ' + report.digits(pair.difference).replace(/^-/, '\u2212') + ' \u00b1 ' + report.digits(pair.half) +
      ' (95 % interval, ' + pair.count + ' pairs): ' + report.verdictWord(pair.verdict, figure) + '; ' +
      report.pText('Holm p', pair.holm);
    return '<span class="sub test' + (pair.verdict === 0 ? ' tie' : '') + '" title="' + report.escape(detail) + '">' + sign + report.pText('p', pair.p) + ', ' + report.pText('Holm', pair.holm) + '</span>';
  };
})();
