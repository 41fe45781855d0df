#include "eval/report/text_table.h"

#include <cmath>
#include <cstdio>

namespace alidade {
namespace {

std::string Print(const char* format, int precision, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), format, precision, value);
  return buffer;
}

}  // namespace

std::string FormatValue(double value, int decimals) {
  if (std::isnan(value)) {
    return kDash;
  }
  const double magnitude = std::abs(value);
  if (magnitude >= 1e6 || (magnitude > 0 && magnitude < std::pow(10.0, 1 - decimals))) {
    return Print("%.*g", 2, value);
  }
  return Print("%.*f", decimals, value);
}

std::string FormatStatistic(const Statistic& statistic, int decimals, const std::string& plus_minus) {
  std::string mean = FormatValue(statistic.mean, decimals);
  if (std::isnan(statistic.standard_error)) {
    return mean;
  }
  // The error shows the digits that the mean shows, unless the mean itself needs more.
  const double magnitude = std::abs(statistic.mean);
  const bool fixed = magnitude < 1e6 && magnitude >= std::pow(10.0, 1 - decimals);
  return mean + plus_minus +
         (fixed ? Print("%.*f", decimals, statistic.standard_error)
                : FormatValue(statistic.standard_error, decimals));
}

}  // namespace alidade
