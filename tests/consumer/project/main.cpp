// Uses an installed Isochor: headers, compiled layers, a foreign library behind one, an error.
#include <cstdio>

#include "isochor/base/error.h"
#include "isochor/base/outcome.h"
#include "isochor/bspline/surface.h"
#include "isochor/exact/rational.h"

int main() {
  using namespace isochor;
  const KnotVector line = KnotVector::uniform(1, 1);
  const Surface square(line, line, {Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(1, 0, 0), Vec3(1, 1, 0)});
  if ((square.point(0.25, 0.75) - Vec3(0.25, 0.75, 0)).norm() > 1e-15) return 1;
  if (name_of(Outcome::kDone) != "done") return 2;
  if (Rational::parse("0.1") + Rational::parse("1/5") != Rational::parse("3/10")) return 3;
  try {
    KnotVector(0, {});
  } catch (const PreconditionError& error) {
    std::puts(error.what());
    return 0;
  }
  return 4;
}
