#include "eval/comparison/paired.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "eval/report/pair_tables.h"

namespace alidade {
namespace {

using ::testing::HasSubstr;

CellResult Cell(const std::string& estimator, unsigned seed, double rmse_pos_m, double nees_pose = 6) {
  CellResult cell;
  cell.estimator = estimator;
  cell.backend = "filter";
  cell.sequence = "walk";
  cell.seed = seed;
  cell.status = "ok";
  cell.frames = 10;
  cell.rmse_pos_m = rmse_pos_m;
  cell.rmse_ori_deg = 0;
  cell.nees_pose = nees_pose;
  cell.input_digest = "d" + std::to_string(seed);
  return cell;
}

PairedDifference PairOf(const Comparison& comparison, const std::string& key, const std::string& sequence) {
  const std::vector<Figure> figures = ListFigures(comparison);
  for (const PairedDifference& pair : ComparePairs(comparison, figures)) {
    if (figures[pair.figure].key == key && pair.sequence == sequence) {
      return pair;
    }
  }
  ADD_FAILURE() << "no pair of " << key;
  return {};
}

TEST(PairedT, GivenAPublishedExampleThenTheIntervalIsTheOneOfTheBook) {
  // Student's own sleep data (Biometrika 1908): extra hours on two drugs, ten patients. t = -4.0621,
  // p = 0.002833, interval -2.4598855 to -0.7001145 (R: t.test(..., paired = TRUE)).
  const std::vector<double> first = {0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0};
  const std::vector<double> second = {1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4};
  std::vector<double> differences;
  for (size_t i = 0; i < first.size(); ++i) {
    differences.push_back(first[i] - second[i]);
  }
  const PairedT test = TestPairs(differences);
  EXPECT_EQ(test.count, 10);
  EXPECT_NEAR(test.mean, -1.58, 1e-12);
  EXPECT_NEAR(test.mean / test.standard_error, -4.0621, 1e-4);
  EXPECT_NEAR(test.low, -2.4598858, 1e-6);
  EXPECT_NEAR(test.high, -0.7001142, 1e-6);
  EXPECT_NEAR(test.p_value, 0.002833, 1e-6);
}

TEST(PairedT, GivenDifferencesWithoutMeanThenOneStudyInTwentyLooksSignificant) {
  std::mt19937 random(4);
  std::exponential_distribution<double> skewed(1.0);
  int significant = 0;
  constexpr int kStudies = 4000;
  for (int study = 0; study < kStudies; ++study) {
    std::vector<double> differences;
    differences.reserve(30);
    for (int i = 0; i < 30; ++i) {
      differences.push_back(skewed(random) - skewed(random));
    }
    const PairedT test = TestPairs(differences);
    significant += test.low > 0 || test.high < 0 ? 1 : 0;
    ASSERT_EQ(test.p_value<0.05, test.low> 0 || test.high < 0);
  }
  EXPECT_NEAR(significant / static_cast<double>(kStudies), 0.05, 0.012);
}

TEST(PairedT, GivenFewOrEqualDifferencesThenThereIsNoFalseCertainty) {
  EXPECT_TRUE(std::isnan(TestPairs({}).p_value));
  EXPECT_TRUE(std::isnan(TestPairs({1.0}).low));
  EXPECT_EQ(TestPairs({0, 0, 0}).p_value, 1);
  EXPECT_EQ(TestPairs({2, 2, 2}).low, 2);
}

// By hand: 4 x 0.005 = 0.02, 3 x 0.01 = 0.03, 2 x 0.03 = 0.06, and 1 x 0.04 raised to the one before.
TEST(HolmCorrect, GivenFourPValuesThenTheyAreThoseComputedByHand) {
  const std::vector<double> corrected = HolmCorrect({0.01, 0.04, 0.03, 0.005});
  ASSERT_EQ(corrected.size(), 4U);
  EXPECT_NEAR(corrected[0], 0.03, 1e-12);
  EXPECT_NEAR(corrected[1], 0.06, 1e-12);
  EXPECT_NEAR(corrected[2], 0.06, 1e-12);
  EXPECT_NEAR(corrected[3], 0.02, 1e-12);
  EXPECT_TRUE(HolmCorrect({}).empty());
}

TEST(HolmCorrect, GivenAMissingOneThenItIsNotCounted) {
  const std::vector<double> corrected = HolmCorrect({std::nan(""), 0.02, 0.7});
  EXPECT_TRUE(std::isnan(corrected[0]));
  EXPECT_NEAR(corrected[1], 0.04, 1e-12);
  EXPECT_NEAR(corrected[2], 0.7, 1e-12);
  EXPECT_EQ(HolmCorrect({0.6, 0.9})[0], 1);
}

// GIVEN studies of ten equal estimators WHEN every pair is tested THEN most find a false difference, and
// after the correction about one in twenty does.
TEST(HolmCorrect, KeepsTheChanceOfAnyFalseDifference) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  int plain = 0, holm = 0;
  constexpr int kStudies = 1000;
  for (int study = 0; study < kStudies; ++study) {
    std::vector<double> p_values;
    for (int test = 0; test < 45; ++test) {
      std::vector<double> differences;
      differences.reserve(8);
      for (int i = 0; i < 8; ++i) {
        differences.push_back(normal(random));
      }
      p_values.push_back(TestPairs(differences).p_value);
    }
    const std::vector<double> corrected = HolmCorrect(p_values);
    plain += *std::min_element(p_values.begin(), p_values.end()) < 0.05 ? 1 : 0;
    holm += *std::min_element(corrected.begin(), corrected.end()) < 0.05 ? 1 : 0;
  }
  EXPECT_GT(plain, 0.8 * kStudies);
  EXPECT_NEAR(holm / static_cast<double>(kStudies), 0.05, 0.025);
}

// GIVEN three estimators on two sequences WHEN corrected THEN the pairs of one sequence and figure count, and
// no others.
TEST(ComparePairs, CorrectsOverThePairsOfOneSequenceAndFigure) {
  Comparison comparison;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    for (const char* name : {"a", "b", "c"}) {
      for (const char* sequence : {"walk", "run"}) {
        CellResult cell = Cell(name, seed, 1 + 0.1 * (name[0] - 'a') * seed);
        cell.sequence = sequence;
        comparison.cells.push_back(cell);
      }
    }
  }
  // Differences of a, b: 0.1 seed; t = 0.25 / 0.06455 = 3.8730 with 3 degrees of freedom, p = 0.0305. All
  // three pairs have the same t, so each p becomes three times its value.
  const PairedDifference pair = PairOf(comparison, "rmse_pos_m", "walk");
  EXPECT_NEAR(pair.difference.p_value, 0.030466, 1e-5);
  EXPECT_NEAR(pair.holm_p_value, 3 * pair.difference.p_value, 1e-12);
}

