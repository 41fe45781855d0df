#pragma once

#include <Eigen/Core>

namespace alidade {

/// Makes square upper triangular in [square | extra] by Householder reflections from the right, bottom row
/// first; both have the same rows. square: n x n, zero below its diagonal. extra ends as zero (and is not
/// written back to zero: what it then holds has no meaning). scratch: n at least.
void FoldColumns(Eigen::Ref<Eigen::MatrixXd> square, Eigen::Ref<Eigen::MatrixXd> extra,
                 Eigen::VectorXd* scratch);

/// Makes the last `size` rows of b upper triangular in its last `size` columns by Householder reflections
/// from the right; the rows above take part. What the rows above then hold in the other columns is surplus.
/// scratch: as many entries as b has rows at least.
void TriangularizeBottom(Eigen::Ref<Eigen::MatrixXd> b, Eigen::Index size, Eigen::VectorXd* scratch);

}  // namespace alidade
