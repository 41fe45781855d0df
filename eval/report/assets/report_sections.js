// The sections of plots of one sequence. Each takes the entries that are drawn: [{name, style, series, cells}].
(function () {
  const data = report.data;
  const state = report.state;
  const allSeeds = function () { return state.seed === report.ALL_SEEDS; };

  report.group = function (title, note, wide) {
    const section = d3.select('#plots').append('section');
    section.append('h2').text(title);
    section.append('p').attr('class', 'note').text(note);
    return section.append('div').attr('class', wide ? 'grid wide' : 'grid').node();
  };

  // Common fields of a plot's specification.
  report.spec = function (id, title, y, unit, legend, more) {
    const base = { id: id, title: title, x: 'time [s]', y: y, unit: unit, height: 230, file: state.sequence + '_' + id,
      legend: legend.map(function (entry) { return { name: report.marked(entry.name), style: entry.style }; }) };
    Object.keys(more).forEach(function (key) { base[key] = more[key]; });
    return base;
  };

  report.lines = function (entries, pick) {
    return entries.map(function (entry) {
      return { name: entry.name, style: entry.style, width: 1.1, t: entry.series.t, v: pick(entry.series) || [] };
    });
  };
  const group = report.group, spec = report.spec, lines = report.lines;

  report.drawTrajectories = function (entries) {
    const mean = allSeeds();
    const grid = group('Trajectory', (mean ? 'Every seed\u2019s estimate; the truth of the first. ' : '') +
      'Position of the body in the world frame' + alignText(entries) + '. Hover to find the same instant in every plot.', true);
    const withTruth = entries.filter(function (entry) { return entry.series.truth.length; });
    const truth = withTruth.length ? [{ name: 'truth', style: report.TRUTH, series: withTruth[0].series }] : [];
    const paths = d3.merge(entries.map(function (entry) {
      return entry.cells.map(function (cell) {
        return { name: entry.name + (mean ? ', seed ' + cell.seed : ''), style: entry.style, series: report.series(cell) };
      });
    })).filter(function (item) { return item.series.est.length; });
    const item = function (source, key, width) {
      return { name: source.name, style: source.style, width: width, t: source.series.t, x: source.series[key][0],
        y: source.series[key][1], v: source.series[key][2] };
    };
    const all = paths.map(function (p) { return item(p, 'est', mean ? 1 : 1.6); })
      .concat(truth.map(function (p) { return item(p, 'truth', 2.2); }));
    const legend = entries.concat(truth);
    report.topView(grid, spec('top', 'Top view', 'y [m]', 'm', legend, { x: 'x [m]', height: 380, lines: all }));
    report.timePlot(grid, spec('height', 'Height', 'z [m]', 'm', legend, { height: 380, lines: all }));
  };

  function alignText(entries) {
    const aligned = report.alignment(d3.merge(entries.map(function (entry) { return entry.cells; })));
    return aligned && aligned !== 'none' ? ', aligned to the truth (' + report.alignmentWords(aligned) + ')' : '';
  }

  report.drawErrors = function (entries, key, title, unit, titles, names) {
    const mean = allSeeds();
    const width = mean ? 1 : 3;
    const grid = group(title, mean ?
      'Root mean square over the seeds (line) and root mean square of the reported standard deviation (1\u03c3, shaded). ' +
      'For a consistent estimator the line follows the edge of the shaded area.' :
      'Truth minus estimate, not aligned (line), and the reported \u00b13\u03c3 (shaded). Drag across a plot to zoom, double-click to reset; on the keyboard, arrows read values.');
    names.forEach(function (name, axis) {
      const bands = entries.filter(function (entry) { return entry.series[key + '_sigma'].length; }).map(function (entry) {
        const sigma = entry.series[key + '_sigma'][axis];
        const times = function (factor) { return sigma.map(function (s) { return s === null ? null : factor * s; }); };
        return { style: entry.style, t: entry.series.t, lo: times(mean ? 0 : -width), hi: times(width) };
      });
      const label = (mean ? 'RMS of ' : '') + name + ' [' + unit + ']';
      report.timePlot(grid, spec(key + '-' + axis, titles[axis], label, unit, entries, { bands: bands, zero: true,
        lines: lines(entries, function (series) { return series[key][axis]; }) }));
    });
  };

  report.drawConsistency = function (entries) {
    const runs = allSeeds() ? d3.max(entries, function (entry) { return entry.cells.length; }) || 1 : 1;
    const band = data.nees_bands[runs - 1];
    const few = allSeeds() && entries.some(function (entry) { return entry.cells.length < runs; });
    const grid = group('Consistency', 'Normalised estimation error squared (NEES) of the pose: squared error in units of the reported covariance, 6 on average when the estimator is consistent, ' +
      'more when it is overconfident. Shaded: where ' +
      (runs > 1 ? 'the mean of ' + runs + ' independent runs' : 'a single run') + ' lies with 95 % probability (' + report.digits(band[0]) + ' to ' +
      report.digits(band[1]) + '). Dashed: mean over time.' + (few ? ' An estimator that lost runs has a wider band than the one shown.' : '') +
      ' Boxes: the relative position error (RPE) of the motion over stretches of each length of the path.' +
      (runs > 1 ? insideText(entries) : ''), true);
    const all = !allSeeds() ? lines(entries, function (series) { return series.nees; }) : entries.map(function (entry) {
      const average = report.neesOverTime(entry.name, state.sequence);
      return { name: entry.name, style: entry.style, width: 1.1, t: average.t, v: average.nees };
    });
    const nees = data.figures.findIndex(function (figure) { return figure.key === 'nees_pose'; });
    const means = all.map(function (line, i) {
      const value = allSeeds() ? d3.mean(line.v.filter(function (v) { return v !== null; })) : entries[i].cells[0].figures[nees];
      return { style: line.style, value: value };
    }).filter(function (mean) { return mean.value > 0; });
    const legend = entries.concat({ name: '95 % band', style: { colour: '#bcdcc9', dash: null } });
    report.timePlot(grid, spec('nees', 'NEES of the pose', 'NEES [\u2013], log scale', '', legend,
      { log: true, height: 300, lines: all, means: means, regions: [{ lo: band[0], hi: band[1] }] }));
    const distances = d3.set(d3.merge(entries.map(function (entry) {
      return d3.merge(entry.cells.map(function (cell) { return cell.rpe.map(function (r) { return r.d; }); }));
    }))).values().map(Number).sort(d3.ascending);
    const groups = distances.map(function (distance) {
      return { name: String(distance), boxes: entries.map(function (entry) { return rpeBox(entry, distance); }).filter(function (box) { return box; }) };
    });
    report.boxPlot(grid, spec('rpe', 'Relative position error', 'error [m]', 'm', entries,
      { x: 'length of the sub-trajectory [m]', height: 300, groups: groups }));
  };

  // How often the mean over the runs is inside its band: 95 % of the time, when the estimator is consistent.
  function insideText(entries) {
    return ' Inside: ' + entries.map(function (entry) {
      const curve = data.nees_over_time.find(function (c) { return c.estimator === entry.name && c.sequence === state.sequence; });
      return entry.name + ' ' + (curve && curve.inside !== null ? (100 * curve.inside).toFixed(1) + ' %' : '\u2013');
    }).join(', ') + '.';
  }

  function rpeBox(entry, distance) {
    const found = d3.merge(entry.cells.map(function (cell) {
      return cell.rpe.filter(function (r) { return r.d === distance && r.q.length; });
    }));
    if (!found.length) { return null; }
    return { name: entry.name + ', ' + distance + ' m', style: entry.style, note: d3.sum(found, function (r) { return r.n; }) + ' sub-trajectories',
      q: found[0].q.map(function (unused, i) { return d3.mean(found, function (r) { return r.q[i]; }); }) };
  }

  // Of audited filters alone: the plan's key `audit`.
  report.drawObservability = function (entries) {
    const audited = entries.filter(function (entry) {
      return (entry.series.rank || []).some(function (rank) { return rank !== null; });
    });
    if (!audited.length) { return; }
    const grid = group('Observability', 'Information in the filter\u2019s Jacobians about the unobservable directions of the initial error. ' +
      'A consistent filter stays at rounding level (values below 1e\u221212 are drawn there) and at rank 11 of 15; information above it is spurious.');
    const leak = function (id, title, unit, key) {
      report.timePlot(grid, spec(id, title, 'information [' + unit + '], log scale', unit, audited,
        { log: true, left: 68, lines: lines(audited, function (series) { return series[key]; }) }));
    };
    leak('yaw-leak', 'Information about yaw', '1/rad\u00b2', 'yaw_leak');
    leak('position-leak', 'Information about global position', '1/m\u00b2', 'position_leak');
    report.timePlot(grid, spec('rank', 'Rank of the observability matrix', 'rank of 15', '', audited,
      { zero: true, lines: lines(audited, function (series) { return series.rank; }) }));
  };

})();