TEST(SignTest, GivenSplitsThenTheChancesAreThoseOfACoin) {
  EXPECT_NEAR(SignTest(0, 5), 2.0 / 32, 1e-12);
  EXPECT_NEAR(SignTest(9, 1), 2 * 11.0 / 1024, 1e-12);
  EXPECT_EQ(SignTest(3, 3), 1);
  EXPECT_EQ(SignTest(0, 0), 1);
}

// GIVEN two estimators whose errors differ far less than the runs do WHEN compared run by run THEN the small
// but steady difference is found, although the means' standard errors overlap.
TEST(ComparePairs, FindsASteadyDifferenceAmongUnlikeRuns) {
  Comparison comparison;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    comparison.cells.push_back(Cell("a", seed, 1.0 * seed));
    comparison.cells.push_back(Cell("b", seed, 1.0 * seed + 0.1 + 0.01 * (seed % 2)));
  }
  const PairedDifference pair = PairOf(comparison, "rmse_pos_m", "walk");
  EXPECT_EQ(pair.first, "a");
  EXPECT_EQ(pair.difference.count, 6);
  EXPECT_NEAR(pair.difference.mean, -0.105, 1e-12);
  EXPECT_EQ(pair.verdict, PairVerdict::kBetter);
  EXPECT_EQ(pair.first_lower, 6);
  EXPECT_NEAR(pair.first_mean, 3.5, 1e-12);
}

TEST(ComparePairs, GivenALostRunThenItIsLeftOutOfThePairsAndReported) {
  Comparison comparison;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    comparison.cells.push_back(Cell("a", seed, 1));
    comparison.cells.push_back(Cell("b", seed, 2 + 0.1 * seed));
  }
  comparison.cells[1].status = "diverged";  // b, seed 1
  comparison.cells[6].status = "failed";    // a, seed 4
  comparison.cells[7].status = "failed";    // b, seed 4
  const PairedDifference pair = PairOf(comparison, "rmse_pos_m", "walk");
  EXPECT_EQ(pair.difference.count, 2);
  EXPECT_EQ(pair.only_first, 1);
  EXPECT_EQ(pair.only_second, 0);
  EXPECT_EQ(pair.neither, 1);
  const std::vector<TextTable> tables = LayOutPairTables(comparison, ListFigures(comparison), "+-");
  ASSERT_FALSE(tables.empty());
  EXPECT_THAT(tables.back().rows[0].cells[2].text, HasSubstr("(2 lost)"));
}

