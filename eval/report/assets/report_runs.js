// The sections on what a run did: innovations, features, time, satellites.
(function () {
  const state = report.state;
  const group = report.group, spec = report.spec, lines = report.lines;

  function percent(share) { return (100 * share).toFixed(1) + ' %'; }

  // Of frames, over the runs of an entry: mean ratio and share inside the band.
  function innovationText(entries, pick) {
    return entries.map(function (entry) {
      const known = entry.cells.map(pick).filter(function (summary) { return summary && summary[0] !== null; });
      return known.length ? entry.name + ' ' + d3.mean(known, function (summary) { return summary[0]; }).toFixed(2) + ', ' +
        percent(d3.mean(known, function (summary) { return summary[1]; })) : '';
    }).filter(function (text) { return text; }).join('; ');
  }

  function drawNis(grid, entries, key, pick, title) {
    const bounds = [];
    entries.forEach(function (entry) {
      const known = entry.cells.map(pick).filter(function (summary) { return summary && summary[0] !== null; });
      (known.length ? known[0].slice(2) : []).forEach(function (value) { if (value > 0) { bounds.push({ style: entry.style, dash: '2 4', value: value }); } });
    });
    report.timePlot(grid, spec(key, title, 'NIS / rows [\u2013], log scale', '', entries,
      { log: true, means: bounds, lines: lines(entries, function (series) { return series[key]; }) }));
  }

  report.drawInnovations = function (entries) {
    const ofVision = function (cell) { return cell.nis; };
    const sensors = report.data.sensors.map(function (sensor) {
      const pick = function (cell) { return cell.sensor_nis[sensor.key]; };
      return { key: sensor.key + '_nis', name: sensor.name, pick: pick, entries: entries.filter(function (entry) { return entry.cells.some(pick); }) };
    }).filter(function (sensor) { return sensor.entries.length; });
    const grid = group('Innovations and features', 'Normalised innovation squared of a frame divided by the number of its rows: 1 on average if the ' +
      'assumed noise is correct. Dotted: 95 % band of a frame with the median number of rows. Gated measurements are ' +
      'excluded; for a smoother the residuals of its window after the solve. Mean and share of frames inside their own band: ' +
      (innovationText(entries, ofVision) || 'unknown') + sensors.map(function (sensor) {
        return '; of ' + sensor.name + ': ' + innovationText(sensor.entries, sensor.pick);
      }).join('') + '.');
    drawNis(grid, entries, 'nis', ofVision, 'Innovations');
    sensors.forEach(function (sensor) { drawNis(grid, sensor.entries, sensor.key, sensor.pick, 'Innovations of ' + sensor.name); });
    report.timePlot(grid, spec('tracks', 'Tracks per frame', 'tracks [1/frame]', '', entries,
      { zero: true, lines: lines(entries, function (series) { return series.tracks; }) }));
    report.timePlot(grid, spec('features', 'Features used per frame', 'features [1/frame]', '', entries,
      { zero: true, lines: lines(entries, function (series) { return series.features; }) }));
  };

  // Distinguished by lightness, too.
  const STAGES = [{ name: 'front end', colour: '#c3ccd4' }, { name: 'propagation', colour: '#3aa0d8' },
    { name: 'update', colour: '#c98500' }, { name: 'rest', colour: '#4a3b52' }];

  // Mean milliseconds a frame by stage; null when not known.
  function stagesOf(entry) {
    const known = entry.cells.filter(function (cell) { return cell.stages[3] !== null; });
    if (!known.length) { return null; }
    const mean = function (i) { return d3.mean(known, function (cell) { return cell.stages[i]; }) || 0; };
    const front = mean(0), propagate = mean(1), update = mean(2), all = mean(3);
    return [front, propagate, update, Math.max(0, all - propagate - update)];
  }

  report.drawCost = function (entries) {
    const grid = group('Cost', 'Wall time a frame. The front end is shared. The back end is propagation, update and the rest (delivery of the IMU, bookkeeping). ' +
      'Boxes: quartiles and median; whiskers: 5 % to 95 %.');
    const medians = entries.map(function (entry) { return entry.series.ms_quantiles[2]; }).filter(function (m) { return m > 0; });
    const log = d3.max(medians) > 6 * d3.min(medians);
    const label = log ? 'time [ms], log scale' : 'time [ms]';
    report.timePlot(grid, spec('time', 'Back-end time per frame', label, 'ms', entries,
      { zero: !log, log: log, lines: lines(entries, function (series) { return series.ms; }) }));
    const boxes = entries.filter(function (entry) { return entry.series.ms_quantiles.length; }).map(function (entry) {
      return { name: entry.name, style: entry.style, q: entry.series.ms_quantiles };
    });
    report.boxPlot(grid, spec('time-box', 'Distribution of the back-end time', label, 'ms', entries,
      { x: '', log: log, height: 262, bottom: 84, named: true, groups: [{ name: '', boxes: boxes }] }));
    const bars = entries.map(function (entry) { return { name: entry.name, parts: stagesOf(entry) }; })
      .filter(function (bar) { return bar.parts; });
    report.barPlot(grid, spec('stages', 'Mean time per frame by stage', '', 'ms', [], { x: 'time [ms]', stages: STAGES, bars: bars,
      legend: STAGES.map(function (stage) { return { name: stage.name, style: { colour: stage.colour, dash: null } }; }) }));
  };

  const SYSTEMS = { G: ['GPS', '#0072b2'], R: ['GLONASS', '#d55e00'], E: ['Galileo', '#009e73'], C: ['BeiDou', '#b5558c'],
    J: ['QZSS', '#c98500'] };
  function systemOf(satellite) { return SYSTEMS[satellite.charAt(0)] || ['other', '#6b6b14']; }

  // A line with a hole where the satellite was out of sight for more than twice the usual step.
  function withHoles(track) {
    const steps = d3.pairs(track.t).map(function (pair) { return pair[1] - pair[0]; });
    const hole = 2.5 * d3.min(steps);
    const line = { t: [], v: [] };
    track.t.forEach(function (time, i) {
      if (i > 0 && steps[i - 1] > hole) {
        line.t.push(time - steps[i - 1] / 2);
        line.v.push(null);
      }
      line.t.push(time);
      line.v.push(track.r[i]);
    });
    return line;
  }

  // Of runs with GNSS: the sky and each satellite's residuals, of the first estimator that is on and has them here.
  report.drawSky = function (entries) {
    const withSky = report.cellsOf(state.sequence).filter(function (cell) { return cell.sky.length; });
    const drawn = withSky.filter(function (cell) { return entries.some(function (entry) { return entry.name === cell.estimator; }); });
    if (!withSky.length) { return; }
    const cell = drawn[0] || withSky[0];
    const tracks = cell.sky.map(function (track) {
      const holes = withHoles(track);
      return { name: track.s + ', rms ' + report.digits(track.rms) + ' m, used ' + (100 * track.used).toFixed(0) + ' %', label: track.s,
        style: { colour: systemOf(track.s)[1], dash: null }, width: 1.6, t: track.t, x: track.x, y: track.y, residuals: holes };
    });
    const ring = function (radius) {
      const angles = d3.range(0, 361, 5).map(function (a) { return a * Math.PI / 180; });
      return { name: (90 - radius) + '\u00b0 of elevation', style: { colour: '#c3ccd4', dash: null }, width: 1, passive: true,
        t: angles, x: angles.map(function (a) { return radius * Math.sin(a); }), y: angles.map(function (a) { return radius * Math.cos(a); }) };
    };
    const seen = d3.set(cell.sky.map(function (track) { return track.s.charAt(0); })).values();
    const legend = seen.map(function (letter) { return { name: systemOf(letter)[0], style: { colour: systemOf(letter)[1], dash: null } }; });
    const grid = group('Satellites', cell.estimator + ', seed ' + cell.seed + ': directions (zenith in the middle, north up, rings at 0, 30 ' +
      'and 60\u00b0 of elevation, the name where a satellite was last received) and pseudorange residuals, predicted minus measured. Colours: ' +
      seen.map(function (letter) { return systemOf(letter)[0]; }).join(', ') + '.', true);
    const describe = function (line, i) {
      const down = Math.sqrt(line.points[i][0] * line.points[i][0] + line.points[i][1] * line.points[i][1]);
      const azimuth = (Math.atan2(line.points[i][0], line.points[i][1]) * 180 / Math.PI + 360) % 360;
      return 'azimuth ' + azimuth.toFixed(1) + '\u00b0, elevation ' + (90 - down).toFixed(1) + '\u00b0';
    };
    report.topView(grid, spec('sky', 'Sky', 'north [\u00b0 from the zenith]', '\u00b0', [], { x: 'east [\u00b0 from the zenith]',
      height: 420, legend: legend, describe: describe, noStart: true, lines: [ring(90), ring(60), ring(30)].concat(tracks) }));
    report.timePlot(grid, spec('residuals', 'Residuals by satellite', 'residual [m]', 'm', [], { height: 420, zero: true, legend: legend,
      lines: tracks.map(function (track) {
        return { name: track.name, style: track.style, width: 1.2, t: track.residuals.t, v: track.residuals.v };
      }) }));
  };
})();
