#pragma once

#include "softfinger/fem/corotated_law.hpp"

namespace softfinger {

/// The law that all tissue follows: an energy density Psi of the principal stretches s_i and of two
/// constants, mu and lambda (see ElasticMaterial). Another law is a file like corotated_law.hpp,
/// named here. Strain limits are added to it, see StrainLimit.
///
/// A law is Law<Arithmetic>(mu, lambda, s, dilatation, pressure). Psi is a sum of what each stretch
/// stores alone and of lambda/2 d^2, where d measures the change of volume and grows with it like
/// s_0 + s_1 + s_2 near 1. The law says what d is; patches may put their mean in its place and
/// then press on it, with lambda 0.
///
///   dilatation(s)            d
///   energy()                 Psi, J/m^3
///   energy_of_dilatation()   its parts
///   energy_along(i)
///   stress(i)                dPsi/ds_i, Pa, without the pressure
///   dilatation_slope(i)      dd/ds_i
///   stiffness(i, j)          d2(Psi + pressure d)/ds_i ds_j, Pa
///   flip(i, j)               the difference of the stresses i and j, pressure included, over that
///                            of their stretches, Pa; finite where these are equal
///
/// Arithmetic is what numbers they are: a double (DoubleArithmetic), or a vector of them. It names
/// the type Number and has
///
///   all(x)                   the number x
///   min, max, select         lane by lane; select(condition, a, b)
///   quotient(a, w)           a / w
///   sum_of_strains(s)        (s_0 - 1) + (s_1 - 1) + (s_2 - 1)
///
/// The last two are its own because each rounds them in its way, and recordings repeat to the bit.
template <typename Arithmetic>
using ConstitutiveLaw = CorotatedLaw<Arithmetic>;

}  // namespace softfinger
