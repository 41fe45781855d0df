#include <array>
#include <bit>
#include <limits>
#include <variant>

#include "eval/record/truth_start.h"
#include "eval/run/session.h"
#include "tests/fuzz/fuzz_scene.h"
#include "tests/fuzz/fuzz_targets.h"

namespace alidade::test {
namespace {

/// The bytes of an input one by one; zeros behind the end.
class ByteSource {
 public:
  explicit ByteSource(std::string_view bytes) : bytes_(bytes) {}
  [[nodiscard]] bool empty() const { return next_ >= bytes_.size(); }
  unsigned Byte() { return empty() ? 0 : static_cast<unsigned char>(bytes_[next_++]); }
  unsigned Word() {
    const unsigned high = Byte();
    return 256 * high + Byte();
  }

 private:
  std::string_view bytes_;
  std::size_t next_ = 0;
};

/// A call of the session.
struct Advance {
  TimeNs imu_ns = 0;
};
struct AskNewest {};
struct RenewCatalog {
  TimeNs from_tag_ns = 0;
  bool empty = false;
};
using Call =
    std::variant<ImuSample, TrackFrame, ObservationEpoch, PositionFix, Advance, AskNewest, RenewCatalog>;

TimeNs* StampOf(Call* call) {
  if (auto* imu = std::get_if<ImuSample>(call)) {
    return &imu->stamp_ns;
  }
  if (auto* frame = std::get_if<TrackFrame>(call)) {
    return &frame->stamp_ns;
  }
  if (auto* epoch = std::get_if<ObservationEpoch>(call)) {
    return &epoch->stamp_ns;
  }
  if (auto* fix = std::get_if<PositionFix>(call)) {
    return &fix->stamp_ns;
  }
  if (auto* advance = std::get_if<Advance>(call)) {
    return &advance->imu_ns;
  }
  if (auto* catalog = std::get_if<RenewCatalog>(call)) {
    return &catalog->from_tag_ns;
  }
  return nullptr;
}

/// The scene's messages in the order of their stamps.
std::vector<Call> SceneCalls() {
  const Dataset& scene = FuzzScene();
  std::vector<Call> calls(scene.imu.begin(), scene.imu.end());
  calls.insert(calls.end(), scene.frames.begin(), scene.frames.end());
  calls.insert(calls.end(), scene.gnss->epochs.begin(), scene.gnss->epochs.end());
  calls.insert(calls.end(), scene.fixes.begin(), scene.fixes.end());
  std::stable_sort(calls.begin(), calls.end(), [](Call a, Call b) { return *StampOf(&a) < *StampOf(&b); });
  return calls;
}

/// A number of a message that can be set to anything, chosen by `which`; null when there is none.
double* NumberOf(Call* call, unsigned which) {
  if (auto* imu = std::get_if<ImuSample>(call)) {
    const unsigned number = which % 7;
    return number < 3 ? &imu->gyro[number] : number < 6 ? &imu->accel[number - 3] : &imu->gap_s;
  }
  if (auto* frame = std::get_if<TrackFrame>(call); frame != nullptr && !frame->observations.empty()) {
    return &frame->observations[which / 2 % frame->observations.size()].pixel[which % 2];
  }
  if (auto* epoch = std::get_if<ObservationEpoch>(call); epoch != nullptr && !epoch->satellites.empty()) {
    SatelliteObservation& satellite = epoch->satellites[which / 4 % epoch->satellites.size()];
    if (!satellite.signals.empty()) {
      SignalObservation& signal = satellite.signals.front();
      const std::array numbers = {&signal.pseudorange_m, &signal.doppler_hz, &signal.cn0_dbhz,
                                  &signal.pseudorange_std_m};
      std::optional<double>& number = *numbers[which % numbers.size()];
      return &number.emplace(number.value_or(1));
    }
  }
  if (auto* fix = std::get_if<PositionFix>(call)) {
    return which % 4 < 3 ? &fix->p_A[which % 4] : &fix->covariance(which / 4 % 3, which / 12 % 3);
  }
  return nullptr;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::array kNumbers = {
    0.0,       -1.0,       1e-300, 1e300, std::numeric_limits<double>::quiet_NaN(),
    kInfinity, -kInfinity, 1e4,    -1e4,  1e9};
constexpr std::array kFactors = {-1.0, 0.5, 2.0, 10.0, 57.29577951308232, 1 / 9.81, 1e-3, 1e3};
constexpr std::array<TimeNs, 12> kShifts = {1,
                                            -1,
                                            10'000'000,
                                            -10'000'000,
                                            kSecondNs,
                                            -kSecondNs,
                                            5 * kSecondNs,
                                            -60 * kSecondNs,
                                            1'000'000 * kSecondNs,
                                            INT64_MAX / 2,
                                            INT64_MIN / 2,
                                            0};

/// Changes the calls by the bytes: five bytes a change.
void Distort(ByteSource* source, std::vector<Call>* calls) {
  for (int changes = 0; changes < 100 && !source->empty() && !calls->empty(); ++changes) {
    const unsigned action = source->Byte();
    const std::size_t place = source->Word() % calls->size();
    const unsigned which = source->Byte();
    const unsigned value = source->Byte();
    Call& call = (*calls)[place];
    const auto at = calls->begin() + static_cast<std::ptrdiff_t>(place);
    switch (action % 9) {
      case 0: {  // the next messages are missing
        const std::size_t end = std::min(calls->size(), place + 1 + which);
        calls->erase(at, calls->begin() + static_cast<std::ptrdiff_t>(end));
        break;
      }
      case 1:
        calls->insert(at, Call(call));
        break;
      case 2: {  // a message comes at another time
        Call moved = std::move(call);
        calls->erase(at);
        const std::size_t to = std::min(calls->size(), place + which);
        calls->insert(calls->begin() + static_cast<std::ptrdiff_t>(to), std::move(moved));
        break;
      }
      case 3:
        if (TimeNs* stamp_ns = StampOf(&call)) {
          const TimeNs shift = kShifts[value % kShifts.size()];
          *stamp_ns = shift == 0 ? 0
                                 : static_cast<TimeNs>(static_cast<std::uint64_t>(*stamp_ns) +
                                                       static_cast<std::uint64_t>(shift));
        }
        break;
      case 4:
        if (double* number = NumberOf(&call, which)) {
          *number = kNumbers[value % kNumbers.size()];
        }
        break;
      case 5:  // from here on a number is wrong by a factor, as by a wrong unit
        for (std::size_t i = place; i < std::min(calls->size(), place + 4 * value); ++i) {
          if (double* number = NumberOf(&(*calls)[i], which)) {
            *number *= kFactors[which % kFactors.size()];
          }
        }
        break;
      case 6: {
        const TimeNs* stamp_ns = StampOf(&call);
        calls->insert(at, Advance{stamp_ns == nullptr ? INT64_MAX : *stamp_ns});
        break;
      }
      case 7:
        if (auto* frame = std::get_if<TrackFrame>(&call);
            frame != nullptr && !frame->observations.empty()) {  // ids that repeat, jump or are negative
          std::int64_t& id = frame->observations[which % frame->observations.size()].track_id;
          id = value % 4 == 0 ? INT64_MIN : value % 4 == 1 ? INT64_MAX : id + static_cast<int>(value % 4) - 3;
        } else if (auto* fix = std::get_if<PositionFix>(&call)) {
          fix->sensor = static_cast<int>(value) - 2;
        } else {
          calls->insert(at, AskNewest{});
        }
        break;
      default: {
        const TimeNs* stamp_ns = StampOf(&call);
        calls->insert(at, RenewCatalog{stamp_ns == nullptr ? INT64_MIN : *stamp_ns, value % 2 == 0});
      }
    }
  }
}

void RequireSound(const NavEstimate& estimate) {
  Require(IsFinite(estimate), "a state is finite");
  Require(estimate.covariance.diagonal().minCoeff() >= 0, "no variance is negative");
}

/// Two bytes of settings, then changes of the scene's messages.
void TakeMessages(std::string_view bytes) {
  const Dataset& scene = FuzzScene();
  ByteSource source(bytes);
  const unsigned settings = source.Byte();
  const unsigned lateness = source.Byte();
  EstimatorConfig config;
  config.backend = (settings & 1) == 0 ? Backend::kFilter : Backend::kSmoother;
  config.filter.window = 6;
  config.smoother.window = 5;
  config.smoother.max_iterations = 2;
  config.init.method = (settings & 2) == 0 ? InitMethod::kTruth : InitMethod::kAuto;
  config.gnss.enabled = (settings & 4) != 0;
  config.fix.enabled = (settings & 8) != 0;
  config.calibration.time_offset = config.calibration.extrinsics = (settings & 16) != 0;
  config.recovery.enabled = (settings & 32) == 0;

  SessionOptions options;
  options.lateness.imu_s = lateness % 4 * 0.01;
  options.lateness.camera_s = lateness / 4 % 4 * 0.1;
  options.lateness.gnss_s = options.lateness.fix_s = lateness / 16 % 4 * 0.2;
  options.live = lateness < 128;
  options.max_waiting = 20;
  options.gnss = SetupOf(*scene.gnss);
  options.start_state = [&](TimeNs imu_ns) { return StartFromTruth(config.init, *scene.truth, imu_ns, 1); };
  options.camera = (settings & 64) == 0;
  Result<std::unique_ptr<Session>> made = Session::Make(config, scene.rig, options);
  Require(made.ok() || !made.message().empty(), "a refusal has a message");
  if (!made.ok()) {
    return;
  }
  Session& session = **made;

  static const std::vector<Call> scene_calls = SceneCalls();
  std::vector<Call> calls = scene_calls;
  Distort(&source, &calls);
  const auto take = [&] {
    for (const SessionEvent& event : session.TakeEvents()) {
      Require(!Describe(event).empty(), "an event has a description");
      if (const auto* state = std::get_if<StateEvent>(&event)) {
        RequireSound(state->estimate);
      }
    }
  };
  for (Call& call : calls) {
    if (auto* imu = std::get_if<ImuSample>(&call)) {
      session.AddImu(*imu);
    } else if (auto* frame = std::get_if<TrackFrame>(&call)) {
      session.AddFrame(std::move(*frame));
    } else if (auto* epoch = std::get_if<ObservationEpoch>(&call)) {
      session.AddGnss(std::move(*epoch));
    } else if (auto* fix = std::get_if<PositionFix>(&call)) {
      session.AddFix(*fix);
    } else if (auto* advance = std::get_if<Advance>(&call)) {
      session.AdvanceTo(advance->imu_ns);
    } else if (auto* catalog = std::get_if<RenewCatalog>(&call)) {
      session.AddCatalog(catalog->from_tag_ns, catalog->empty ? nullptr : scene.gnss->catalog);
    } else {
      const Result<NewestState> newest = session.Newest();
      if (newest.ok()) {
        RequireSound(newest->estimate);
      }
    }
    take();
  }
  session.Flush();
  take();
}

constexpr std::array kTargets = {FuzzTarget{"session", TakeMessages}};

}  // namespace

std::span<const FuzzTarget> SessionTargets() {
  return kTargets;
}

}  // namespace alidade::test
