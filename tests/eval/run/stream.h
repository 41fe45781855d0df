#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <variant>
#include <vector>

#include "core/random.h"
#include "eval/dataset/dataset.h"
#include "eval/record/run_record.h"
#include "eval/run/session.h"
#include "gnss/alignment/alignment.h"
#include "gnss/model/gnss_epoch.h"

namespace alidade::test {

/// When the messages of a sensor arrive: after their stamp by `delay_s` and up to `jitter_s` more.
struct Delay {
  double delay_s = 0;
  double jitter_s = 0;
};
struct Delays {
  Delay imu = {}, camera = {}, gnss = {}, fix = {};
};

struct Arrival {
  TimeNs arrival_ns = 0;
  Sensor sensor = Sensor::kImu;
  size_t index = 0;
};

/// The messages of a log in the order of their arrival; equal seeds give equal orders.
inline std::vector<Arrival> ArrivalsOf(const Dataset& dataset, const Delays& delays, unsigned seed) {
  RandomStream random(seed, "arrivals");
  std::vector<Arrival> arrivals;
  const auto add = [&](Sensor sensor, size_t index, TimeNs stamp_ns, const Delay& delay) {
    arrivals.push_back(
        {stamp_ns + SecondsToNs(delay.delay_s + delay.jitter_s * random.Uniform(0, 1)), sensor, index});
  };
  for (size_t i = 0; i < dataset.imu.size(); ++i) {
    add(Sensor::kImu, i, dataset.imu[i].stamp_ns, delays.imu);
  }
  for (size_t i = 0; i < dataset.frames.size(); ++i) {
    add(Sensor::kCamera, i, dataset.frames[i].stamp_ns, delays.camera);
  }
  for (size_t i = 0; dataset.gnss != nullptr && i < dataset.gnss->epochs.size(); ++i) {
    add(Sensor::kGnss, i, dataset.gnss->epochs[i].stamp_ns, delays.gnss);
  }
  for (size_t i = 0; i < dataset.fixes.size(); ++i) {
    const PositionFix& fix = dataset.fixes[i];
    const FixSensor& sensor = dataset.rig.fixes[static_cast<size_t>(fix.sensor)];
    add(SensorOf<PositionFixEntry>(), i, fix.stamp_ns + SecondsToNs(sensor.time_offset_s), delays.fix);
  }
  std::stable_sort(arrivals.begin(), arrivals.end(),
                   [](const Arrival& a, const Arrival& b) { return a.arrival_ns < b.arrival_ns; });
  return arrivals;
}

inline void AddTo(Session* session, const Dataset& dataset, const Arrival& message) {
  switch (message.sensor) {
    case Sensor::kImu:
      session->AddImu(dataset.imu[message.index]);
      break;
    case Sensor::kCamera:
      session->AddFrame(dataset.frames[message.index]);
      break;
    case Sensor::kGnss:
      session->AddGnss(dataset.gnss->epochs[message.index]);
      break;
    default:
      session->AddFix(dataset.fixes[message.index]);
      break;
  }
}

/// Hands the messages over one by one, and what waits at the end; returns all events.
inline std::vector<SessionEvent> Stream(Session* session, const Dataset& dataset,
                                        const std::vector<Arrival>& arrivals) {
  std::vector<SessionEvent> events;
  const auto take = [&] {
    for (SessionEvent& event : session->TakeEvents()) {
      events.push_back(std::move(event));
    }
  };
  for (const Arrival& message : arrivals) {
    AddTo(session, dataset, message);
    take();
  }
  session->Flush();
  take();
  return events;
}

/// The events of one kind.
template <typename Event>
std::vector<Event> Only(const std::vector<SessionEvent>& events) {
  std::vector<Event> only;
  for (const SessionEvent& event : events) {
    if (const Event* found = std::get_if<Event>(&event)) {
      only.push_back(*found);
    }
  }
  return only;
}

/// The states after frames.
inline std::vector<NavEstimate> StatesOf(const std::vector<SessionEvent>& events,
                                         Sensor source = Sensor::kCamera) {
  std::vector<NavEstimate> states;
  for (const StateEvent& event : Only<StateEvent>(events)) {
    if (event.source == source) {
      states.push_back(event.estimate);
    }
  }
  return states;
}

[[nodiscard]] inline bool SameBits(const NavEstimate& a, const NavEstimate& b) {
  return a.stamp_ns == b.stamp_ns && a.nav.R_WB == b.nav.R_WB && a.nav.p_WB == b.nav.p_WB &&
         a.nav.v_WB == b.nav.v_WB && a.bias.gyro == b.bias.gyro && a.bias.accel == b.bias.accel &&
         a.covariance == b.covariance;
}

/// Expects a session's states to be those of the ordered log's records in the frame of the alignment: bit by
/// bit after it; to 1e-9 up to it, where the session's are in its local world and are turned here
/// (covariances relative to their norm).
inline void ExpectStatesOfLog(const std::vector<RunRecord>& records, const AlignedEvent& aligned,
                              const std::vector<NavEstimate>& states) {
  constexpr double kRounding = 1e-9;
  constexpr double kRootRounding = 1e-6;
  ASSERT_EQ(states.size(), records.size());
  size_t before = 0;
  for (size_t i = 0; i < states.size(); ++i) {
    const NavEstimate& expected = records[i].estimate;
    if (states[i].stamp_ns > aligned.global.stamp_ns) {
      ASSERT_TRUE(SameBits(states[i], expected)) << i;
      continue;
    }
    ++before;
    const NavEstimate turned = TurnIntoEnu(aligned.alignment, states[i]);
    ASSERT_EQ(turned.stamp_ns, expected.stamp_ns);
    ASSERT_LT((turned.nav.R_WB - expected.nav.R_WB).norm(), kRounding) << i;
    ASSERT_LT((turned.nav.p_WB - expected.nav.p_WB).norm(), kRounding) << i;
    ASSERT_LT((turned.nav.v_WB - expected.nav.v_WB).norm(), kRounding) << i;
    ASSERT_LT((turned.bias.gyro - expected.bias.gyro).norm(), kRounding) << i;
    ASSERT_LT((turned.bias.accel - expected.bias.accel).norm(), kRounding) << i;
    // The state of the alignment itself is turned by the estimator, which may hold a root of its covariance.
    ASSERT_TRUE(turned.covariance.isApprox(
        expected.covariance, states[i].stamp_ns < aligned.global.stamp_ns ? kRounding : kRootRounding))
        << i;
  }
  EXPECT_GT(before, 5u);
  EXPECT_GT(states.size() - before, 50u);
}

}  // namespace alidade::test
