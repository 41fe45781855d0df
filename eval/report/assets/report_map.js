// Maps: one figure of all estimators on all sequences, coloured; hidden with a single sequence.
(function () {
  const escape = report.escape;

  function heatCell(cell) {
    const number = cell[2] ? '<b>' + escape(cell[0]) + '</b>' : escape(cell[0]);
    return '<td style="background:' + cell[3] + ';color:' + cell[4] + '">' + number +
      (cell[1] ? '<span class="sub">' + escape(cell[1]) + '</span>' : '') + '</td>';
  }

  function heatRows(map, columns) {
    let group = '';
    return map.rows.filter(function (row) { return !report.state.skip[row.sequence]; }).map(function (row) {
      const head = row.group && row.group !== group ?
        '<tr class="group"><th scope="rowgroup" colspan="' + (columns.length + 1) + '">' + escape(row.group) + '</th></tr>' : '';
      group = row.group;
      return head + '<tr><th scope="row">' + report.name(row.sequence) + '</th>' +
        columns.map(function (i) { return heatCell(row.cells[i]); }).join('') + '</tr>';
    }).join('');
  }

  function shownColumns(map) {
    return d3.range(map.labels.length).filter(function (i) { return !report.state.off[map.labels[i]]; });
  }

  function heatTable(map) {
    const columns = shownColumns(map);
    return '<figure><figcaption>' + escape(map.title) + '</figcaption><p class="note">' + escape(map.reading) + '</p>' +
      '<p class="heat-legend">' + map.legend.map(function (step) {
        return '<span style="background:' + step[0] + ';color:' + step[1] + '">' + escape(step[2]) + '</span>';
      }).join('') + '</p><div class="table-scroll" tabindex="0" role="region" aria-label="' + escape(map.title) + '"><table class="heat"><thead><tr><th scope="col"></th>' +
      columns.map(function (i) { return '<th scope="col">' + report.name(report.marked(map.labels[i])) + '</th>'; }).join('') +
      '</tr></thead><tbody>' + heatRows(map, columns) + '</tbody></table></div></figure>';
  }

  report.drawMaps = function () {
    document.getElementById('map').hidden = !report.data.maps.length;
    const tables = document.getElementById('map-tables');
    tables.classList.toggle('stacked', report.data.maps.some(function (map) { return shownColumns(map).length > 4; }));
    tables.innerHTML = report.data.maps.map(heatTable).join('');
  };
})();
