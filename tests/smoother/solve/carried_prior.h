#pragma once

#include <gtest/gtest.h>

#include "tests/smoother/sliding/gnss_fixture.h"
#include "tests/smoother/solve/given_terms.h"
#include "tests/smoother/window/calibrated_window.h"

namespace alidade::test {

/// Calibrates the window and returns the prior over its states, clock and calibration that is left when its
/// oldest frame, which goes, has been marginalised.
inline LinearPrior PriorWithoutTheOldest(ErrorConvention convention, GnssFixture* fixture) {
  const CalibrationEstimate estimate = CalibrateWindow(fixture);
  fixture->calibration = {estimate.layout, estimate.mean};
  LinearPrior prior;
  EXPECT_TRUE(MakeInitialPrior(convention, fixture->window.frame(0), SomeCovariance(), &prior));
  GnssWindow gnss(fixture->context.config, {}, fixture->gravity_W);
  GnssAlignment alignment;
  alignment.enu = fixture->context.mount.enu;
  alignment.clock = Vector6d::Zero();
  gnss.Align(alignment, &fixture->window.frame(0), &prior);
  AddCalibrationPrior(estimate, &prior);
  prior = Marginalize(fixture->window, prior, PoseSystem(4, &fixture->calibration),
                      {fixture->gravity_W, &fixture->context});
  fixture->window.RemoveOldest();
  return prior;
}

}  // namespace alidade::test
