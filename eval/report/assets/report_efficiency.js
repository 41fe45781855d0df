// How near each estimator comes to the bound of the batch estimate on one sequence; hidden without a batch.
(function () {
  const headings = ['hindsight ori.', 'hindsight pos.', 'smoothing \u03c3 ori.', 'smoothing \u03c3 pos.', 'filtering \u03c3 ori.', 'filtering \u03c3 pos.'];

  report.drawEfficiency = function (sequence) {
    const entries = report.data.efficiency.filter(function (entry) { return entry.sequence === sequence && !report.state.off[entry.estimator]; });
    document.getElementById('efficiency').hidden = !entries.length;
    if (!entries.length) { return; }
    document.getElementById('efficiency-table').innerHTML = '<table><thead><tr><th scope="col">bound / achieved</th><th scope="col">pairs</th>' +
      headings.map(function (heading) { return '<th scope="col">' + heading + '</th>'; }).join('') + '</tr></thead><tbody>' +
      entries.map(function (entry) {
        return '<tr><th scope="row">' + report.swatch(report.style(entry.estimator)) + report.name(report.marked(entry.estimator)) + '</th><td>' + entry.pairs + '</td>' +
          entry.ratios.map(function (ratio) { return '<td>' + report.format(ratio, 2) + '</td>'; }).join('') + '</tr>';
      }).join('') + '</tbody></table>';
  };
}());
