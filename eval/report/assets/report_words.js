// What a figure is, in a sentence, where it stands.
(function () {
  const ALIGNMENTS = {
    none: 'none: none',
    pos: 'pos: in position',
    posyaw: 'posyaw: in position and yaw about gravity, the directions that visual-inertial odometry cannot observe',
    se3: 'se3: in position and orientation, which hides an error in tilt too',
    sim3: 'sim3: in position, orientation and scale, which hides errors in tilt and scale too'
  };

  // An alignment by its name; other texts (several alignments) unchanged.
  report.alignmentWords = function (align) { return ALIGNMENTS[align] || align; };

  // Empty for figures that name themselves, such as times.
  report.meaning = function (key, align) {
    if (key.indexOf('nees_') === 0 && key !== 'nees_inside_share') {
      return 'NEES: squared error in units of the covariance that the estimator claims. Its mean is the number of degrees of freedom (6 for ' +
        'the pose, 3 for the others) when the claim is true; above, the estimator is overconfident, below, cautious. Unaligned.';
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
    return '';
  };
})();
