// The tables of the page: overview, one sequence, input digests.
(function () {
  const data = report.data;
  const escape = report.escape;

  function figureIndex(key) {
    return data.figures.findIndex(function (figure) { return figure.key === key; });
  }

  report.aggregate = function (estimator, sequence) {
    return data.aggregate.find(function (row) { return row.estimator === estimator && row.sequence === sequence; });
  };

  function failure(row) {
    const reasons = [['diverged', 'diverged'], ['not_initialized', 'not initialized'], ['failed', 'failed']];
    return reasons.filter(function (r) { return row[r[0]] > 0; }).map(function (r) { return r[1]; }).join(', ');
  }

  // Whether a row has means of figure `i`: no run need have ended ok for those of all runs.
  function hasMean(row, i) { return row && (row.ok > 0 || data.figures[i].all_runs); }

  // Mean, standard error below it, and how many runs are behind it when some were lost.
  function statistic(row, i, best, extra) {
    const figure = data.figures[i];
    if (!row) { return '<td>\u2013</td>'; }
    if (!hasMean(row, i)) { return '<td class="bad">' + failure(row) + '<span class="sub bad">0 of ' + row.cells + ' ok</span></td>'; }
    let html = report.format(row.means[i], figure.decimals);
    if (row.errors[i] !== null) { html += '<span class="sub">\u00b1 ' + report.formatError(row.errors[i], row.means[i], figure.decimals) + '</span>'; }
    if (extra && row.ok < row.cells) { html += '<span class="sub bad">' + row.ok + ' of ' + row.cells + ' ok</span>'; }
    return '<td' + (best.indexOf(row.estimator) >= 0 ? ' class="best"' : '') + '>' + html + (extra || '') + '</td>';
  }

  function estimatorHead(estimator, backend) {
    const words = [backend || '', report.smoothed(estimator) ? 'smoothed' : ''].filter(function (word) { return word; });
    return '<th scope="row">' + report.swatch(report.style(estimator)) + report.name(estimator) +
      (words.length ? '<span class="sub">' + escape(words.join(', ')) + '</span>' : '') + '</th>';
  }

  function referencesOf(estimator, sequence, key) {
    return data.references.filter(function (r) {
      return r.estimator === estimator && r.sequence === sequence && r.figures[key] !== undefined;
    });
  }

  // Mean over the shown sequences, only where the estimator has every one of them.
  function acrossSequences(estimator, i) {
    const rows = report.shownSequences().map(function (sequence) { return report.aggregate(estimator, sequence); });
    const complete = rows.every(function (row) { return hasMean(row, i) && row.means[i] !== null; });
    return complete ? d3.mean(rows, function (row) { return row.means[i]; }) : null;
  }

  function backendOf(estimator) {
    return (data.aggregate.find(function (row) { return row.estimator === estimator; }) || {}).backend;
  }

  // The column of means as an entry an estimator for report.best.
  function meanEntries(i) {
    const shown = report.shownSequences();
    return report.shownEstimators().map(function (estimator) {
      const lost = d3.sum(data.aggregate, function (row) {
        return row.estimator === estimator && shown.indexOf(row.sequence) >= 0 && !data.figures[i].all_runs ? row.cells - row.ok : 0;
      });
      return { name: estimator, value: acrossSequences(estimator, i), lost: lost, backend: backendOf(estimator) };
    });
  }

  // The best of figure `i` on one sequence, among the estimators that are shown.
  function bestOn(sequence, i) {
    const rows = report.shownEstimators().map(function (name) { return report.aggregate(name, sequence); })
      .filter(function (row) { return row; });
    const most = d3.max(rows, function (row) { return row.ok; });
    return report.best(rows.map(function (row) {
      return { name: row.estimator, value: row.means[i], lost: data.figures[i].all_runs ? 0 : most - row.ok };
    }), data.figures[i]);
  }

  function rivalOf(best) { return report.state.against === report.BEST ? best[0] : report.state.against; }

  function overviewCell(estimator, sequence, i, most, best) {
    const figure = data.figures[i];
    const row = report.aggregate(estimator, sequence);
    let extra = hasMean(row, i) ? report.testLine(estimator, rivalOf(best), sequence, i) : '';
    extra += referencesOf(estimator, sequence, figure.key).map(function (r) {
      return '<span class="sub"><i>' + escape(r.source) + ' ' + report.format(r.figures[figure.key], figure.decimals) + '</i></span>';
    }).join('');
    if (row && figure.ideal === 'low' && row.means[i] !== null) {
      extra += '<span class="bar" aria-hidden="true"><i style="width:' + (100 * row.means[i] / most).toFixed(1) + '%"></i></span>';
    }
    return statistic(row, i, best, extra || ' ');
  }

  // References to estimators that did not run here.
  function foreignRows(wanted, cellsOf) {
    const seen = [];
    data.references.filter(wanted).forEach(function (r) {
      const name = r.estimator + '\n' + r.source;
      if (data.estimators.indexOf(r.estimator) < 0 && seen.indexOf(name) < 0) {
        seen.push(name);
      }
    });
    return seen.map(function (name) {
      const parts = name.split('\n');
      return '<tr class="reference"><th scope="row">' + report.name(parts[0]) + '<span class="sub">' + escape(parts[1]) + '</span></th>' +
        cellsOf(function (r) { return r.estimator === parts[0] && r.source === parts[1]; }) + '</tr>';
    }).join('');
  }

  report.overviewTable = function (key) {
    const i = figureIndex(key), figure = data.figures[i], sequences = report.shownSequences(), several = sequences.length > 1;
    const columns = sequences.map(function (sequence) {
      const most = d3.max(report.shownEstimators(), function (estimator) {
        const row = report.aggregate(estimator, sequence);
        return row ? row.means[i] : null;
      });
      return { sequence: sequence, most: most, best: bestOn(sequence, i) };
    });
    const head = sequences.map(function (sequence) { return '<th scope="col">' + report.name(sequence) + '</th>'; }).join('');
    const means = meanEntries(i), bestMean = report.best(means, figure);
    const tested = sequences.length === data.sequences.length;  // the pooled test is over all of them
    const rows = means.map(function (entry) {
      const mean = '<td' + (bestMean.indexOf(entry.name) >= 0 ? ' class="best"' : '') + '>' + report.format(entry.value, figure.decimals) +
        (tested && entry.value !== null ? report.testLine(entry.name, rivalOf(bestMean), null, i) : '') + '</td>';
      return '<tr>' + estimatorHead(entry.name, entry.backend) + columns.map(function (column) {
        return overviewCell(entry.name, column.sequence, i, column.most, column.best);
      }).join('') + (several ? mean : '') + '</tr>';
    }).join('');
    const foreign = foreignRows(function (r) { return r.figures[key] !== undefined && sequences.indexOf(r.sequence) >= 0; }, function (matches) {
      return sequences.map(function (sequence) {
        const found = data.references.find(function (r) { return matches(r) && r.sequence === sequence; });
        return '<td>' + report.format(found ? found.figures[key] : null, figure.decimals) + '</td>';
      }).join('') + (several ? '<td></td>' : '');
    });
    return '<table><thead><tr><th scope="col">Estimator</th>' + head +
      (several ? '<th scope="col">mean</th>' : '') + '</tr></thead><tbody>' + rows + foreign + '</tbody></table>';
  };

  function testNote(i) {
    if (!data.pairs.some(function (pair) { return pair[1] === i; })) { return ''; }
    const against = report.state.against === report.BEST ? 'the best of the column' : report.state.against;
    return ' Below a value, the test of its difference to ' + against + ' (paired t-test on equal inputs; the mean: one sample a sequence): ' +
      '\u2248 not significant at 5 %, \u25bc significantly lower, \u25b2 significantly higher. Holm: ' +
      'the p-value corrected for the number of pairs of estimators of the column; the signs are of p, not corrected.';
  }

  function meaningNote(key) {
    const meaning = report.meaning(key, report.alignment(data.cells));
    return meaning ? ' ' + meaning : '';
  }

  function smoothedNote() {
    const names = report.shownEstimators().filter(report.smoothed);
    return names.length ? ' Smoothed: uses later data (' + names.join(', ') + '), which the others do not have: a causal ' +
      'estimator\u2019s row uses data until its stamp. A smoothed estimator is never shaded as best.' : '';
  }

  report.overviewNote = function (key) {
    const i = figureIndex(key), figure = data.figures[i];
    const ideal = figure.ideal === 'low' ? 'Lower is better.' : figure.ideal === 'target' ?
      'Ideal is ' + Number(figure.target.toFixed(4)) + '.' : 'No value is better than another.';
    const unit = figure.unit ? ' in ' + figure.unit : '';
    return figure.label + unit + ', mean over ' + (figure.all_runs ? 'all seeds' : 'the seeds that ended ok') + ' \u00b1 its standard error. ' +
      ideal + meaningNote(key) + (figure.ideal === 'none' ? '' : ' The best of each column is shaded, among the shown estimators' +
      (figure.all_runs ? '.' : ' that lost the fewest runs.')) + testNote(i) + smoothedNote() + (data.references.length ? ' Published figures are in italics.' : '');
  };

  report.sequenceTable = function (sequence) {
    const align = report.alignment(report.cellsOf(sequence));
    // How much was completed stands beside the runs that ended ok, the many RPE columns last.
    const place = function (i) { return data.figures[i].key === 'completion' ? -1 : data.figures[i].key.indexOf('rpe_') === 0 ? 1 : 0; };
    const used = data.figures.map(function (figure, i) { return i; }).filter(function (i) {
      return data.aggregate.some(function (row) { return row.sequence === sequence && row.means[i] !== null; });
    }).sort(function (a, b) { return place(a) - place(b) || a - b; });
    const head = used.map(function (i) {
      const figure = data.figures[i];
      return '<th scope="col" title="' + escape(report.meaning(figure.key, align)) + '">' + escape(figure.label) + '<span class="unit">' + (escape(figure.unit) || '\u00a0') + '</span></th>';
    }).join('');
    const referenceCells = function (matches) {
      return '<td></td>' + used.map(function (i) {
        const figure = data.figures[i];
        const found = data.references.find(function (r) { return matches(r) && r.sequence === sequence; });
        return '<td>' + report.format(found ? found.figures[figure.key] : null, figure.decimals) + '</td>';
      }).join('');
    };
    const best = {};
    used.forEach(function (i) { best[i] = bestOn(sequence, i); });
    const rows = report.shownEstimators().map(function (estimator) {
      const row = report.aggregate(estimator, sequence);
      if (!row) { return ''; }
      const counts = '<td' + (row.ok < row.cells ? ' class="bad"' : '') + '>' + row.ok + ' of ' + row.cells +
        (row.ok < row.cells ? '<span class="sub bad">' + failure(row) + '</span>' : '') + '</td>';
      const own = data.references.filter(function (r) { return r.estimator === estimator && r.sequence === sequence; });
      return '<tr>' + estimatorHead(estimator, row.backend) + counts +
        used.map(function (i) { return hasMean(row, i) ? statistic(row, i, best[i]) : '<td>\u2013</td>'; }).join('') + '</tr>' +
        own.map(function (r) {
          return '<tr class="reference"><th scope="row">' + report.name(estimator) + '<span class="sub">' + escape(r.source) + '</span></th>' +
            referenceCells(function (other) { return other === r; }) + '</tr>';
        }).join('');
    }).join('');
    return '<table><thead><tr><th scope="col">Estimator</th><th scope="col">runs ok</th>' + head + '</tr></thead><tbody>' + rows +
      foreignRows(function (r) { return r.sequence === sequence; }, referenceCells) + '</tbody></table>';
  };

  report.digestTable = function () {
    const rows = [];
    data.cells.forEach(function (cell) {
      const row = '<tr><th scope="row">' + report.name(cell.sequence) + '</th><td>' + cell.seed + '</td><td class="digest">' +
        (escape(cell.digest) || '\u2013') + '</td></tr>';
      if (rows.indexOf(row) < 0) { rows.push(row); }
    });
    return '<table><thead><tr><th scope="col">Sequence</th><th scope="col">Seed</th>' +
      '<th scope="col" class="digest-head">SHA-256 of the measurement log</th></tr></thead><tbody>' + rows.join('') + '</tbody></table>';
  };
})();
