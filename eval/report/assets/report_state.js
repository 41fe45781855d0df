// What is selected. It lives in the address (#sequence=...&without=...), so that a link opens the page as it was left.
(function () {
  const data = report.data;
  const DEFAULT_FIGURE = 'ate_pos_m', BEST = 'best';
  report.ALL_SEEDS = 'all';
  report.BEST = BEST;

  // off and skip: names of estimators and sequences that are switched off. against: what the overview tests differences to.
  const state = { sequence: null, seed: null, figure: null, against: BEST, off: {}, skip: {} };
  report.state = state;

  const smoothed = d3.set(data.aggregate.filter(function (row) { return row.mode === 'smoothed'; }).map(function (row) { return row.estimator; }));
  // Whether an estimator uses data of later than its rows.
  report.smoothed = function (estimator) { return smoothed.has(estimator); };

  report.marked = function (estimator) { return estimator + (report.smoothed(estimator) ? ' (smoothed)' : ''); };

  report.shownEstimators = function () { return data.estimators.filter(function (name) { return !state.off[name]; }); };
  report.shownSequences = function () { return data.sequences.filter(function (name) { return !state.skip[name]; }); };
  // What the cells' ATE and trajectories are aligned by: one word, or each with its estimators.
  report.alignment = function (cells) {
    const groups = new Map();
    cells.filter(function (cell) { return cell.align; }).forEach(function (cell) {
      groups.set(cell.align, (groups.get(cell.align) || new Set()).add(cell.estimator));
    });
    return groups.size < 2 ? Array.from(groups.keys()).join('') : Array.from(groups, function (group) {
      return group[0] + ': ' + Array.from(group[1]).join(', ');
    }).join('; ');
  };
  report.cellsOf = function (sequence) { return data.cells.filter(function (cell) { return cell.sequence === sequence; }); };
  report.seedsOf = function (sequence) {
    return d3.set(report.cellsOf(sequence).map(function (cell) { return cell.seed; })).values();
  };

  function figureKeys() { return data.figures.map(function (figure) { return figure.key; }); }
  function pick(value, list, fallback) { return list.indexOf(value) >= 0 ? value : fallback; }

  // Makes the selection one that the data has.
  report.settle = function () {
    const shown = report.shownSequences();
    state.sequence = pick(state.sequence, shown, shown[0] || data.sequences[0]);
    const seeds = report.seedsOf(state.sequence);
    state.seed = state.seed === report.ALL_SEEDS && seeds.length > 1 ? state.seed : pick(state.seed, seeds, seeds[0]);
    state.figure = pick(state.figure, figureKeys(), pick(DEFAULT_FIGURE, figureKeys(), figureKeys()[0]));
    state.against = pick(state.against, data.estimators, BEST);
  };

  function switchedOff(text, names) {
    const off = {};
    text.split(',').map(decodeURIComponent).forEach(function (name) { if (names.indexOf(name) >= 0) { off[name] = true; } });
    return off;
  }

  report.readAddress = function () {
    const parts = {};
    location.hash.slice(1).split('&').forEach(function (part) {
      const at = part.indexOf('=');
      if (at > 0) { parts[part.slice(0, at)] = part.slice(at + 1); }
    });
    ['sequence', 'seed', 'figure', 'against'].forEach(function (key) {
      state[key] = parts[key] === undefined ? null : decodeURIComponent(parts[key]);
    });
    state.off = switchedOff(parts.without || '', data.estimators);
    state.skip = switchedOff(parts.skip || '', data.sequences);
    report.settle();
  };

  // Only what differs from the page as it opens.
  report.writeAddress = function () {
    const parts = [];
    const add = function (key, value, usual) { if (value !== usual) { parts.push(key + '=' + encodeURIComponent(value)); } };
    add('sequence', state.sequence, report.shownSequences()[0]);
    add('seed', state.seed, report.seedsOf(state.sequence)[0]);
    add('figure', state.figure, pick(DEFAULT_FIGURE, figureKeys(), figureKeys()[0]));
    add('against', state.against, BEST);
    const names = function (key, off) {
      const list = Object.keys(off).filter(function (name) { return off[name]; });
      if (list.length) { parts.push(key + '=' + list.map(encodeURIComponent).join(',')); }
    };
    names('without', state.off);
    names('skip', state.skip);
    const hash = parts.length ? '#' + parts.join('&') : '';
    if (hash !== location.hash) { history.replaceState(null, '', location.pathname + location.search + hash); }
  };
})();
