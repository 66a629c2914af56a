// The inner loops of VolumeContraction on one strip of columns, four columns at a time.
//
// Symbols: a strip holds 4 L columns of a grid of poles. Lane l of a Pack belongs to column l L +
// t, t = 0 .. L - 1: neighbours of a column are in the same lane of a neighbouring Pack, so that
// every load is aligned whatever the offset. d and e are the degrees in u and v; C coordinates are
// carried (three, or the two that one gradient column needs) and G gradient columns come out (three
// or one).
//
// Stages, in the words of docs/volume.md, "Tensors on differences":
//   pairs:  D[o]_t    = sum over s of tau^v_{t,o,s} step_{t+s-e}             (along v, for row k)
//   areas:  T[a]_t    = sum over o of along_u[a]_{t+o-e} x D[o]_t            (for row j = k - d +
//   a) rows:   row[b]_t += sum over a of tau^u_{a,b} T[a]_t                     (row i = k - d + b)
// areas never leave the registers.
//
// The file contraction_stages.h holds the loops; it is compiled once for every instruction set.
#pragma once

#include "isochor/base/instruction_set.h"

namespace isochor::internal {

inline constexpr int kLanes = 4;

struct alignas(8 * kLanes) Pack {
  double lane[kLanes];
};

enum class Columns { kAll, kOne };  // all three gradient columns, or one

// Along v. Sums over the offsets o = 0 .. 2e and, for each, s = first_step(e, o) ..
// end_step(e, o) - 1; `tau` holds one Pack for each (t, o, s) in that order.
struct PairsArguments {
  int degree = 0;  // e
  int length = 0;  // L
  const Pack* tau = nullptr;
  const Pack* steps = nullptr;  // C Packs for each t = -e .. L + e - 2
  Pack* pairs = nullptr;        // out: C Packs for each (t, o)
};
constexpr int first_step(int e, int o) { return o > e ? o - e : 0; }
constexpr int end_step(int e, int o) { return o < e ? o + e : 2 * e; }
// The number of (o, s): 3 e^2 + e.
constexpr int step_count(int e) { return e * (3 * e + 1); }

// Across rows, for one row k.
struct RowsArguments {
  int degree = 0;   // d
  int offsets = 0;  // 2e + 1
  int length = 0;   // L
  const Pack* pairs = nullptr;
  const Pack* const* along_u = nullptr;  // 2d rows; C Packs for each t = -e .. L + e - 1
  const double* tau = nullptr;           // 2d x (2d + 1), entry (a, b)
  Pack* const* rows = nullptr;           // 2d + 1 rows; G Packs for each t
};

struct Stages {
  // out[k] = a[k] - b[k] for k = 0 .. count - 1.
  void (*subtract)(const Pack* a, const Pack* b, int count, Pack* out) = nullptr;
  void (*pairs)(const PairsArguments&) = nullptr;
  void (*rows)(const RowsArguments&) = nullptr;
};

// The loops for these degrees: unrolled for degrees up to 6, else with counts known at run time.
// kAvx2 is for processors that have it (best_instruction_set()).
Stages find_stages(InstructionSet set, Columns columns, int u_degree, int v_degree);

// One instruction set each; the second gives null pointers where the library was built without it.
Stages portable_stages(Columns columns, int u_degree, int v_degree);
Stages avx2_stages(Columns columns, int u_degree, int v_degree);

}  // namespace isochor::internal
