#include "eval/study/fault_recovery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "eval/study/fault_study_table.h"

namespace alidade {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr TimeNs kStart = 1'000 * kSecondNs;
constexpr double kNever = FaultFigures::kNever;

TimeNs At(double seconds) {
  return kStart + SecondsToNs(seconds);
}

/// 40 s at 10 Hz with a NEES of 6 and 3 and an error of 0.1 m; `change` takes a row and its time [s].
template <typename Change>
std::vector<RunInstant> RowsWith(const Change& change) {
  std::vector<RunInstant> rows;
  for (int i = 0; i <= 400; ++i) {
    RunInstant& row = rows.emplace_back();
    row.known_ns = kStart + i * (kSecondNs / 10);
    row.reported = {row.known_ns, 6, false};
    row.nees_position = 3;
    row.error_m = 0.1;
    change(0.1 * i, &row);
  }
  return rows;
}

std::vector<RunInstant> CleanRows() {
  return RowsWith([](double, RunInstant*) {});
}

/// A fault from 10 to 12 s.
FaultFigures Score(const std::vector<RunInstant>& rows, const std::vector<RunInstant>* clean = nullptr) {
  return ScoreFault(rows, {At(10), At(12)}, clean);
}

/// In [from, to) the row is not ok, the pose beyond 3 sigma, and the position twice as wrong as before.
auto BadIn(double from_s, double to_s) {
  return [=](double t, RunInstant* row) {
    if (t > from_s - 0.05 && t < to_s - 0.05) {
      row->ok = false;
      row->reported.nees_pose = 20.2;
      row->nees_position = 14.3;
      row->error_m = 0.2;
    }
  };
}

TEST(FaultRecoveryTest, GivenNoEffectThenItHasRecoveredAtTheEndAndNeverReported) {
  const std::vector<RunInstant> clean = CleanRows();
  const FaultFigures figures = Score(clean, &clean);
  EXPECT_EQ(figures.reported_after_s, kNever);
  EXPECT_EQ(figures.ok_after_s, 0);
  EXPECT_EQ(figures.covered_after_s, 0);
  EXPECT_EQ(figures.accurate_after_s, 0);
  EXPECT_EQ(figures.silent_s, 0);
  EXPECT_TRUE(figures.beside_clean);
}

TEST(FaultRecoveryTest, GivenALateRecoveryThenTimesCountFromStartAndEndOfTheFault) {
  const std::vector<RunInstant> rows = RowsWith(BadIn(10.3, 17.5));
  const std::vector<RunInstant> clean = CleanRows();
  const FaultFigures figures = Score(rows, &clean);
  EXPECT_NEAR(figures.reported_after_s, 0.3, 1e-9);
  EXPECT_NEAR(figures.ok_after_s, 5.5, 1e-9);
  EXPECT_NEAR(figures.covered_after_s, 5.5, 1e-9);
  // RMS of a window with 0.2 m in eight of its 21 rows: 0.146 m; in nine: 0.151 m.
  EXPECT_NEAR(figures.accurate_after_s, 5.5 - 0.8, 1e-9);
  EXPECT_NEAR(Score(rows).accurate_after_s, 5.5, 1e-9) << "without a clean run: 3 sigma";
  EXPECT_FALSE(Score(rows).beside_clean);
}

TEST(FaultRecoveryTest, GivenACleanRunThatIsBetterAtFirstThenErrorsAreComparedOverTheSameTime) {
  std::vector<RunInstant> clean =
      RowsWith([](double t, RunInstant* row) { row->error_m = t < 14.95 ? 0.05 : 0.1; });
  // Ratio of the RMS with 0.1 m in five of the clean run's 21 rows: 1.53; in six: 1.47.
  EXPECT_NEAR(Score(CleanRows(), &clean).accurate_after_s, 1.5, 1e-9);
  clean.resize(120);
  EXPECT_EQ(Score(CleanRows(), &clean).accurate_after_s, kNever) << "no clean rows after the fault";
}

TEST(FaultRecoveryTest, TheLimitIsTheQuantileOfThreeSigma) {
  const auto with_nees = [](double pose, double position) {
    return Score(RowsWith([=](double, RunInstant* row) {
      row->reported.nees_pose = pose;
      row->nees_position = position;
    }));
  };
  // Chi-square quantiles of 0.9973: 20.06 with 6 degrees of freedom, 14.16 with 3.
  EXPECT_EQ(with_nees(20.0, 14.1).covered_after_s, 0);
  EXPECT_EQ(with_nees(20.0, 14.1).accurate_after_s, 0);
  EXPECT_EQ(with_nees(20.1, 14.2).covered_after_s, kNever);
  EXPECT_EQ(with_nees(20.1, 14.2).accurate_after_s, kNever);
}

TEST(FaultRecoveryTest, GivenARunThatStaysBadOrEndsThenItNeverRecovers) {
  const std::vector<RunInstant> clean = CleanRows();
  std::vector<RunInstant> rows = RowsWith(BadIn(10, 50));
  std::vector<RunInstant> ended = RowsWith(BadIn(10, 12));
  ended.resize(115);
  for (const std::vector<RunInstant>& run : {rows, ended, std::vector<RunInstant>()}) {
    const FaultFigures figures = Score(run, &clean);
    EXPECT_EQ(figures.ok_after_s, kNever);
    EXPECT_EQ(figures.covered_after_s, kNever);
    EXPECT_EQ(figures.accurate_after_s, kNever);
  }
}

TEST(FaultRecoveryTest, GivenARecoveryThatIsLostAgainThenTheStatusCountsFromTheLastOneAndErrorsFromTheFirst) {
  const std::vector<RunInstant> rows = RowsWith([](double t, RunInstant* row) {
    BadIn(10, 14)(t, row);
    BadIn(20, 23)(t, row);
  });
  const FaultFigures figures = Score(rows);
  EXPECT_NEAR(figures.ok_after_s, 11, 1e-9);
  EXPECT_NEAR(figures.covered_after_s, 2, 1e-9) << "six seconds are more than two";
}

TEST(FaultRecoveryTest, GivenAWindowThatIsInterruptedThenErrorsCountFromTheNextOne) {
  const auto lost_again_at = [](double again_s) {
    return Score(RowsWith([=](double t, RunInstant* row) {
      BadIn(10, 14)(t, row);
      BadIn(again_s, again_s + 0.1)(t, row);
    }));
  };
  EXPECT_NEAR(lost_again_at(16.0).covered_after_s, 4.1, 1e-9) << "1.9 s from the first row to the last";
  EXPECT_NEAR(lost_again_at(16.1).covered_after_s, 2.0, 1e-9) << "2.0 s";

  std::vector<RunInstant> rows = RowsWith(BadIn(10, 14));
  rows.erase(rows.begin() + 151, rows.begin() + 165);  // 15.1 to 16.4 s
  EXPECT_NEAR(Score(rows).covered_after_s, 4.5, 1e-9) << "no rows for 1.5 s";
  rows = RowsWith([](double t, RunInstant* row) {
    BadIn(10, 14)(t, row);
    row->reported.nees_pose = t > 14.95 && t < 15.05 ? kNan : row->reported.nees_pose;
  });
  EXPECT_NEAR(Score(rows).covered_after_s, 3.1, 1e-9) << "an unknown NEES is not inside";
}

TEST(FaultRecoveryTest, GivenAFaultUntilTheEndThenOnlyReportAndSilenceCount) {
  const FaultFigures figures = ScoreFault(RowsWith(BadIn(10, 50)), {At(5), std::nullopt}, nullptr);
  EXPECT_NEAR(figures.reported_after_s, 5, 1e-9);
  EXPECT_TRUE(std::isnan(figures.ok_after_s));
  EXPECT_TRUE(std::isnan(figures.covered_after_s));
  EXPECT_TRUE(std::isnan(figures.accurate_after_s));
}

TEST(FaultRecoveryTest, TheLongestSilentFailureIsThatSinceTheStartOfTheFault) {
  const std::vector<RunInstant> rows = RowsWith([](double t, RunInstant* row) {
    const bool wrong = t < 9 || (t > 12.95 && t < 19.05) || (t > 24.95 && t < 32.05);
    row->reported.nees_pose = wrong ? 1000 : 6;
  });
  EXPECT_NEAR(Score(rows).silent_s, 7, 1e-9);
  EXPECT_TRUE(std::isnan(Score({}).silent_s));
}

TEST(FaultRecoveryTest, TimesOfAFault) {
  SimulatorConfig config;
  config.fault = SimFaultKind::kBlackout;
  config.fault_start_s = 10;
  config.fault_duration_s = 5;
  EXPECT_EQ(FaultTimesOf(config, kStart, At(17)).begin_ns, At(10));
  EXPECT_EQ(FaultTimesOf(config, kStart, At(17)).end_ns, At(15));
  EXPECT_EQ(FaultTimesOf(config, kStart, At(16.9)).end_ns, std::nullopt) << "less than a window follows";
  for (const SimFaultKind fault :
       {SimFaultKind::kCameraClock, SimFaultKind::kImuClock, SimFaultKind::kImuUnit}) {
    config.fault = fault;
    EXPECT_EQ(FaultTimesOf(config, kStart, At(17)).end_ns, At(10)) << "holds from its start on";
  }
  config.fault = SimFaultKind::kStaleEphemerides;
  EXPECT_EQ(FaultTimesOf(config, kStart, At(17)).begin_ns, kStart);
  EXPECT_EQ(FaultTimesOf(config, kStart, At(17)).end_ns, std::nullopt);
}

// GIVEN a run off by 0.3 m at a deviation of 0.1 m that is lost at 3.0 s and given up at 4.5 s THEN the rows
// hold its errors, and the status of the lost row is known from 4.5 s on.
TEST(FaultRecoveryTest, RowsHoldStatusAndErrorsOfARun) {
  Trajectory truth;
  RunResult run;
  for (int i = 0; i <= 60; ++i) {
    TrajectoryPoint& point = truth.points.emplace_back();
    point.stamp_ns = At(0.1 * i);
    point.nav.p_WB.x() = 0.2 * i;
    if (i > 30 && i < 50) {
      continue;
    }
    RunRecord& record = run.records.emplace_back();
    record.estimate.stamp_ns = point.stamp_ns;
    record.estimate.nav = point.nav;
    record.estimate.nav.p_WB.y() += 0.3;
    record.estimate.covariance = 0.01 * Matrix15d::Identity();
    record.status = i < 20 ? "local" : i == 30 ? "lost" : i == 50 ? "restarted" : "ok";
  }
  run.restarts.push_back({At(4.5), "", At(5), ""});
  EvaluationOptions options;
  options.alignment = TrajectoryAlignment::kNone;
  const std::vector<RunInstant> rows = InstantsOf(run, truth, options);
  ASSERT_EQ(rows.size(), 42U);
  EXPECT_NEAR(rows[10].error_m, 0.3, 1e-9);
  EXPECT_NEAR(rows[10].reported.nees_pose, 9, 1e-6);
  EXPECT_NEAR(rows[10].nees_position, 9, 1e-6);
  EXPECT_TRUE(rows[10].ok);
  EXPECT_TRUE(rows[30].reported.alarmed);
  EXPECT_EQ(rows[30].reported.stamp_ns, At(3));
  EXPECT_EQ(rows[30].known_ns, At(4.5));
  EXPECT_FALSE(rows[31].ok) << "restarted";
  EXPECT_NEAR(ScoreFault(rows, {At(3.5), At(4)}, nullptr).reported_after_s, 1, 1e-9);
  EXPECT_NEAR(ScoreFault(rows, {At(3.5), At(4)}, nullptr).ok_after_s, 1.1, 1e-9);
  EXPECT_TRUE(std::isnan(InstantsOf(run, Trajectory(), options)[10].error_m)) << "no truth";
  EXPECT_TRUE(InstantsOf(RunResult(), truth, options).empty());
}

FaultFigures Recovered(double after_s) {
  FaultFigures figures{after_s, after_s, after_s, after_s, true, 0};
  return figures;
}

TEST(FaultStudyTableTest, HoldsMeanAndWorstAndHowManyRunsRecovered) {
  FaultStudyRow row{"blackout", "filter", {Recovered(0.5), Recovered(1.5)}};
  row.runs[1].ok_after_s = kNever;
  row.runs[0].covered_after_s = row.runs[1].covered_after_s = kNever;
  row.runs[0].silent_s = 7.5;
  std::string table = FaultStudyTable({row, {"none_there", "filter", {}}});
  EXPECT_THAT(table, HasSubstr("in brackets: runs in which it happened."));
  EXPECT_THAT(table,
              HasSubstr("| blackout | `filter` | 2 | 1.00, 1.50 | 0.50, 0.50 (1 of 2) | never | 1.00, 1.50 | "
                        "3.75, 7.50 |\n"));
  EXPECT_THAT(table, Not(HasSubstr("none_there")));
  EXPECT_THAT(table, Not(HasSubstr("\\*")));

  row.runs[0].ok_after_s = row.runs[1].ok_after_s = kNan;
  row.runs[0].beside_clean = false;
  table = FaultStudyTable({row});
  EXPECT_THAT(table, HasSubstr("| 1.00, 1.50 | – | never | 1.00, 1.50 \\* |"));
  EXPECT_THAT(table, HasSubstr("\n\\* position within 3 sigma"));
}

}  // namespace
}  // namespace alidade
