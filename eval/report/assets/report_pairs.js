// Paired differences between estimators: a matrix of one figure on one sequence.
(function () {
  const data = report.data;

  function cell(pair, figure) {
    const word = report.verdictWord(pair.verdict, figure);
    const shade = word === 'better' || word === 'worse' ? ' class="' + word + '"' : '';
    return '<td' + shade + '>' + report.format(pair.difference, figure.decimals).replace(/^-/, '\u2212') +
      '<span class="sub">\u00b1 ' + report.formatError(pair.half, pair.difference, figure.decimals) + '</span><span class="sub">' +
      word + '</span><span class="sub">' + report.pText('p', pair.p) + '</span><span class="sub">' + report.pText('Holm', pair.holm) + '</span>' + (pair.lost ? '<span class="sub bad">' + pair.lost + ' lost</span>' : '') + '</td>';
  }

  // Empty where nothing is paired. `most.count` becomes the largest number of pairs.
  function matrix(sequence, i, most) {
    const shown = report.shownEstimators();
    const used = shown.filter(function (row) {
      return shown.some(function (column) { return row !== column && report.pair(row, column, sequence, i); });
    });
    if (!used.length) { return ''; }
    const head = used.map(function (name) { return '<th scope="col">' + report.name(report.marked(name)) + '</th>'; }).join('');
    const rows = used.map(function (row) {
      return '<tr><th scope="row">' + report.swatch(report.style(row)) + report.name(report.marked(row)) + '</th>' + used.map(function (column) {
        const pair = row === column ? null : report.pair(row, column, sequence, i);
        most.count = pair ? Math.max(most.count, pair.count) : most.count;
        return pair ? cell(pair, data.figures[i]) : '<td>\u2013</td>';
      }).join('') + '</tr>';
    }).join('');
    return '<table><thead><tr><th scope="col">row \u2212 column</th>' + head + '</tr></thead><tbody>' + rows + '</tbody></table>';
  }

  // The section is hidden where there is nothing to compare: one estimator, one seed, or a figure that is not paired.
  report.drawPairs = function (sequence, key) {
    const i = data.figures.findIndex(function (f) { return f.key === key; });
    const most = { count: 0 }, all = { count: 0 };
    const here = matrix(sequence, i, most);
    const across = data.sequences.length > 1 && report.shownSequences().length === data.sequences.length ? matrix(null, i, all) : '';
    document.getElementById('pairs').hidden = !here && !across;
    if (!here && !across) { return; }
    const figure = data.figures[i];
    document.getElementById('pairs-note').textContent = figure.label + (figure.unit ? ' [' + figure.unit + ']' : '') +
      ', row minus column on the same input and seed, with half of the 95 % interval of the mean (Student\u2019s t' +
      (here ? ', ' + sequence + ', ' + most.count + ' pairs' : '') +
      '). Shaded where the interval excludes zero. p: of the pair alone. Holm: corrected for the number of pairs of the table, so that with probability 95 % none ' +
      'below 0.05 is by chance. The figure is selected in the overview; pairs.csv has all figures. ' +
      report.meaning(key, report.alignment(data.cells));
    document.getElementById('pairs-table').innerHTML = here + (across ? '<p class="note">Over all ' + data.sequences.length +
      ' sequences, one sample a sequence:</p>' + across : '');
  };
})();
