// What a figure is, in a sentence, where it stands.
(function () {
  const ALIGNMENTS = {
    none: 'none: as it is',
    pos: 'pos: in position',
    posyaw: 'posyaw: in position and yaw about gravity, the directions that visual-inertial odometry cannot observe',
    se3: 'se3: in position and orientation, which hides an error in tilt too',
    sim3: 'sim3: in position, orientation and scale, which hides errors in tilt and scale too'
  };

  // An alignment, or several with their estimators, with what each of them is.
  report.alignmentWords = function (align) {
    const used = Object.keys(ALIGNMENTS).filter(function (name) { return new RegExp('(^|; )' + name + '( of|:|$)').test(align); });
    const words = used.map(function (name) { return ALIGNMENTS[name]; }).join('; ');
    return used.indexOf(align) >= 0 ? words : align + (words ? '; ' + words : '');
  };

  // Empty for figures that name themselves, such as times.
  report.meaning = function (key, align) {
    if (key.indexOf('nees_') === 0 && key !== 'nees_inside_share') {
      return 'NEES: squared error in units of the covariance that the estimator reports. Its mean is the number of degrees of freedom (6 for ' +
        'the pose, 3 for the others) when the estimator is consistent; above, the estimator is overconfident, below, cautious. Unaligned.';
    }
    if (key.indexOf('rpe_') === 0) {
      return 'RPE: error of the relative motion over stretches of this length of the path, which no alignment but one in scale changes: drift, ' +
        'independent of how the drift adds up.';
    }
    if (key.indexOf('ate_') === 0) {
      return 'ATE: root mean square of the error of the trajectory after its best alignment to the truth' +
        (align ? ' (' + report.alignmentWords(align) + ').' : '.');
    }
    if (key.indexOf('rmse_') === 0) {
      return 'RMSE: root mean square of the error of the estimate as it is, without alignment.';
    }
    if (key === 'completion') {
      return 'Completed: share of the time from the first to the last camera frame with an estimate (rows at most 0.5 s apart), of all runs, ' +
        'also of those that were lost.';
    }
    if (key === 'realtime_factor') {
      return 'x real time: seconds of camera data that a second of front end and back end processes; of the back end alone where the tracks were ' +
        'read from a file, of the whole program where it reports no times.';
    }
    return '';
  };
})();
