#include "smoother/solve/sensor_terms.h"

#include "smoother/factors/imu_factor.h"
#include "smoother/factors/measurement_factor.h"
#include "smoother/factors/rest_factor.h"
#include "smoother/solve/factor_term.h"

namespace alidade {
namespace {

Status AddImuTerm(const SensorContext& context, const WindowFrame& from, const WindowFrame& to,
                  WindowTerms* terms) {
  const ImuFactor factor(&*to.preintegration, context.gravity_W, from.first_estimate(), to.first_estimate());
  if (!factor.valid()) {
    return Status::Diverged("smoother: IMU covariance up to " + FormatSeconds(to.stamp_ns) +
                            " s is not positive definite; the four noise densities must be positive");
  }
  terms->push_back(MakeTerm(factor, {NavBlock(from), BiasBlock(from), NavBlock(to), BiasBlock(to)}));
  return Status::Ok();
}

void AddMeasurementTerms(const SensorContext& context, const WindowFrame& frame, WindowTerms* terms) {
  for (const FrameMeasurement& attached : frame.measurements) {
    std::visit(
        [&](const auto& kind) {
          using Factor = MeasurementFactor<std::decay_t<decltype(kind)>>;
          terms->push_back(
              MakeTerm(Factor(&attached, context.gravity_W, context.calibration->layout),
                       {NavBlock(frame), BiasBlock(frame), CalibrationBlock(*context.calibration)}));
        },
        attached.measurement);
  }
}

void AddEpochTerms(const SensorContext& context, const WindowFrame& frame, WindowTerms* terms) {
  const GnssFactorContext& gnss = *context.gnss;
  for (const FrameEpoch& epoch : frame.epochs) {
    const double dt_s = epoch.SecondsAfter(frame.stamp_ns);
    const auto rows = static_cast<int>(CountEpochRows(gnss.config, epoch.measurements));
    if (rows > 0) {
      terms->push_back(MakeTerm(
          GnssEpochFactor(&gnss, &epoch, dt_s, rows, context.calibration->layout),
          {NavBlock(frame), BiasBlock(frame), ClockBlock(frame), CalibrationBlock(*context.calibration)}));
    }
  }
}

void AddClockTerm(const GnssFactorContext& gnss, const WindowFrame& from, const WindowFrame& to,
                  WindowTerms* terms) {
  const ClockStep step(gnss.config, SecondsBetween(from.stamp_ns, to.stamp_ns), to.clock_anew);
  terms->push_back(MakeTerm(ClockFactor(step), {ClockBlock(from), ClockBlock(to)}));
}

}  // namespace

Status AddSensorTerms(const SensorContext& context, const WindowFrames& frames, int count,
                      WindowTerms* terms) {
  const auto frame = [&](int index) -> const WindowFrame& { return *frames[static_cast<size_t>(index)]; };
  for (int i = 0; i + 1 < count; ++i) {
    ALIDADE_RETURN_IF_ERROR(AddImuTerm(context, frame(i), frame(i + 1), terms));
  }
  for (int i = 0; i < count; ++i) {
    if (frame(i).rest) {
      terms->push_back(MakeTerm(RestFactor(*frame(i).rest), {NavBlock(frame(i)), BiasBlock(frame(i))}));
    }
  }
  for (int i = 0; i < count; ++i) {
    AddMeasurementTerms(context, frame(i), terms);
  }
  for (int i = 0; context.gnss != nullptr && i < count; ++i) {
    AddEpochTerms(context, frame(i), terms);
    if (i + 1 < count) {
      AddClockTerm(*context.gnss, frame(i), frame(i + 1), terms);
    }
  }
  return Status::Ok();
}

}  // namespace alidade
