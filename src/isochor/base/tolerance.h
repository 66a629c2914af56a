// The one home of small numbers: each with its unit, the inequality it enters and why.
//
// Two kinds that never mix: rounding bounds (proven, dimensionless multiples of epsilon) and user
// tolerances (lengths relative to the model's diagonal, angles). Knots compare exactly, always.
#pragma once

#include <limits>

namespace isochor {

// Unit roundoff of double: |fl(a op b) - (a op b)| <= kUnitRoundoff |a op b|.
inline constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2;

// Knots that were computed (shifted by a period, mapped to a neighbour's domain) are the same knot
// when |s - t| <= kSameKnot * scale, scale the largest knot or the domain's length. Dimensionless:
// such a map rounds three times; real spans are far longer.
inline constexpr double kSameKnot = 1e-13;

// Two sides carry the same basis when knots (mapped to [0, 1]) and weights (as ratios) differ by at
// most this. Dimensionless. Poles tied one to one then open a gap of at most d * 1e-10 times the
// displacement, far below kCoincident; writers that print ten digits still pass.
inline constexpr double kSameSide = 1e-10;

// A point of a surface has no usable normal when |S_u x S_v| <= kSingular |S_u| |S_v|, or when a
// whole domain travelled at the speed |S_u| (or |S_v|) covers less than kSingular * diagonal.
// Dimensionless: half the digits of a double are left for the normal's direction.
inline constexpr double kSingular = 1e-8;

// Two lengths count as equal when they differ by less than this share; only used to choose (which
// span to divide), never to judge. Dimensionless.
inline constexpr double kSameLength = 1e-9;

// Two boundary poles are "the same point" when |p - q| <= kCoincident * diagonal. Dimensionless.
// CAD writers round to 1e-7 of a millimetre on metre-sized models; 1e-6 of the diagonal separates
// that noise from real gaps in the 902 files that were measured.
inline constexpr double kCoincident = 1e-6;

// A join or knot line is called smooth when the angle between the normals of its sides stays below
// kSmoothAngle everywhere; radians. Joins between the two angles are "almost smooth": they are
// neither sharpened nor forced, so they are protected like smooth ones.
inline constexpr double kSmoothAngle = 1e-4;
inline constexpr double kAlmostSmoothAngle = 0.087;  // 5 degrees

// Two sides have the same normal curvature when |ka - kb| * diagonal <= kSameCurvature.
// Dimensionless.
inline constexpr double kSameCurvature = 1e-3;

// Two quadrature rules for the moments of a patch with weights agree when the sum of |differences|
// over its elements stays below kQuadratureNoise times the integral of the absolute integrand.
// Dimensionless: the rounding of either sum, which no finer rule can go below.
inline constexpr double kQuadratureNoise = 32 * kUnitRoundoff;

// A cell of a patch with weights has enough Gauss points when its remainder is at most
// kQuadratureShare * r_x r_y r_z, the product of its poles' largest coordinates. Dimensionless: a
// few hundred times less than the bound of the rounding there.
inline constexpr double kQuadratureShare = 2 * kUnitRoundoff;

// Two directions of length one are the same, or perpendicular, when they miss it by less than this.
// Dimensionless: a few hundred roundings, for normals that were computed.
inline constexpr double kSameDirection = 1e-13;

// A displacement constraint is met when |got - asked| <= kReached * diagonal. Dimensionless;
// the solve attains about 1e-15, so this is a promise with three digits to spare.
inline constexpr double kReached = 1e-12;

// The volume is kept when |V - target| <= kVolumeKept * max(|V before|, |target|). Dimensionless.
inline constexpr double kVolumeKept = 1e-13;

// Rows of a constraint matrix scaled to unit length are taken as dependent when the squared pivot
// of their Gram matrix falls below this. Dimensionless: (64 eps)^2 would be noise, 1e-20 keeps
// pivots that still carry six digits.
inline constexpr double kDependentPivot = 1e-20;

// A trimming curve runs along a side of its surface when it stays nearer than
// kSideDistance * diagonal to the side, or within the tolerance of its edge. Dimensionless.
inline constexpr double kSideDistance = 1e-9;

// ... but never when it leaves the side by more than this part of the domain, however large its
// tolerance is, and always when by less than that (rounding of parameters in files). Dimensionless.
inline constexpr double kSideSlack = 1e-3;
inline constexpr double kSideNoise = 1e-10;

// A patch has no usable normal of its own where |S_u x S_v| * (parameter area) <= kSingularNormal *
// (its own diagonal)^2. Dimensionless; only for pictures: slender patches stay far above.
inline constexpr double kSingularNormal = 1e-10;

// A converted surface is the same as the original when their points at equal parameters are within
// kSameSurface * diagonal. Dimensionless; a few roundings of coordinates.
inline constexpr double kSameSurface = 1e-12;

// Two rows of a displacement map are the same when their coefficients, between 0 and 1, agree to
// this: a few d roundings of knot insertion in two directions, for degrees to 25. Dimensionless.
inline constexpr double kSameRow = 1e-12;

// An equation of smoothness follows from the ties of an edge in different bases when elimination
// leaves at most this part of it. Dimensionless: the noise of measured factors, far below what an
// independent equation leaves.
inline constexpr double kImpliedRow = 1e-9;

// Two strips of surface meet by constant factors when |H_n+ - lambda H_n- - rho H| (and the
// relation of second derivatives) stays below kSmoothResidual times the terms it is made of.
// Dimensionless: an edit that turns the surface by an angle a changes the angle between the strips
// by at most about a * kSmoothResidual, a hundredth of kSmoothAngle; seams of lofts written by CAD
// reach 3e-7.
inline constexpr double kSmoothResidual = 1e-6;

// A factor measured on poles that are doubles is taken as the simplest rational within this part of
// itself, or farther off where that does not make the residual worse. Dimensionless: some hundred
// roundings.
inline constexpr double kFactorNoise = 2e-14;

// Weights near a line are products w_ij = a_i b_j when they differ from them by at most this part.
// Dimensionless: products of written weights are rounded once or twice.
inline constexpr double kSeparateWeights = 1e-13;

// The direction of a volume correction is stationary when it turns by less than this; radians.
// Below it the displacement changes by less than kReached of itself, so nothing visible is gained.
inline constexpr double kStationary = 1e-13;

// A volume gradient vanishes on the coefficients that may change when projecting it leaves less
// than this part of it: what is left is rounding of the projection, not a direction. Dimensionless.
inline constexpr double kVanishing = 1e-10;

}  // namespace isochor