TEST(ComparePairs, GivenRunsOfDifferentInputThenTheyAreNoPair) {
  Comparison comparison;
  comparison.cells = {Cell("a", 1, 1), Cell("a", 2, 1), Cell("b", 1, 2), Cell("b", 2, 2)};
  comparison.cells[3].input_digest = "other";
  EXPECT_EQ(PairOf(comparison, "rmse_pos_m", "walk").difference.count, 1);
}

// GIVEN runs of which some were killed, before anything said what their input was, WHEN completion is
// compared THEN all are pairs, and of a figure of finished runs only those that finished.
TEST(ComparePairs, GivenKilledRunsThenTheirCompletionIsPaired) {
  Comparison comparison;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    for (const char* name : {"a", "b"}) {
      comparison.cells.push_back(Cell(name, seed, name[0] == 'a' ? 1 : 2));
      comparison.cells.back().completion = 1;
    }
  }
  for (CellResult* killed : {&comparison.cells[1], &comparison.cells[3]}) {  // b, seeds 1 and 2
    killed->status = "failed";
    killed->input_digest.clear();
    killed->completion.reset();
  }
  comparison.cells[5].input_digest = "other";  // b, seed 3
  const PairedDifference completed = PairOf(comparison, "completion", "walk");
  EXPECT_EQ(completed.difference.count, 3);
  EXPECT_EQ(completed.only_first, 1);
  EXPECT_EQ(completed.only_second, 1);
  EXPECT_NEAR(completed.difference.mean, 2.0 / 3, 1e-12);
  const PairedDifference error = PairOf(comparison, "rmse_pos_m", "walk");
  EXPECT_EQ(error.difference.count, 1);
  EXPECT_EQ(error.only_first, 3);
}

TEST(ComparePairs, GivenANeesThenHigherIsNotCalledWorse) {
  Comparison comparison;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    comparison.cells.push_back(Cell("a", seed, 1, 9 + 0.1 * seed));
    comparison.cells.push_back(Cell("b", seed, 1, 5));
  }
  EXPECT_EQ(PairOf(comparison, "nees_pose", "walk").verdict, PairVerdict::kHigher);
  EXPECT_EQ(PairOf(comparison, "rmse_pos_m", "walk").verdict, PairVerdict::kNoDifference);
}

// GIVEN three sequences WHEN pooled THEN each counts once, whatever its number of seeds.
TEST(ComparePairs, PoolsSequencesWithOneSampleEach) {
  Comparison comparison;
  comparison.pair_across = true;
  const double shift[] = {0.1, 0.2, 0.6};
  for (int s = 0; s < 3; ++s) {
    for (unsigned seed = 1; seed <= (s == 0 ? 5U : 1U); ++seed) {
      for (const char* name : {"a", "b"}) {
        CellResult cell = Cell(name, seed, 1 + (name[0] == 'b' ? shift[s] : 0));
        cell.sequence = "s" + std::to_string(s);
        comparison.cells.push_back(cell);
      }
    }
  }
  const PairedDifference pool = PairOf(comparison, "rmse_pos_m", kAllSequences);
  EXPECT_EQ(pool.difference.count, 3);
  EXPECT_NEAR(pool.difference.mean, -0.3, 1e-12);
  // Student's t with 2 degrees of freedom: 4.30265 standard errors of sqrt(0.07 / 3).
  EXPECT_NEAR(pool.difference.high, -0.3 + 4.30265 * std::sqrt(0.07 / 3), 1e-5);
  EXPECT_EQ(pool.verdict, PairVerdict::kNoDifference);
  const std::vector<TextTable> tables = LayOutPairTables(comparison, ListFigures(comparison), "+-");
  ASSERT_EQ(tables.size(), 2U);
  EXPECT_THAT(tables[1].title, HasSubstr(kAllSequences));
}

TEST(PairTables, GivenAMatrixThenBothSidesOfThePairAgree) {
  Comparison comparison;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    comparison.cells.push_back(Cell("a", seed, 1 + 0.5 * (seed % 2)));
    comparison.cells.push_back(Cell("b", seed, 2));
  }
  comparison.pair_figures = {"rmse_pos_m"};
  const std::vector<TextTable> tables = LayOutPairTables(comparison, ListFigures(comparison), "+-");
  ASSERT_EQ(tables.size(), 1U);
  EXPECT_EQ(tables[0].rows[0].cells[2].text, "\u22120.750+-0.459 better (p 0.014, Holm 0.014)");
  EXPECT_TRUE(tables[0].rows[0].cells[2].best);
  EXPECT_EQ(tables[0].rows[1].cells[1].text, "0.750+-0.459 worse (p 0.014, Holm 0.014)");
  EXPECT_THAT(PairsCsv(comparison, ListFigures(comparison)),
              HasSubstr("walk,rmse_pos_m,a,b,4,0,0,0,1.25,2,0.625,-0.75,"));
}

}  // namespace
}  // namespace alidade
