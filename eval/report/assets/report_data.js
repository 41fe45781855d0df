'use strict';

// The data of the page, decoded from its JSON; see eval/report_data.cc for the packing.
const report = {};

// A fault must not leave a page that looks finished: it is shown, and it marks the page for tests.
window.addEventListener('error', function (event) {
  document.documentElement.setAttribute('data-errors', event.message);
  const notice = document.createElement('p');
  notice.className = 'note bad';
  notice.textContent = 'This page met a fault: ' + event.message;
  document.querySelector('main').prepend(notice);
});

(function () {
  // Okabe-Ito without its yellow and black, and two dark tones: distinguishable with any colour vision, dark enough on white.
  const COLOURS = ['#0072b2', '#d55e00', '#009e73', '#b5558c', '#c98500', '#3aa0d8', '#6b2346', '#6b6b14'];
  const DASHES = [null, '6 3', '2 2'];

  report.data = JSON.parse(document.getElementById('data').textContent);
  report.TRUTH = { colour: '#1b2430', dash: '1 3' };

  report.style = function (estimator) {
    const i = report.data.estimators.indexOf(estimator);
    return { colour: COLOURS[i % COLOURS.length], dash: DASHES[Math.floor(i / COLOURS.length) % DASHES.length] };
  };

  function unpack(column) {
    let sum = 0;
    return column.d.map(function (delta) {
      if (delta === null) { return null; }
      sum += delta;
      return sum * column.q;
    });
  }

  // Columns of a cell, unpacked once.
  report.series = function (cell) {
    if (!cell.unpacked) {
      const packed = cell.series;
      const unpacked = { t: unpack(packed.t) };
      ['truth', 'est', 'ori', 'ori_sigma', 'pos', 'pos_sigma'].forEach(function (key) {
        unpacked[key] = packed[key].map(unpack);
      });
      ['nees', 'ms', 'ms_quantiles', 'features', 'tracks', 'nis', 'rank', 'yaw_leak', 'position_leak'].forEach(function (key) { unpacked[key] = packed[key]; });
      report.data.sensors.forEach(function (sensor) { unpacked[sensor.key + '_nis'] = packed.sensor_nis[sensor.key] || []; });
      cell.unpacked = unpacked;
    }
    return cell.unpacked;
  };

  // The pose NEES of an estimator averaged over its runs that ended ok, instant by instant: {t, nees}.
  report.neesOverTime = function (estimator, sequence) {
    const curve = report.data.nees_over_time.find(function (c) { return c.estimator === estimator && c.sequence === sequence; });
    return curve ? { t: unpack(curve.t), nees: curve.nees } : { t: [], nees: [] };
  };

  // Index of the entry of the ascending list `times` nearest to `time`; -1 when there is none.
  report.nearest = function (times, time) {
    const i = d3.bisectLeft(times, time);
    if (i === 0) { return times.length ? 0 : -1; }
    return i < times.length && times[i] - time < time - times[i - 1] ? i : i - 1;
  };

  // Combines one column of several series on the time grid of the first.
  function combine(all, pick, fold) {
    return all[0].t.map(function (time, i) {
      const values = [];
      all.forEach(function (series) {
        const column = pick(series);
        const at = series.t[i] === time ? i : report.nearest(series.t, time);
        const value = column && at >= 0 ? column[at] : null;
        if (value !== null && value !== undefined) { values.push(value); }
      });
      return values.length ? fold(values) : null;
    });
  }

  const rootMeanSquare = function (values) { return Math.sqrt(d3.mean(values, function (v) { return v * v; })); };

  // The rows at even steps: the others show extremes and would bias a mean.
  function regularRows(series, mask) {
    const keep = function (column) { return mask ? column.filter(function (unused, i) { return mask[i] === '1'; }) : column; };
    const rows = {};
    Object.keys(series).forEach(function (key) {
      rows[key] = key === 'ms_quantiles' ? series[key] : Array.isArray(series[key][0]) ? series[key].map(keep) : keep(series[key]);
    });
    return rows;
  }

  // Over seeds: errors and deviations as root mean squares, the rest as means.
  report.overSeeds = function (cells) {
    const all = cells.map(function (cell) { return regularRows(report.series(cell), cell.series.regular); });
    const merged = { t: all[0].t, truth: all[0].truth, est: all[0].est };
    ['ori', 'ori_sigma', 'pos', 'pos_sigma'].forEach(function (key) {
      merged[key] = all[0][key].map(function (unused, axis) {
        return combine(all, function (series) { return series[key][axis]; }, rootMeanSquare);
      });
    });
    const ofSensors = report.data.sensors.map(function (sensor) { return sensor.key + '_nis'; });
    ['nees', 'ms', 'features', 'tracks', 'nis', 'rank', 'yaw_leak', 'position_leak'].concat(ofSensors).forEach(function (key) {
      merged[key] = combine(all, function (series) { return series[key]; }, d3.mean);
    });
    const filled = all.filter(function (series) { return series.ms_quantiles.length; });
    merged.ms_quantiles = filled.length ? filled[0].ms_quantiles.map(function (unused, i) {
      return d3.mean(filled, function (series) { return series.ms_quantiles[i]; });
    }) : [];
    return merged;
  };

  // As the tables of the program print: fixed decimals, two significant digits when small, exponents when huge.
  report.format = function (value, decimals) {
    if (value === null || value === undefined || isNaN(value)) { return '\u2013'; }
    const magnitude = Math.abs(value);
    if (magnitude >= 1e6) { return value.toExponential(1); }
    if (magnitude > 0 && magnitude < Math.pow(10, 1 - decimals)) { return String(Number(value.toPrecision(2))); }
    return value.toFixed(decimals);
  };

  // The standard error of `mean`, with the digits that the mean shows.
  report.formatError = function (error, mean, decimals) {
    const fixed = Math.abs(mean) < 1e6 && Math.abs(mean) >= Math.pow(10, 1 - decimals);
    return fixed ? error.toFixed(decimals) : report.format(error, decimals);
  };

  report.digits = function (value) {
    return value === null || value === undefined ? '\u2013' : String(Number(value.toPrecision(4)));
  };
})();
