// Paired differences between estimators: a matrix of one figure on one sequence.
(function () {
  const data = report.data;
  // Columns of an entry of data.pairs; see eval/report_data.cc.
  const SEQUENCE = 0, FIGURE = 1, FIRST = 2, SECOND = 3, COUNT = 4, LOST = 5, DIFFERENCE = 6, HALF = 7, VERDICT = 8;

  function pairsOf(sequence, figure) {
    return data.pairs.filter(function (p) { return p[SEQUENCE] === sequence && p[FIGURE] === figure; });
  }

  function cell(pair, flipped, figure) {
    const sign = flipped ? -1 : 1, verdict = sign * pair[VERDICT], low = figure.ideal === 'low';
    const words = low ? { '-1': 'better', '1': 'worse', '0': 'no difference' } : { '-1': 'lower', '1': 'higher', '0': 'no difference' };
    const shade = !low || verdict === 0 ? '' : ' class="' + words[verdict] + '"';
    return '<td' + shade + '>' + report.format(sign * pair[DIFFERENCE], figure.decimals).replace(/^-/, '\u2212') +
      '<span class="sub">\u00b1 ' + report.formatError(pair[HALF], pair[DIFFERENCE], figure.decimals) + '</span><span class="sub">' +
      words[verdict] + '</span>' + (pair[LOST] ? '<span class="sub bad">' + pair[LOST] + ' lost</span>' : '') + '</td>';
  }

  function matrix(pairs, figure) {
    const used = data.estimators.filter(function (unused, e) {
      return pairs.some(function (p) { return p[FIRST] === e || p[SECOND] === e; });
    });
    const head = used.map(function (name) { return '<th scope="col">' + report.name(name) + '</th>'; }).join('');
    const rows = used.map(function (row) {
      return '<tr><th scope="row">' + report.swatch(report.style(row)) + report.name(row) + '</th>' + used.map(function (column) {
        const r = data.estimators.indexOf(row), c = data.estimators.indexOf(column);
        const pair = pairs.find(function (p) { return (p[FIRST] === r && p[SECOND] === c) || (p[FIRST] === c && p[SECOND] === r); });
        return pair ? cell(pair, pair[FIRST] !== r, figure) : '<td>\u2013</td>';
      }).join('') + '</tr>';
    }).join('');
    return '<table><thead><tr><th scope="col">row \u2212 column</th>' + head + '</tr></thead><tbody>' + rows + '</tbody></table>';
  }

  // The section is hidden where there is nothing to compare: one estimator, one seed, or a figure that is not paired.
  report.drawPairs = function (sequence, key) {
    const figure = data.figures.findIndex(function (f) { return f.key === key; });
    const pairs = pairsOf(data.sequences.indexOf(sequence), figure), across = pairsOf(-1, figure);
    document.getElementById('pairs').hidden = !pairs.length && !across.length;
    if (!pairs.length && !across.length) { return; }
    const described = data.figures[figure];
    document.getElementById('pairs-note').textContent = described.label + (described.unit ? ' [' + described.unit + ']' : '') +
      ', row minus column on the same input and seed, with half of the 95 % interval of the mean (Student\u2019s t' +
      (pairs.length ? ', ' + d3.max(pairs, function (p) { return p[COUNT]; }) + ' pairs' : '') +
      '). Shaded where the interval leaves out zero; not corrected for the number of pairs. The figure is chosen in the overview; pairs.csv has all.';
    document.getElementById('pairs-table').innerHTML = (pairs.length ? matrix(pairs, described) : '') +
      (across.length ? '<p class="note">Over all sequences, one sample a sequence:</p>' + matrix(across, described) : '');
  };
})();
