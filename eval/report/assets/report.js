// The page: what is selected, and the tables and plots that follow from it.
(function () {
  const data = report.data;
  const state = report.state;
  const MOST_PLOTTED = 8;  // more colours cannot be distinguished
  const element = function (id) { return document.getElementById(id); };

  // One entry an estimator that is on and has something to draw: {name, style, series, cells}.
  function chosen() {
    const all = state.seed === report.ALL_SEEDS;
    return report.shownEstimators().map(function (name) {
      const cells = report.cellsOf(state.sequence).filter(function (cell) {
        const wanted = all ? cell.status === 'ok' : String(cell.seed) === state.seed;
        return cell.estimator === name && wanted && cell.series.t.d.length > 0;
      });
      const series = cells.length === 0 ? null : all ? report.overSeeds(cells) : report.series(cells[0]);
      return { name: name, style: report.style(name), series: series, cells: cells };
    }).filter(function (entry) { return entry.series; });
  }

  function drawPlots() {
    const scroll = window.scrollY;
    const plots = element('plots');
    plots.style.minHeight = plots.offsetHeight + 'px';  // the page must not jump while it is drawn anew
    plots.textContent = '';
    report.view.plots = [];
    report.hideTooltip();
    const possible = chosen(), entries = possible.slice(0, MOST_PLOTTED);
    element('crowd').textContent = possible.length > MOST_PLOTTED ? 'The plots show the first ' + MOST_PLOTTED + ' of the ' + possible.length +
      ' selected estimators; the tables show all.' : '';
    report.drawTrajectories(entries);
    report.drawErrors(entries, 'pos', 'Position error', 'm', ['Error in x', 'Error in y', 'Error in z'], ['x error', 'y error', 'z error']);
    report.drawErrors(entries, 'ori', 'Orientation error', 'deg', ['Error about body x', 'Error about body y',
      'Error about body z'], ['\u03c6x', '\u03c6y', '\u03c6z']);
    report.drawConsistency(entries);
    report.drawObservability(entries);
    report.drawInnovations(entries);
    report.drawSky(entries);
    report.drawCost(entries);
    plots.style.minHeight = '';
    window.scrollTo(0, scroll);
    element('zoom-reset').hidden = report.view.domain === null;
    const root = document.documentElement;
    root.setAttribute('data-plots', document.querySelectorAll('svg.plot').length);
    root.setAttribute('data-lines', document.querySelectorAll('svg.plot path.line').length);
    root.setAttribute('data-bands', document.querySelectorAll('svg.plot path.band').length);
  }

  function failureList(cells, withSequence) {
    return cells.filter(function (cell) { return cell.status !== 'ok'; }).map(function (cell) {
      return '<li><span class="bad">' + report.escape(cell.estimator) + (withSequence ? ' on ' + report.escape(cell.sequence) : '') + ', seed ' +
        cell.seed + ': ' + report.escape(cell.status.replace('_', ' ')) + '</span> ' + report.escape(cell.message) + '</li>';
    }).join('');
  }

  function drawSequence() {
    const cells = report.cellsOf(state.sequence);
    const ran = cells.find(function (cell) { return cell.duration > 0; });
    const align = report.alignment(cells);
    element('sequence-title').textContent = state.sequence || '';
    element('sequence-note').textContent = (ran ? report.digits(ran.duration) + ' s, ' + report.digits(ran.path) + ' m, ' +
      ran.frames + ' frames. ' : '') + ['rmse_', 'ate_', 'rpe_', 'nees_', 'completion', 'realtime_factor'].map(function (key) {
        return report.meaning(key, align);
      }).join(' ');
    element('sequence-table').innerHTML = report.sequenceTable(state.sequence);
    report.drawEfficiency(state.sequence);
    report.drawFrontend(state.sequence);
    report.drawPairs(state.sequence, state.figure);
    element('failures').innerHTML = failureList(cells, false);
  }

  function fillSelect(id, options, value) {
    const select = d3.select('#' + id);
    select.selectAll('option').remove();
    options.forEach(function (option) { select.append('option').attr('value', option[0]).text(option[1]); });
    select.property('value', value);
  }

  // Buttons that switch `names` on and off; `off` holds those that are off. At least one stays on.
  function fillChips(id, names, off, label) {
    const box = d3.select('#' + id);
    const focused = document.activeElement && document.activeElement.getAttribute('data-name');
    const within = element(id).contains(document.activeElement);
    box.selectAll('*').remove();
    const add = function (kind, name, html, pressed, flip) {
      const chip = box.append('button').attr({ type: 'button', class: kind, 'data-name': name }).html(html)
        .on('click', function () { flip(); refresh(); });
      if (pressed !== null) { chip.attr('aria-pressed', String(pressed)); }
      if (within && focused === name) { chip.node().focus(); }
    };
    names.forEach(function (name) {
      add('chip', name, label(name), !off[name], function () { off[name] = !off[name]; });
    });
    const allOn = names.every(function (name) { return !off[name]; });
    add('chip-all', ' all', allOn ? 'none' : 'all', null, function () {
      names.forEach(function (name, i) { off[name] = allOn && (id !== 'sequence-chips' || i > 0); });
    });
  }

  function drawControls() {
    const seeds = report.seedsOf(state.sequence);
    const seedOptions = seeds.map(function (seed) { return [seed, seed]; });
    if (seeds.length > 1) { seedOptions.push([report.ALL_SEEDS, 'all ' + seeds.length + ' together']); }
    fillSelect('seed-select', seedOptions, state.seed);
    fillSelect('sequence-select', report.shownSequences().map(function (s) { return [s, s]; }), state.sequence);
    fillSelect('figure-select', data.figures.map(function (f) { return [f.key, f.label + (f.unit ? ' [' + f.unit + ']' : '')]; }), state.figure);
    fillSelect('against-select', [[report.BEST, 'the best']].concat(data.estimators.map(function (name) { return [name, name]; })), state.against);
    element('against-field').hidden = !data.pairs.length;
    const here = function (name) { return report.aggregate(name, state.sequence) ? 0 : 1; };
    const order = data.estimators.slice().sort(function (a, b) {  // those of the sequence first: the plots show no others
      return here(a) - here(b) || data.estimators.indexOf(a) - data.estimators.indexOf(b);
    });
    fillChips('chips', order, state.off, function (name) {
      return report.swatch(report.style(name)) + report.escape(report.marked(name));
    });
    d3.selectAll('#chips .chip').filter(function () { return here(this.getAttribute('data-name')); }).classed('elsewhere', true)
      .attr('title', 'did not run on ' + state.sequence);
    d3.select('#chips').append('span').attr('class', 'legend').html(report.swatch(report.TRUTH) + 'truth');
    element('sequence-chips').hidden = data.sequences.length < 2;
    fillChips('sequence-chips', data.sequences, state.skip, report.escape);
  }

  function drawOverview() {
    element('overview-note').textContent = report.overviewNote(state.figure);
    element('overview-table').innerHTML = report.overviewTable(state.figure);
    report.drawMaps();
  }

  function drawFacts() {
    const runs = d3.sum(data.aggregate, function (row) { return row.cells; });
    const ok = d3.sum(data.aggregate, function (row) { return row.ok; });
    const count = function (n, word) { return n + ' ' + word + (n === 1 ? '' : 's'); };
    element('facts').innerHTML = count(data.estimators.length, 'estimator') + ' on ' + count(data.sequences.length, 'sequence') + ', ' +
      count(runs, 'run') + (ok === runs ? ', all ok' : ', <b class="bad">' + (runs - ok) + ' not ok</b>') +
      (data.not_run.length ? '; <b class="bad">not run: ' + data.not_run.length + '</b>' : '') +
      (data.shown_note ? '. ' + report.escape(data.shown_note) : '');
    element('lost').hidden = ok === runs;
    element('lost-list').innerHTML = failureList(data.cells, true);
    element('not-run').hidden = !data.not_run.length;
    element('not-run-list').innerHTML = data.not_run.map(function (note) { return '<li>' + report.escape(note) + '</li>'; }).join('');
    element('command').textContent = data.command || '(not recorded)';
    element('thinning').textContent = 'A plotted series has at most about ' + data.points + ' frames: every n-th one, and those that hold its extremes; ' +
      'the figures are of all frames.';
    element('digest-table').innerHTML = report.digestTable();
  }

  // Draws all that follows from the selection.
  function refresh() {
    report.settle();
    report.writeAddress();
    drawControls();
    drawOverview();
    drawSequence();
    drawPlots();
  }

  function attachControls() {
    const follow = function (id, key) {
      d3.select('#' + id).on('change', function () {
        state[key] = this.value;
        if (key === 'sequence') { report.view.domain = null; }
        refresh();
      });
    };
    follow('figure-select', 'figure');
    follow('against-select', 'against');
    follow('sequence-select', 'sequence');
    follow('seed-select', 'seed');
    d3.select('#zoom-reset').on('click', function () { report.view.onZoom(null); });
    report.view.onZoom = function (domain) { report.view.domain = domain; drawPlots(); };
    window.addEventListener('hashchange', function () { report.readAddress(); refresh(); });
    let width = window.innerWidth, timer = null;
    window.addEventListener('resize', function () {
      if (window.innerWidth !== width) {
        width = window.innerWidth;
        clearTimeout(timer);
        timer = setTimeout(drawPlots, 120);
      }
    });
  }

  function start() {
    if (data.cells.length === 0) {
      element('facts').textContent = 'There are no runs to show. ' + data.not_run.join('; ');
      d3.selectAll('main > *').remove();
      document.documentElement.setAttribute('data-ready', 'true');
      return;
    }
    report.readAddress();
    attachControls();
    drawFacts();
    refresh();
    document.documentElement.setAttribute('data-ready', 'true');
  }

  start();
})();
