#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "gnss/formats/rinex_observation.h"
#include "gnss/orbits/gnss_files.h"
#include "gnss/positioning/single_point.h"
#include "gnss/positioning/single_point_options.h"
#include "gnss/positioning/single_point_solution.h"
#include "tests/gnss/positioning/position_track.h"
#include "tests/support/shared_data.h"

// Real observations: where the truth is known, and RTKLIB as independent oracle. Each test prints what it
// measured: docs/gnss.md quotes these lines.

namespace alidade {
namespace {

struct Solved {
  std::size_t epochs = 0;
  std::vector<SinglePointSolution> solutions;
  test::PositionTrack track;
};

std::string Shared(const std::string& path) {
  return test::SharedDir() + "/data/" + path;
}

Solved Solve(const std::string& observations, const GnssFiles& files,
             const GnssCorrectionOptions& options = {}) {
  Solved run;
  ReaderWarnings warnings;
  const Result<ObservationFile> file = ReadRinexObservation(observations);
  const auto catalog = LoadSatelliteCatalog(files, &warnings);
  EXPECT_TRUE(file.ok() && catalog.ok()) << file.message() << catalog.message();
  if (!file.ok() || !catalog.ok()) {
    return run;
  }
  SinglePointSolver solver(MeasurementBuilder(*catalog, options, file->glonass_channels),
                           SinglePointOptions(), file->approximate_position_E);
  run.epochs = file->epochs.size();
  for (const ObservationEpoch& epoch : file->epochs) {
    if (Result<SinglePointSolution> solution = solver.Solve(epoch); solution.ok()) {
      run.track[solution->stamp_ns] = solution->position_E;
      run.solutions.push_back(*std::move(solution));
    }
  }
  return run;
}

void Print(const char* what, const test::TrackStatistics& s) {
  std::printf("measured: %s: %d epochs, mean E %.2f N %.2f U %.2f m, rms horizontal %.2f, 3D %.2f m\n", what,
              s.count, s.mean.x(), s.mean.y(), s.mean.z(), s.rms.head<2>().norm(), s.rms_3d());
}

const std::string kEsbc = "gnss/static_esbc/";

GnssFiles EsbcBroadcast() {
  return {{Shared(kEsbc + "ESBC00DNK_R_20201770000_01D_MN.rnx")}, {}, {}};
}

/// The station in ITRF2014 at 2020.48: its header is in ETRF2014, which has moved with Eurasia since 1989
/// (EUREF technical note 1: 0.085, 0.531, -0.770 mas a year). The antenna stands 0.216 m above.
Eigen::Vector3d EsbcAntenna() {
  const Eigen::Vector3d marker(3582105.2910, 532589.7313, 5232754.8054);
  constexpr double kMas = M_PI / 180 / 3600e3;
  const Eigen::Vector3d turned = -31.48 * kMas * Eigen::Vector3d(0.085, 0.531, -0.770).cross(marker);
  return EnuFrame::At(marker + turned).ToEcef({0, 0, 0.216});
}

TEST(SinglePointRealTest, StaticStationAgreesWithRtklibAndIsAtLeastAsNear) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const Solved run = Solve(Shared(kEsbc + "ESBC_4h.rnx"), EsbcBroadcast());
  EXPECT_EQ(run.solutions.size(), 480u);
  const test::TrackStatistics ours = test::Compare(run.track, EsbcAntenna());
  EXPECT_LT(ours.rms_3d(), 1.5);
  const test::PositionTrack oracle =
      test::RtklibSinglePoint(45, 10, Shared(kEsbc + "ESBC_4h.rnx") + " " + EsbcBroadcast().navigation[0]);
  if (oracle.empty()) {
    GTEST_SKIP() << "rnx2rtkp is not installed: no comparison with it";
  }
  const test::TrackStatistics theirs = test::Compare(oracle, EsbcAntenna());
  int pairs = 0;
  double sum = 0;
  for (const auto& [stamp, position] : oracle) {
    const auto near = run.track.lower_bound(stamp - kSecondNs);
    if (near != run.track.end() && near->first < stamp + kSecondNs) {
      sum += (near->second - position).squaredNorm();
      ++pairs;
    }
  }
  EXPECT_EQ(pairs, 480);
  EXPECT_LT(std::sqrt(sum / std::max(pairs, 1)), 0.5);
  EXPECT_LE(ours.rms_3d(), theirs.rms_3d());
  Print("static station, Alidade", ours);
  Print("static station, RTKLIB", theirs);
  std::printf("measured: static station, Alidade against RTKLIB: rms 3D %.2f m\n",
              std::sqrt(sum / std::max(pairs, 1)));
}

TEST(SinglePointRealTest, StaticVelocityIsSmallAndUnbiased) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const Solved run = Solve(Shared(kEsbc + "ESBC_4h.rnx"), EsbcBroadcast());
  const Eigen::Matrix3d R_NE = EnuFrame::At(EsbcAntenna()).R_EN.transpose();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double squared = 0;
  for (const SinglePointSolution& s : run.solutions) {
    ASSERT_TRUE(s.has_velocity);
    mean += R_NE * s.velocity_E / static_cast<double>(run.solutions.size());
    squared += s.velocity_E.squaredNorm() / static_cast<double>(run.solutions.size());
  }
  std::printf("measured: static velocity: rms 3D %.4f m/s, mean E %.4f N %.4f U %.4f m/s\n",
              std::sqrt(squared), mean.x(), mean.y(), mean.z());
  EXPECT_LT(std::sqrt(squared), 0.02);
  EXPECT_LT(std::abs(mean.z()), 0.002) << "the Sagnac rate with the other sign gives 6 mm/s";
}

