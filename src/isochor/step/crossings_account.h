// Which faces of a shape cut through each other, and for which that is not known. No OpenCASCADE
// types here.
//
// Each pair of faces gets one of four answers; `pairs` is their sum. A pair is *apart* when
// enclosures of the two faces were proven disjoint piece by piece; *neighbours* share an edge or a
// vertex and are apart but for a strip along what they share; a *crossing* was found and checked;
// the others are *undecided*. The same answers hold for a face and itself.
#pragma once

#include <utility>
#include <vector>

#include "isochor/base/vec3.h"

namespace isochor {

struct Crossing {
  int face_a = 0, face_b = 0;  // 0-based; the same: the face cuts through itself
  Vec3 at = Vec3::Zero();      // on both, to rounding
  // One face reaches this far through the other on both sides of it, at the least; more than
  // `limit`, which is made of their tolerances and gaps.
  double depth = 0.0, limit = 0.0;
  bool one_body = true;  // false: the faces belong to different solids
};

struct CrossingsAccount {
  long pairs = 0, apart = 0, neighbours = 0, crossing = 0, undecided = 0;
  long faces = 0, faces_free = 0, faces_crossing = 0, faces_undecided = 0;  // with themselves
  std::vector<Crossing> found;                       // the first one of each pair
  std::vector<std::pair<int, int>> undecided_pairs;  // the first few
};

}  // namespace isochor
