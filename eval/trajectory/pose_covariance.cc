#include "eval/trajectory/pose_covariance.h"

namespace alidade {

const std::array<std::string_view, 21>& PoseCovarianceNames() {
  static const std::array<std::string_view, 21> kNames = {
      "c_00", "c_01", "c_02", "c_03", "c_04", "c_05", "c_11", "c_12", "c_13", "c_14", "c_15",
      "c_22", "c_23", "c_24", "c_25", "c_33", "c_34", "c_35", "c_44", "c_45", "c_55"};
  return kNames;
}

Status ReadPoseCovariance(const CsvReader& csv, size_t first, Matrix6d* covariance) {
  size_t index = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column, ++index) {
      double value = 0;
      ALIDADE_RETURN_IF_ERROR(csv.ReadReal(first + index, PoseCovarianceNames()[index], &value));
      if (column == row && value < 0) {
        return csv.Fault(first + index, "covariance", "a variance that is not negative");
      }
      (*covariance)(row, column) = value;
      (*covariance)(column, row) = value;
    }
  }
  return Status::Ok();
}

}  // namespace alidade
