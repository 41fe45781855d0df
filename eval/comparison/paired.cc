#include "eval/comparison/paired.h"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "core/numbers.h"

namespace alidade {
namespace {

constexpr double kTail = 0.025;  // of a two-sided 95 % interval

/// The runs of one aggregate row by seed.
using Runs = std::map<unsigned, const CellResult*>;

/// One sequence: its rows in order, and every seed that any of them has.
struct Block {
  std::string sequence;
  std::vector<std::string> labels;
  std::map<std::string, Runs> runs;
  std::set<unsigned> seeds;
};

std::vector<Block> SplitBySequence(const Comparison& comparison) {
  std::vector<Block> blocks;
  for (const CellGroup& group : GroupCells(comparison)) {
    if (blocks.empty() || blocks.back().sequence != group.sequence) {
      blocks.push_back({group.sequence, {}, {}, {}});
    }
    Block& block = blocks.back();
    block.labels.push_back(group.label);
    for (const CellResult* cell : group.cells) {
      block.runs[group.label][cell->seed] = cell;
      block.seeds.insert(cell->seed);
    }
  }
  return blocks;
}

double ValueOf(const Figure& figure, const Runs& runs, unsigned seed) {
  const auto run = runs.find(seed);
  const bool counts = run != runs.end() && (run->second->status == "ok" || figure.of_all_runs);
  return counts ? figure.value(*run->second) : kNan;
}

/// A run that was killed or did not start leaves no digest; figures of all runs count it, on the input that
/// its seed stands for.
bool SameInput(const Figure& figure, const Runs& first, const Runs& second, unsigned seed) {
  const std::string& a = first.at(seed)->input_digest;
  const std::string& b = second.at(seed)->input_digest;
  return a == b || (figure.of_all_runs && (a.empty() || b.empty()));
}

PairVerdict VerdictOf(const PairedT& test, Ideal ideal) {
  if (test.count < 2) {
    return PairVerdict::kTooFew;
  }
  if (test.low <= 0 && test.high >= 0) {
    return PairVerdict::kNoDifference;
  }
  if (ideal == Ideal::kLow) {
    return test.mean < 0 ? PairVerdict::kBetter : PairVerdict::kWorse;
  }
  return test.mean < 0 ? PairVerdict::kLower : PairVerdict::kHigher;
}

PairedDifference Compare(const Block& block, const Figure& figure, const Runs& first, const Runs& second) {
  PairedDifference pair;
  std::vector<double> differences;
  for (const unsigned seed : block.seeds) {
    const double a = ValueOf(figure, first, seed);
    const double b = ValueOf(figure, second, seed);
    const bool paired = !std::isnan(a) && !std::isnan(b) && SameInput(figure, first, second, seed);
    pair.only_first += !paired && !std::isnan(a) ? 1 : 0;
    pair.only_second += !paired && !std::isnan(b) ? 1 : 0;
    pair.neither += std::isnan(a) && std::isnan(b) ? 1 : 0;
    if (paired) {
      differences.push_back(a - b);
      pair.first_mean += a;
      pair.second_mean += b;
      pair.first_lower += a < b ? 1 : 0;
      pair.second_lower += b < a ? 1 : 0;
    }
  }
  const double count = static_cast<double>(differences.size());
  pair.first_mean = count > 0 ? pair.first_mean / count : kNan;
  pair.second_mean = count > 0 ? pair.second_mean / count : kNan;
  pair.difference = TestPairs(differences);
  pair.sign_p_value = SignTest(pair.first_lower, pair.second_lower);
  pair.verdict = VerdictOf(pair.difference, figure.ideal);
  return pair;
}

void AppendPairs(const Block& block, const std::vector<Figure>& figures,
                 std::vector<PairedDifference>* pairs) {
  for (size_t i = 0; i < figures.size(); ++i) {
    for (size_t a = 0; a < block.labels.size() && IsPaired(figures[i]); ++a) {
      for (size_t b = a + 1; b < block.labels.size(); ++b) {
        PairedDifference pair =
            Compare(block, figures[i], block.runs.at(block.labels[a]), block.runs.at(block.labels[b]));
        if (pair.difference.count + pair.only_first + pair.only_second > 0) {
          pair.sequence = block.sequence;
          pair.first = block.labels[a];
          pair.second = block.labels[b];
          pair.figure = i;
          pairs->push_back(pair);
        }
      }
    }
  }
}

/// One sample a sequence: the mean difference of its pairs.
PairedDifference Pool(const std::vector<const PairedDifference*>& parts, Ideal ideal) {
  PairedDifference pool = *parts.front();
  pool.sequence = kAllSequences;
  pool.first_mean = pool.second_mean = 0;
  pool.first_lower = pool.second_lower = pool.only_first = pool.only_second = pool.neither = 0;
  std::vector<double> differences;
  for (const PairedDifference* part : parts) {
    pool.only_first += part->only_first;
    pool.only_second += part->only_second;
    pool.neither += part->neither;
    if (part->difference.count > 0) {
      differences.push_back(part->difference.mean);
      pool.first_mean += part->first_mean;
      pool.second_mean += part->second_mean;
      pool.first_lower += part->difference.mean < 0 ? 1 : 0;
      pool.second_lower += part->difference.mean > 0 ? 1 : 0;
    }
  }
  const double count = static_cast<double>(differences.size());
  pool.first_mean = count > 0 ? pool.first_mean / count : kNan;
  pool.second_mean = count > 0 ? pool.second_mean / count : kNan;
  pool.difference = TestPairs(differences);
  pool.sign_p_value = SignTest(pool.first_lower, pool.second_lower);
  pool.verdict = VerdictOf(pool.difference, ideal);
  return pool;
}

/// Sets holm_p_value; a family is the pairs of one sequence and figure.
void CorrectForNumber(std::vector<PairedDifference>* pairs) {
  std::map<std::pair<std::string, size_t>, std::vector<PairedDifference*>> families;
  for (PairedDifference& pair : *pairs) {
    families[{pair.sequence, pair.figure}].push_back(&pair);
  }
  for (const auto& [place, family] : families) {
    std::vector<double> p_values;
    for (const PairedDifference* pair : family) {
      p_values.push_back(pair->difference.p_value);
    }
    const std::vector<double> corrected = HolmCorrect(p_values);
    for (size_t i = 0; i < family.size(); ++i) {
      family[i]->holm_p_value = corrected[i];
    }
  }
}

}  // namespace

std::string ToString(PairVerdict verdict) {
  switch (verdict) {
    case PairVerdict::kTooFew:
      return "too few pairs";
    case PairVerdict::kNoDifference:
      return "no significant difference";
    case PairVerdict::kBetter:
      return "significantly better";
    case PairVerdict::kWorse:
      return "significantly worse";
    case PairVerdict::kLower:
      return "significantly lower";
    case PairVerdict::kHigher:
      return "significantly higher";
  }
  return "";
}

PairedT TestPairs(const std::vector<double>& differences) {
  const Statistic statistic = ComputeStatistic(differences);
  PairedT test{statistic.count, statistic.mean, statistic.standard_error, kNan, kNan, kNan};
  if (statistic.count < 2) {
    return test;
  }
  const boost::math::students_t student(statistic.count - 1);
  const double half = boost::math::quantile(boost::math::complement(student, kTail)) * test.standard_error;
  test.low = test.mean - half;
  test.high = test.mean + half;
  if (test.standard_error > 0) {
    const double t = std::abs(test.mean / test.standard_error);
    test.p_value = 2 * boost::math::cdf(boost::math::complement(student, t));
  } else {
    test.p_value = test.mean == 0 ? 1 : 0;
  }
  return test;
}

std::vector<double> HolmCorrect(const std::vector<double>& p_values) {
  std::vector<size_t> order;
  for (size_t i = 0; i < p_values.size(); ++i) {
    if (!std::isnan(p_values[i])) {
      order.push_back(i);
    }
  }
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return p_values[a] < p_values[b]; });
  std::vector<double> corrected(p_values.size(), kNan);
  double largest = 0;
  for (size_t i = 0; i < order.size(); ++i) {
    largest = std::max(largest, static_cast<double>(order.size() - i) * p_values[order[i]]);
    corrected[order[i]] = std::min(1.0, largest);
  }
  return corrected;
}

