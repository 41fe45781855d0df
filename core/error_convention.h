#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "core/navigation_state.h"

namespace alidade {

/// How an error vector xi = (theta, p, v) perturbs an estimate (R^, p^, v^) into the truth.
///
///   right_invariant  R = Exp(theta) R^,  x = Exp(theta) x^ + xi_x   (x in {p, v}; paper eq. 3-1)
///   left_invariant   R = R^ Exp(theta),  x = x^ + R^ xi_x
///   so3xrn           R = R^ Exp(theta),  x = x^ + xi_x
///
/// Biases are additive in all three. All measurement Jacobians are taken in ONE canonical chart
/// zeta = (phi, dp, dv): R = R^ Exp(phi), p = p^ + dp, v = v^ + dv (that is so3xrn); a convention contributes
/// only its chart Jacobian C = d zeta / d xi at 0, so that H_xi = J_zeta C and P_zeta = C P_xi C^T.
enum class ErrorConvention { kRightInvariant, kLeftInvariant, kSo3xRn };
inline constexpr std::array kErrorConventions = {ErrorConvention::kRightInvariant,
                                                 ErrorConvention::kLeftInvariant, ErrorConvention::kSo3xRn};

[[nodiscard]] std::optional<ErrorConvention> ParseErrorConvention(std::string_view name);
[[nodiscard]] std::string_view ToString(ErrorConvention convention);
/// All names, joined by `separator`.
[[nodiscard]] std::string ErrorConventionNames(std::string_view separator);

/// est [+] xi, xi = (theta, p, v), 9x1.
[[nodiscard]] NavState Retract(ErrorConvention convention, const NavState& estimate, const Vector9d& xi);
/// truth [-] est: the xi with Retract(convention, estimate, xi) == truth.
[[nodiscard]] Vector9d Local(ErrorConvention convention, const NavState& estimate, const NavState& truth);
/// C = d zeta / d xi at xi = 0, 9x9 over (theta, p, v).
[[nodiscard]] Matrix9d ChartJacobian(ErrorConvention convention, const NavState& estimate);
/// C^-1, in closed form.
[[nodiscard]] Matrix9d InverseChartJacobian(ErrorConvention convention, const NavState& estimate);

/// The same for a pose alone, xi = (theta, p), 6x1.
[[nodiscard]] Pose Retract(ErrorConvention convention, const Pose& estimate, const Vector6d& xi);
[[nodiscard]] Vector6d Local(ErrorConvention convention, const Pose& estimate, const Pose& truth);
[[nodiscard]] Matrix6d ChartJacobian(ErrorConvention convention, const Pose& estimate);
[[nodiscard]] Matrix6d InverseChartJacobian(ErrorConvention convention, const Pose& estimate);

/// C padded with identity for the biases, 15x15 over (theta, p, v, bg, ba).
[[nodiscard]] Matrix15d ImuChartJacobian(ErrorConvention convention, const NavState& estimate);
[[nodiscard]] Matrix15d InverseImuChartJacobian(ErrorConvention convention, const NavState& estimate);

}  // namespace alidade