TEST(SinglePointRealTest, PreciseProductsAreNoWorseThanBroadcast) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  GnssFiles precise = EsbcBroadcast();
  precise.orbits = {Shared(kEsbc + "GRG0MGXFIN_20201760000_01D_15M_ORB.SP3"),
                    Shared(kEsbc + "GRG0MGXFIN_20201770000_01D_15M_ORB.SP3")};
  precise.clocks = {Shared(kEsbc + "GRG0MGXFIN_20201770000_01D_30S_CLK.CLK.gz")};
  for (const IonosphereMode mode : {IonosphereMode::kBroadcast, IonosphereMode::kFree}) {
    GnssCorrectionOptions options;
    options.ionosphere = mode;
    const Solved with = Solve(Shared(kEsbc + "ESBC_4h.rnx"), precise, options);
    const Solved without = Solve(Shared(kEsbc + "ESBC_4h.rnx"), EsbcBroadcast(), options);
    EXPECT_EQ(with.solutions.size(), 480u);
    const bool pair = mode == IonosphereMode::kFree;
    const test::TrackStatistics precise_error = test::Compare(with.track, EsbcAntenna());
    const test::TrackStatistics broadcast_error = test::Compare(without.track, EsbcAntenna());
    Print(pair ? "SP3 and CLK, ionosphere-free" : "SP3 and CLK, broadcast ionosphere", precise_error);
    Print(pair ? "broadcast orbits, ionosphere-free" : "broadcast orbits, broadcast ionosphere",
          broadcast_error);
    EXPECT_LE(precise_error.rms_3d(), broadcast_error.rms_3d()) << pair;
    EXPECT_LE(precise_error.rms.head<2>().norm(), broadcast_error.rms.head<2>().norm()) << pair;
  }
}

TEST(SinglePointRealTest, StreetCanyonIsSolvedThroughItsReflections) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const std::string folder = Shared("gnss/urban_static_tst2/");
  GnssFiles files;
  for (const char* name : {"c.20n", "c.20g", "c.20l", "c.20b", "d.20n", "d.20g", "d.20l", "d.20b"}) {
    files.navigation.push_back(folder + "hksc155" + name);
  }
  const Solved run = Solve(folder + "2020_06_03_TST_03.obs", files);
  EXPECT_EQ(run.epochs, 986u);
  EXPECT_GE(run.solutions.size(), 937u) << "95 %";
  const EnuFrame truth = EnuFrame::At(ToEcef({22.299915404 * M_PI / 180, 114.177707462 * M_PI / 180, 4.890}));
  std::vector<double> horizontal;
  for (const auto& [stamp, position] : run.track) {
    horizontal.push_back(truth.FromEcef(position).head<2>().norm());
  }
  std::sort(horizontal.begin(), horizontal.end());
  Print("street canyon", test::Compare(run.track, truth.origin_E));
  std::printf("measured: street canyon: %zu of %zu epochs, horizontal median %.2f m, 95 %% %.2f m\n",
              run.solutions.size(), run.epochs, horizontal[horizontal.size() / 2],
              horizontal[horizontal.size() * 95 / 100]);
  EXPECT_LE(horizontal[horizontal.size() / 2], 3.0);
}

