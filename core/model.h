#pragma once

// What a measurement model is in this library.
//
// A model is a plain struct with one function Evaluate(states..., residual, jacobians...). It returns the
// UNWHITENED residual
//
//     r = predicted - measured                     (SI units; vision: the ideal normalised image plane)
//
// and its Jacobians with respect to the canonical chart zeta = (phi, dp, dv, dbg, dba) of each state:
//
//     R = R^ Exp(phi),  p = p^ + dp,  v = v^ + dv,  biases additive.
//
// A null Jacobian pointer skips that block and changes no other output. A model depends on neither Ceres nor
// a filter: the filter multiplies with the error convention's chart Jacobian (core/error_convention.h), the
// smoother lifts to its manifold, and noise, gates and kernels are applied by shared code (core/robust.h,
// core/landmark_reduction.h).
