// The page: what is selected, and the plots that follow from it.
(function () {
  const data = report.data;
  const MEAN = 'all';
  const state = { sequence: data.sequences[0], seed: null, off: {}, figure: 'ate_pos_m' };
  const element = function (id) { return document.getElementById(id); };

  function cellsOf(sequence) { return data.cells.filter(function (cell) { return cell.sequence === sequence; }); }
  function seedsOf(sequence) { return d3.set(cellsOf(sequence).map(function (cell) { return cell.seed; })).values(); }
  const drawable = function (cell) { return cell.series.t.d.length > 0; };

  // One entry an estimator that is on and has something to draw: {name, style, series, cells}.
  function chosen() {
    return data.estimators.filter(function (name) { return !state.off[name]; }).map(function (name) {
      const cells = cellsOf(state.sequence).filter(function (cell) {
        const wanted = state.seed === MEAN ? cell.status === 'ok' : String(cell.seed) === state.seed;
        return cell.estimator === name && wanted && drawable(cell);
      });
      const series = cells.length === 0 ? null : state.seed === MEAN ? report.overSeeds(cells) : report.series(cells[0]);
      return { name: name, style: report.style(name), series: series, cells: cells };
    }).filter(function (entry) { return entry.series; });
  }

  function group(title, note, wide) {
    const section = d3.select('#plots').append('section');
    section.append('h2').text(title);
    section.append('p').attr('class', 'note').text(note);
    return section.append('div').attr('class', wide ? 'grid wide' : 'grid').node();
  }

  // Common fields of a plot's specification.
  function spec(id, title, y, unit, legend, more) {
    const base = { id: id, title: title, x: 'time [s]', y: y, unit: unit, height: 230, file: state.sequence + '_' + id,
      legend: legend.map(function (entry) { return { name: entry.name, style: entry.style }; }) };
    Object.keys(more).forEach(function (key) { base[key] = more[key]; });
    return base;
  }

  function lines(entries, pick) {
    return entries.map(function (entry) {
      return { name: entry.name, style: entry.style, width: 1.1, t: entry.series.t, v: pick(entry.series) || [] };
    });
  }

  function drawTrajectories(entries) {
    const mean = state.seed === MEAN;
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
  }

  function alignText(entries) {
    const aligned = entries.length ? entries[0].cells[0].align : '';
    return aligned && aligned !== 'none' ? ', aligned to the truth (' + aligned + ')' : '';
  }

  function drawErrors(entries, key, title, unit, titles, names) {
    const mean = state.seed === MEAN;
    const width = mean ? 1 : 3;
    const grid = group(title, mean ?
      'Root mean square over the seeds (line) beside the root mean square of the deviation the estimator claims (1\u03c3, shaded). ' +
      'An honest estimator\u2019s line follows its shade\u2019s edge.' :
      'Truth minus estimate, not aligned (line), inside the \u00b13\u03c3 the estimator claims (shaded). Drag across a plot to zoom, double-click to undo.');
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
  }

  function drawConsistency(entries) {
    const runs = state.seed === MEAN ? d3.max(entries, function (entry) { return entry.cells.length; }) || 1 : 1;
    const band = data.nees_bands[runs - 1];
    const few = state.seed === MEAN && entries.some(function (entry) { return entry.cells.length < runs; });
    const grid = group('Consistency', 'Normalised estimation error squared of the pose (6 degrees of freedom; ideal mean 6). Shaded: where ' +
      (runs > 1 ? 'the mean of ' + runs + ' independent runs' : 'a single run') + ' lies with 95 % probability (' + report.digits(band[0]) + ' to ' +
      report.digits(band[1]) + '). Dashed: mean over time.' + (few ? ' An estimator that lost runs has a wider band than is drawn.' : '') +
      (runs > 1 ? insideText(entries) : ''), true);
    const all = state.seed !== MEAN ? lines(entries, function (series) { return series.nees; }) : entries.map(function (entry) {
      const average = report.neesOverTime(entry.name, state.sequence);
      return { name: entry.name, style: entry.style, width: 1.1, t: average.t, v: average.nees };
    });
    const means = all.map(function (line) {
      return { style: line.style, value: d3.mean(line.v.filter(function (v) { return v !== null; })) };
    }).filter(function (mean) { return mean.value > 0; });
    report.timePlot(grid, spec('nees', 'NEES of the pose', 'NEES [\u2013], log scale', '', entries,
      { log: true, height: 300, lines: all, means: means, regions: [{ lo: band[0], hi: band[1] }] }));
    const distances = d3.set(d3.merge(entries.map(function (entry) {
      return d3.merge(entry.cells.map(function (cell) { return cell.rpe.map(function (r) { return r.d; }); }));
    }))).values().map(Number).sort(d3.ascending);
    const groups = distances.map(function (distance) {
      return { name: String(distance), boxes: entries.map(function (entry) { return rpeBox(entry, distance); }).filter(function (box) { return box; }) };
    });
    report.boxPlot(grid, spec('rpe', 'Relative position error', 'error [m]', 'm', entries,
      { x: 'length of the sub-trajectory [m]', height: 300, groups: groups }));
  }

  // How often the mean over the runs is inside its band: 95 % of the time, when the covariance is honest.
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
  function drawObservability(entries) {
    const audited = entries.filter(function (entry) {
      return (entry.series.rank || []).some(function (rank) { return rank !== null; });
    });
    if (!audited.length) { return; }
    const grid = group('Observability', 'What the Jacobians that the filter used say about the initial error along directions that nothing can ' +
      'measure. A consistent filter stays at rounding (below 1e\u221212, drawn as that) and at rank 11 of 15; information above it is invented.');
    const leak = function (id, title, unit, key) {
      report.timePlot(grid, spec(id, title, 'information [' + unit + '], log scale', unit, audited,
        { log: true, lines: lines(audited, function (series) { return series[key]; }) }));
    };
    leak('yaw-leak', 'Information about yaw', '1/rad\u00b2', 'yaw_leak');
    leak('position-leak', 'Information about global position', '1/m\u00b2', 'position_leak');
    report.timePlot(grid, spec('rank', 'Rank of the observability matrix', 'rank of 15', '', audited,
      { zero: true, lines: lines(audited, function (series) { return series.rank; }) }));
  }

  // Of runs with GNSS: the sky and each satellite's residuals, of the first such estimator's first seed.
  function drawSky(entries) {
    const with_sky = d3.merge(entries.map(function (entry) {
      return entry.cells.filter(function (cell) { return cell.sky && cell.sky.length; }).map(function (cell) {
        return { name: entry.name, cell: cell };
      });
    }));
    if (!with_sky.length) { return; }
    const first = with_sky[0];
    const colours = d3.scale.category20();
    const tracks = first.cell.sky.map(function (track) {
      return { name: track.s + ', rms ' + report.digits(track.rms) + ' m, used ' + (100 * track.used).toFixed(0) + ' %',
        style: { colour: colours(track.s), dash: null }, width: 2, t: track.t, x: track.x, y: track.y, v: track.r };
    });
    const ring = function (radius) {
      const angles = d3.range(0, 361, 5).map(function (a) { return a * Math.PI / 180; });
      return { name: (90 - radius) + '\u00b0 of elevation', style: { colour: '#c3ccd4', dash: null }, width: 1,
        t: angles, x: angles.map(function (a) { return radius * Math.sin(a); }),
        y: angles.map(function (a) { return radius * Math.cos(a); }) };
    };
    const grid = group('Satellites', first.name + ', seed ' + first.cell.seed + ': directions (zenith in the middle, north up, rings at 0, 30 ' +
      'and 60\u00b0 of elevation) and pseudorange residuals, predicted less measured.', true);
    report.topView(grid, spec('sky', 'Sky', 'north [\u00b0 from the zenith]', '\u00b0', [], { x: 'east [\u00b0 from the zenith]',
      height: 380, lines: tracks.concat([ring(90), ring(60), ring(30)]) }));
    report.timePlot(grid, spec('residuals', 'Residuals by satellite', 'residual [m]', 'm', [], { height: 380, zero: true, lines: tracks }));
  }

  function drawCost(entries) {
    const grid = group('Cost', 'Time of the back end a frame, and the features that updated the state. Boxes: quartiles and median; whiskers: 5 % to 95 %.');
    const medians = entries.map(function (entry) { return entry.series.ms_quantiles[2]; }).filter(function (m) { return m > 0; });
    const log = d3.max(medians) > 6 * d3.min(medians);
    const label = log ? 'time [ms], log scale' : 'time [ms]';
    report.timePlot(grid, spec('time', 'Back-end time per frame', label, 'ms', entries,
      { zero: !log, log: log, lines: lines(entries, function (series) { return series.ms; }) }));
    const boxes = entries.filter(function (entry) { return entry.series.ms_quantiles.length; }).map(function (entry) {
      return { name: entry.name, style: entry.style, q: entry.series.ms_quantiles };
    });
    report.boxPlot(grid, spec('time-box', 'Distribution of the back-end time', label, 'ms', entries,
      { x: 'estimators, in the order of the buttons above', log: log, groups: [{ name: '', boxes: boxes }] }));
    report.timePlot(grid, spec('features', 'Features used per frame', 'features [1/frame]', '', entries,
      { zero: true, lines: lines(entries, function (series) { return series.features; }) }));
  }

  function drawPlots() {
    const scroll = window.scrollY;
    const plots = element('plots');
    plots.style.minHeight = plots.offsetHeight + 'px';  // the page must not jump while it is drawn anew
    plots.textContent = '';
    report.view.plots = [];
    report.hideTooltip();
    const entries = chosen();
    drawTrajectories(entries);
    drawErrors(entries, 'pos', 'Position error', 'm', ['Error in x', 'Error in y', 'Error in z'], ['x error', 'y error', 'z error']);
    drawErrors(entries, 'ori', 'Orientation error', 'deg', ['Error about body x', 'Error about body y',
      'Error about body z'], ['\u03c6x', '\u03c6y', '\u03c6z']);
    drawConsistency(entries);
    drawObservability(entries);
    drawSky(entries);
    drawCost(entries);
    plots.style.minHeight = '';
    window.scrollTo(0, scroll);
    element('zoom-reset').hidden = report.view.domain === null;
    const root = document.documentElement;
    root.setAttribute('data-plots', document.querySelectorAll('svg.plot').length);
    root.setAttribute('data-lines', document.querySelectorAll('svg.plot path.line').length);
    root.setAttribute('data-bands', document.querySelectorAll('svg.plot path.band').length);
  }

  function drawSequence() {
    const cells = cellsOf(state.sequence);
    const ran = cells.find(function (cell) { return cell.duration > 0; });
    element('sequence-title').textContent = state.sequence;
    element('sequence-note').textContent = (ran ? report.digits(ran.duration) + ' s, ' + report.digits(ran.path) + ' m, ' +
      ran.frames + ' frames. ' : '') + 'RMSE is of the raw estimate' + (ran && ran.align ? '; ATE after alignment \u201c' + ran.align + '\u201d' : '') + '.';
    element('sequence-table').innerHTML = report.sequenceTable(state.sequence);
    report.drawEfficiency(state.sequence);
    report.drawFrontend(state.sequence);
    report.drawPairs(state.sequence, state.figure);
    element('failures').innerHTML = cells.filter(function (cell) { return cell.status !== 'ok'; }).map(function (cell) {
      return '<li><span class="bad">' + report.escape(cell.estimator) + ', seed ' + cell.seed + ': ' +
        report.escape(cell.status.replace('_', ' ')) + '</span> ' + report.escape(cell.message) + '</li>';
    }).join('');
  }

  function fillSeeds() {
    const seeds = seedsOf(state.sequence);
    const options = seeds.map(function (seed) { return [seed, seed]; });
    if (seeds.length > 1) { options.push([MEAN, 'all ' + seeds.length + ' together']); }
    if (!options.some(function (option) { return option[0] === state.seed; })) { state.seed = seeds[0]; }
    fillSelect('seed-select', options, state.seed);
  }

  function fillSelect(id, options, value) {
    const select = d3.select('#' + id);
    select.selectAll('option').remove();
    options.forEach(function (option) { select.append('option').attr('value', option[0]).text(option[1]); });
    select.property('value', value);
  }

  function fillChips() {
    const chips = d3.select('#chips');
    chips.selectAll('*').remove();
    data.estimators.forEach(function (name) {
      const chip = chips.append('button').attr({ type: 'button', class: 'chip', 'aria-pressed': String(!state.off[name]) });
      chip.html(report.swatch(report.style(name)) + report.escape(name));
      chip.on('click', function () { state.off[name] = !state.off[name]; fillChips(); drawPlots(); });
    });
    chips.append('span').attr('class', 'legend').html(report.swatch(report.TRUTH) + 'truth');
    const allOn = data.estimators.every(function (name) { return !state.off[name]; });
    chips.append('button').attr({ type: 'button', class: 'chip-all' }).text(allOn ? 'none' : 'all').on('click', function () {
      data.estimators.forEach(function (name) { state.off[name] = allOn; });
      fillChips();
      drawPlots();
    });
  }

  function drawOverview() {
    element('overview-note').textContent = report.overviewNote(state.figure);
    element('overview-table').innerHTML = report.overviewTable(state.figure);
  }

  function drawFacts() {
    const ok = data.cells.filter(function (cell) { return cell.status === 'ok'; }).length;
    const count = function (n, word) { return n + ' ' + word + (n === 1 ? '' : 's'); };
    element('facts').textContent = count(data.estimators.length, 'estimator') + ' on ' + count(data.sequences.length, 'sequence') + ', ' +
      count(data.cells.length, 'run') + (ok === data.cells.length ? ', all ok' : ', ' + (data.cells.length - ok) + ' not ok');
    element('command').textContent = data.command || '(not recorded)';
    element('thinning').textContent = 'A plotted series keeps every n-th frame, at most ' + data.points + ' of them; the figures are of all frames.';
    element('digest-table').innerHTML = report.digestTable();
  }

  function selectSequence(sequence) {
    state.sequence = sequence;
    report.view.domain = null;
    fillSeeds();
    drawSequence();
    drawPlots();
  }

  // "#sequence=S&seed=N" opens the page there.
  function readAddress() {
    location.hash.slice(1).split('&').forEach(function (part) {
      const at = part.indexOf('='), key = part.slice(0, at), value = decodeURIComponent(part.slice(at + 1));
      if (key === 'sequence' && data.sequences.indexOf(value) >= 0) { state.sequence = value; }
      if (key === 'seed') { state.seed = value; }
    });
  }

  function start() {
    if (data.cells.length === 0) {
      element('facts').textContent = 'There are no runs to show.';
      d3.selectAll('main > *').remove();
      document.documentElement.setAttribute('data-ready', 'true');
      return;
    }
    readAddress();
    // More than six at once hide each other; the others are one click away.
    data.estimators.forEach(function (name, i) { state.off[name] = i >= 6; });
    fillSelect('figure-select', data.figures.map(function (f) { return [f.key, f.label + (f.unit ? ' [' + f.unit + ']' : '')]; }), state.figure);
    fillSelect('sequence-select', data.sequences.map(function (s) { return [s, s]; }), state.sequence);
    d3.select('#figure-select').on('change', function () { state.figure = this.value; drawOverview(); report.drawPairs(state.sequence, state.figure); });
    d3.select('#sequence-select').on('change', function () { selectSequence(this.value); });
    d3.select('#seed-select').on('change', function () { state.seed = this.value; drawPlots(); });
    d3.select('#zoom-reset').on('click', function () { report.view.onZoom(null); });
    report.view.onZoom = function (domain) { report.view.domain = domain; drawPlots(); };
    drawFacts();
    drawOverview();
    fillChips();
    selectSequence(state.sequence);
    let width = window.innerWidth, timer = null;
    window.addEventListener('resize', function () {
      if (window.innerWidth !== width) {
        width = window.innerWidth;
        clearTimeout(timer);
        timer = setTimeout(drawPlots, 120);
      }
    });
    document.documentElement.setAttribute('data-ready', 'true');
  }

  start();
})();