TEST(SinglePointRealTest, EveryEpochOfAPhoneIsSolved) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const std::string folder = Shared("gnss/phone_xiaomi/");
  const GnssFiles files{
      {folder + "BRUX00BEL_R_20240920000_01D_EN.rnx", folder + "HERT00GBR_R_20240920000_01D_GN.rnx",
       folder + "CORD00ARG_R_20240920000_01D_MN.rnx"},
      {},
      {}};
  const Solved run = Solve(folder + "GEOP092I.24o", files);
  EXPECT_EQ(run.solutions.size(), 599u);
  const test::TrackStatistics scatter = test::Compare(run.track, run.track.begin()->second);
  const Eigen::Vector3d deviation = (scatter.rms.cwiseAbs2() - scatter.mean.cwiseAbs2()).cwiseSqrt();
  std::printf("measured: phone: %zu of %zu epochs, deviation E %.2f N %.2f U %.2f m\n", run.solutions.size(),
              run.epochs, deviation.x(), deviation.y(), deviation.z());
  // RTKLIB with GPS and Galileo: 1.5, 2.6, 4.3 m.
  EXPECT_LT(deviation.x(), 1.5);
  EXPECT_LT(deviation.y(), 2.6);
  EXPECT_LT(deviation.z(), 4.3);
}

TEST(SinglePointRealTest, Rinex4IsSolvedAsItsOlderFormsAre) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const std::string folder = Shared("gnss/rinex4_kms3/");
  const Solved modern = Solve(folder + "KMS3.rnx", {{folder + "KMS300DNK_R_20221591000_01H_MN.rnx"}, {}, {}});
  const Solved older =
      Solve(folder + "KMS300DNK_R_20221591000_01H_30S_MO.crx", {{folder + "KMS3_v3.nav"}, {}, {}});
  EXPECT_EQ(modern.solutions.size(), 19u);
  ASSERT_EQ(older.solutions.size(), 19u);
  for (std::size_t i = 0; i < 19; ++i) {
    EXPECT_LT((modern.solutions[i].position_E - older.solutions[i].position_E).norm(), 0.1);
  }
  const test::PositionTrack oracle =
      test::RtklibSinglePoint(45, 10, folder + "KMS3.rnx " + folder + "KMS3_v3.nav");
  if (oracle.empty()) {
    GTEST_SKIP() << "rnx2rtkp is not installed: no comparison with it";
  }
  const test::TrackStatistics difference = test::Compare(modern.track, oracle.begin()->second);
  Print("RINEX 4.00, against RTKLIB's first position from 3.04", difference);
  EXPECT_LT(difference.rms_3d(), 1);
}

TEST(SinglePointRealTest, WalkIsNearItsReference) {
  ALIDADE_SKIP_WITHOUT_SHARED_DATA();
  const std::string folder = Shared("gnss_imu/walk_0827/mav0/gnss0/");
  const Solved run = Solve(folder + "obs.rnx", {{folder + "nav.rnx"}, {}, {}});
  EXPECT_EQ(run.solutions.size(), 536u);
  // The reference has a constant offset, and its stamps are cut to milliseconds.
  const test::PositionTrack reference = test::ParsePositionFile(test::ReadFile(folder + "reference.pos"));
  const EnuFrame frame = EnuFrame::At(reference.begin()->second);
  std::vector<Eigen::Vector3d> errors;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& [stamp, position] : reference) {
    const auto near = run.track.lower_bound(stamp);
    if (near != run.track.end() && near->first < stamp + 2 * kSecondNs / 1000) {
      errors.push_back(frame.R_EN.transpose() * (near->second - position));
      mean += errors.back();
    }
  }
  ASSERT_GE(errors.size(), 530u);
  mean /= static_cast<double>(errors.size());
  double squared = 0;
  for (const Eigen::Vector3d& error : errors) {
    squared += (error - mean).head<2>().squaredNorm() / static_cast<double>(errors.size());
  }
  std::printf("measured: walk: %zu epochs, horizontal rms %.2f m after the mean E %.2f N %.2f U %.2f m\n",
              errors.size(), std::sqrt(squared), mean.x(), mean.y(), mean.z());
  EXPECT_LT(std::sqrt(squared), 1.2) << "RTKLIB: 1.75";
}

}  // namespace
}  // namespace alidade
