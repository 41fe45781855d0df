// What the front end made of the images of one sequence; hidden where tracks were not made in this comparison.
(function () {
  const columns = [['seed', 0], ['images', 0], ['features', 1], ['mean_length', 1], ['median_length', 0], ['lost', 2], ['rejected', 2],
    ['thinned', 2], ['mean_ms', 2], ['p95_ms', 2]];
  const headings = ['seed', 'images', 'features a frame', 'mean life (frames)', 'median life', 'lost (%)', 'rejected (%)', 'thinned (%)',
    'ms a frame', '95 % of frames'];

  report.drawFrontend = function (sequence) {
    const entries = report.data.frontends.filter(function (entry) { return entry.sequence === sequence; });
    document.getElementById('frontend').hidden = !entries.length;
    document.getElementById('frontend-table').innerHTML = '<table><thead><tr>' +
      headings.map(function (heading) { return '<th scope="col">' + heading + '</th>'; }).join('') + '</tr></thead><tbody>' +
      entries.map(function (entry) {
        return '<tr>' + columns.map(function (column) {
          return '<td>' + report.format(entry[column[0]], column[1]) + '</td>';
        }).join('') + '</tr>';
      }).join('') + '</tbody></table>';
  };
}());
