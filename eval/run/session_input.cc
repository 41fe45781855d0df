#include <utility>

#include "core/format.h"
#include "eval/run/session.h"

// What a Session takes in, and which of it is skipped or too late.

namespace alidade {

void Session::AddImu(const ImuSample& as_stamped) {
  if (failed()) {
    return;
  }
  ImuSample sample = as_stamped;
  sample.stamp_ns -= imu_jump_ns_;
  if (!sample.gyro.allFinite() || !sample.accel.allFinite()) {
    Skip(Sensor::kImu, sample.stamp_ns, "not finite");
    return;
  }
  if (options_.live) {
    TakeUnlessLeap(sample);
  } else {
    TakeImu(sample);
  }
}

void Session::TakeUnlessLeap(const ImuSample& sample) {
  const TimeNs newest_ns = loop_.imu().newest_ns();
  const ImuLeap::Outcome outcome = leap_.Add(sample, newest_ns);
  if (outcome.refused) {
    const TimeNs refused_ns = outcome.refused->stamp_ns;
    Skip(Sensor::kImu, refused_ns,
         Format("its stamp is %.3f s after the previous sample and no later sample confirms it",
                SecondsBetween(newest_ns, refused_ns)));
  }
  if (outcome.confirmed) {
    TakeImu(*outcome.confirmed);
  }
  if (outcome.verdict == ImuLeap::Verdict::kTake) {
    TakeImu(sample);
  } else if (outcome.verdict == ImuLeap::Verdict::kTwice) {
    SkipTwice(Sensor::kImu, sample.stamp_ns);
  }
}

void Session::TakeImu(const ImuSample& sample) {
  switch (loop_.imu().Add(sample)) {
    case ImuStream::Arrival::kTwice:
      SkipTwice(Sensor::kImu, sample.stamp_ns);
      return;
    case ImuStream::Arrival::kTooLate:
      RefuseLate(Sensor::kImu, sample.stamp_ns, loop_.imu().delivered_ns() - sample.stamp_ns);
      return;
    case ImuStream::Arrival::kTaken:
      break;
  }
  camera_clock_.AddImu(sample);
  Process();
}

void Session::AddFrame(TrackFrame frame) {
  if (failed()) {
    return;
  }
  frame.stamp_ns -= camera_jump_ns_;
  const TimeNs stamp_ns = frame.stamp_ns;
  if (!options_.camera) {
    Skip(Sensor::kCamera, stamp_ns, "the session is one without a camera");
    return;
  }
  const TimeNs imu_ns = stamp_ns + frame_offset_ns_;
  if (imu_ns < processed_ns_) {
    RefuseLate(Sensor::kCamera, stamp_ns, processed_ns_ - imu_ns);
    return;
  }
  if (stamp_ns <= last_frame_ns_) {
    RefuseLate(Sensor::kCamera, stamp_ns, last_frame_ns_ - stamp_ns);
    return;
  }
  if (!frames_.emplace(stamp_ns, std::move(frame)).second) {
    SkipTwice(Sensor::kCamera, stamp_ns);
    return;
  }
  Process();
  if (frames_.size() > options_.max_waiting) {
    const TimeNs oldest_ns = frames_.begin()->first;
    frames_.erase(frames_.begin());
    Skip(Sensor::kCamera, oldest_ns,
         Format("the IMU does not reach it, and %zu frames wait", frames_.size()));
  }
}

void Session::AddGnss(ObservationEpoch epoch) {
  AddGnss(std::make_shared<const ObservationEpoch>(std::move(epoch)));
}

void Session::AddGnss(std::shared_ptr<const ObservationEpoch> epoch) {
  GnssRun* run = loop_.gnss();
  if (run == nullptr) {
    SkipUnused(Sensor::kGnss, epoch->stamp_ns, "GNSS");
  } else if (!failed() && run->Add(std::move(epoch), processed_ns_)) {
    ProcessAfter(run);
  }
}

void Session::AddMeasurement(const Measurement& measurement) {
  const Sensor sensor = SensorOf(measurement);
  MeasurementRun* run = loop_.measurements(sensor);
  if (run == nullptr) {
    SkipUnused(sensor, StampOf(measurement), PluralNameOf(sensor));
  } else if (!failed() && run->Add(measurement, processed_ns_)) {
    ProcessAfter(run);
  }
}

void Session::SkipUnused(Sensor sensor, TimeNs stamp_ns, const char* name) {
  if (!failed()) {
    Skip(sensor, stamp_ns, std::string("the session is one without ") + name);
  }
}

void Session::ProcessAfter(SensorRun* arrival) {
  Process();
  if (arrival->waiting() > options_.max_waiting) {
    arrival->SkipNext();
  }
}

void Session::AddCatalog(TimeNs from_tag_ns, std::shared_ptr<const SatelliteCatalog> catalog) {
  if (GnssRun* run = loop_.gnss()) {
    run->feed().AddCatalog(from_tag_ns, std::move(catalog));
  }
}

void Session::Skip(Sensor sensor, TimeNs stamp_ns, std::string reason) {
  events_.emplace_back(SkippedEvent{sensor, stamp_ns, std::move(reason)});
}

void Session::SkipTwice(Sensor sensor, TimeNs stamp_ns) {
  Skip(sensor, stamp_ns, "there is one with this stamp already");
}

void Session::RefuseLate(Sensor sensor, TimeNs stamp_ns, TimeNs by_ns) {
  events_.emplace_back(TooLateEvent{sensor, stamp_ns, SecondsBetween(0, by_ns)});
}

}  // namespace alidade