double SignTest(int lower, int higher) {
  const int count = lower + higher;
  if (count == 0) {
    return 1;
  }
  const boost::math::binomial coin(count, 0.5);
  return std::min(1.0, 2 * boost::math::cdf(coin, std::min(lower, higher)));
}

bool IsPaired(const Figure& figure) {
  return figure.unit != "ms" && figure.unit != "s/s";
}

std::vector<PairedDifference> ComparePairs(const Comparison& comparison, const std::vector<Figure>& figures) {
  std::vector<PairedDifference> pairs;
  for (const Block& block : SplitBySequence(comparison)) {
    AppendPairs(block, figures, &pairs);
  }
  if (comparison.pair_across) {
    const std::vector<PairedDifference> across = PoolSequences(pairs, figures);
    pairs.insert(pairs.end(), across.begin(), across.end());
  }
  CorrectForNumber(&pairs);
  return pairs;
}

std::vector<PairedDifference> PoolSequences(const std::vector<PairedDifference>& pairs,
                                            const std::vector<Figure>& figures) {
  using Key = std::tuple<size_t, std::string, std::string>;
  std::vector<Key> order;
  std::map<Key, std::vector<const PairedDifference*>> parts;
  for (const PairedDifference& pair : pairs) {
    const Key key(pair.figure, pair.first, pair.second);
    if (parts.count(key) == 0) {
      order.push_back(key);
    }
    parts[key].push_back(&pair);
  }
  std::vector<PairedDifference> pools;
  pools.reserve(order.size());
  for (const Key& key : order) {
    pools.push_back(Pool(parts.at(key), figures[std::get<0>(key)].ideal));
  }
  CorrectForNumber(&pools);
  return pools;
}

}  // namespace alidade
